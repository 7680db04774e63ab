#include "sim/module/module.hpp"

#include <algorithm>

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
namespace gp = global_parameter;

constexpr std::uint8_t suppress_reply = 255;
constexpr std::uint8_t move_absolute = 0;
constexpr std::uint8_t move_relative = 1;
constexpr std::uint8_t event_once = 0;
constexpr std::uint8_t event_always = 1;

Answer echo(const Request& request, Status status = Status::ok) {
  return {Answer::Form::reply, status, request.value};
}

// An unknown number is answered with 0, not with the request's value, as the vendor's firmware
// does.
Answer reading(const tl::expected<std::int32_t, Status>& result) {
  return {Answer::Form::reply, result ? Status::ok : result.error(), result.value_or(0)};
}

}  // namespace

Module::Module(const Model& model, ModuleAddress address, const Clock& clock)
    : model_(&model),
      clock_(&clock),
      power_on_(clock.now()),
      axes_at_(power_on_),
      globals_(address, clock),
      events_(model.axes) {
  for (int i = 0; i < model.axes; ++i) axes_.emplace_back(model.family, power_on_);
}

FirmwareVersion Module::version() const { return {model_->number, 1, 1}; }

Answer Module::execute(const Request& request, Medium medium, EventSink& from) {
  run_due();
  heartbeat(medium).heard(clock_->now());
  auto answer = dispatch(request, from);
  const bool reads = effect_of(request.command, request.type) == Effect::reads;
  if (globals_.value(suppress_reply) != 0 && !reads) answer.form = Answer::Form::none;
  return answer;
}

Answer Module::dispatch(const Request& request, EventSink& from) {
  switch (request.command) {
    case Command::ROR: return rotate(request, 1);
    case Command::ROL: return rotate(request, -1);
    case Command::MST: return stop(request);
    case Command::MVP: return move(request);
    case Command::SAP: return set_axis_parameter(request);
    case Command::GAP: return get_axis_parameter(request);
    case Command::SGP: return set_global_parameter(request);
    case Command::GGP: return get_global_parameter(request);
    case Command::GET_FIRMWARE_VERSION: return tell_version(request);
    case Command::TARGET_REACHED_EVENT: return arm_event(request, from);
    default: return echo(request, Status::invalid_command);
  }
}

Answer Module::rotate(const Request& request, std::int32_t sign) {
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  const auto status = axes_[request.motor].rotate(std::int64_t{sign} * request.value);
  if (status == Status::ok) events_.move_abandoned(request.motor);
  return echo(request, status);
}

Answer Module::stop(const Request& request) {
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  events_.move_abandoned(request.motor);
  axes_[request.motor].stop();
  return echo(request);
}

Answer Module::move(const Request& request) {
  if (request.type != move_absolute && request.type != move_relative) {
    return echo(request, Status::wrong_type);
  }
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  auto& axis = axes_[request.motor];
  const bool relative = request.type == move_relative;
  const auto status = relative ? axis.move_by(request.value) : axis.move_to(request.value);
  if (status != Status::ok) return echo(request, status);
  events_.move_begun(request.motor);
  // The newer firmware tells where a relative movement goes.
  return relative && model_->family == Family::sixpoint ? reading(axis.get(ap::target_position))
                                                        : echo(request);
}

Answer Module::set_axis_parameter(const Request& request) {
  if (!has_motor(request)) {
    const auto* row = find_parameter(axis_parameters(model_->family), request.type);
    const bool writable = row != nullptr && row->access == Access::read_write;
    return echo(request, writable ? Status::invalid_value : Status::wrong_type);
  }
  return echo(request, axes_[request.motor].set(request.type, request.value));
}

Answer Module::get_axis_parameter(const Request& request) const {
  if (has_motor(request)) return reading(axes_[request.motor].get(request.type));
  const bool known = find_parameter(axis_parameters(model_->family), request.type) != nullptr;
  return known ? echo(request, Status::invalid_value) : reading(tl::unexpected(Status::wrong_type));
}

Answer Module::set_global_parameter(const Request& request) {
  const bool foreign_bank = request.motor != 0 && globals_.get(request.type).has_value();
  const auto status =
      foreign_bank ? Status::invalid_value : globals_.set(request.type, request.value);
  // The time of both heartbeats begins when they are set, whichever wire that came by.
  if (status == Status::ok && request.type == gp::serial_heartbeat) serial_.heard(clock_->now());
  if (status == Status::ok && request.type == gp::can_heartbeat) can_.heard(clock_->now());
  return echo(request, status);
}

Answer Module::get_global_parameter(const Request& request) const {
  const auto result = globals_.get(request.type);
  if (result && request.motor != 0) return echo(request, Status::invalid_value);
  return reading(result);
}

Answer Module::tell_version(const Request& request) const {
  switch (static_cast<VersionForm>(request.type)) {
    case VersionForm::text: return {Answer::Form::version_text, Status::ok, 0};
    case VersionForm::binary: return {Answer::Form::reply, Status::ok, to_value(version())};
  }
  return echo(request, Status::wrong_type);
}

Answer Module::arm_event(const Request& request, EventSink& from) {
  if (request.type != event_once && request.type != event_always) {
    return echo(request, Status::wrong_type);
  }
  const auto motors = static_cast<std::uint32_t>(request.value);
  if (motors >> axes_.size() != 0) return echo(request, Status::invalid_value);
  if (request.type == event_once) {
    events_.arm_once(motors, from);
  } else {
    events_.arm_always(motors, from);
  }
  return echo(request);
}

TimePoint Module::serial_due() const {
  return serial_.due(globals_.milliseconds(gp::serial_heartbeat));
}

TimePoint Module::can_due() const { return can_.due(globals_.milliseconds(gp::can_heartbeat)); }

// Stops at the instant the time ran out, even if nobody looked then.
void Module::stop_if_silent(TimePoint now) {
  while (std::min(serial_due(), can_due()) <= now) {
    bring_axes_to(std::min(serial_due(), can_due()));
    (serial_due() <= can_due() ? serial_ : can_).expire();
    for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
      events_.move_abandoned(motor);
      axes_[motor].stop();
    }
  }
}

void Module::bring_axes_to(TimePoint time) {
  axes_at_ = std::max(axes_at_, time);
  for (auto& axis : axes_) axis.advance_to(axes_at_);
}

void Module::run_due() {
  const auto now = clock_->now();
  stop_if_silent(now);
  bring_axes_to(now);
  events_.run_due(now, axes_, *this);
}

TimePoint Module::next_due() const {
  auto due = std::min({serial_due(), can_due(), events_.next_due(axes_)});
  for (const auto& axis : axes_) due = std::min(due, axis.outlook().look_again);
  return due;
}

}  // namespace tmcl::sim
