// What the next ramp tick of a TMC429 does, and for how many ticks it does just the same.
#include <algorithm>
#include <cstdlib>

#include "motion/ramp/integer.hpp"
#include "motion/ramp/tmc429_units.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmcl::ramp {
namespace {

// The sum of the whole parts of |first + i * step| / 256 for i = 0 .. n-1. The speed does not
// change its sign on the way.
std::uint32_t sum_of_speeds(std::int32_t first, std::int32_t step, std::uint32_t n) {
  constexpr std::uint32_t few = 6;  // where adding up is quicker
  constexpr std::uint32_t unit = 256;
  auto low = static_cast<std::uint32_t>(std::abs(first));
  const auto high =
      static_cast<std::uint32_t>(std::abs(first + step * static_cast<std::int32_t>(n - 1)));
  const auto rise = static_cast<std::uint32_t>(std::abs(step));
  low = std::min(low, high);
  if (n > few) return floor_sum(n, unit, rise, low);
  std::uint32_t sum = 0;
  for (; n != 0; --n, low += rise) sum += low / unit;
  return sum;
}

}  // namespace

bool Tmc429Rules::blocked(std::int32_t velocity) const {
  return (velocity < 0 && left_ && !disable_stop_l_) ||
         (velocity > 0 && right_ && !disable_stop_r_);
}

std::int32_t Tmc429Rules::distance() const { return wrap24(std::int64_t{x_target_} - x_actual_); }

// The speed that v_min and v_max have yet to limit; grows with the distance, which is at least 1.
std::uint32_t Tmc429Rules::unclipped_speed(std::uint32_t distance) const {
  const std::uint64_t d = std::min(distance, distance_limit);
  const std::uint64_t product = d * factor();
  if (mode_ == Mode::soft) {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(product >> (3U + pdiv_), 2047));
  }
  std::uint64_t square = 0;
  switch (last_step_) {
    case LastStep::r3: square = ((product - factor()) << 8U) >> pdiv_; break;
    case LastStep::r2: square = (product << 8U) >> pdiv_; break;
    case LastStep::r1: square = (product >> (3U + pdiv_)) * step_unit; break;
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(integer_root(square), 2047));
}

// The inverse: the least distance at which the ramp asks for this speed or more.
std::uint32_t Tmc429Rules::nearest_distance_of(std::uint32_t speed) const {
  if (speed <= static_cast<std::uint32_t>(std::min(v_min_, v_max_))) return 1;
  const std::uint64_t square = std::uint64_t{speed} * speed;
  const std::uint64_t p = factor();
  std::uint64_t distance = 0;
  if (mode_ == Mode::soft) {
    distance = divide_up(std::uint64_t{speed} << (3U + pdiv_), p);
  } else if (last_step_ == LastStep::r1) {
    distance = divide_up(divide_up(square, step_unit) << (3U + pdiv_), p);
  } else {
    distance = divide_up(square << pdiv_, p << 8U) + (last_step_ == LastStep::r3 ? 1 : 0);
  }
  return static_cast<std::uint32_t>(distance);
}

std::int32_t Tmc429Rules::asked_velocity(std::int32_t dx) const {
  if (dx == 0) return 0;
  const auto raw =
      static_cast<std::int32_t>(unclipped_speed(static_cast<std::uint32_t>(std::abs(dx))));
  const auto speed = std::min(std::max(raw, v_min_), v_max_);
  return dx > 0 ? speed : -speed;
}

// What the ramp stage slews to when it sees this distance, in 1/256.
std::int32_t Tmc429Rules::goal(std::int32_t dx) const {
  std::int32_t wanted = velocity_;
  if (positioning()) wanted = asked_velocity(dx) * v_unit;
  if (mode_ == Mode::velocity) wanted = std::clamp(v_target_, -v_max_, v_max_) * v_unit;
  return blocked(wanted) ? 0 : wanted;
}

std::int32_t Tmc429Rules::slew(std::int32_t dx) const {
  if (stops_dead() || stops_on_target(dx)) return -velocity_;
  return std::clamp(goal(dx) - velocity_, -a_max_, a_max_);
}

bool Tmc429Rules::stops_on_target(std::int32_t dx) const {
  return positioning() && dx == 0 && std::abs(v_actual()) <= v_min_;
}

// ---- what the coming ramp ticks will do ----

struct Tmc429Rules::Approach {
  std::int32_t sign;  // of the motion
  std::int32_t distance;
  std::uint32_t speed;  // 1/256
  std::int32_t goal;    // 1/256
  std::uint32_t accumulator;
};

Tmc429Rules::Seen Tmc429Rules::seen() const {
  const auto until = seen_at(next_ramp_tick());
  const auto sum =
      accumulator_ + pulses(tick_, until) * static_cast<std::uint32_t>(std::abs(v_actual()));
  const auto steps = static_cast<std::int64_t>(sum / step_unit);
  return {wrap24(std::int64_t{x_target_} - x_actual_ - (velocity_ < 0 ? -steps : steps)),
          static_cast<std::uint32_t>(sum % step_unit)};
}

Tmc429Rules::Run Tmc429Rules::run_of(Tick ramp_ticks, std::int32_t slew) const {
  return {next_ramp_tick() + (ramp_ticks << ramp_div_) - 1, slew};
}

Tmc429Rules::Run Tmc429Rules::plan() const {
  if (stops_dead()) return run_of(1, -velocity_);
  return positioning() ? plan_positioning() : plan_slew(goal(0));
}

// Towards a velocity that stays the same.
Tmc429Rules::Run Tmc429Rules::plan_slew(std::int32_t goal) const {
  const auto left = goal - velocity_;
  if (left == 0 || a_max_ == 0) return {forever, 0};
  const bool slows_down = (velocity_ < 0) != (left < 0) && velocity_ != 0;
  const auto full =
      (slows_down ? std::min(std::abs(velocity_), std::abs(left)) : std::abs(left)) / a_max_;
  if (full == 0) return run_of(1, std::clamp(left, -a_max_, a_max_));
  return run_of(static_cast<Tick>(full), left < 0 ? -a_max_ : a_max_);
}

Tmc429Rules::Run Tmc429Rules::plan_positioning() const {
  const auto [dx, accumulator] = seen();
  if (stops_on_target(dx)) {
    const bool nothing_left = velocity_ == 0 && (accumulator == 0 || at_stop_ == Accumulator::kept);
    if (nothing_left) return {forever, 0};
    auto run = run_of(1, -velocity_);
    run.stops_on_target = true;
    return run;
  }
  const auto wanted = goal(dx);
  const std::int32_t sign = velocity_ != 0 ? (velocity_ < 0 ? -1 : 1) : (wanted < 0 ? -1 : 1);
  const Approach approach{sign, sign * dx, static_cast<std::uint32_t>(std::abs(velocity_)),
                          sign * wanted, accumulator};
  if (wanted == velocity_) return plan_cruise(approach);
  if (a_max_ == 0) return plan_crawl(approach);
  const bool faster = approach.goal > static_cast<std::int32_t>(approach.speed);
  return faster ? plan_acceleration(approach) : plan_deceleration(approach);
}

// As fast as the ramp asks, until it asks for less.
Tmc429Rules::Run Tmc429Rules::plan_cruise(const Approach& approach) const {
  if (approach.speed == 0) return {forever, 0};
  const auto nearest = nearest_distance_of(approach.speed / v_unit);
  return run_until_step(approach, static_cast<std::uint32_t>(approach.distance) - nearest + 1);
}

// Without a_max it can neither follow the ramp nor slow down; only a target met at v_min stops it.
Tmc429Rules::Run Tmc429Rules::plan_crawl(const Approach& approach) const {
  const auto speed = approach.speed / v_unit;
  if (speed == 0 || speed > static_cast<std::uint32_t>(v_min_)) return {forever, 0};
  const auto steps = static_cast<std::uint32_t>(approach.distance) & (2U * half_turn - 1);
  return run_until_step(approach, steps);
}

// At the present speed up to, but not including, the ramp tick that sees so many more steps.
Tmc429Rules::Run Tmc429Rules::run_until_step(const Approach& approach, std::uint32_t steps) const {
  const auto needed = std::uint64_t{steps} * step_unit - approach.accumulator;
  const auto first = seen_at(next_ramp_tick()) >> pulse_div_;
  const auto pulse = (first + divide_up(needed, approach.speed / v_unit)) << pulse_div_;
  const auto sees = pulse + (order_ == Order::ramp_first ? 1 : 0);
  return {(divide_up(sees, Tick{1} << ramp_div_) << ramp_div_) - 1, 0};
}

// The speeds of so many pulses after `begin`, added up. The first interval between ramp ticks has
// the first velocity, each further one a slew more; the sign does not change on the way.
std::uint64_t Tmc429Rules::sum_of_pulses(Tick begin, Tick count, std::int32_t first,
                                         std::int32_t slew) const {
  if (count == 0) return 0;
  if (ramp_div_ >= pulse_div_) {
    const auto each = ramp_div_ - pulse_div_;
    const auto whole = static_cast<std::uint32_t>((count - 1) >> each);
    const auto rest = count - (Tick{whole} << each);
    const auto last = first + slew * static_cast<std::int32_t>(whole);
    const auto sum = whole == 0 ? 0 : std::uint64_t{sum_of_speeds(first, slew, whole)} << each;
    return sum + rest * static_cast<std::uint32_t>(std::abs(last / v_unit));
  }
  // There are several ramp ticks between two pulses.
  const auto pulse = ((begin >> pulse_div_) + 1) << pulse_div_;
  const auto before = static_cast<std::int32_t>((pulse - begin - 1) >> ramp_div_);
  return sum_of_speeds(first + before * slew, slew * (1 << (pulse_div_ - ramp_div_)),
                       static_cast<std::uint32_t>(count));
}

// Whether one more full slew fits under the ramp after so many.
bool Tmc429Rules::still_below_ramp(const Approach& approach, std::uint32_t slews) const {
  const auto begin = seen_at(next_ramp_tick());
  const auto count = pulses(begin, begin + (Tick{slews} << ramp_div_));
  const auto first = static_cast<std::int32_t>(approach.speed) + a_max_;
  const auto sum = approach.accumulator + sum_of_pulses(begin, count, first, a_max_);
  const auto steps = sum / step_unit;
  if (steps >= static_cast<std::uint64_t>(approach.distance)) return false;
  const auto asked = asked_velocity(approach.distance - static_cast<std::int32_t>(steps)) * v_unit;
  const auto speed = approach.speed + (slews + 1) * static_cast<std::uint32_t>(a_max_);
  return speed <= static_cast<std::uint32_t>(asked);
}

// The speed rises and what the ramp asks for falls, so the slews that fit can be searched for.
Tmc429Rules::Run Tmc429Rules::plan_acceleration(const Approach& approach) const {
  const auto left = static_cast<std::uint32_t>(approach.goal) - approach.speed;
  auto too_many = left / static_cast<std::uint32_t>(a_max_) + 1;
  if (too_many == 1) return run_of(1, approach.sign * static_cast<std::int32_t>(left));
  std::uint32_t fit = 1;
  if (still_below_ramp(approach, too_many - 2)) fit = too_many - 1;
  while (too_many - fit > 1) {
    const auto middle = fit + (too_many - fit) / 2;
    (still_below_ramp(approach, middle - 1) ? fit : too_many) = middle;
  }
  return run_of(fit, approach.sign * a_max_);
}

// Only full slews for as long as the ramp cannot ask for less than a whole one, the target cannot
// stop the motor, and the distance does not wrap: moving on, the ramp asks for less and less, also
// through the target and past it.
Tmc429Rules::Run Tmc429Rules::plan_deceleration(const Approach& approach) const {
  const auto a = static_cast<std::uint32_t>(a_max_);
  const auto above_goal = approach.speed - static_cast<std::uint32_t>(std::max(approach.goal, 0));
  const auto v_stop = static_cast<std::uint32_t>(v_min_ + 1) * v_unit;
  const auto above_stop = approach.speed >= v_stop ? (approach.speed - v_stop) / a + 1 : 1;
  const auto steps_until_wrap = std::max(0, approach.distance + half_turn - 1);
  const auto room = static_cast<std::uint64_t>(steps_until_wrap) * step_unit;
  const auto interval = (Tick{1} << ramp_div_ >> std::min(pulse_div_, ramp_div_)) + 1;
  const auto until_wrap = room / (interval * (approach.speed / v_unit + 1));
  const auto full = std::min<std::uint64_t>({above_goal / a, above_stop, until_wrap});
  if (full > 0) return run_of(full, -approach.sign * a_max_);
  const auto left = approach.goal - static_cast<std::int32_t>(approach.speed);
  return run_of(1, approach.sign * std::clamp(left, -a_max_, a_max_));
}

}  // namespace tmcl::ramp
