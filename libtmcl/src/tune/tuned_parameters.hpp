/// The axis parameters that tuning sets and reads.
#pragma once

#include "tmcl/parameter_number.hpp"

namespace tmcl::verbs::tuned {

constexpr auto max_current = number_of("max_current");
constexpr auto standby_current = number_of("standby_current");
constexpr auto max_bow = number_of("max_bow");
constexpr auto load_value = number_of("load_value");
constexpr auto threshold = number_of("stallguard2_threshold");
constexpr auto stop_on_stall = number_of("smart_energy_stall_velocity");
constexpr auto cool_step = number_of("smart_energy_hysteresis_start");

}  // namespace tmcl::verbs::tuned
