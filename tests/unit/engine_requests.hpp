/// The requests and replies that tests of the engine are made of.
#pragma once

#include <vector>

#include "tmcl/datagram.hpp"

namespace tmcl::test {

inline Request gap(std::uint8_t module, std::uint8_t type = 1, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::GAP, type, motor, 0};
}
inline Request mvp(std::uint8_t module, std::int32_t target, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::MVP, 0, motor, target};
}
inline Request mst(std::uint8_t module, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::MST, 0, motor, 0};
}

inline Reply reply_to(const Request& request, std::int32_t value = 0) {
  return {default_host_address, reply_byte(request.address), Status::ok, request.command, value};
}

inline std::vector<Command> commands_of(const std::vector<Request>& requests) {
  std::vector<Command> commands;
  for (const auto& request : requests) commands.push_back(request.command);
  return commands;
}

}  // namespace tmcl::test
