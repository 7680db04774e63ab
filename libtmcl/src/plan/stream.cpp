#include "tmcl/plan/stream.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/stream_runner.hpp"

namespace tmcl::plan {

double AxisTracking::rms() const {
  return readings == 0 ? 0 : std::sqrt(squares / static_cast<double>(readings));
}

// ---- the clock of the course ----

void CourseClock::start(TimePoint now, bool stands) {
  at_ = now;
  rate_ = stands ? 0 : 1;
}

void CourseClock::advance(TimePoint now) {
  const double time = seconds(now - at_);
  at_ = std::max(at_, now);
  if (time > 0) passed_ = passed_after(time, rate_);
}

double CourseClock::passed_in(Duration ahead) const {
  double rate = rate_;
  return passed_after(seconds(ahead), rate);
}

double CourseClock::passed_after(double time, double& rate) const {
  const double goal = paused_ ? 0 : 1;
  const double needed = std::abs(goal - rate) * ramp_s_;
  const double changing = std::min(time, needed);
  const double reached = needed > 0 ? rate + (goal - rate) * changing / needed : goal;
  const double passed = passed_ + (rate + reached) / 2 * changing + (time - changing) * goal;
  rate = reached;
  return passed;
}

// ---- what both modes share ----

namespace {

namespace ap = axis_parameter;
using Kind = StreamCommand::Kind;

constexpr int measuring_rounds = 4;
constexpr int stop_attempts = 3;
constexpr Duration look_interval = std::chrono::milliseconds(10);
constexpr Duration longest_braking = std::chrono::seconds(10);
constexpr Duration longest_way_to_rest = std::chrono::seconds(30);
// Readings at rest that are not on target before an axis counts as stopped by somebody.
constexpr int looks_at_rest = 5;

}  // namespace

PathStream::Runner::Runner(const Course& course, std::vector<StreamAxis> axes,
                           StreamOptions options)
    : course_(course), options_(options), axes_(axes.size()) {
  for (std::size_t i = 0; i < axes.size(); ++i) axes_[i].info = std::move(axes[i]);
  report_.axes.resize(axes_.size());
}

StreamStep PathStream::Runner::next(TimePoint now) {
  now_ = now;
  if (!script_) {
    script_.emplace(whole());
    proceed(script_->start(now));
  } else if (std::holds_alternative<StreamWait>(step_) && wait_is_over()) {
    proceed(script_->resume({}, now));
  }
  return step_;
}

bool PathStream::Runner::wait_is_over() const {
  return now_ >= std::get<StreamWait>(step_).until || (stop_asked_ && phase_ != Phase::after);
}

void PathStream::Runner::answered(TimePoint now, StreamAnswer answer) {
  asked_at_ = now_;
  now_ = now;
  answer_ = std::move(answer);
  if (phase_ == Phase::running || phase_ == Phase::pausing) {
    ++report_.commands;
    report_.busy_s += seconds(now_ - asked_at_);
  }
  proceed(script_->resume({}, now));
}

void PathStream::Runner::proceed(const std::optional<Step>& step) {
  if (step) return;
  phase_ = Phase::ended;
  step_ = StreamEnd{};
}

TimePoint PathStream::Runner::middle() const { return asked_at_ + (now_ - asked_at_) / 2; }

PathStream::Runner::Fault PathStream::Runner::fault(StreamFault::Kind kind, std::size_t axis,
                                                    std::string message) {
  return StreamFault{kind, axis, std::move(message)};
}

// A command that fails because its sender wants to stop is none that was refused.
PathStream::Runner::Fault PathStream::Runner::refusal(std::size_t axis) const {
  if (stop_asked_) return stop_asked_;
  return fault(StreamFault::Kind::refused, axis, fmt::format("{{{}}}: {}", axis, answer_.error()));
}

PathStream::Runner::Fault PathStream::Runner::asked_to_stop() const { return stop_asked_; }

Script<PathStream::Runner::Fault> PathStream::Runner::know(std::size_t axis,
                                                           std::uint8_t parameter) {
  if (axes_[axis].before.contains(parameter)) co_return std::nullopt;
  co_await command({Kind::get, axis, parameter, 0});
  if (!answer_) co_return refusal(axis);
  axes_[axis].before[parameter] = *answer_;
  axes_[axis].parameters[parameter] = *answer_;
  co_return std::nullopt;
}

bool PathStream::Runner::is_known_as(std::size_t axis, std::uint8_t parameter,
                                     std::int32_t value) const {
  const auto known = axes_[axis].parameters.find(parameter);
  return known != axes_[axis].parameters.end() && known->second == value;
}

Script<PathStream::Runner::Fault> PathStream::Runner::set(std::size_t axis, std::uint8_t parameter,
                                                          std::int32_t value) {
  auto unknown = co_await know(axis, parameter);
  if (unknown) co_return unknown;
  if (is_known_as(axis, parameter, value)) co_return std::nullopt;
  // Whether or not an answer comes: it may be carried out.
  axes_[axis].parameters.erase(parameter);
  co_await command({Kind::set, axis, parameter, value});
  if (!answer_) co_return refusal(axis);
  axes_[axis].parameters[parameter] = value;
  if (axes_[axis].info.twin) {
    let_twin_run(axis, middle());
    axes_[axis].info.twin->set({parameter, value});
  }
  co_return std::nullopt;
}

void PathStream::Runner::let_twin_run(std::size_t axis, TimePoint to) {
  auto& twin = *axes_[axis].info.twin;
  const auto ahead = to - twin_start_ - (twin.elapsed() - axes_[axis].twin_begin);
  if (ahead > Duration::zero()) twin.advance(ahead);
}

std::int32_t PathStream::Runner::microsteps(std::size_t axis, double position) const {
  return static_cast<std::int32_t>(std::lround(position * axes_[axis].info.microsteps_per_unit));
}

Script<PathStream::Runner::Fault> PathStream::Runner::measure() {
  const auto begin = course_.at(0).position;
  Duration total{};
  int count = 0;
  for (int round = 0; round < measuring_rounds; ++round) {
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      if (auto asked = asked_to_stop()) co_return asked;
      const bool looks_at_speed = round == 0;
      co_await command(
          {Kind::get, axis, looks_at_speed ? ap::actual_velocity : ap::actual_position, 0});
      if (!answer_) co_return refusal(axis);
      const auto wanted = looks_at_speed ? 0 : microsteps(axis, begin[axis]);
      if (*answer_ != wanted) {
        co_return fault(StreamFault::Kind::not_at_start, axis,
                        looks_at_speed
                            ? fmt::format("{{{}}} is moving", axis)
                            : fmt::format("{{{}}} is at {} and not at {}, where the path starts",
                                          axis, *answer_, wanted));
      }
      total += now_ - asked_at_;
      report_.worst_round_trip = std::max(report_.worst_round_trip, now_ - asked_at_);
      ++count;
    }
  }
  report_.round_trip = total / count;
  co_return std::nullopt;
}

Script<PathStream::Runner::Fault> PathStream::Runner::whole() {
  auto result = co_await measure();
  const bool by_velocities = options_.mode == StreamMode::velocity;
  if (!result && by_velocities) result = co_await prepare_velocities();
  if (!result && !by_velocities) result = co_await prepare_legs();
  if (!result) {
    const auto begin = now_;
    phase_ = Phase::running;
    if (by_velocities) {
      result = co_await by_velocity();
    } else {
      result = co_await by_position();
    }
    phase_ = Phase::after;
    report_.passed_s = seconds(now_ - begin);
    if (!result && !by_velocities)
      result = co_await come_to_rest(std::vector<bool>(axes_.size(), true), longest_way_to_rest);
    // The last time that a stop by somebody else can be told from one's own.
    if (!result) result = co_await check_all();
    if (result || by_velocities) {
      auto stopped = co_await stop_all();
      if (!result) result = stopped;
    }
  }
  phase_ = Phase::after;
  co_await restore();
  if (!result) result = co_await arrive();
  report_.fault = result;
  co_return result;
}

// What cannot be stopped at once is tried again, after all the others.
Script<PathStream::Runner::Fault> PathStream::Runner::stop_all() {
  std::vector<bool> stopped(axes_.size(), false);
  Fault result;
  for (int attempt = 0; attempt < stop_attempts; ++attempt) {
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      if (stopped[axis]) continue;
      co_await command({Kind::stop, axis, 0, 0});
      stopped[axis] = answer_.has_value();
    }
  }
  report_.unstopped.clear();
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (stopped[axis]) continue;
    report_.unstopped.push_back(axis);
    report_.remarks.push_back(fmt::format("{{{}}} could not be stopped", axis));
  }
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    std::vector<bool> only(axes_.size(), false);
    only[axis] = stopped[axis];
    auto restless = co_await come_to_rest(only, longest_braking);
    if (restless && !result) result = std::move(restless);
  }
  co_return result;
}

Script<PathStream::Runner::Fault> PathStream::Runner::come_to_rest(std::vector<bool> which,
                                                                   Duration at_most) {
  const auto patience = now_ + at_most;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    while (which[axis]) {
      co_await command({Kind::get, axis, ap::actual_velocity, 0});
      if (!answer_) co_return refusal(axis);
      if (*answer_ == 0) break;
      if (now_ > patience)
        co_return fault(StreamFault::Kind::no_end, axis,
                        fmt::format("{{{}}} did not come to rest", axis));
      co_await until(now_ + look_interval);
    }
  }
  co_return std::nullopt;
}

Script<PathStream::Runner::Fault> PathStream::Runner::restore() {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    for (const auto& [parameter, value] : axes_[axis].before) {
      if (is_known_as(axis, parameter, value)) continue;
      co_await command({Kind::set, axis, parameter, value});
      if (!answer_) {
        report_.remarks.push_back(fmt::format("parameter {} of {{{}}} was {} before: {}", parameter,
                                              axis, value, answer_.error()));
      }
    }
  }
  co_return std::nullopt;
}

Script<PathStream::Runner::Fault> PathStream::Runner::arrive() {
  auto wrong = co_await go_to_end();
  if (wrong) {
    co_await stop_all();
  } else {
    report_.unstopped.clear();
  }
  co_return wrong;
}

Script<PathStream::Runner::Fault> PathStream::Runner::go_to_end() {
  const auto end = course_.at(course_.duration()).position;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (auto asked = asked_to_stop()) co_return asked;
    co_await command({Kind::move_to, axis, 0, microsteps(axis, end[axis])});
    if (!answer_) co_return refusal(axis);
  }
  const auto patience = now_ + longest_way_to_rest;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto target = microsteps(axis, end[axis]);
    for (int at_rest = 0;;) {
      co_await command({Kind::get, axis, ap::actual_position, 0});
      if (!answer_) co_return refusal(axis);
      const auto position = *answer_;
      co_await command({Kind::get, axis, ap::actual_velocity, 0});
      if (!answer_) co_return refusal(axis);
      if (*answer_ == 0 && position == target) break;
      if (*answer_ == 0) ++at_rest;
      if (auto asked = asked_to_stop()) co_return asked;
      if (at_rest > looks_at_rest || now_ > patience) {
        co_return fault(
            StreamFault::Kind::no_end, axis,
            fmt::format("{{{}}} stands at {} and not at its end, {}", axis, position, target));
      }
      co_await until(now_ + look_interval);
    }
  }
  co_return std::nullopt;
}

// Whoever reads a position, reads it somewhere between question and answer.
PathStream::Runner::Fault PathStream::Runner::take_reading(std::size_t axis) {
  clock_.advance(middle());
  const auto planned = planned_position(axis);
  const double position = *answer_ / axes_[axis].info.microsteps_per_unit;
  const double off = position - planned;
  auto& tracking = report_.axes[axis];
  ++tracking.readings;
  tracking.largest = std::max(tracking.largest, std::abs(off));
  tracking.squares += off * off;
  if (std::abs(off) <= options_.most_deviation) return std::nullopt;
  return fault(StreamFault::Kind::off_course, axis,
               fmt::format("{{{}}} is {:.6g} off the path, at {:.6g}; {:.6g} are allowed", axis,
                           std::abs(off), position, options_.most_deviation));
}

// What it was told last, if that is what it does.
Script<PathStream::Runner::Fault> PathStream::Runner::check(std::size_t axis) {
  co_await command({Kind::get, axis, ap::target_velocity, 0});
  if (!answer_) co_return refusal(axis);
  const auto told = axes_[axis].velocity;
  if (!told || *answer_ == *told) co_return std::nullopt;
  co_return fault(StreamFault::Kind::foreign, axis,
                  fmt::format("{{{}}} was {} by somebody else", axis,
                              *answer_ == 0 ? "stopped" : "told another velocity"));
}

Script<PathStream::Runner::Fault> PathStream::Runner::check_all() {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto wrong = co_await check(axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

Script<PathStream::Runner::Fault> PathStream::Runner::read_position(std::size_t axis) {
  co_await command({Kind::get, axis, ap::actual_position, 0});
  if (!answer_) co_return refusal(axis);
  co_return take_reading(axis);
}

PathStream::Runner::Fault PathStream::Runner::note_delay(Duration late, Duration period) {
  report_.worst_delay = std::max(report_.worst_delay, late);
  if (late <= most_late_updates * period) return std::nullopt;
  return fault(StreamFault::Kind::starved, 0,
               fmt::format("an update came {:.1f} ms late; {:.1f} ms are allowed",
                           seconds(late) * 1e3, seconds(period) * 1e3 * most_late_updates));
}

// ---- the public face ----

PathStream::PathStream(const Course& course, std::vector<StreamAxis> axes, StreamOptions options)
    : runner_(std::make_unique<Runner>(course, std::move(axes), options)) {}
PathStream::~PathStream() = default;
PathStream::PathStream(PathStream&&) noexcept = default;
PathStream& PathStream::operator=(PathStream&&) noexcept = default;

StreamStep PathStream::next(TimePoint now) { return runner_->next(now); }
void PathStream::answered(TimePoint now, StreamAnswer answer) {
  runner_->answered(now, std::move(answer));
}
void PathStream::stop(StreamFault why) { runner_->stop(std::move(why)); }
void PathStream::pause(bool on) { runner_->pause(on); }
PathStream::Phase PathStream::phase() const { return runner_->phase(); }
double PathStream::passed() const { return runner_->passed(); }
const StreamReport& PathStream::report() const { return runner_->report(); }

}  // namespace tmcl::plan
