#include "engine/custody.hpp"

#include <algorithm>

#include "tmcl/bus_options.hpp"

namespace tmcl::engine {
namespace {

constexpr unsigned most_ends = 3;

}  // namespace

SharedHold Custody::holder() const {
  auto hold = holder_.lock();
  return hold && end_of(hold) == End::not_yet ? hold : nullptr;
}

Custody::End Custody::end_of(const SharedHold& hold) const {
  const auto is_same = [&](const Ended& ended) { return ended.hold.lock() == hold; };
  const auto found = std::ranges::find_if(ended_, is_same);
  return found == ended_.end() ? End::not_yet : found->why;
}

void Custody::end(const SharedHold& hold, End why) {
  std::erase_if(ended_, [](const Ended& ended) { return ended.hold.expired(); });
  ended_.push_back({hold, why});
}

bool Custody::admits(const Call& call) const {
  const auto hold = holder();
  if (recording_) return hold ? call.options.hold == hold : gave_up();
  return !hold || call.options.hold == hold || call.is_stop();
}

bool Custody::is_lost_on_bootloader(const Call& call) const {
  const auto hold = holder();
  return hold && in_bootloader_ && call.options.hold != hold;
}

void Custody::on_submitted(const Call& call) {
  if (call.options.hold && call.options.hold == holder())
    in_bootloader_ = call.options.in_bootloader;
}

void Custody::on_sent(const Call& call, TimePoint now) {
  if (!call.options.hold) return;
  holder_ = call.options.hold;
  has_holder_ = true;
  in_bootloader_ = call.options.in_bootloader;
  last_used_ = now;
  if (call.request.command != Command::START_DOWNLOAD || call.options.is_program_line) return;
  recording_ = true;
  ends_sent_ = 0;
}

void Custody::on_answered(Command command, Status status, TimePoint now) {
  last_used_ = now;
  const bool ended = command == Command::END_DOWNLOAD && status != Status::command_loaded;
  const bool refused = command == Command::START_DOWNLOAD && !is_success(status);
  if (!ended && !refused) return;
  recording_ = false;
  ends_sent_ = 0;
}

void Custody::found_recording() {
  recording_ = true;
  ends_sent_ = 0;
}

SharedHold Custody::end_download() {
  auto hold = recording_ ? holder() : nullptr;
  if (hold) end(hold, End::stop);
  return hold;
}

void Custody::look_after(TimePoint now, bool in_flight) {
  if (!has_holder_) return;
  const auto hold = holder();
  if (hold && !in_flight && now - last_used_ >= hold_idle_limit) end(hold, End::idle);
  if (!holder()) has_holder_ = false;
}

bool Custody::gave_up() const { return ends_sent_ >= most_ends; }

}  // namespace tmcl::engine
