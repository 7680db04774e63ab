#include "tmcl/ramp/tmc429.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "motion/ramp/mentions.hpp"
#include "motion/ramp/register_rows.hpp"
#include "motion/ramp/tmc429_units.hpp"

namespace tmcl::ramp {
namespace {

constexpr std::int32_t greatest_speed = 2047;
constexpr std::int32_t greatest_divider = 13;

constexpr std::string_view modes[] = {"ramp", "soft", "velocity", "hold"};

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
