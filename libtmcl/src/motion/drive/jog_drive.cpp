#include "tmcl/plan/jog_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "motion/drive/drive_runner.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

std::int32_t value_of(const JogAxis& axis, std::uint8_t parameter) {
  const auto found = std::ranges::find(axis.ramp, parameter, &Setting::parameter);
  return found == axis.ramp.end() ? 0 : found->value;
}

double way_between(double fast, double slow, double acceleration) {
  return acceleration > 0 ? (fast * fast - slow * slow) / (2 * acceleration) : 0;
}

/// In microsteps, from a speed in microsteps per second.
double braking_distance(const JogAxis& axis, double speed) {
  constexpr auto max_bow = number_of("max_bow");
  constexpr auto v1 = number_of("velocity_v1");
  constexpr auto d1 = number_of("deceleration_d1");
  const auto limit = ramp_limits(*axis.model, axis.ramp).acceleration;
  const auto acceleration = to_pps2(InternalAcceleration{limit}, axis.units);
  if (speed <= 0 || acceleration.value <= 0) return 0;
  if (axis.model->family == Family::tmc457 && value_of(axis, max_bow) > 0)
    return ramp_length({speed}, acceleration, to_pps3(value_of(axis, max_bow))).microsteps;
  if (axis.model->family != Family::sixpoint) return way_between(speed, 0, acceleration.value);
  const auto slow_speed = to_pps(InternalVelocity{value_of(axis, v1)}, axis.units).value;
  const auto slow = to_pps2(InternalAcceleration{value_of(axis, d1)}, axis.units).value;
  const auto knee = slow > 0 ? std::min(speed, slow_speed) : 0;
  return way_between(speed, knee, acceleration.value) + way_between(knee, 0, slow);
}

struct Motion {
  double position;
  double velocity;  // in microsteps per second
};

/// At the end of the time for which the wish holds.
Motion at_end_of_hold(const JogAxis& axis, Microsteps position, InternalVelocity velocity,
                      const JogWish& wish) {
  if (auto twin = axis.twin) {
    twin->place(position, velocity);
    if (twin->rotate(wish.velocity)) {
      twin->advance(wish.hold);
      const auto motion = twin->motion();
      return {static_cast<double>(motion.position.value), motion.velocity.value};
    }
  }
  const auto wished = to_pps(wish.velocity, axis.units).value;
  return {position.value + wished * seconds(wish.hold), wished};
}

}  // namespace

Microsteps jog_target(const JogAxis& axis, Microsteps position, InternalVelocity velocity,
                      const JogWish& wish) {
  const auto end = at_end_of_hold(axis, position, velocity, wish);
  const auto braking = braking_distance(axis, std::abs(end.velocity));
  const auto rest =
      end.velocity < 0 ? std::floor(end.position - braking) : std::ceil(end.position + braking);
  auto target = std::clamp<double>(rest, axis.range.least, axis.range.greatest);
  // An axis that is beyond its range already is not sent back by a wish to go further out.
  const bool turns_round = velocity.value != 0 && (velocity.value > 0) != (wish.velocity.value > 0);
  if (!turns_round)
    target = wish.velocity.value > 0 ? std::max<double>(target, position.value)
                                     : std::min<double>(target, position.value);
  return {static_cast<std::int32_t>(target)};
}

class JogDrive::Runner final : public DriveRunner {
 public:
  Runner() : DriveRunner(1) {}

  void know(JogAxis axis) {
    for (const auto setting : axis.ramp) settings_[0].know(setting);
    axis_ = std::move(axis);
  }

  Result<std::optional<std::uint64_t>> wish(JogWish wish) {
    if (is_ending_) return std::optional<std::uint64_t>();
    if (auto wrong = objection_to(wish)) return tl::unexpected(std::move(*wrong));
    wish_ = wish;
    end_wait();
    return std::optional(++last_wish_);
  }

  std::uint64_t done() const { return done_wish_; }
  const JogGoal& goal() const { return goal_; }
  const DriveReport& report() const { return report_; }

 private:
  std::optional<Error> objection_to(const JogWish& wish) const {
    if (axis_.model == nullptr) return std::nullopt;
    const auto most = settings_[0].before(ap::max_velocity);
    if (std::abs(std::int64_t{wish.velocity.value}) <= most) return std::nullopt;
    return bad_argument(fmt::format("{} is faster than the max_velocity of the axis, {}",
                                    std::abs(std::int64_t{wish.velocity.value}), most),
                        "jog more slowly, or set max_velocity");
  }

  Script<Fault> whole() override {
    report_.fault = co_await go();
    is_ending_ = true;
    if (report_.fault && was_sent_) co_await stop_and_rest(report_);
    heeds_stop_ = false;
    co_await restore(report_);
    co_return report_.fault;
  }

  Script<Fault> go() {
    Fault wrong;
    while (!wrong && !is_ending_) {
      if (asked_to_stop()) co_return asked_to_stop();
      if (const auto wish = std::exchange(wish_, std::nullopt)) {
        wrong = co_await take(*wish);
      } else {
        wrong = co_await look_on();
      }
    }
    co_return wrong;
  }

  Script<Fault> take(JogWish wish) {
    const auto number = last_wish_;
    if (auto wrong = objection_to(wish))
      co_return DriveFault{DriveFault::Kind::unsuited, 0, {}, std::move(*wrong), {}};
    Fault wrong;
    if (wish.velocity.value == 0) {
      wrong = co_await end();
    } else {
      wrong = co_await go_on(wish);
    }
    if (!wrong) done_wish_ = number;
    co_return wrong;
  }

  /// As near as its brakes allow.
  Script<Fault> end() {
    is_ending_ = true;
    auto wrong = co_await stop_and_rest(report_);
    if (wrong) co_return wrong;
    co_await command({Kind::get, 0, ap::actual_position, 0});
    if (!answer_) co_return refusal(0);
    goal_ = {{*answer_}, now_};
    co_return std::nullopt;
  }

  Script<Fault> go_on(JogWish wish) {
    auto wrong = co_await set(0, {ap::max_velocity, std::abs(wish.velocity.value)});
    if (!wrong) wrong = asked_to_stop();
    if (wrong) co_return wrong;
    co_await command({Kind::get, 0, ap::actual_velocity, 0});
    if (!answer_) co_return refusal(0);
    const InternalVelocity velocity{*answer_};
    co_await command({Kind::get, 0, ap::actual_position, 0});
    if (!answer_) co_return refusal(0);
    if (asked_to_stop()) co_return asked_to_stop();
    const auto until = now_ + wish.hold;
    const auto target = jog_target(axis_, {*answer_}, velocity, wish);
    const auto begin = now_;
    was_sent_ = true;
    co_await command({Kind::move_to, 0, 0, target.value});
    if (!answer_) co_return refusal(0);
    goal_ = {target, until};
    watched_ = {{0, target}, Arrival(target, begin, {most_standing, {}, time_to_begin})};
    co_return std::nullopt;
  }

  /// The bus is left to others until the axis has to brake.
  Script<Fault> look_on() {
    const bool is_to_brake = watched_ && now_ >= goal_.until;
    const auto next = !watched_      ? TimePoint::max()
                      : !is_to_brake ? goal_.until
                                     : now_ + drive_look_interval;
    co_await until(next);
    if (!is_to_brake || wish_ || asked_to_stop()) co_return std::nullopt;
    auto wrong = co_await look(*watched_, TimePoint::max());
    if (!wrong && !watched_->arrival && !wish_) is_ending_ = true;
    co_return wrong;
  }

  JogAxis axis_;
  std::optional<JogWish> wish_;
  std::uint64_t last_wish_ = 0;
  std::uint64_t done_wish_ = 0;
  JogGoal goal_;
  std::optional<Watched> watched_;
  bool was_sent_ = false;
  bool is_ending_ = false;
  DriveReport report_;
};

JogDrive::JogDrive() : Drive(std::make_unique<Runner>()) {}
JogDrive::~JogDrive() = default;

JogDrive::Runner& JogDrive::jog() { return static_cast<Runner&>(*runner_); }
const JogDrive::Runner& JogDrive::jog() const { return static_cast<const Runner&>(*runner_); }
void JogDrive::know(JogAxis axis) { jog().know(std::move(axis)); }
Result<std::optional<std::uint64_t>> JogDrive::wish(JogWish wish) { return jog().wish(wish); }
std::uint64_t JogDrive::done() const { return jog().done(); }
const JogGoal& JogDrive::goal() const { return jog().goal(); }
const DriveReport& JogDrive::report() const { return jog().report(); }

}  // namespace tmcl::plan
