// A stream of velocities.
#include <algorithm>
#include <array>
#include <cmath>

#include "motion/drive/guided_runner.hpp"

namespace tmcl::plan {
namespace {

// A change of velocity is over in this part of an update.
constexpr double ramp_part_of_update = 0.5;
// How many updates are looked at to know how steep a course is.
constexpr double most_samples = 1e6;
// At the course, in the time that an axis takes to brake.
constexpr std::size_t looks_ahead = 8;
// To which a correction is found.
constexpr double least_part = 0.01;

// Where a course is from the next update on.
struct CourseAhead {
  double step_s = 0;
  std::array<double, looks_ahead + 1> position{};

  // How far an axis gets beyond it that is there then with this speed, and comes to rest.
  double passed_by(double from, double speed, double slope) const {
    double most = 0;
    for (std::size_t look = 0; look < position.size(); ++look) {
      const double after =
          std::min(step_s * static_cast<double>(look), std::max(speed, 0.0) / slope);
      most = std::max(most, from + (speed - slope * after / 2) * after - position[look]);
    }
    return most;
  }
};

class VelocityRunner final : public GuidedRunner {
 public:
  using GuidedRunner::GuidedRunner;

 private:
  Script<Fault> prepare() override;
  Script<Fault> pass_course() override;
  Script<Fault> find_steepest();
  void on_feed() override { clock_.set_factor(std::min(asked_feed_, prepared_for_)); }
  Script<Fault> raise_acceleration(std::size_t axis, std::uint8_t parameter, double feed);
  Script<Fault> prepare_for_feed();
  Script<Fault> update(std::size_t axis);
  std::int32_t velocity_for(std::size_t axis) const;
  double correction(std::size_t axis, double behind) const;
  double without_overtaking(std::size_t axis, double speed, double correction) const;
  CourseAhead course_ahead(std::size_t axis, double sense, double time_s) const;

  std::vector<TimePoint> due_ = std::vector<TimePoint>(axes());  // of each axis' next update
  AxisValues steepest_{};  // between updates; in units a second squared
  std::vector<std::pair<std::size_t, std::uint8_t>> accelerations_;  // of all axes
  double prepared_for_ = 1;   // this part of the planned speed
  double preparing_for_ = 1;  // and this one
  std::size_t prepared_ = 0;  // how many of the accelerations
};

StreamScript VelocityRunner::prepare() {
  const auto commands = 2 * axes_.size() + 1;
  report_.period =
      std::max(options_.period_min, duration(time_to_send(report_.round_trip, commands)));
  auto asked = co_await find_steepest();
  if (asked) co_return asked;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    Fault refused;
    for (const auto parameter : guidance_of(axes_[axis].family).accelerations) {
      accelerations_.emplace_back(axis, parameter);
      refused = co_await raise_acceleration(axis, parameter, prepared_for_);
      if (refused) co_return refused;
    }
    refused = co_await prepare_ramp(axis);
    if (refused) co_return refused;
  }
  set_pause_ramp();
  co_return std::nullopt;
}

StreamScript VelocityRunner::raise_acceleration(std::size_t axis, std::uint8_t parameter,
                                                double feed) {
  const auto& info = axes_[axis];
  const double wanted =
      std::ceil(feed * steepest_[axis] / ramp_part_of_update * std::abs(info.microsteps_per_unit) /
                info.units.acceleration.value);
  auto unknown = co_await know(axis, parameter);
  if (unknown) co_return unknown;
  const auto own = settings_[axis].before(parameter);
  const auto most = std::max(own, greatest_acceleration_of(info));
  const auto value = wanted < most ? std::max(own, static_cast<std::int32_t>(wanted)) : most;
  auto refused = co_await set(axis, {parameter, value});
  co_return refused;
}

StreamScript VelocityRunner::find_steepest() {
  const double step = std::max(seconds(report_.period), course_.duration() / most_samples);
  auto before = course_.at(0).position;
  AxisValues speed{};
  for (std::size_t look = 0; static_cast<double>(look) * step < course_.duration() + step; ++look) {
    const auto position = course_.at(static_cast<double>(look + 1) * step).position;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const double now = (position[axis] - before[axis]) / step;
      auto& steepest = steepest_[axis];
      steepest = std::max(steepest, std::abs(now - speed[axis]) / step);
      speed[axis] = now;
    }
    before = position;
    if (yields_at(look)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  co_return std::nullopt;
}

StreamScript VelocityRunner::pass_course() {
  auto wrong = co_await set_out();
  if (wrong) co_return wrong;
  std::ranges::fill(due_, now_);
  clock_.start(now_, clock_.paused());
  for (std::size_t round = 0;; ++round) {
    const auto begin = now_;
    wrong = co_await prepare_for_feed();
    if (wrong) co_return wrong;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      wrong = co_await update(axis);
      if (wrong) co_return wrong;
    }
    ++report_.updates;
    const auto read = round % axes_.size();
    auto off = co_await read_position(read);
    if (off) co_return off;
    correct(read);
    off = co_await look_at_encoder(begin + report_.period);
    if (off) co_return off;
    clock_.advance(now_);
    if (stands_at_halt()) {
      wrong = co_await pass_halt({});
      if (wrong) co_return wrong;
      std::ranges::fill(due_, now_);
    }
    if (clock_.is_over()) co_return std::nullopt;
    co_await until(begin + report_.period);
  }
}

// Where a course is passed faster than planned, its corners are steeper. One command in an update:
// more would make that late.
StreamScript VelocityRunner::prepare_for_feed() {
  if (asked_feed_ <= prepared_for_) co_return std::nullopt;
  if (prepared_ == 0) preparing_for_ = asked_feed_;
  const auto [axis, parameter] = accelerations_[prepared_];
  auto refused = co_await raise_acceleration(axis, parameter, preparing_for_);
  if (refused || ++prepared_ < accelerations_.size()) co_return refused;
  prepared_ = 0;
  prepared_for_ = preparing_for_;
  on_feed();
  co_return std::nullopt;
}

StreamScript VelocityRunner::update(std::size_t axis) {
  auto wrong = co_await check(axis);
  if (!wrong) wrong = asked_to_stop();
  if (!wrong) wrong = note_delay(now_ - due_[axis], report_.period);
  if (wrong) co_return wrong;
  due_[axis] = now_ + report_.period;
  clock_.advance(now_);
  wrong = co_await tell_velocity(axis, velocity_for(axis), clock_.passed_in(report_.period));
  co_return wrong;
}

std::int32_t VelocityRunner::velocity_for(std::size_t axis) const {
  const auto& info = axes_[axis];
  const double planned = course_.at(clock_.passed()).position[axis];
  const double next = course_.at(clock_.passed_in(report_.period)).position[axis];
  double behind = planned * info.microsteps_per_unit - expected(axis, now_);
  // Readings are whole microsteps. Where the course stands, a motor would go to and fro for one.
  if (std::abs(behind) < (next == planned ? 2 : 1)) behind = 0;
  const double period = seconds(report_.period);
  const double course_speed = (next - planned) * info.microsteps_per_unit / period;
  const double speed =
      course_speed + without_overtaking(axis, course_speed, correction(axis, behind));
  const double value = speed / info.units.velocity.value;
  const double most = info.greatest_velocity;
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)));
}

// How much faster than the course an axis is to be that is so many microsteps behind it: no more
// than what the acceleration that the course leaves takes away again on that way. Otherwise an axis
// that is far behind would overtake the course.
double VelocityRunner::correction(std::size_t axis, double behind) const {
  const double scale = std::abs(axes_[axis].microsteps_per_unit);
  const double gain = position_gain / seconds(report_.period);
  const auto parameter = guidance_of(axes_[axis].family).accelerations.front();
  const double slope = acceleration_now(axis, parameter);
  const double left = left_by_course(axis, slope);
  // With this, a gain would ask for just as much.
  const double even = left / (gain * gain);
  const double off = std::abs(behind);
  const double speed = off <= even ? gain * off : std::sqrt(left * (2 * off - even));
  return std::copysign(std::min(speed, most_correction * course_.top_speed(axis) * scale), behind);
}

// As much of a correction as brings the axis no farther beyond the course than none, if it brakes
// from the next update on: in a corner ahead the course may be slower all at once.
double VelocityRunner::without_overtaking(std::size_t axis, double speed, double correction) const {
  const double slope = acceleration_now(axis, guidance_of(axes_[axis].family).slowing);
  const double sense = std::copysign(1.0, correction);
  const double fastest = sense * (speed + correction);
  const double within = options_.even_within * std::abs(axes_[axis].microsteps_per_unit);
  const double way = std::abs(correction) * (seconds(report_.period) + fastest / slope);
  if (slope <= 0 || fastest <= 0 || way <= within) return correction;
  const auto course = course_ahead(axis, sense, fastest / slope);
  auto motion = motion_at(axis, now_);
  motion.slope = slope;
  const auto beyond = [&](double part) {
    motion.end_speed = speed + part * correction;
    const auto next = motion.from(now_ + report_.period);
    return course.passed_by(sense * next.position, sense * next.speed, slope);
  };
  const double most = std::max(beyond(0), within);
  if (beyond(1) <= most) return correction;
  auto [allowed, refused] = std::pair(0.0, 1.0);
  while (refused - allowed > least_part) {
    const double part = (allowed + refused) / 2;
    (beyond(part) > most ? refused : allowed) = part;
  }
  return allowed * correction;
}

CourseAhead VelocityRunner::course_ahead(std::size_t axis, double sense, double time_s) const {
  CourseAhead ahead{time_s / looks_ahead};
  for (std::size_t look = 0; look < ahead.position.size(); ++look) {
    const auto time = report_.period + duration(ahead.step_s * static_cast<double>(look));
    ahead.position[look] =
        sense * course_.at(clock_.passed_in(time)).position[axis] * axes_[axis].microsteps_per_unit;
  }
  return ahead;
}

}  // namespace

std::unique_ptr<StreamRunner> velocity_runner(const Course& course, StreamAxes axes,
                                              StreamOptions options) {
  return std::make_unique<VelocityRunner>(course, std::move(axes), options);
}

}  // namespace tmcl::plan
