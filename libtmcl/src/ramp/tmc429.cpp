#include "tmcl/ramp/tmc429.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tmcl::ramp {
namespace {

constexpr std::int32_t v_unit = 256;               // speeds carry eight bits of fraction
constexpr std::uint32_t step_unit = 2048;          // overflow of the pulse accumulator
constexpr std::uint32_t distance_limit = 1 << 19;  // the deceleration looks no further ahead
constexpr std::uint64_t greatest_speed = 2047;

constexpr std::int32_t wrap24(std::int64_t x) {
  const auto low = static_cast<std::uint32_t>(x & 0xFFFFFF);
  return static_cast<std::int32_t>(low ^ 0x800000U) - 0x800000;
}

constexpr std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

// Exact: below 2^52 the root of a number just under a square does not round up to the next integer.
std::uint64_t integer_root(std::uint64_t m) {
  return static_cast<std::uint64_t>(std::sqrt(static_cast<double>(m)));
}

}  // namespace

void Tmc429::set_x_target(std::int32_t microsteps) { x_target_ = wrap24(microsteps); }
void Tmc429::set_x_actual(std::int32_t microsteps) { x_actual_ = wrap24(microsteps); }
void Tmc429::set_v_min(std::int32_t v) { v_min_ = std::clamp(v, 0, 2047); }
void Tmc429::set_v_max(std::int32_t v) { v_max_ = std::clamp(v, 0, 2047); }
void Tmc429::set_v_target(std::int32_t v) { v_target_ = std::clamp(v, -2047, 2047); }
void Tmc429::set_v_actual(std::int32_t v) { velocity_ = std::clamp(v, -2047, 2047) * v_unit; }

void Tmc429::set_a_max(std::int32_t a) {
  a_max_ = std::clamp(a, 0, 2047);
  update_factor();
}

void Tmc429::set_dividers(Tmc429Dividers dividers) {
  constexpr std::uint8_t greatest = 13;
  pulse_div_ = std::min(dividers.pulse, greatest);
  ramp_div_ = std::min(dividers.ramp, greatest);
  update_factor();
}

void Tmc429::set_mode(Mode mode) {
  // The register holds what the ramp last asked for, so velocity mode goes on from there.
  if (positioning()) v_target_ = asked_velocity();
  mode_ = mode;
}

// p = a_max / (128 * 2^(ramp_div - pulse_div)), less one per cent so that rounding never
// overshoots. Outside the range of the registers the nearest end is taken.
void Tmc429::update_factor() {
  constexpr std::uint8_t last = 13;
  const auto numerator = static_cast<std::uint64_t>(a_max_) * 99 << (pulse_div_ + 3U);
  const auto denominator = std::uint64_t{100} << (7U + ramp_div_);
  for (pdiv_ = 0; pdiv_ < last; ++pdiv_) {
    if ((numerator << pdiv_) / denominator >= 128) break;
  }
  const auto scaled = std::clamp<std::uint64_t>((numerator << pdiv_) / denominator, 128, 255);
  pmul_ = static_cast<std::uint8_t>(scaled - 128);
}

std::int32_t Tmc429::distance() const {
  return wrap24(static_cast<std::int64_t>(x_target_) - x_actual_);
}

// The speed that v_min and v_max have yet to limit; grows with the distance, which is at least 1.
std::uint64_t Tmc429::unclipped_speed(std::uint32_t distance) const {
  const std::uint64_t d = std::min(distance, distance_limit);
  const std::uint64_t factor = 128U + pmul_;
  if (mode_ == Mode::soft) return std::min((d * factor) >> (3U + pdiv_), greatest_speed);
  const auto m = (d - 1) * factor;
  const auto square = pdiv_ <= 8 ? m << (8U - pdiv_) : m >> (pdiv_ - 8U);
  return std::min(integer_root(square), greatest_speed);
}

// The inverse: the least distance at which the ramp still asks for this speed, itself limited.
std::uint32_t Tmc429::nearest_distance_of(std::int32_t speed) const {
  if (speed <= v_min_) return 1;
  const auto w = static_cast<std::uint64_t>(speed);
  const std::uint64_t factor = 128U + pmul_;
  if (mode_ == Mode::soft) return static_cast<std::uint32_t>(divide_up(w << (3U + pdiv_), factor));
  const auto square = w * w;
  const auto least = pdiv_ <= 8 ? divide_up(square, factor << (8U - pdiv_))
                                : divide_up(square << (pdiv_ - 8U), factor);
  return static_cast<std::uint32_t>(least + 1);
}

std::int32_t Tmc429::asked_velocity() const {
  const auto dx = distance();
  if (dx == 0) return 0;
  const auto raw =
      static_cast<std::int32_t>(unclipped_speed(static_cast<std::uint32_t>(std::abs(dx))));
  const auto speed = std::min(std::max(raw, v_min_), v_max_);
  return dx > 0 ? speed : -speed;
}

std::int32_t Tmc429::v_target() const { return positioning() ? asked_velocity() : v_target_; }

std::int32_t Tmc429::v_actual() const { return velocity_ / v_unit; }

std::int32_t Tmc429::slew() const {
  if (mode_ == Mode::hold) return 0;
  const auto goal = positioning() ? asked_velocity() : std::clamp(v_target_, -v_max_, v_max_);
  return std::clamp(goal * v_unit - velocity_, -a_max_, a_max_);
}

std::int32_t Tmc429::a_actual() const { return arrived() ? 0 : slew(); }

bool Tmc429::arrived() const { return positioning() && at_target() && velocity_ == 0; }

void Tmc429::ramp_stage() {
  if (positioning() && at_target() && std::abs(v_actual()) <= v_min_) {
    velocity_ = 0;
    accumulator_ = 0;
    return;
  }
  velocity_ += slew();
}

// Runs the pulse stage alone.
void Tmc429::coast(Tick until) {
  const auto pulses = (until >> pulse_div_) - (tick_ >> pulse_div_);
  tick_ = until;
  const auto sum = accumulator_ + pulses * static_cast<std::uint64_t>(std::abs(v_actual()));
  accumulator_ = static_cast<std::uint32_t>(sum % step_unit);
  // More than 2^24 steps are whole turns of the counter.
  const auto steps = static_cast<std::int64_t>(sum / step_unit & 0xFFFFFF);
  x_actual_ = wrap24(x_actual_ + (velocity_ < 0 ? -steps : steps));
}

// The last tick up to which no ramp tick changes the speed.
Tick Tmc429::steady_until() const {
  if (arrived()) return accumulator_ == 0 ? forever : tick_;
  if (slew() != 0) return tick_;
  if (!positioning()) return forever;
  // Without a_max it can neither follow the ramp nor slow down; only a target met at v_min stops
  // it.
  if (velocity_ != asked_velocity() * v_unit)
    return std::abs(v_actual()) > v_min_ ? forever : tick_;
  const auto speed = static_cast<std::uint64_t>(std::abs(v_actual()));
  if (speed == 0) return forever;
  const auto left = static_cast<std::uint32_t>(std::abs(distance()));
  const auto steps = left - nearest_distance_of(std::abs(v_actual()));
  const auto pulses = (step_unit * (std::uint64_t{steps} + 1) - 1 - accumulator_) / speed;
  return (((tick_ >> pulse_div_) + pulses + 1) << pulse_div_) - 1;
}

// One stretch of steady motion, or one ramp tick.
void Tmc429::step_towards(Tick until) {
  const auto ramp_tick = next_ramp_tick();
  if (const auto steady = steady_until(); steady >= ramp_tick)
    return coast(std::min(steady, until));
  if (ramp_tick > until) return coast(until);
  coast(ramp_tick - 1);
  ramp_stage();  // sees the position before this tick's pulse
  coast(ramp_tick);
}

void Tmc429::advance_to(Tick tick) {
  while (tick_ < tick) step_towards(tick);
}

std::optional<Tick> Tmc429::arrival(Tick limit) const {
  auto ahead = *this;
  while (ahead.positioning() && ahead.tick_ < limit && !ahead.arrived() && !ahead.settled()) {
    ahead.step_towards(limit);
  }
  if (!ahead.arrived()) return std::nullopt;
  return ahead.tick_;
}

}  // namespace tmcl::ramp
