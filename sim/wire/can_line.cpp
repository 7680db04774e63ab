#include "sim/wire/can_line.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "sim/bench.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

constexpr std::uint8_t long_frame = sizeof CanFrame::data;
// Seven bytes at 1 Mbit/s, stuffing included.
constexpr auto frame_time = std::chrono::microseconds(125);
// Modules hold few frames back; what more they would send is lost.
constexpr std::size_t most_on_the_wire = 64;

std::uint32_t identifier(const Globals& globals, std::uint8_t number) {
  return static_cast<std::uint32_t>(globals.value(number));
}

bool is_for(const Module& module, const CanFrame& frame) {
  const auto secondary = identifier(module.globals(), gp::can_secondary_address);
  return frame.id == identifier(module.globals(), gp::can_id) ||
         (secondary != 0 && frame.id == secondary);
}

}  // namespace

CanLine::CanLine(Bench& bench, Output output, Pace pace)
    : Line(bench), output_(std::move(output)), pace_(pace) {}

void CanLine::receive(const CanFrame& frame) {
  if (pace_)
    return on_the_wire_.send({nullptr, frame}, bench().clock().now(), pace_.of_frame(frame));
  for (const auto& module : bench().modules()) hear(*module, frame);
}

void CanLine::hear(Module& module, const CanFrame& frame) {
  if (!is_for(module, frame)) return;
  auto& ear = ears_[&module];
  std::ranges::copy_n(frame.data.begin(), std::min(frame.length, long_frame), ear.bytes.begin());
  const Format format{frame.extended,
                      frame.length == can_datagram_size ? can_datagram_size : long_frame};
  const auto request = decode_can_request({frame.id, frame.extended, long_frame, ear.bytes});
  if (!request) return;
  ear.format = format;
  const auto& globals = module.globals();
  const auto own = identifier(globals, gp::can_id);
  const auto reply_id = identifier(globals, gp::can_reply_id);
  const auto answer = module.execute(*request, Medium::can, *this);
  if (frame.id != own || answer.form == Answer::Form::none) return;
  if (answer.form == Answer::Form::version_text) {
    CanFrame text{reply_id, format.extended, format.length, {}};
    std::ranges::copy_n(to_text(module.version()).begin(), format.length, text.data.begin());
    return send(module, text);
  }
  const Reply ordinary{0, reply_byte(ModuleAddress{static_cast<std::uint16_t>(own)}), answer.status,
                       request->command, answer.value};
  const auto reply =
      answer.form == Answer::Form::program_line ? program::memory_reply(answer.line) : ordinary;
  send(module, encode_can(reply, reply_id, format.extended, format.length));
}

void CanLine::target_reached(const Module& module, std::int32_t motors) {
  const auto& globals = module.globals();
  const auto format = ears_[&module].format;
  const Reply event{0, globals.byte(gp::can_id), Status::delayed, Command::TARGET_REACHED_EVENT,
                    motors};
  send(module,
       encode_can(event, identifier(globals, gp::can_reply_id), format.extended, format.length));
}

void CanLine::send(const Module& sender, const CanFrame& frame) {
  if (answering_.size() + on_the_wire_.size() >= most_on_the_wire) return;
  const auto now = bench().clock().now();
  if (pace_) {
    answering_.push_back({now + pace_.to_answer, {&sender, frame}});
    return;
  }
  output_(frame);
  if (is_heard(sender, frame)) on_the_wire_.send({&sender, frame}, now, frame_time);
}

bool CanLine::is_heard(const Module& sender, const CanFrame& frame) const {
  return std::ranges::any_of(bench().modules(), [&](const auto& module) {
    return module.get() != &sender && is_for(*module, frame);
  });
}

TimePoint CanLine::next_due() const {
  const auto next = on_the_wire_.next_due();
  return answering_.empty() ? next : std::min(next, answering_.front().first);
}

// What is answered to a frame ends later than now: this ends.
void CanLine::run_due() {
  const auto now = bench().clock().now();
  while (next_due() <= now) {
    while (!answering_.empty() && answering_.front().first <= now) {
      const auto& answer = answering_.front().second;
      on_the_wire_.send(answer, now, pace_.of_frame(answer.frame));
      answering_.pop_front();
    }
    const auto sent = on_the_wire_.take(now);
    if (!sent) continue;
    if (pace_ && sent->sender != nullptr) output_(sent->frame);
    for (const auto& module : bench().modules()) {
      if (module.get() != sent->sender) hear(*module, sent->frame);
    }
  }
}

}  // namespace tmcl::sim
