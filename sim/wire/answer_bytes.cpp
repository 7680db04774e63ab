#include "sim/wire/answer_bytes.hpp"

#include <algorithm>

#include "tmcl/parameter.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

SerialBytes text_bytes(std::uint8_t host, FirmwareVersion version) {
  SerialBytes bytes{host};
  std::ranges::copy(to_text(version), bytes.begin() + 1);
  return bytes;
}

}  // namespace

Sender sender(const Globals& globals) {
  return {globals.byte(gp::serial_host_address), globals.byte(gp::serial_address)};
}

SerialBytes answer_bytes(Sender from, const Module& module, Command command, const Answer& answer) {
  if (answer.form == Answer::Form::version_text) return text_bytes(from.host, module.version());
  if (answer.form == Answer::Form::program_line) {
    return encode_serial(program::memory_reply(answer.line, from.host));
  }
  return encode_serial(Reply{from.host, from.module, answer.status, command, answer.value});
}

Reply arrival_of(Sender from, std::int32_t motors) {
  return {from.host, from.module, Status::delayed, Command::TARGET_REACHED_EVENT, motors};
}

}  // namespace tmcl::sim
