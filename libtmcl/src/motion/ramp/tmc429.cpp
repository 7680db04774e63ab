#include "tmcl/ramp/tmc429.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "motion/ramp/integer.hpp"
#include "motion/ramp/mentions.hpp"
#include "motion/ramp/register_rows.hpp"

namespace tmcl::ramp {
namespace {

constexpr std::uint32_t step_unit = 2048;          // overflow of the pulse accumulator
constexpr std::uint32_t distance_limit = 1 << 19;  // the deceleration looks no further ahead
constexpr std::int32_t greatest_speed = 2047;
constexpr unsigned position_bits = 24;
constexpr std::int32_t half_turn = 1 << (position_bits - 1);  // of the position counter
constexpr std::int32_t greatest_divider = 13;

constexpr std::string_view modes[] = {"ramp", "soft", "velocity", "hold"};

constexpr std::int32_t wrap24(std::int64_t x) {
  return static_cast<std::int32_t>(sign_extend(static_cast<std::uint64_t>(x), position_bits));
}

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

// Addresses from the vendor's register headers, bits from the data sheet.
// clang-format off
struct Tmc429::Rows : RowsOf<Tmc429> {
  static constexpr auto all = std::to_array<Row>({
    in<&G::mode_>({"mode", 0, 3, "how it drives", {0x14, 0, 2}, modes}),
    in<&G::v_min_>({"v_min", 0, greatest_speed,
      "speed at which the motor may stop at once; with 0 it does not arrive", {0x04, 0, 11}}),
    in<&G::v_max_>({"v_max", 0, greatest_speed,
      "greatest speed, in f / 2^(pulse_div + 16) microsteps/s", {0x06, 0, 11}}),
    {{"v_target", -greatest_speed, greatest_speed, "set-point in velocity mode, as v_max", {0x08, 0, 12}},
     [](const G& g) { return std::int64_t{g.v_target()}; },
     [](G& g, std::int64_t value) { g.v_target_ = static_cast<std::int32_t>(value); }},
    {{"v_actual", -greatest_speed, greatest_speed, "present speed; keeps its value in hold mode only", {0x0A, 0, 12}},
     [](const G& g) { return std::int64_t{g.v_actual()}; },
     [](G& g, std::int64_t value) { g.velocity_ = static_cast<std::int32_t>(value) * v_unit; }},
    in<&G::a_max_>({"a_max", 0, greatest_speed,
      "in f^2 / 2^(pulse_div + ramp_div + 29) microsteps/s^2", {0x0C, 0, 11}}),
    in<&G::pulse_div_>({"pulse_div", 0, greatest_divider, "scale of speeds, as an exponent of two", {0x18, 12, 4}}),
    in<&G::ramp_div_>({"ramp_div", 0, greatest_divider, "scale of accelerations, as an exponent of two", {0x18, 8, 4}}),
    in<&G::pmul_>({"pmul", 0, 255,
      "factor of the deceleration: (128 + pmul) / 2^(3 + pdiv); bit 7 is always set", {0x12, 8, 7}}),
    in<&G::pdiv_>({"pdiv", 0, greatest_divider, "its exponent", {0x12, 0, 4}}),
    in<&G::x_target_>({"x_target", -half_turn, half_turn - 1, "where the motor goes, in microsteps", {0x00, 0, 24}}),
    in<&G::x_actual_>({"x_actual", -half_turn, half_turn - 1, "where it is, in microsteps", {0x02, 0, 24}}),
    in<&G::disable_stop_l_>({"disable_stop_l", 0, 1, "1: the left switch does not stop", {0x14, 8, 1}}),
    in<&G::disable_stop_r_>({"disable_stop_r", 0, 1, "1: the right switch does not stop", {0x14, 9, 1}}),
    in<&G::soft_stop_>({"soft_stop", 0, 1, "1: a switch slows down at a_max; 0: it stops dead", {0x14, 10, 1}}),
    in<&G::ref_rnl_>({"ref_rnl", 0, 1, "the switch that latches the position: 0 left, 1 right", {0x14, 11, 1}}),
    in<&G::last_step_>({"last_step", 0, 2,
      "the ramp's law at distance d: r3 (d - 1), r1 (floor(p d)), r2 (d)", {}, last_steps}),
    in<&G::factor_rule_>({"factor_rule", 0, 4, "how pmul and pdiv follow", {}, factor_rules}),
    in<&G::order_>({"order", 0, 1, "what comes first at a common tick", {}, orders}),
    in<&G::at_stop_>({"accumulator", 0, 1, "the fraction of a microstep at the stop on the target", {}, accumulators}),
  });
  static constexpr auto infos = infos_of(all);
};
// clang-format on

std::span<const RegisterInfo> Tmc429::registers() { return Rows::infos; }

Written Tmc429::write(Register name, std::int64_t value) {
  const auto& row = Rows::all[static_cast<std::size_t>(name)];
  if (!row.info.takes(value)) return out_of_range(row.info, value);
  run_.end = tick_;
  // The register holds what the ramp last asked for, so velocity mode goes on from there.
  if (name == Register::mode) v_target_ = v_target();
  row.write(*this, value);
  follow(name);
  return {};
}

std::int64_t Tmc429::read(Register name) const {
  return Rows::all[static_cast<std::size_t>(name)].read(*this);
}

// pmul and pdiv follow what they are made of, until one of the two is written.
void Tmc429::follow(Register written) {
  switch (written) {
    case Register::pmul:
    case Register::pdiv:
      pmul_ &= 0x7F;
      factor_written_ = true;
      break;
    case Register::a_max:
    case Register::pulse_div:
    case Register::ramp_div:
    case Register::factor_rule:
      if (!factor_written_) update_factor();
      break;
    default: break;
  }
}

// Outside the range of the registers the nearest end is taken.
void Tmc429::update_factor() {
  struct Share {
    std::uint32_t thousandths;
    bool round;
    std::uint32_t less;
  };
  constexpr std::array<Share, 5> shares = {
      {{990, false, 0}, {950, false, 0}, {988, false, 0}, {1000, true, 0}, {1000, true, 1}}};
  const auto& share = shares[static_cast<std::size_t>(factor_rule_)];
  const auto numerator = static_cast<std::uint64_t>(a_max_) * share.thousandths
                         << (pulse_div_ + 3U);
  const auto denominator = std::uint64_t{1000} << (7U + ramp_div_);
  const auto scaled = [&] {
    return ((numerator << pdiv_) + (share.round ? denominator / 2 : 0)) / denominator;
  };
  pdiv_ = 0;
  while (pdiv_ < greatest_divider && scaled() < 128) ++pdiv_;
  const auto pmul = std::clamp<std::uint64_t>(scaled(), 128, 255) - 128;
  pmul_ = static_cast<std::uint8_t>(pmul - std::min<std::uint64_t>(pmul, share.less));
}

std::vector<Finding> Tmc429::findings() const {
  using R = Register;
  std::vector<Finding> all;
  if (mode_ == Mode::hold) return all;  // where no limit applies
  const auto holds = [this](R name) { return held(*this, name); };
  if (v_max_ == 0) all.push_back({"{}: the motor does not move", {holds(R::v_max)}});
  if (a_max_ == 0)
    all.push_back({"{}: the motor can neither speed up nor slow down", {holds(R::a_max)}});
  if (!positioning()) return all;
  if (v_min_ == 0) all.push_back({"{}: the motor may stop short of its target", {holds(R::v_min)}});
  if (v_min_ > v_max_) all.push_back({"{} is above {}", {holds(R::v_min), holds(R::v_max)}});
  if (auto finding = wrong_deceleration(); a_max_ != 0 && finding)
    all.push_back(std::move(*finding));
  return all;
}

// Whether the ramp to the target asks for what a_max cannot do.
std::optional<Finding> Tmc429::wrong_deceleration() const {
  using R = Register;
  const auto holds = [this](R name) { return held(*this, name); };
  const double scale = std::exp2(ramp_div_ - pulse_div_);
  if (a_max_ < scale / 2 || a_max_ > 4096 * scale - 1) {
    return Finding{
        "{} is outside its valid range for {} and {}: the motor may oscillate around its target",
        {holds(R::a_max), holds(R::pulse_div), holds(R::ramp_div)}};
  }
  if (factor() * 128 * scale > a_max_ * std::exp2(3 + pdiv_)) {
    return Finding{
        "{} and {} are too great for {}, {} and {}: the motor overshoots its target",
        {holds(R::pmul), holds(R::pdiv), holds(R::a_max), holds(R::pulse_div), holds(R::ramp_div)}};
  }
  return std::nullopt;
}

void Tmc429::set_switches(bool left, bool right) {
  const bool closes = ref_rnl_ ? right && !right_ : left && !left_;
  if (closes && latch_armed_) {
    x_latched_ = x_actual_;
    latch_armed_ = false;
  }
  left_ = left;
  right_ = right;
  run_.end = tick_;
}

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

// ---- moving ----

void Tmc429::add_pulses(std::uint64_t sum, bool backwards) {
  sum += accumulator_;
  accumulator_ = static_cast<std::uint32_t>(sum % step_unit);
  // More than 2^24 steps are whole turns of the counter.
  const auto steps = static_cast<std::int64_t>(sum / step_unit & (2U * half_turn - 1));
  x_actual_ = wrap24(x_actual_ + (backwards ? -steps : steps));
}

// Runs the pulse stage alone.
void Tmc429::coast(Tick until) {
  if (until <= tick_) return;
  add_pulses(pulses(tick_, until) * static_cast<std::uint32_t>(std::abs(v_actual())),
             velocity_ < 0);
  tick_ = until;
}

// Within the present run.
void Tmc429::move(Tick until) {
  if (run_.is_steady() || until < next_ramp_tick()) return coast(until);
  slew_through(until);
}

void Tmc429::slew_through(Tick until) {
  const auto slews = static_cast<std::int32_t>((until >> ramp_div_) - (tick_ >> ramp_div_));
  const auto begin = seen_at(next_ramp_tick());
  if (begin > tick_) coast(begin);
  if (run_.stops_on_target && at_stop_ == Accumulator::cleared) accumulator_ = 0;
  const auto first = velocity_ + run_.slew;
  velocity_ += run_.slew * slews;
  tick_ = until;
  add_pulses(sum_of_pulses(begin, pulses(begin, until), first, run_.slew),
             first < 0 || velocity_ < 0);
}

void Tmc429::advance_to(Tick tick) {
  tick = std::min(tick, last_tick);
  if (tick <= run_.end && run_.is_steady()) return coast(tick);
  while (tick_ < tick) {
    if (tick_ >= run_.end) {
      if (brake(tick)) continue;
      run_ = plan();
    }
    move(std::min(tick, run_.end));
  }
}

// The motor follows the ramp down to its target and has some way to go.
bool Tmc429::brakes(const Seen& seen) const {
  const bool forward = velocity_ > 0;
  const auto distance = forward ? seen.dx : -seen.dx;
  if (!positioning() || distance <= 0 || std::abs(v_actual()) <= v_min_ || blocked(velocity_))
    return false;
  const auto asked = std::abs(asked_velocity(seen.dx));
  return asked < std::min(v_max_, greatest_speed) && std::abs(velocity_) >= asked * v_unit;
}

// While it does so every ramp tick may be another run. Here they are taken one after the other with
// as little as possible to do in each: "the ramp asks for speed w" is "needed(w) <= allowed", which
// takes no root, and most ticks are full slews. False if the case at hand is another one.
bool Tmc429::brake(Tick until) {
  constexpr std::int32_t least_acceleration = 8;  // below this the runs are long
  const auto first = next_ramp_tick() >> ramp_div_;
  const auto beyond = (until + 1) >> ramp_div_;
  if (a_max_ < least_acceleration || ramp_div_ < pulse_div_ || order_ != Order::ramp_first ||
      last_step_ == LastStep::r1 || first >= beyond) {
    return false;
  }
  const auto start = seen();
  // Farther away the ramp asks for the same speed everywhere.
  if (!brakes(start) || std::abs(start.dx) > static_cast<std::int32_t>(distance_limit)) {
    return false;
  }

  const bool soft = mode_ == Mode::soft;
  const auto each = ramp_div_ - pulse_div_;
  const auto up = !soft && pdiv_ < 8 ? 8 - pdiv_ : 0;
  const auto down = soft ? 3 + pdiv_ : std::max(0, pdiv_ - 8);
  const auto needed = [&](std::int32_t w) { return (soft ? w : w * w) << down; };
  const auto per_step = static_cast<std::int32_t>(factor()) << up;
  const auto a_max = a_max_;
  const auto slowest = v_min_ * v_unit + a_max;

  const std::int32_t sign = velocity_ > 0 ? 1 : -1;
  auto left = sign * start.dx;
  auto accumulator = start.accumulator;
  auto speed = std::abs(velocity_);
  auto allowed = (left - (soft || last_step_ == LastStep::r2 ? 0 : 1)) * per_step;
  auto tick = first;
  for (; tick < beyond && left > 0 && speed >= slowest; ++tick) {
    if (needed((speed - a_max) / v_unit + 1) > allowed) {
      speed -= a_max;
    } else {
      auto asked = speed / v_unit;
      while (needed(asked) > allowed) --asked;
      speed = asked * v_unit;
    }
    accumulator += static_cast<std::uint32_t>(speed / v_unit) << each;
    const auto steps = static_cast<std::int32_t>(accumulator / step_unit);
    accumulator %= step_unit;
    left -= steps;
    allowed -= steps * per_step;
  }
  if (tick == first) return false;
  x_actual_ = wrap24(std::int64_t{x_target_} - sign * left);
  velocity_ = sign * speed;
  accumulator_ = accumulator;
  tick_ = (tick << ramp_div_) - 1;
  run_.end = tick_;
  return true;
}

// What the motor is doing, by what the next ramp tick will see.
std::string_view Tmc429::phase() const {
  if (mode_ == Mode::hold) return velocity_ == 0 ? "rest" : "hold";
  if (a_max_ == 0) return velocity_ == 0 ? "rest" : "cruise";
  const auto wanted = goal(seen().dx);
  if (velocity_ == 0) return wanted == 0 ? "rest" : "accelerate";
  if ((wanted < 0) != (velocity_ < 0) || wanted == 0) return "decelerate";
  if (std::abs(velocity_) < std::abs(wanted)) return "accelerate";
  const bool full_speed = mode_ == Mode::velocity || std::abs(wanted) == v_max_ * v_unit;
  return velocity_ == wanted && full_speed ? "cruise" : "decelerate";
}

Tick Tmc429::next_change() {
  if (run_.end <= tick_) run_ = plan();
  // Slowing down towards the target, runs only follow each other until it is reached.
  if (run_.end == forever) return earliest_pass(velocity_);
  if (brakes(seen())) return std::min(earliest_pass(velocity_), earliest_halt());
  // The last ramp tick of a run makes the state that the next run starts from.
  const auto last = run_.end >> ramp_div_ << ramp_div_;
  const auto slews = static_cast<std::int32_t>((run_.end >> ramp_div_) - (tick_ >> ramp_div_));
  return std::min(last > tick_ ? last : run_.end + 1, earliest_pass(velocity_ + run_.slew * slews));
}

// Without v_min the ramp may bring the motor to a halt before the target; not before this tick.
Tick Tmc429::earliest_halt() const {
  if (v_min_ != 0 || a_max_ == 0) return forever;
  const auto slews = static_cast<Tick>(std::abs(velocity_) / a_max_);
  return next_ramp_tick() + (slews == 0 ? 0 : (slews - 1) << ramp_div_);
}

// Before this tick it neither comes upon the target nor leaves it if it does not go faster than now
// or at the given velocity.
Tick Tmc429::earliest_pass(std::int32_t velocity) const {
  const auto fastest = std::max(std::abs(velocity), std::abs(velocity_)) / v_unit;
  if (fastest == 0) return forever;
  const auto dx = distance();
  const bool away = dx < 0 ? velocity >= 0 && velocity_ >= 0 : velocity <= 0 && velocity_ <= 0;
  const auto steps = dx == 0 ? 1 : away ? 2 * half_turn - std::abs(dx) : std::abs(dx);
  const auto needed = static_cast<std::uint64_t>(steps) * step_unit - accumulator_;
  return ((tick_ >> pulse_div_) + divide_up(needed, static_cast<std::uint64_t>(fastest)))
         << pulse_div_;
}

}  // namespace tmcl::ramp
