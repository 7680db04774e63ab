#include "sim/wire/serial_line.hpp"

#include <algorithm>
#include <utility>

#include "sim/bench.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// A host that asks on without waiting for replies loses some, as with a real module's buffer.
constexpr std::size_t most_delayed = 64;

struct Sender {
  std::uint8_t host;
  std::uint8_t module;
};

Sender sender(const Globals& globals) {
  return {globals.byte(gp::serial_host_address), globals.byte(gp::serial_address)};
}

bool obeys_silently(const Globals& globals, std::uint8_t address) {
  const auto secondary = globals.byte(gp::serial_secondary_address);
  return secondary != 0 && address == secondary;
}

SerialBytes text_bytes(std::uint8_t host, FirmwareVersion version) {
  SerialBytes bytes{host};
  std::ranges::copy(to_text(version), bytes.begin() + 1);
  return bytes;
}

SerialBytes answer_bytes(Sender from, const Module& module, Command command, const Answer& answer) {
  if (answer.form == Answer::Form::version_text) return text_bytes(from.host, module.version());
  if (answer.form == Answer::Form::program_line) {
    return encode_serial(program::memory_reply(answer.line, from.host));
  }
  return encode_serial(Reply{from.host, from.module, answer.status, command, answer.value});
}

}  // namespace

SerialLine::SerialLine(Bench& bench, Output output) : Line(bench), output_(std::move(output)) {}

void SerialLine::receive(std::span<const std::uint8_t> bytes) {
  const auto now = bench().clock().now();
  for (const auto byte : bytes) {
    if (const auto frame = framer_.push(byte, now)) deliver(*frame);
  }
}

void SerialLine::deliver(const SerialBytes& frame) {
  for (const auto& module : bench().modules()) hand_to(*module, frame);
}

void SerialLine::hand_to(Module& module, const SerialBytes& frame) {
  const auto from = sender(module.globals());
  const bool addressed = frame[0] == from.module;
  if (!addressed && !obeys_silently(module.globals(), frame[0])) return;
  const auto request = decode_serial_request(frame);
  const auto answer = request ? module.execute(*request, Medium::serial, *this)
                              : Answer{Answer::Form::reply, Status::wrong_checksum, 0};
  if (!addressed || answer.form == Answer::Form::none) return;
  const auto command = request ? request->command : Command{};
  send(module, answer_bytes(from, module, command, answer));
}

void SerialLine::send(const Module& module, const SerialBytes& bytes) {
  const auto pause = module.globals().milliseconds(gp::telegram_pause_time);
  if (pause.count() == 0) return output_(bytes);
  if (delayed_.size() < most_delayed) delayed_.push_back({bench().clock().now() + pause, bytes});
}

TimePoint SerialLine::next_due() const {
  const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
  return first == delayed_.end() ? never : first->at;
}

void SerialLine::run_due() {
  const auto now = bench().clock().now();
  for (auto next = next_due(); next <= now; next = next_due()) {
    const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
    const auto bytes = first->bytes;
    delayed_.erase(first);
    output_(bytes);
  }
}

void SerialLine::target_reached(const Module& module, std::int32_t motors) {
  const auto from = sender(module.globals());
  const Reply event{from.host, from.module, Status::delayed, Command::TARGET_REACHED_EVENT, motors};
  send(module, encode_serial(event));
}

}  // namespace tmcl::sim
