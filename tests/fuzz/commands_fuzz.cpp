// The bytes as commands to simulated modules, with time passing between them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bench.hpp"

namespace {

using tmcl::fuzz::require;
using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t bytes_per_command = 9;
// A fuzzer would rather try other commands than let time pass.
constexpr std::size_t most_commands = 40;

/// Numbers near where something ends are likelier than any others.
std::int32_t value_of(Bytes bytes) {
  const std::array<std::int64_t, 8> near{0, 1, -1, 2047, 1234, 65536, INT32_MAX, INT32_MIN};
  const auto any = tmcl::detail::get_value(bytes.subspan(1, 4));
  return bytes[0] < near.size() ? static_cast<std::int32_t>(near[bytes[0]]) : any;
}

void check(const tmcl::fuzz::Bench& bench, const tmcl::Request& request) {
  if (bench.sent.empty()) return;
  require(bench.sent.size() % tmcl::serial_datagram_size == 0, "replies are whole");
  if (request.command == tmcl::Command::GET_FIRMWARE_VERSION ||
      request.command == tmcl::Command::READ_TMCL_MEMORY) {
    return;
  }
  const auto reply = tmcl::decode_serial_reply(Bytes(bench.sent).first<9>());
  require(reply.has_value(), "with the right sum");
  require(tmcl::find_status(reply->status) != nullptr, "a status that a manual lists");
  require(reply->command == request.command, "and the command that it answers");
}

void give(tmcl::fuzz::Bench& bench, Bytes bytes) {
  const tmcl::Request request{tmcl::ModuleAddress{static_cast<std::uint16_t>(1 + bytes[0] % 2)},
                              static_cast<tmcl::Command>(bytes[1]), bytes[2],
                              static_cast<std::uint8_t>(bytes[3] % 8), value_of(bytes.subspan(4))};
  const bool ascii =
      bench.bench.modules()[0]->in_ascii_mode() || bench.bench.modules()[1]->in_ascii_mode();
  bench.sent.clear();
  bench.line.receive(encode_serial(request));
  if (!ascii) check(bench, request);
  bench.pass(std::chrono::milliseconds(bytes[0] / 2));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tmcl::fuzz::Bench bench{3110, 1276};
  Bytes bytes(data, size);
  for (std::size_t i = 0; i < most_commands && bytes.size() >= bytes_per_command; ++i) {
    give(bench, bytes);
    bytes = bytes.subspan(bytes_per_command);
  }
  return 0;
}
