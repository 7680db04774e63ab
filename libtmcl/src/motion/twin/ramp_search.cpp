#include "tmcl/plan/ramp_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double beyond_all_registers = 1e15;
constexpr int halvings = 14;

/// A ramp that was tried, in microsteps and seconds.
struct Tried {
  double velocity;      // That was asked for.
  double acceleration;  // That was asked for.
  RampChoice choice;
  FollowedMove move;

  double seconds() const { return move.seconds.value_or(infinity); }
};

/// Lets the twin make the move with one ramp after another.
class Trials {
 public:
  Trials(const RampSearch& search, RampRequest request)
      : search_(search), model_(*search.units.model), request_(std::move(request)) {
    distance_ = std::abs(static_cast<double>(search.distance.value));
    fastest_ = greatest_velocity();
    if (search.fastest) fastest_ = std::min(fastest_, search.fastest->value);
  }

  double distance() const { return distance_; }
  /// The greatest velocity that the model has, and that may be.
  double fastest() const { return fastest_; }
  /// The greatest acceleration with this velocity.
  double steepest(double velocity) const {
    constexpr double part_of_a_bow = 15.0 / 16;  // of a TMC457, whose deceleration is more
    auto steepest = within_reach(velocity, beyond_all_registers);
    if (!chosen(velocity, steepest)) steepest *= part_of_a_bow;
    return steepest;
  }
  /// As near to the acceleration as can be had with this velocity.
  double within_reach(double velocity, double acceleration) const {
    const auto choice = chosen(velocity, acceleration);
    return choice || choice.error().is_velocity() ? acceleration : choice.error().nearest;
  }
  double velocity_within_reach(double velocity) const {
    const auto choice = chosen(velocity, 1);
    return choice || !choice.error().is_velocity() ? velocity : choice.error().nearest;
  }

  /// Nothing for a ramp that the model does not have, and for a move that is not described.
  std::optional<Tried> run(double velocity, double acceleration) const {
    auto choice = chosen(velocity, acceleration);
    if (!choice) return std::nullopt;
    auto settings = search_.held;
    settings.insert(settings.end(), choice->settings.begin(), choice->settings.end());
    auto move = follow_move(model_, settings, search_.distance);
    if (!move) return std::nullopt;
    return Tried{velocity, acceleration, std::move(*choice), std::move(*move)};
  }

  /// With what is told of a ramp that was asked for.
  tl::expected<FoundRamp, RampSearchFault> found(const Tried& best) const {
    const RampWish wish{
        {best.velocity, "microsteps/s"}, {best.acceleration, "microsteps/s^2"}, {}, search_.jerk};
    auto planned = plan_ramp(wish, search_.units, search_.present_bow);
    if (!planned) {
      return tl::unexpected(
          RampSearchFault{RampSearchFault::Kind::objection, {}, std::move(planned.error())});
    }
    return FoundRamp{std::move(*planned), best.move};
  }

 private:
  Reached<RampChoice> chosen(double velocity, double acceleration) const {
    auto request = request_;
    request.velocity = {velocity};
    request.acceleration = request.deceleration = {acceleration};
    return choose_ramp(model_, request, *search_.units.module);
  }
  double greatest_velocity() const {
    const auto choice = chosen(beyond_all_registers, 1);
    return choice ? beyond_all_registers : choice.error().nearest;
  }

  const RampSearch& search_;
  const Model& model_;
  RampRequest request_;
  double distance_;
  double fastest_;
};

/// Whether there is something to try at all.
tl::expected<Trials, RampSearchFault> trials_of(const RampSearch& search) {
  const RampWish wish{{1, "microsteps/s"}, {1, "microsteps/s^2"}, {}, search.jerk};
  auto request = ramp_request(wish, search.units, search.present_bow);
  if (!request) {
    return tl::unexpected(
        RampSearchFault{RampSearchFault::Kind::objection, {}, std::move(request.error())});
  }
  Trials trials(search, std::move(*request));
  const double velocity = trials.fastest();
  if (search.distance.value == 0 || !trials.run(velocity, trials.steepest(velocity)))
    return tl::unexpected(RampSearchFault{RampSearchFault::Kind::not_foreseeable});
  return trials;
}

/// The first of two bounds at which `holds`, as near as halving the way between them gets: it does
/// at `to` and not at `from`.
template <class Holds>
double first_at_which(double from, double to, const Holds& holds) {
  for (int i = 0; i < halvings; ++i) {
    const double middle = std::sqrt(from * to);
    (holds(middle) ? to : from) = middle;
  }
  return to;
}

// ---- the gentlest

class GentlestRamp {
 public:
  GentlestRamp(const Trials& trials, double seconds) : trials_(trials), seconds_(seconds) {}

  /// A ramp up and a ramp down, one after the other, ask for the least acceleration: velocities
  /// above their peak make no difference, but that the dividers of a TMC429 follow from them, and
  /// make some accelerations coarse.
  tl::expected<FoundRamp, RampSearchFault> find() {
    constexpr double lowest = 0.7;
    constexpr double step = 1.1;
    constexpr int velocities = 24;
    const double peak = 2 * trials_.distance() / seconds_;
    double velocity = lowest * peak;
    for (int i = 0; i < velocities; ++i, velocity *= step) {
      find_acceleration(trials_.velocity_within_reach(std::min(velocity, trials_.fastest())), peak);
      if (velocity >= trials_.fastest()) break;
    }
    if (!best_) return tl::unexpected(too_quick());
    lower_velocity(peak / 2);
    return trials_.found(*best_);
  }

 private:
  bool in_time(double velocity, double acceleration) {
    auto tried = trials_.run(velocity, acceleration);
    if (!tried || tried->seconds() > seconds_) return false;
    if (!best_ || tried->choice.acceleration <= best_->choice.acceleration)
      best_ = std::move(*tried);
    return true;
  }

  /// Upwards from what not even an ideal ramp could do with, since a generator need not arrive with
  /// each acceleration between two that it arrives with.
  void find_acceleration(double velocity, double ideal_peak) {
    constexpr double too_little = 0.8;
    constexpr double step = 1.1;
    const double peak = std::min(velocity, ideal_peak);
    const double spare = seconds_ - trials_.distance() / peak;
    if (spare <= 0) return;
    auto most = trials_.steepest(velocity);
    if (best_) most = std::min(most, best_->choice.acceleration.value);
    double below = std::min(trials_.within_reach(velocity, too_little * peak / spare), most);
    if (in_time(velocity, below)) return;
    for (double above = below; above < most; below = above) {
      above = std::min(step * above, most);
      if (!in_time(velocity, above)) continue;
      first_at_which(below, above, [&](double middle) { return in_time(velocity, middle); });
      return;
    }
  }

  void lower_velocity(double least) {
    const auto gentlest = *best_;
    first_at_which(least, gentlest.velocity, [&](double lower) {
      const auto tried = trials_.run(lower, gentlest.acceleration);
      const bool holds = tried && tried->seconds() <= seconds_ &&
                         tried->choice.acceleration <= gentlest.choice.acceleration;
      if (holds) best_ = tried;
      return holds;
    });
  }

  RampSearchFault too_quick() const {
    const double velocity = trials_.fastest();
    RampSearchFault fault{RampSearchFault::Kind::too_quick};
    if (const auto tried = trials_.run(velocity, trials_.steepest(velocity)))
      fault.nearest_s = tried->move.seconds;
    return fault;
  }

  const Trials& trials_;
  double seconds_;
  std::optional<Tried> best_;
};

// ---- the quickest

class QuickestRamp {
 public:
  QuickestRamp(const Trials& trials, const MotorWish& motor)
      : trials_(trials), motor_(motor), most_share_(1 / (1 + motor.margin)) {}

  /// Finer and finer: a little more velocity or acceleration may have other dividers on a TMC429,
  /// whose coarser stairs ask for more torque, so that the time has many minima.
  tl::expected<FoundRamp, RampSearchFault> find() {
    constexpr double coarse = 1.15;
    constexpr double fine = 1.03;
    constexpr double finest = 1.005;
    const double fastest = fastest_with_torque();
    const double slowest = fastest / 1000;
    for (const double step : {coarse, fine}) look_between(slowest, fastest, step);
    if (!best_) return tl::unexpected(RampSearchFault{RampSearchFault::Kind::too_little_torque});
    const double velocity = best_->velocity;
    look_between(velocity / fine, std::min(fine * velocity, fastest), finest);
    return trials_.found(*best_);
  }

 private:
  /// How much torque is left at this speed; negative: it is missing.
  double spare(double velocity) const {
    const double speed = velocity / motor_.microsteps_per_full_step;
    return most_share_ * motor_.torque.there(speed) - motor_.torque.asked(speed, 0);
  }
  /// It falls with the speed. 0: there is none at any speed.
  double fastest_with_torque() const {
    constexpr int finer_halvings = 40;
    if (spare(0) <= 0) return 0;
    double enough = 0;
    double too_fast = trials_.fastest();
    if (spare(too_fast) > 0) return too_fast;
    for (int i = 0; i < finer_halvings; ++i) {
      const double middle = (enough + too_fast) / 2;
      (spare(middle) > 0 ? enough : too_fast) = middle;
    }
    return enough;
  }

  std::optional<Tried> within_torque(double velocity, double acceleration) const {
    auto tried = trials_.run(velocity, acceleration);
    if (!tried || !tried->move.seconds) return std::nullopt;
    const auto use = torque_use(tried->move, motor_.torque, motor_.microsteps_per_full_step);
    return use.share <= most_share_ ? std::move(tried) : std::nullopt;
  }

  /// Each velocity and acceleration is this much less than the one before it.
  void look_between(double slowest, double fastest, double step) {
    for (double velocity = fastest; velocity > slowest; velocity /= step) look_at(velocity, step);
  }
  /// The steepest ramp with this velocity that the motor has the torque for, and may be quicker
  /// than the best.
  void look_at(double velocity, double step) {
    if (!may_be_quicker(velocity, trials_.steepest(velocity))) return;
    double acceleration = steepest(velocity);
    while (may_be_quicker(velocity, acceleration) && !keep(velocity, acceleration)) {
      const double next = trials_.within_reach(velocity, acceleration / step);
      if (next >= acceleration) return;
      acceleration = next;
    }
  }
  /// An S-curve may have more acceleration than the trapezoid: little of it is left at the top.
  double steepest(double velocity) {
    constexpr double more = 1.5;
    constexpr double rounded = 1.1;
    const double most = trials_.steepest(velocity);
    double steepest = trials_.within_reach(velocity, rounded * steepest_trapezoid(velocity, most));
    while (steepest < most && keep(velocity, steepest)) steepest = std::min(more * steepest, most);
    return std::min(steepest, most);
  }
  /// It asks for most torque at the end of its acceleration.
  double steepest_trapezoid(double velocity, double most) const {
    const double per_acceleration = motor_.torque.inertia / 1e6 / motor_.microsteps_per_full_step;
    const auto is_too_much = [&](double acceleration) {
      const double peak = std::min(velocity, std::sqrt(trials_.distance() * acceleration));
      return per_acceleration * acceleration > spare(peak);
    };
    return is_too_much(most) ? first_at_which(most, 1, std::not_fn(is_too_much)) : most;
  }
  /// Whether an ideal ramp with these would be quicker than the best.
  bool may_be_quicker(double velocity, double acceleration) const {
    if (!best_) return true;
    const double way = trials_.distance();
    const double to_speed = velocity * velocity / acceleration;
    const double seconds = to_speed <= way ? way / velocity + velocity / acceleration
                                           : 2 * std::sqrt(way / acceleration);
    return seconds < best_->seconds();
  }
  /// Whether the motor has the torque for it.
  bool keep(double velocity, double acceleration) {
    auto tried = within_torque(velocity, acceleration);
    if (!tried) return false;
    if (!best_ || tried->seconds() < best_->seconds()) best_ = std::move(*tried);
    return true;
  }

  const Trials& trials_;
  const MotorWish& motor_;
  double most_share_;
  std::optional<Tried> best_;
};

}  // namespace

std::string describe(const RampSearchFault& fault, const RampSearch& search) {
  const std::string model(search.units.model->name);
  const auto move = fmt::format("a move by {} microsteps", search.distance.value);
  switch (fault.kind) {
    case RampSearchFault::Kind::objection: return fault.objection->error.message;
    case RampSearchFault::Kind::not_foreseeable: break;
    case RampSearchFault::Kind::too_little_torque:
      return "the load leaves less torque than the margin wants, at any speed";
    case RampSearchFault::Kind::too_quick:
      if (!fault.nearest_s) return fmt::format("a {} does not make {} in that time", model, move);
      return fmt::format("a {} makes {} in {} s at best", model, move,
                         plain_number(*fault.nearest_s, 4));
  }
  return fmt::format("how a {} makes {} is not described", model, move);
}

tl::expected<FoundRamp, RampSearchFault> gentlest_ramp(const RampSearch& search, double seconds) {
  return trials_of(search).and_then(
      [&](const Trials& trials) { return GentlestRamp(trials, seconds).find(); });
}

tl::expected<FoundRamp, RampSearchFault> quickest_ramp(const RampSearch& search,
                                                       const MotorWish& motor) {
  return trials_of(search).and_then(
      [&](const Trials& trials) { return QuickestRamp(trials, motor).find(); });
}

}  // namespace tmcl::plan
