/// What a module says on a serial line or over USB, as bytes.
#pragma once

#include <cstdint>

#include "sim/module/module.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// The first two bytes of all that a module says.
struct Sender {
  std::uint8_t host;
  std::uint8_t module;
};

/// As the module's global parameters have it now: what a command changes of these is not in its
/// own answer.
Sender sender(const Globals& globals);

/// For an answer that is one.
SerialBytes answer_bytes(Sender from, const Module& module, Command command, const Answer& answer);
/// That motors of this bit mask have reached their targets (command 138).
Reply arrival_of(Sender from, std::int32_t motors);

}  // namespace tmcl::sim
