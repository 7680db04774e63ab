/// What all fronts of a daemon share.
#pragma once

#include <memory>

#include "fronts/latency.hpp"
#include "gateway/store/tokens.hpp"

namespace tmcld {

struct FrontShare {
  std::shared_ptr<Tokens> tokens{};
  /// From when a stop came in until it was answered.
  Latency stop_latency{};
};

}  // namespace tmcld
