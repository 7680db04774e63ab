// The bytes as a program file, and as a program that is loaded into a simulated module and run.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bench.hpp"
#include "tmcl/program.hpp"

namespace {

namespace program = tmcl::program;
using tmcl::fuzz::require;
using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t bytes_per_command = 7;
constexpr std::size_t most_commands = 60;

void as_file(Bytes bytes) {
  const auto commands = program::from_bytes(bytes);
  if (!commands) return require(!commands.error().empty(), "there is a reason");
  require(std::ranges::equal(program::to_bytes(*commands), bytes), "a file is as it was read");
}

void tell(tmcl::fuzz::Bench& bench, tmcl::Command command, std::uint8_t type = 0,
          std::uint8_t motor = 0, std::int32_t value = 0) {
  bench.line.receive(
      encode_serial(tmcl::Request{tmcl::ModuleAddress{1}, command, type, motor, value}));
}

// Jumps within the program are likelier than any others.
void as_program(Bytes bytes) {
  tmcl::fuzz::Bench bench{3110};
  tell(bench, tmcl::Command::START_DOWNLOAD);
  for (std::size_t i = 0; i < most_commands && bytes.size() >= bytes_per_command; ++i) {
    const auto far = tmcl::detail::get_value(bytes.subspan(3, 4));
    const auto value = (bytes[3] & 1U) != 0 ? std::int32_t{bytes[4] % 64} : far;
    tell(bench, static_cast<tmcl::Command>(bytes[0] % 128), bytes[1] % 64, bytes[2] % 8, value);
    bytes = bytes.subspan(bytes_per_command);
  }
  tell(bench, tmcl::Command::END_DOWNLOAD);
  tell(bench, tmcl::Command::RUN_APPLICATION, 1);
  bench.pass(std::chrono::milliseconds(50));
  tell(bench, tmcl::Command::STOP_APPLICATION);
  bench.pass(std::chrono::milliseconds(50));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  as_file({data, size});
  as_program({data, size});
  return 0;
}
