#include "sim/wire/serial_line.hpp"

#include <algorithm>
#include <utility>

#include "sim/bench.hpp"
#include "sim/wire/answer_bytes.hpp"
#include "sim/wire/rates.hpp"
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

bool takes_any_address(const Module& module) {
  return module.settings().traits.get<Addressing>(Trait::addressing, module.model()) ==
         Addressing::any;
}

}  // namespace

SerialLine::SerialLine(Bench& bench, Output output, const SerialWire& wire)
    : Line(bench), output_(std::move(output)), wire_(wire), disturbance_(wire.noise, wire.seed) {}

void SerialLine::receive(std::span<const std::uint8_t> bytes) {
  receive(bytes, bench().clock().now());
}

void SerialLine::receive(std::span<const std::uint8_t> bytes, TimePoint earliest) {
  Bytes said(bytes.begin(), bytes.end());
  if (!wire_.pace) return hear(std::move(said), earliest);
  coming_.send({earliest, std::move(said)}, bench().clock().now(),
               wire_.pace.of_bytes(bytes.size()));
}

void SerialLine::hear(Bytes bytes, TimePoint earliest) {
  if (wire_.echoes) output_(bytes);
  disturbance_.disturb(bytes);
  const auto& modules = bench().modules();
  ears_.resize(modules.size());
  for (const auto byte : bytes) {
    for (std::size_t i = 0; i < modules.size(); ++i) {
      const auto heard = is_at_rate_of_host(*modules[i]) ? byte : disturbance_.garbage();
      hear(*modules[i], ears_[i], heard, earliest);
    }
  }
}

bool SerialLine::is_at_rate_of_host(const Module& module) const {
  if (!wire_.pace || !wire_.has_rates_of_modules) return true;
  return serial_rate(module.globals().value(gp::serial_baud_rate)) == wire_.pace.bits_per_second;
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
  const bool addressed = frame[0] == from.module || takes_any_address(module);
  if (!module.hears() || (!addressed && !obeys_silently(module.globals(), frame[0]))) return;
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
  if (!module.hears() || (!addressed && !obeys_silently(module.globals(), reply_byte(*meant))))
    return;
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
  const auto own = module.settings().to_answer;
  if (own || wire_.pace) pause += own.value_or(wire_.pace.to_answer);
  if (pause.count() == 0) return say({std::move(bytes), &module});
  if (delayed_.size() < most_delayed)
    delayed_.push_back({bench().clock().now() + pause, std::move(bytes), &module});
}

void SerialLine::say(Said said) {
  if (!is_at_rate_of_host(*said.speaker)) disturbance_.garble(said.bytes);
  disturbance_.disturb(said.bytes);
  if (!wire_.pace) return output_(said.bytes);
  auto* before = going_.last();
  if (before != nullptr && before->speaker != said.speaker)
    return disturbance_.garble(before->bytes);
  const auto takes = wire_.pace.of_bytes(said.bytes.size());
  going_.send(std::move(said), bench().clock().now(), takes);
}

TimePoint SerialLine::next_due() const {
  const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
  const auto on_wires = std::min(coming_.next_due(), going_.next_due());
  return first == delayed_.end() ? on_wires : std::min(on_wires, first->at);
}

void SerialLine::run_due() {
  const auto now = bench().clock().now();
  while (next_due() <= now) {
    if (const auto said = going_.take(now)) output_(said->bytes);
    if (auto heard = coming_.take(now)) hear(std::move(heard->bytes), heard->at);
    const auto first = std::ranges::min_element(delayed_, {}, &Delayed::at);
    if (first != delayed_.end() && first->at <= now) {
      Said said{std::move(first->bytes), first->speaker};
      delayed_.erase(first);
      say(std::move(said));
    }
  }
}

void SerialLine::target_reached(const Module& module, std::int32_t motors) {
  const auto event = arrival_of(sender(module.globals()), motors);
  if (module.in_ascii_mode()) return send(module, bytes_of(ascii::to_text(event) + '\r'));
  const auto bytes = encode_serial(event);
  send(module, Bytes(bytes.begin(), bytes.end()));
}

}  // namespace tmcl::sim
