// What the next tick of a six-point generator does, and for how many ticks it does just the same.
#include <algorithm>

#include "motion/ramp/sixpoint_ways.hpp"
#include "tmcl/ramp/sixpoint.hpp"

namespace tmcl::ramp {
namespace {

constexpr std::int64_t half_microstep = microstep / 2;
constexpr std::int64_t half_turn = microstep << 31;  // of the 32 bit position
constexpr std::int64_t never_stops = std::int64_t{1} << 62;

constexpr Tick at_least_one(std::int64_t ticks) { return ticks > 1 ? static_cast<Tick>(ticks) : 1; }

// The way of the ticks that slow down from v to `floor`, by d each and by what is left in the last.
constexpr std::int64_t way_down(std::int64_t v, std::int64_t floor, std::int64_t d) {
  const auto whole = static_cast<std::uint32_t>(v - floor) / static_cast<std::uint32_t>(d);
  const auto rest = v - floor - std::int64_t{whole} * d;
  return way_of(whole, v, -d) + (rest > 0 ? floor : 0);
}

}  // namespace

std::uint64_t SixPointRules::target() const {
  return static_cast<std::uint64_t>(value(Register::xtarget)) << 32;
}

std::int64_t SixPointRules::distance() const {
  return static_cast<std::int64_t>(target() - position_) >> position_shift;
}

bool SixPointRules::blocked(int direction) const {
  const auto enabled = value(Register::sw_mode);
  if (direction < 0) return left_ && (enabled & stop_l_enable) != 0;
  return direction > 0 && right_ && (enabled & stop_r_enable) != 0;
}

// Where it would go from standstill.
int SixPointRules::wanted_direction() const {
  if (mode() == Mode::position) return sign(distance());
  if (mode() == Mode::hold || value(Register::vmax) == 0) return 0;
  return mode() == Mode::velocity_positive ? 1 : -1;
}

// What the ticks after one with this speed take until one has the speed VSTOP.
std::int64_t SixPointRules::braking_distance(std::int64_t speed) const {
  const auto vstop = speed_in(Register::vstop);
  const auto knee = std::max(vstop, speed_in(Register::v1));
  std::int64_t way = 0;
  if (speed > knee) {
    if (value(Register::dmax) == 0) return never_stops;
    way += way_down(speed, knee, value(Register::dmax));
    speed = knee;
  }
  if (speed > vstop) {
    if (value(Register::d1) == 0) return never_stops;
    way += way_down(speed, vstop, value(Register::d1));
  }
  return way;
}

// The least way left that lets the next tick have this speed and not be the last one.
std::int64_t SixPointRules::reserve(std::int64_t speed) const {
  if (speed <= speed_in(Register::vstop)) return speed + half_microstep + 1;
  return speed + braking_distance(speed);
}

SixPointRules::Slew SixPointRules::slew_from(std::int64_t v) const {
  const auto v1 = speed_in(Register::v1);
  const auto vmax = speed_in(Register::vmax);
  const bool rises = v < vmax;
  const bool below_knee = rises ? v < v1 : v <= v1;
  Slew slew{};
  slew.phase = below_knee ? Phase::a1 : Phase::amax;
  slew.step = value(below_knee ? Register::a1 : Register::amax);
  if (rises) {
    slew.limit = below_knee ? std::min(v1, vmax) : vmax;
    slew.next =
        std::max(std::min(v + slew.step, slew.limit), std::min(speed_in(Register::vstart), vmax));
  } else {
    slew.limit = below_knee ? vmax : std::max(v1, vmax);
    slew.next = std::max(v - slew.step, slew.limit);
  }
  if (slew.next == vmax && v == vmax) slew.phase = Phase::vmax;
  return slew;
}

SixPointRules::Run SixPointRules::next_run() const {
  if (tick_ < stands_until_) return standing(stands_until_ - tick_);
  if (velocity_ != 0 && blocked(sign(velocity_))) return stopping();
  switch (mode()) {
    case Mode::position: return positioning();
    case Mode::hold:
      return velocity_ == 0 ? standing(forever)
                            : to_speed(sign(velocity_), speed(), Phase::hold, forever);
    default: return slewing();
  }
}

SixPointRules::Run SixPointRules::to_speed(int heading, std::int64_t next, Phase phase,
                                           Tick ticks) const {
  const auto change = heading * next - velocity_;
  const auto register_in_use = [&] {
    switch (phase) {
      case Phase::a1: return value(Register::a1);
      case Phase::amax: return value(Register::amax);
      case Phase::dmax: return value(Register::dmax);
      case Phase::d1: return value(Register::d1);
      default: return 0;
    }
  };
  return {.ticks = ticks,
          .change = change,
          .acceleration = sign(change) * register_in_use(),
          .phase = phase};
}

// At a switch.
SixPointRules::Run SixPointRules::stopping() const {
  const bool soft = (value(Register::sw_mode) & en_softstop) != 0;
  if (!soft || speed() <= speed_in(Register::vstop)) return to_speed(0, 0, Phase::rest, 1);
  return slowing(sign(velocity_), 0, forever);
}

// The velocity modes.
SixPointRules::Run SixPointRules::slewing() const {
  const int wanted = mode() == Mode::velocity_positive ? 1 : -1;
  const auto a = std::int64_t{value(Register::amax)};
  const auto v = speed();
  if (v == 0 && blocked(wanted)) return standing(forever);
  const int heading = v != 0 ? sign(velocity_) : wanted;
  const auto limit = heading == wanted ? speed_in(Register::vmax) : 0;
  if (v == limit || a == 0) {
    if (v == 0) return standing(forever);
    return to_speed(heading, v, v == limit ? Phase::vmax : Phase::amax, forever);
  }
  const auto way_off = v < limit ? limit - v : v - limit;
  const auto step = std::min(a, way_off);
  return to_speed(heading, v < limit ? v + step : v - step, Phase::amax, at_least_one(way_off / a));
}

SixPointRules::Run SixPointRules::positioning() const {
  const auto left = distance();
  const int side = sign(left);
  if (velocity_ == 0 && (side == 0 || blocked(side))) return standing(forever);
  const int heading = velocity_ != 0 ? sign(velocity_) : side;
  if (side != -heading) return approaching(heading, heading * left);
  // Away from the target. Half a turn further on, it would be ahead.
  auto run = to_speed(0, 0, Phase::rest, 1);
  if (speed() > speed_in(Register::vstop)) {
    run = slowing(heading, 0, at_least_one((half_turn - 1 + heading * left) / speed()));
  }
  run.turns = true;
  run.brakes = braking_;
  return run;
}

SixPointRules::Run SixPointRules::approaching(int heading, std::int64_t left) const {
  const auto v = speed();
  const auto vstop = speed_in(Register::vstop);
  const auto slew = slew_from(v);
  const bool may_speed_up = !braking_ || v < vstop;
  if (may_speed_up && reserve(slew.next) <= left) {
    auto run = speeding(heading, left, slew);
    run.brakes = braking_;
    return run;
  }
  return braking(heading, left, v < vstop ? std::min(slew.next, vstop) : v);
}

SixPointRules::Run SixPointRules::speeding(int heading, std::int64_t left, const Slew& slew) const {
  const auto v = speed();
  const auto vstop = speed_in(Register::vstop);
  auto run = to_speed(heading, slew.next, slew.phase, 1);
  if (slew.next == v) {
    if (v == 0) return standing(forever);
    run.ticks = static_cast<Tick>((left - reserve(v)) / v + 1);
    return run;
  }
  const auto change = slew.next - v;
  if (change != slew.step && change != -slew.step) return run;
  auto most = (slew.limit - v) / change;
  // At VSTOP the reserve may fall by what it takes to come to rest within half a microstep.
  if (change > 0 && v < vstop) most = std::min(most, (vstop - v) / change);
  run.ticks = fitting_steps(left, change, at_least_one(most));
  return run;
}

// How many of `most` steps leave enough way to brake. The first one does, and once one does not,
// none will: speeding up, the way left falls and the reserve grows; slowing down by less than the
// braking would, or below VSTOP, the way left falls faster than the reserve; and slowing down by
// more, only the end can be too near.
Tick SixPointRules::fitting_steps(std::int64_t left, std::int64_t change, Tick most) const {
  const auto v = speed();
  const auto too_far = [&](Tick n) {
    const auto next = v + static_cast<std::int64_t>(n) * change;
    return reserve(next) > left - way_of(n - 1, v, change);
  };
  if (!too_far(most)) return most;
  return first_tick(most, too_far) - 1;
}

// Towards the target, with no way left for more speed than `held`.
SixPointRules::Run SixPointRules::braking(int heading, std::int64_t left, std::int64_t held) const {
  if (speed() == 0 && held == 0) return standing(forever);  // VSTOP is 0 and VSTART too fast
  auto run = reserve(held) <= left ? holding(heading, left, held) : ending(heading, left);
  run.brakes = true;
  return run;
}

SixPointRules::Run SixPointRules::holding(int heading, std::int64_t left, std::int64_t held) const {
  const auto ticks = held == speed() ? (left - reserve(held)) / held + 1 : 1;
  return to_speed(heading, held, held > speed_in(Register::vstop) ? slowing_phase() : Phase::vstop,
                  static_cast<Tick>(ticks));
}

SixPointRules::Run SixPointRules::ending(int heading, std::int64_t left) const {
  const auto v = speed();
  const auto vstop = speed_in(Register::vstop);
  if (v > vstop) {
    // What is to spare stays the same while it slows down, so it can hold once its speed is as low.
    const auto run =
        slowing(heading, left - braking_distance(v), at_least_one((half_turn - 1 + left) / v));
    const auto next = heading * (velocity_ + run.change);
    if (next > vstop || left > next + half_microstep) return run;
  }
  auto run = to_speed(0, 0, Phase::rest, 1);
  run.arrives = true;
  return run;
}

SixPointRules::Phase SixPointRules::slowing_phase() const {
  return speed() <= speed_in(Register::v1) ? Phase::d1 : Phase::dmax;
}

// With DMAX and D1, from more than VSTOP down to it. The run ends before the speed `floor` and
// after `most` ticks, but has one tick at least.
SixPointRules::Run SixPointRules::slowing(int heading, std::int64_t floor, Tick most) const {
  const auto v = speed();
  const auto phase = slowing_phase();
  const std::int64_t d = value(phase == Phase::d1 ? Register::d1 : Register::dmax);
  const auto limit = phase == Phase::d1
                         ? speed_in(Register::vstop)
                         : std::max(speed_in(Register::v1), speed_in(Register::vstop));
  const auto ticks = d == 0 ? most : at_least_one((v - std::max(limit, floor) - 1) / d);
  return to_speed(heading, std::max(v - d, limit), phase, std::min(ticks, most));
}

}  // namespace tmcl::ramp
