#include "bus/bus_core.hpp"

#include <array>

namespace tmcl {
namespace {

// Far more than one exchange brings; a flood of garbage is read over several rounds.
constexpr std::size_t read_size = 512;
constexpr int frames_per_round = 64;

BusOptions named(BusOptions options, const Link& link) {
  if (options.name.empty()) options.name = link.name();
  return options;
}

}  // namespace

BusCore::BusCore(Link link, BusOptions options)
    : link_(std::move(link)),
      engine_(link_.framing(), link_.wire_time(), named(std::move(options), link_)) {}

void BusCore::on_readable(TimePoint now) {
  if (!open_) return;
  if (link_.framing() == Framing::serial) {
    read_bytes(now);
  } else {
    read_frames(now);
  }
}

void BusCore::read_bytes(TimePoint now) {
  std::array<std::uint8_t, read_size> buffer;
  const auto count = link_.read(buffer);
  if (!count) return close(count.error().message);
  engine_.on_bytes(std::span(buffer).first(*count), now);
}

void BusCore::read_frames(TimePoint now) {
  for (int i = 0; i < frames_per_round; ++i) {
    const auto input = link_.read_frame();
    if (!input) return close(input.error().message);
    if (!*input) return;
    if (const auto* frame = std::get_if<CanFrame>(&**input)) {
      engine_.on_frame(*frame, now);
    } else {
      const auto& condition = std::get<CanCondition>(**input);
      conditions_.push_back(
          {BusEvent::Kind::link_condition, {}, condition.severe ? 1 : 0, condition.text});
    }
  }
}

void BusCore::on_writable(TimePoint now) {
  if (!open_) return;
  const auto count = link_.write(unwritten_);
  if (!count) return close(count.error().message);
  unwritten_ = unwritten_.subspan(*count);
  engine_.on_deadline(now);
}

void BusCore::close(const std::string& why) {
  open_ = false;
  unwritten_ = {};
  engine_.on_link_lost(why);
}

void BusCore::send(const Request& request, TimePoint now) {
  if (!open_) return;
  if (link_.framing() == Framing::serial) return send_bytes(request, now);
  const auto sent = link_.write_frame(encode_can(request, link_.can_extended()));
  if (!sent) return close(sent.error().message);
  if (!*sent) engine_.on_send_refused(request, now);
}

void BusCore::send_bytes(const Request& request, TimePoint now) {
  // What a stuck link cannot take now must not reach the module later, when nobody wants it any
  // more.
  if (wants_to_write()) return engine_.on_send_refused(request, now);
  unfinished_ = encode_serial(request);
  const auto count = link_.write(unfinished_);
  if (!count) return close(count.error().message);
  if (*count == 0) return engine_.on_send_refused(request, now);
  unwritten_ = std::span(unfinished_).subspan(*count);
}

void BusCore::run_actions(TimePoint now,
                          const std::function<void(engine::Completion)>& on_completion,
                          const std::function<void(const BusEvent&)>& on_event) {
  for (const auto& event : std::exchange(conditions_, {})) on_event(event);
  while (auto action = engine_.next_action()) {
    if (const auto* to_send = std::get_if<engine::Send>(&*action)) {
      send(to_send->request, now);
    } else if (auto* completion = std::get_if<engine::Completion>(&*action)) {
      on_completion(std::move(*completion));
    } else {
      on_event(std::get<BusEvent>(*action));
    }
  }
}

}  // namespace tmcl
