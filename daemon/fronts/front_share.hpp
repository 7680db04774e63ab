/// What all fronts of a daemon share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "api/configuration_keeper.hpp"
#include "fronts/latency.hpp"
#include "gateway/store/tokens.hpp"
#include "tmcl/clock.hpp"

namespace tmcld {

struct FrontShare {
  std::shared_ptr<Tokens> tokens{};
  /// Of the page, as a browser takes them; empty where nothing is served by HTTP.
  std::vector<std::string> page_addresses{};
  std::shared_ptr<ConfigurationKeeper> configuration{};
  /// From when a stop came in until it was answered.
  Latency stop_latency{};
  /// When the last system.stop_all came in; TimePoint{}: none has.
  tmcl::TimePoint stopped_all{};
  /// In virtual time: clients are in the same one, and what they say of when they have sent a call
  /// counts.
  bool clients_share_virtual_time = false;
};

}  // namespace tmcld
