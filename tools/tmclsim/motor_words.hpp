/// What the console and the bench file say of the supply of motors, and of their drivers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "sim/stage/driver_fault.hpp"

namespace tmclsim {

/// As in parameter 208, from its bit 1 on.
inline constexpr auto driver_fault_names =
    std::to_array<std::string_view>({"overtemperature", "overtemperature_warning", "short_a",
                                     "short_b", "open_load_a", "open_load_b"});
std::optional<tmcl::sim::DriverFault> parse_driver_fault(std::string_view word);

/// What a USB port gives, in tenths of a volt: the module lives, and its motors have no torque.
inline constexpr std::int32_t usb_supply = 50;
inline constexpr std::string_view usb_supply_word = "usb";
/// "24", "23.5" or "usb", in tenths.
std::optional<std::int32_t> parse_supply(std::string_view text);

}  // namespace tmclsim
