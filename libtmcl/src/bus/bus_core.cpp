#include "bus/bus_core.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include <poll.h>

#include "link/opening.hpp"

namespace tmcl {
namespace {

// Far more than one exchange brings; a flood of garbage is read over several rounds.
constexpr std::size_t read_size = 512;
constexpr int frames_per_round = 64;
// So often input is looked for before a request goes out all the same: on a line that is never
// silent.
constexpr unsigned most_looks = 8;

Traffic traffic_of(const CanFrame& frame, Traffic::Direction direction, TimePoint now) {
  return {now, direction, frame.id, frame.extended, std::span(frame.data).first(frame.length)};
}

BusOptions named(BusOptions options, const Link& link) {
  if (options.name.empty()) options.name = link.name();
  return options;
}

}  // namespace

BusCore::BusCore(Link link, BusOptions options)
    : link_(std::move(link)),
      engine_(link_.framing(), link_.wire_time(), named(std::move(options), link_)) {}

void BusCore::on_readable(TimePoint now) {
  if (open_) read(now, nullptr);
}

/// `next`: what goes out if nothing has come in. True if something has.
bool BusCore::read(TimePoint now, const Request* next) {
  return link_.framing() == Framing::serial ? read_bytes(now, next) : read_frames(now, next);
}

bool BusCore::read_bytes(TimePoint now, const Request* next) {
  std::array<std::uint8_t, read_size> buffer;
  const auto count = link_.read(buffer);
  if (count && *count == 0) return false;
  if (next != nullptr) engine_.on_input_before(*next);
  if (count) {
    const auto bytes = std::span(buffer).first(*count);
    tell({now, Traffic::Direction::in, 0, false, bytes});
    engine_.on_bytes(bytes, now);
  } else {
    close(count.error().message);
  }
  return true;
}

bool BusCore::read_frames(TimePoint now, const Request* next) {
  for (int i = 0; i < frames_per_round; ++i) {
    const auto input = link_.read_frame();
    if (input && !*input) return i > 0;
    if (next != nullptr && i == 0) engine_.on_input_before(*next);
    if (!input) {
      close(input.error().message);
      return true;
    }
    if (const auto* frame = std::get_if<CanFrame>(&**input)) {
      tell(traffic_of(*frame, Traffic::Direction::in, now));
      engine_.on_frame(*frame, now);
    } else {
      const auto& condition = std::get<CanCondition>(**input);
      conditions_.push_back(
          {BusEvent::Kind::link_condition, {}, condition.severe ? 1 : 0, condition.text});
    }
  }
  return true;
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

void BusCore::send(const engine::Send& send, TimePoint now) {
  if (!open_) return;
  const auto& request = send.request;
  if (refuses_movements_ && effect_of(request.command, request.type) == Effect::moves)
    return engine_.on_send_refused(request, now);
  // What has come in before the request goes out is no answer to it.
  looks_ = looks_ < most_looks && read(now, &send.request) ? looks_ + 1 : 0;
  if (looks_ > 0) return engine_.on_deadline(now);
  link_.framing() == Framing::serial ? send_bytes(send, now) : send_frame(send, now);
}

void BusCore::send_frame(const engine::Send& send, TimePoint now) {
  const auto frame = encode_can(send.request, link_.can_extended());
  const auto sent = link_.write_frame(frame);
  if (!sent) return close(sent.error().message);
  if (!*sent) return engine_.on_send_refused(send.request, now);
  auto traffic = traffic_of(frame, Traffic::Direction::out, now);
  traffic.asker = send.asker;
  tell(traffic);
}

void BusCore::send_bytes(const engine::Send& send, TimePoint now) {
  // What a stuck link cannot take now must not reach the module later, when it is not wanted any
  // more.
  if (wants_to_write()) return engine_.on_send_refused(send.request, now);
  unfinished_ = encode_serial(send.request);
  std::span<const std::uint8_t> bytes = unfinished_;
  if (send.leaves_ascii) {
    const auto line = engine::leaving_ascii_mode(send.request.address);
    std::ranges::copy(line, unfinished_.begin());
    bytes = bytes.first(line.size());
  }
  const auto count = link_.write(bytes);
  if (!count) return close(count.error().message);
  if (*count == 0) return engine_.on_send_refused(send.request, now);
  unwritten_ = bytes.subspan(*count);
  tell({now, Traffic::Direction::out, 0, false, bytes, send.asker});
}

void BusCore::stop_at_once(AxisAddress motor) noexcept {
  const Request stop{motor.module, Command::MST, 0, motor.motor, 0};
  try {
    if (open_) write_stop(stop);
  } catch (...) {  // only a link that fails takes memory, to say why
  }
}

void BusCore::write_stop(const Request& stop) {
  if (link_.framing() == Framing::can) {
    (void)link_.write_frame(encode_can(stop, link_.can_extended()));
    return;
  }
  if (wants_to_write()) (void)link_.write(std::exchange(unwritten_, {}));
  if (engine_.next_deadline()) await_silence();
  (void)link_.write(encode_serial(stop));
  await_silence();
}

/// Until an answer has come, or should have. Of what it says nothing depends.
void BusCore::await_silence() {
  constexpr int patience_ms = 5;
  const auto wire_ms = std::chrono::ceil<std::chrono::milliseconds>(link_.wire_time()).count();
  SerialBytes answer{};
  pollfd waiting{link_.descriptor(), POLLIN, 0};
  for (std::size_t left = answer.size(); left > 0;) {
    if (::poll(&waiting, 1, patience_ms + static_cast<int>(wire_ms)) <= 0) return;
    const auto count = link_.read(std::span(answer).first(left));
    if (!count || *count == 0) return;
    left -= *count;
  }
}

namespace {

bool is_unanswered_movement(const Result<Answer>& result) {
  if (result || result.error().code != Errc::reply_timeout || !result.error().request) return false;
  const auto& request = *result.error().request;
  return effect_of(request.command, request.type) == Effect::moves;
}

}  // namespace

void BusCore::run_actions(TimePoint now,
                          const std::function<void(engine::Completion)>& on_completion,
                          const std::function<void(const BusEvent&)>& on_event) {
  for (const auto& event : std::exchange(conditions_, {})) on_event(event);
  while (auto action = engine_.next_action()) {
    if (const auto* to_send = std::get_if<engine::Send>(&*action)) {
      send(*to_send, now);
    } else if (auto* completion = std::get_if<engine::Completion>(&*action)) {
      const bool comes_late = is_unanswered_movement(completion->result);
      on_completion(std::move(*completion));
      if (comes_late && open_ && abort_connection(link_.descriptor()))
        close(
            "a movement was not answered: the connection was ended, so that it does not come late");
    } else {
      on_event(std::get<BusEvent>(*action));
    }
  }
}

}  // namespace tmcl
