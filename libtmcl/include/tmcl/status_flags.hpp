/// What the flags of a module mean that tell what is wrong, or why a motor stopped.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace tmcl {

struct StatusFlag {
  std::int32_t bit;
  std::string_view name;
};

/// Names of such flags that a stop may be due to.
namespace status_flag {
constexpr std::string_view stall = "stall";
constexpr std::string_view deviation = "deviation";
}  // namespace status_flag

/// Of a parameter with such flags, by its standard name; nothing for any other. What is no fault is
/// left out: that the motor stands, for one.
std::span<const StatusFlag> status_flags(std::string_view parameter);

}  // namespace tmcl
