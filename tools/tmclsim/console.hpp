/// What a person, or a test, does to the simulated world while it runs: lines on standard input.
#pragma once

#include <string>
#include <string_view>

#include "sim/bench.hpp"

namespace tmclsim {

/// Does what the line says, now. "ok", or "error: " and a sentence; nothing for an empty line.
///
///     load 1/0 500        module 1, motor 0: half of what the motor can drive
///     slip 1/0 200        shift its encoder by so many counts
///     press 1/0 right     hold a switch with a finger: left, right or home
///     release 1/0 right
///     input 1 0 1         module 1: digital input 0 is high
///     analog 1 0 512      its analogue input 0 reads so much
///     driver 1/0 short_a on  coil A of the motor has a short circuit
///     supply 1 23.5       the supply of its motors, in volts; usb: as much as that port has
///     brown_out 1 200     too little of it, for so many ms
///     temperature 1 40    in degrees centigrade
///     power 1 off         its supply fails: off, on, or cycle for both
std::string run_console_line(tmcl::sim::Bench& bench, std::string_view line);

}  // namespace tmclsim
