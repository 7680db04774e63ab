#include "engine/custody.hpp"

#include "tmcl/bus_options.hpp"

namespace tmcl::engine {
namespace {

constexpr unsigned most_ends = 3;

}  // namespace

std::shared_ptr<Hold> Custody::holder() const {
  auto hold = holder_.lock();
  return hold && hold->ended == Hold::End::not_yet ? hold : nullptr;
}

bool Custody::admits(const Call& call) const {
  const auto hold = holder();
  if (recording_) return hold ? call.options.hold == hold : gave_up();
  return !hold || call.options.hold == hold || call.is_stop();
}

bool Custody::is_lost_on_bootloader(const Call& call) const {
  const auto hold = holder();
  return hold && hold->in_bootloader && call.options.hold != hold;
}

void Custody::on_sent(const Call& call, TimePoint now) {
  if (!call.options.hold) return;
  holder_ = call.options.hold;
  has_holder_ = true;
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

std::shared_ptr<Hold> Custody::end_download(Hold::End why) {
  auto hold = recording_ ? holder() : nullptr;
  if (hold) hold->ended = why;
  return hold;
}

void Custody::look_after(TimePoint now, bool in_flight) {
  if (!has_holder_) return;
  const auto hold = holder();
  if (hold && !in_flight && now - last_used_ >= hold_idle_limit) hold->ended = Hold::End::idle;
  if (!holder()) has_holder_ = false;
}

bool Custody::gave_up() const { return ends_sent_ >= most_ends; }

}  // namespace tmcl::engine
