#include "sim/wire/serial_line.hpp"

#include <algorithm>
#include <utility>

#include "sim/bench.hpp"
#include "sim/wire/answer_bytes.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

// A host that asks on without waiting for replies loses some, as with a real module's buffer.
constexpr std::size_t most_delayed = 64;

bool obeys_silently(const Globals& globals, std::uint8_t address) {
  const auto secondary = globals.serial_secondary_address();
  return secondary != 0 && address == secondary;
}

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

SerialLine::SerialLine(Bench& bench, Output output, Pace pace)
    : Line(bench), output_(std::move(output)), pace_(pace) {}

void SerialLine::receive(std::span<const std::uint8_t> bytes) {
  receive(bytes, bench().clock().now());
}

void SerialLine::receive(std::span<const std::uint8_t> bytes, TimePoint earliest) {
  if (!pace_) return hear(bytes, earliest);
  coming_.send({earliest, Bytes(bytes.begin(), bytes.end())}, bench().clock().now(),
               pace_.of_bytes(bytes.size()));
}

void SerialLine::hear(std::span<const std::uint8_t> bytes, TimePoint earliest) {
  const auto& modules = bench().modules();
  ears_.resize(modules.size());
  for (const auto byte : bytes) {
    for (std::size_t i = 0; i < modules.size(); ++i) hear(*modules[i], ears_[i], byte, earliest);
  }
}

bool SerialLine::is_unfinished() const {
  return std::ranges::any_of(ears_, [](const Ear& ear) { return ear.framer.has_begun(); });
}

void SerialLine::hear(Module& module, Ear& ear, std::uint8_t byte, TimePoint earliest) {
  if (ear.ascii != module.in_ascii_mode()) ear = Ear{{}, {}, module.in_ascii_mode()};
  if (ear.ascii) return hear_character(module, ear, byte);
  const auto frame = ear.framer.push(byte, earliest, bench().clock().now());
  if (frame) hand_to(module, *frame);
}

void SerialLine::hear_character(Module& module, Ear& ear, std::uint8_t byte) {
  const auto& globals = module.globals();
  const auto echo = AsciiTerminal::echo_of(globals.value(gp::ascii_mode));
  const auto heard = ear.terminal.push(byte, globals.byte(gp::serial_address), echo);
  if (!heard.echo.empty()) output_(bytes_of(heard.echo));
  if (heard.line) hand_to(module, *heard.line);
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
  const auto bytes = answer_bytes(from, module, command, answer);
  send(module, Bytes(bytes.begin(), bytes.end()));
}

void SerialLine::hand_to(Module& module, const std::string& line) {
  const auto from = sender(module.globals());
  const auto meant = ascii::address_of(line);
  if (!meant) return;
  const bool addressed = reply_byte(*meant) == from.module;
  if (!addressed && !obeys_silently(module.globals(), reply_byte(*meant))) return;
  const auto order = ascii::parse(line);
  const auto answer =
      order ? execute(module, *order) : Answer{Answer::Form::reply, order.error().status, 0};
  if (!addressed || answer.form == Answer::Form::none) return;
  const auto text = ascii::to_text({from.host, from.module, answer.status, {}, answer.value});
  send(module, bytes_of(text + '\r'));
}

Answer SerialLine::execute(Module& module, const ascii::Order& order) {
  if (const auto* request = std::get_if<Request>(&order))
    return module.execute(*request, Medium::serial, *this);
  module.leave_ascii_mode();
  return Answer{};
}

void SerialLine::send(const Module& module, Bytes bytes) {
  Duration pause = module.globals().milliseconds(gp::telegram_pause_time);
  if (pace_) pause += pace_.to_answer;
  if (pause.count() == 0) return say(std::move(bytes));
  if (delayed_.size() < most_delayed)
    delayed_.push_back({bench().clock().now() + pause, std::move(bytes)});
}

void SerialLine::say(Bytes bytes) {
  if (!pace_) return output_(bytes);
  const auto takes = pace_.of_bytes(bytes.size());
  going_.send(std::move(bytes), bench().clock().now(), takes);
}

TimePoint SerialLine::next_due() const {
  const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
  const auto on_wires = std::min(coming_.next_due(), going_.next_due());
  return first == delayed_.end() ? on_wires : std::min(on_wires, first->at);
}

void SerialLine::run_due() {
  const auto now = bench().clock().now();
  while (next_due() <= now) {
    if (const auto heard = coming_.take(now)) hear(heard->bytes, heard->at);
    const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
    if (first != delayed_.end() && first->at <= now) {
      auto bytes = std::move(first->bytes);
      delayed_.erase(first);
      say(std::move(bytes));
    }
    if (const auto said = going_.take(now)) output_(*said);
  }
}

void SerialLine::target_reached(const Module& module, std::int32_t motors) {
  const auto event = arrival_of(sender(module.globals()), motors);
  if (module.in_ascii_mode()) return send(module, bytes_of(ascii::to_text(event) + '\r'));
  const auto bytes = encode_serial(event);
  send(module, Bytes(bytes.begin(), bytes.end()));
}

}  // namespace tmcl::sim
