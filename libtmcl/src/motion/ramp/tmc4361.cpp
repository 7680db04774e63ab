#include "tmcl/ramp/tmc4361.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "motion/ramp/mentions.hpp"
#include "motion/ramp/part_name.hpp"
#include "motion/ramp/register_rows.hpp"
#include "motion/ramp/s_curve.hpp"

namespace tmcl::ramp {
namespace {

// How many of a register's units make a microstep per second, or per second squared.
constexpr double v_units = 256;
constexpr double a_units = 4;
// Velocities in a tick are less than 2^8 microsteps, accelerations less than 2^-10.
constexpr int v_bits = 54;
constexpr double v_step = 0x1p-54;
constexpr int a_bits = 72;
constexpr double a_step = 0x1p-72;
// No acceleration may be built up in fewer.
constexpr double steepest_clocks = 1024;

constexpr std::int64_t x_greatest = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t v_greatest = x_greatest;
constexpr std::int64_t a_greatest = (1 << 24) - 1;
constexpr std::int64_t bow_greatest = (1 << 24) - 1;
constexpr std::string_view modes[] = {"velocity", "", "", "", "position"};

}  // namespace

// clang-format off
struct Tmc4361::Rows : RowsOf<Tmc4361> {
  static constexpr auto all = std::to_array<Row>({
    in<&G::mode_>({"rampmode", 2, 6, "how it drives, with S-shaped ramps", {0x20, 0, 3}, modes}),
    in<&G::xtarget_>({"xtarget", -x_greatest - 1, x_greatest, "microsteps", {0x37, 0, 32}}),
    {{"xactual", -x_greatest - 1, x_greatest, "microsteps", {0x21, 0, 32}},
     [](const G& g) { return g.motion().position; },
     [](G& g, std::int64_t value) { g.track_.place(static_cast<std::int32_t>(value), g.tick_); }},
    in<&G::vmax_>({"vmax", -v_greatest, v_greatest,
      "in the mode velocity where to, else the greatest, 1/256 microsteps/s", {0x24, 0, 32}}),
    in<&G::amax_>({"amax", 0, a_greatest, "acceleration, 1/4 microsteps/s^2", {0x28, 0, 24}}),
    in<&G::dmax_>({"dmax", 0, a_greatest, "deceleration, as amax", {0x29, 0, 24}}),
    in<&G::dstop_>({"dstop", 0, a_greatest, "deceleration of a soft stop at a switch, as amax", {0x2C, 0, 24}}),
    in<&G::bow1_>({"bow1", 0, bow_greatest, "how fast the acceleration rises, microsteps/s^3; 0: steeply", {0x2D, 0, 24}}),
    in<&G::bow2_>({"bow2", 0, bow_greatest, "how fast the acceleration falls, as bow1", {0x2E, 0, 24}}),
    in<&G::bow3_>({"bow3", 0, bow_greatest, "how fast the deceleration rises, as bow1", {0x2F, 0, 24}}),
    in<&G::bow4_>({"bow4", 0, bow_greatest, "how fast the deceleration falls, as bow1", {0x30, 0, 24}}),
    in<&G::stop_left_en_>({"stop_left_en", 0, 1, "1: the left switch stops negative motion", {0x01, 0, 1}}),
    in<&G::stop_right_en_>({"stop_right_en", 0, 1, "1: the right switch stops positive motion", {0x01, 1, 1}}),
    in<&G::soft_stop_en_>({"soft_stop_en", 0, 1, "1: a switch stops the motor with dstop, 0: at once", {0x01, 5, 1}}),
    in<&G::clk_freq_>({"clk_freq", 4'194'304, 32'000'000, "the clock's frequency, Hz", {0x31, 0, 25}}),
  });
  static constexpr auto infos = infos_of(all);
};
// clang-format on

std::span<const RegisterInfo> Tmc4361::registers() { return Rows::infos; }

Written Tmc4361::write(Register name, std::int64_t value) {
  const auto& row = Rows::all[static_cast<std::size_t>(name)];
  if (!row.info.takes(value)) return out_of_range(row.info, value);
  row.write(*this, value);
  planned_ = false;
  return {};
}

std::int64_t Tmc4361::read(Register name) const {
  return Rows::all[static_cast<std::size_t>(name)].read(*this);
}

// The greatest values are those of the data sheet's section "Internal Ramp Generator Units".
std::vector<Finding> Tmc4361::findings() const {
  using R = Register;
  std::vector<Finding> found;
  const auto holds = [this](R name) { return held(*this, name); };
  if (amax_ == 0) found.push_back({"{}: the motor cannot speed up", {holds(R::amax)}});
  if (dmax_ == 0) found.push_back({"{}: the motor cannot slow down", {holds(R::dmax)}});
  if (vmax_ == 0 && mode_ == Mode::position)
    found.push_back({"{}: the motor cannot drive to a target", {holds(R::vmax)}});
  if (dstop_ == 0 && soft_stop_en_ && (stop_left_en_ || stop_right_en_))
    found.push_back({"{}: a switch does not stop the motor", {holds(R::dstop)}});
  const double steepest = std::max(amax_, dmax_) / a_units * clk_freq_ / steepest_clocks;
  for (const auto name : {R::bow1, R::bow2, R::bow3, R::bow4}) {
    if (read(name) == 0) {
      found.push_back({"{}: taken as none, where the data sheet wants at least 1", {holds(name)}});
    } else if (static_cast<double>(read(name)) > steepest) {
      found.push_back({"{} is more than the greater of {} and {} allows",
                       {holds(name), holds(R::amax), holds(R::dmax)}});
    }
  }
  const bool positioning = mode_ == Mode::position;
  if (std::abs(vmax_ / v_units) > static_cast<double>(clk_freq_) / (positioning ? 4 : 2)) {
    found.push_back({positioning ? "{} is more than 1/4 microstep a clock"
                                 : "{} is more than 1/2 microstep a clock",
                     {holds(R::vmax)}});
  }
  return found;
}

void Tmc4361::set_switches(bool left, bool right) {
  if (left == left_ && right == right_) return;
  left_ = left;
  right_ = right;
  planned_ = false;
}

void Tmc4361::halt() {
  vmax_ = 0;
  mode_ = Mode::velocity;
  track_.coast(tick_, 0);
  planned_ = false;
}

// In microsteps per tick.
double Tmc4361::velocity_of(std::int64_t registered) const {
  return static_cast<double>(registered) / v_units / ticks_a_second();
}

bool Tmc4361::barred(double velocity) const {
  return (velocity < 0 && left_ && stop_left_en_) || (velocity > 0 && right_ && stop_right_en_);
}

Forces Tmc4361::forces() const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const double a_unit = 1 / (a_units * ticks_a_second() * ticks_a_second());
  if (stops_) return {0, dstop_ * a_unit, {infinite}};
  const double bow_unit = a_unit * a_units / ticks_a_second();
  const double steepest = a_greatest * a_unit * clocks_per_tick / steepest_clocks;
  const auto bow = [&](std::int32_t value) { return value == 0 ? steepest : value * bow_unit; };
  return {amax_ * a_unit, dmax_ * a_unit, {bow(bow1_), bow(bow2_), bow(bow3_), bow(bow4_)}};
}

double Tmc4361::distance() const { return to_double(to_fixed(xtarget_) - track_.at(tick_).x); }

Tmc4361 Tmc4361::planned() const {
  auto copy = *this;
  copy.plan();
  return copy;
}

void Tmc4361::plan() {
  planned_ = true;
  stops_ = false;
  const auto now = track_.at(tick_);
  const Moving from{to_double(now.v), to_double(2 * now.h)};
  if (!barred(from.velocity) && !barred(eventual_velocity(from, forces()))) {
    return plan_ramp(from.velocity, from.acceleration);
  }
  if (soft_stop_en_) {
    stops_ = true;
    const auto profile = plan_velocity({from.velocity, 0}, 0, forces());
    return track_.begin(profile, 0, forces(), tick_, xtarget_);
  }
  track_.coast(tick_, 0);
  plan_ramp(0, 0);
}

void Tmc4361::plan_ramp(double velocity, double acceleration) {
  const auto limits = forces();
  // What the velocity register can take up while the acceleration is taken back: by the second bow,
  // and before that, as long as the speed falls, by the fourth.
  const double along = acceleration < 0 ? -velocity : velocity;
  const double room = velocity_of(v_greatest) - std::max(along, 0.0);
  const double most = std::sqrt(
      2 * (limits.bows.second * std::max(0.0, room) + limits.bows.fourth * std::max(0.0, -along)));
  const Moving from{velocity, std::clamp(acceleration, -most, most)};
  const double v = velocity_of(vmax_);
  const double speed = std::abs(v);
  const auto profile =
      mode_ == Mode::velocity
          ? plan_velocity(from, permitted(v), limits)
          : plan_move(from, distance(), {permitted(speed), -permitted(-speed)}, limits);
  track_.begin(profile, from.acceleration, limits, tick_, xtarget_);
}

// To the stretch in which the tick lies.
void Tmc4361::run_to(Tick tick) {
  if (!planned_) plan();
  while (track_.ends_by(tick)) {
    tick_ = track_.until();
    track_.next(forces(), xtarget_);
    if (track_.over() && stops_) plan();
  }
}

Motion Tmc4361::motion() const {
  if (!planned_) return planned().motion();
  const auto now = track_.at(tick_);
  // Precise enough, and faster than to_double().
  const double per_second = ticks_a_second();
  const double v = static_cast<double>(rounded(now.v, v_bits)) * (v_units * v_step) * per_second;
  const double a = static_cast<double>(rounded(2 * now.h, a_bits)) * (a_units * a_step) *
                   per_second * per_second;
  return {rounded(now.x, 0), std::llround(v), std::llround(a)};
}

int Tmc4361::heading() const {
  if (!planned_) return planned().heading();
  const auto v = static_cast<SignedFixed>(track_.at(tick_).v);
  return (v > 0) - (v < 0);
}

std::string_view Tmc4361::phase() const {
  if (!planned_) return planned().phase();
  return stops_ ? "stop" : bow_name(track_.part());
}

Tick Tmc4361::next_change() {
  if (!planned_) plan();
  return track_.until();
}

bool Tmc4361::arrived() const {
  if (!planned_) return planned().arrived();
  return mode_ == Mode::position && track_.arrived();
}

}  // namespace tmcl::ramp
