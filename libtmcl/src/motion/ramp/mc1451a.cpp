#include "tmcl/ramp/mc1451a.hpp"

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

// How many of a register's units make a step, as a power of two, with the tick as unit of time.
constexpr int v_bits = 16 + 4;
constexpr int a_bits = 16 + 2 * 4;
constexpr double v_unit = 1.0 / (1 << v_bits);
constexpr double a_unit = 1.0 / (1 << a_bits);
constexpr double jerk_unit = 1.0 / (1LL << (32 + 3 * 4));

constexpr std::string_view shapes[] = {"s_curve", "trapezoidal"};

}  // namespace

// clang-format off
struct Mc1451a::Rows : RowsOf<Mc1451a> {
  static constexpr auto all = std::to_array<Row>({
    in<&G::shape_>({"profile", 0, 1, "its shape", {}, shapes}),
    in<&G::position_>({"position", -(1 << 30), (1 << 30) - 1, "destination, steps"}),
    in<&G::velocity_>({"velocity", 0, 1'073'741'823, "maximum velocity, 2^-16 steps/cycle"}),
    in<&G::acceleration_>({"acceleration", 0, 32'767, "maximum acceleration, 2^-16 steps/cycle^2"}),
    in<&G::jerk_>({"jerk", 0, 2'147'483'647, "2^-32 steps/cycle^3, S-curve only"}),
  });
  static constexpr auto infos = infos_of(all);
};
// clang-format on

std::span<const RegisterInfo> Mc1451a::registers() { return Rows::infos; }

Written Mc1451a::write(Register name, std::int64_t value) {
  const auto& row = Rows::all[static_cast<std::size_t>(name)];
  if (!row.info.takes(value)) return out_of_range(row.info, value);
  if (in_motion() && !takes_in_motion(name)) {
    return tl::unexpected(RegisterError{RegisterError::Reason::in_motion, &row.info, value});
  }
  row.write(*this, value);
  planned_ = false;
  return {};
}

std::int64_t Mc1451a::read(Register name) const {
  return Rows::all[static_cast<std::size_t>(name)].read(*this);
}

std::vector<Finding> Mc1451a::findings() const {
  std::vector<Finding> found;
  const auto zero = [&](Register name) {
    found.push_back({"{}: the axis cannot move", {held(*this, name)}});
  };
  if (velocity_ == 0) zero(Register::velocity);
  if (acceleration_ == 0) zero(Register::acceleration);
  if (jerk_ == 0 && shape_ == Shape::s_curve) zero(Register::jerk);
  return found;
}

Forces Mc1451a::forces() const {
  const double a = acceleration_ * a_unit;
  const bool s_curve = shape_ == Shape::s_curve;
  return {a, a, {s_curve ? jerk_ * jerk_unit : std::numeric_limits<double>::infinity()}};
}

void Mc1451a::plan() {
  planned_ = true;
  slows_ = false;
  const auto limits = forces();
  const auto now = track_.at(tick_);
  const double distance = to_double(to_fixed(position_) - now.x);
  const double most = velocity_ * v_unit;
  // Only a trapezoid is ever planned in motion.
  const double v = to_double(now.v);
  const double speed = std::abs(v);
  auto profile = Profile{};
  if (speed > most + v_unit / 2 && v * distance > 0 &&
      2 * std::abs(distance) * limits.deceleration > speed * speed) {
    slows_ = true;
    profile = plan_velocity({v, 0}, std::copysign(most, v), limits);
  } else if (limits.bows.first > 0) {
    profile = plan_move({v, 0}, distance, {std::max(most, v), std::max(most, -v)}, limits);
  }
  track_.begin(profile, 0, limits, tick_, position_);
}

Mc1451a Mc1451a::planned() const {
  auto copy = *this;
  copy.plan();
  return copy;
}

// To the stretch in which the tick lies.
void Mc1451a::run_to(Tick tick) {
  if (!planned_) plan();
  while (track_.ends_by(tick)) {
    tick_ = track_.until();
    track_.next(forces(), position_);
    if (track_.over() && slows_) plan();
  }
}

Motion Mc1451a::motion() const {
  if (!planned_) return planned().motion();
  const auto now = track_.at(tick_);
  return {rounded(now.x, 0), rounded(now.v, v_bits), rounded(2 * now.h, a_bits)};
}

int Mc1451a::heading() const {
  if (!planned_) return planned().heading();
  const auto v = static_cast<SignedFixed>(track_.at(tick_).v);
  return (v > 0) - (v < 0);
}

std::string_view Mc1451a::phase() const {
  if (!planned_) return planned().phase();
  const auto part = track_.part();
  return shape_ == Shape::s_curve ? s_curve_name(part) : trapezoid_name(part);
}

Tick Mc1451a::next_change() {
  if (!planned_) plan();
  return track_.until();
}

}  // namespace tmcl::ramp
