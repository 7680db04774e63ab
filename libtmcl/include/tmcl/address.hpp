/// Which motor of which module.
#pragma once

#include <compare>
#include <cstdint>

#include "tmcl/datagram.hpp"

namespace tmcl {

struct AxisAddress {
  ModuleAddress module{1};
  std::uint8_t motor = 0;
  auto operator<=>(const AxisAddress&) const = default;
};

}  // namespace tmcl
