#include "sim/module/module.hpp"

#include <algorithm>

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

constexpr std::uint8_t suppress_reply = 255;

}  // namespace

Module::Module(const Model& model, ModuleAddress address, const Clock& clock)
    : model_(&model),
      clock_(&clock),
      now_(clock.now()),
      globals_(address, clock),
      events_(model.axes) {
  for (int i = 0; i < model.axes; ++i) axes_.emplace_back(model.family, now_);
}

FirmwareVersion Module::version() const { return {model_->number, 1, 1}; }

Answer Module::execute(const Request& request, Medium medium, EventSink& from) {
  run_due();
  heartbeat(medium).heard(now_);
  auto answer = execute_direct(request, from);
  const bool reads = effect_of(request.command, request.type) == Effect::reads;
  if (globals_.value(suppress_reply) != 0 && !reads) answer.form = Answer::Form::none;
  return answer;
}

Answer Module::execute_direct(const Request& request, EventSink& from) {
  switch (request.command) {
    case Command::GET_FIRMWARE_VERSION: return tell_version(request);
    case Command::TARGET_REACHED_EVENT: return arm_event(request, from);
    default: return perform(request);
  }
}

Answer Module::perform(const Request& request) {
  switch (request.command) {
    case Command::ROR: return rotate(request, 1);
    case Command::ROL: return rotate(request, -1);
    case Command::MST: return stop(request);
    case Command::MVP: return move(request);
    case Command::SAP: return set_axis_parameter(request);
    case Command::GAP: return get_axis_parameter(request);
    case Command::SGP: return set_global_parameter(request);
    case Command::GGP: return get_global_parameter(request);
    default: return echo(request, Status::invalid_command);
  }
}

TimePoint Module::serial_due() const {
  return serial_.due(globals_.milliseconds(gp::serial_heartbeat));
}

TimePoint Module::can_due() const { return can_.due(globals_.milliseconds(gp::can_heartbeat)); }

void Module::stop_if_silent() {
  const bool serial_silent = serial_due() <= now_;
  const bool can_silent = can_due() <= now_;
  if (serial_silent) serial_.expire();
  if (can_silent) can_.expire();
  if (serial_silent || can_silent) stop_all_motors();
}

TimePoint Module::next_due() const {
  auto due = std::min({serial_due(), can_due(), events_.next_due(axes_)});
  for (const auto& axis : axes_) due = std::min(due, axis.next_due());
  return due;
}

// Each thing that is due leaves with a later time, or none, when it is due next.
void Module::run_due() {
  const auto present = clock_->now();
  for (auto due = next_due(); due <= present; due = next_due()) {
    bring_to(due);
    run_what_is_due_now();
  }
  bring_to(present);
}

void Module::bring_to(TimePoint time) {
  now_ = std::max(now_, time);
  for (auto& axis : axes_) axis.advance_to(now_);
}

void Module::run_what_is_due_now() {
  stop_if_silent();
  for (auto& axis : axes_) axis.run_due();
  events_.run_due(now_, axes_, *this);
}

}  // namespace tmcl::sim
