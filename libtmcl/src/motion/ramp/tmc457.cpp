#include "tmcl/ramp/tmc457.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/ramp/mentions.hpp"
#include "motion/ramp/part_name.hpp"
#include "motion/ramp/register_rows.hpp"
#include "motion/ramp/s_curve.hpp"

namespace tmcl::ramp {
namespace {

// How many of a register's units make a microstep, as a power of two, with the clock as unit of
// time.
constexpr int v_bits = 30;
constexpr int a_bits = 42;
constexpr double v_unit = 1.0 / (1LL << v_bits);
constexpr double a_unit = 1.0 / (1LL << a_bits);
constexpr double bow_unit = a_unit / 1024;
constexpr double overflow = 2.0;  // of the velocity register

constexpr std::int64_t v_greatest = 0x7FFF0000;
constexpr std::int64_t a_greatest = 0xFFFFFD;

// A bow tick.
constexpr double bow_ticks = 1024;

constexpr std::int64_t x_greatest = std::numeric_limits<std::int32_t>::max();
constexpr std::string_view modes[] = {"position", "", "velocity", "hold"};

}  // namespace

// Addresses from the vendor's register headers, bits from the data sheet.
// clang-format off
struct Tmc457::Rows : RowsOf<Tmc457> {
  static constexpr auto all = std::to_array<Row>({
    in<&G::mode_>({"mode", 0, 3, "how it drives", {0x00, 0, 2}, modes}),
    in<&G::x_target_>({"x_target", -x_greatest - 1, x_greatest, "microsteps", {0x09, 0, 32}}),
    {{"x_actual", -x_greatest - 1, x_greatest, "microsteps", {0x01, 0, 32}},
     [](const G& g) { return g.motion().position; },
     [](G& g, std::int64_t value) { g.track_.place(static_cast<std::int32_t>(value), g.tick_); }},
    in<&G::v_max_>({"v_max", 0, v_greatest, "in the mode position, clock/2^30 microsteps/s", {0x03, 0, 32}}),
    in<&G::v_target_>({"v_target", -v_greatest, v_greatest,
      "in the modes velocity and hold, clock/2^30 microsteps/s", {0x04, 0, 32}}),
    in<&G::a_max_>({"a_max", 0, a_greatest, "acceleration, clock^2/2^42 microsteps/s^2", {0x05, 0, 24}}),
    in<&G::d_max_>({"d_max", 0, a_greatest,
      "deceleration, as a_max; only 15/16 of it with bow_max > 0", {0x06, 0, 24}}),
    {{"a_max_d_max", 0, a_greatest, "both a_max and d_max; reads a_max", {0x0F, 0, 24}},
     [](const G& g) { return std::int64_t{g.a_max_}; },
     [](G& g, std::int64_t value) { g.a_max_ = g.d_max_ = static_cast<std::int32_t>(value); }},
    in<&G::d_stop_>({"d_stop", 0, a_greatest, "deceleration of a stop event, as a_max", {0x07, 0, 24}}),
    in<&G::bow_max_>({"bow_max", 0, 18,
      "0 trapezoid, n adds 2^(n-1) to the acceleration every 1024 clocks", {0x08, 0, 5}}),
    in<&G::enable_stop_l_>({"enable_stop_l", 0, 1, "1: the left switch stops negative motion"}),
    in<&G::enable_stop_r_>({"enable_stop_r", 0, 1, "1: the right switch stops positive motion"}),
  });
  static constexpr auto infos = infos_of(all);
};
// clang-format on

std::span<const RegisterInfo> Tmc457::registers() { return Rows::infos; }

Written Tmc457::write(Register name, std::int64_t value) {
  const auto& row = Rows::all[static_cast<std::size_t>(name)];
  if (!row.info.takes(value)) return out_of_range(row.info, value);
  row.write(*this, value);
  planned_ = false;
  return {};
}

std::int64_t Tmc457::read(Register name) const {
  return Rows::all[static_cast<std::size_t>(name)].read(*this);
}

std::vector<Finding> Tmc457::findings() const {
  using R = Register;
  std::vector<Finding> found;
  const auto holds = [this](R name) { return held(*this, name); };
  if (a_max_ == 0) found.push_back({"{}: the motor cannot speed up", {holds(R::a_max)}});
  if (d_max_ == 0) found.push_back({"{}: the motor cannot slow down", {holds(R::d_max)}});
  if (v_max_ == 0) found.push_back({"{}: the motor cannot drive to a target", {holds(R::v_max)}});
  if (d_stop_ == 0 && (enable_stop_l_ || enable_stop_r_))
    found.push_back({"{}: a switch does not stop the motor", {holds(R::d_stop)}});
  const auto limit = a_max_ <= d_max_ ? R::a_max : R::d_max;
  // What is added to an acceleration counts as that does.
  std::vector mentions{holds(R::bow_max), mention(limit, bow_value(), Finding::Form::value),
                       holds(limit)};
  const auto least = std::min(a_max_, d_max_);
  if (oscillates()) {
    found.push_back({"{} is {} and so exceeds {}: the motor oscillates", std::move(mentions)});
  } else if (least > 0 && least <= 2 * bow_value()) {
    found.push_back(
        {"{} is {}, no less than half of {}: the motor may oscillate", std::move(mentions)});
  }
  return found;
}

void Tmc457::set_switches(bool left, bool right) {
  if (left == left_ && right == right_) return;
  left_ = left;
  right_ = right;
  planned_ = false;
}

// Each bow tick changes the acceleration by a whole bow value, which is more than it may be.
bool Tmc457::oscillates() const {
  const auto least = std::min(a_max_, d_max_);
  return least > 0 && bow_value() > least;
}

bool Tmc457::barred(double velocity) const {
  return (velocity < 0 && left_ && enable_stop_l_) || (velocity > 0 && right_ && enable_stop_r_);
}

Forces Tmc457::forces() const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (course_ == Course::stop) return {0, d_stop_ * a_unit, {infinite}};
  if (course_ == Course::oscillation) {
    return {bow_value() * a_unit, bow_value() * a_unit, {infinite}};
  }
  if (bow_max_ == 0) return {a_max_ * a_unit, d_max_ * a_unit, {infinite}};
  return {a_max_ * a_unit, d_max_ * a_unit * 15 / 16, {bow_value() * bow_unit}};
}

double Tmc457::distance() const { return to_double(to_fixed(x_target_) - track_.at(tick_).x); }

Tmc457 Tmc457::planned() const {
  auto copy = *this;
  copy.plan();
  return copy;
}

void Tmc457::plan() {
  planned_ = true;
  const auto now = track_.at(tick_);
  const double v = to_double(now.v);
  const double a = to_double(2 * now.h);
  const double bow = bow_value() * bow_unit;
  const double eventual = bow > 0 ? v + a * std::abs(a) / (2 * bow) : v;
  if (barred(v) || barred(eventual)) {
    course_ = Course::stop;
    track_.begin(plan_velocity({v, 0}, 0, forces()), 0, forces(), tick_, x_target_);
  } else if (mode_ == Mode::hold) {
    course_ = Course::hold;
    track_.coast(tick_, to_fixed(permitted(v_target_ * v_unit)));
  } else if (oscillates()) {
    course_ = Course::oscillation;
    plan_oscillation(v);
  } else {
    course_ = Course::ramp;
    plan_ramp(v, a);
  }
}

void Tmc457::plan_ramp(double velocity, double acceleration) {
  const auto limits = forces();
  const double along = acceleration < 0 ? -velocity : velocity;
  const double most = std::sqrt(2 * limits.bows.second * std::max(0.0, overflow - along));
  const Moving from{velocity, std::clamp(acceleration, -most, most)};
  const double v = v_max_ * v_unit;
  const auto profile = mode_ == Mode::velocity
                           ? plan_velocity(from, permitted(v_target_ * v_unit), limits)
                           : plan_move(from, distance(), {permitted(v), -permitted(-v)}, limits);
  track_.begin(profile, from.acceleration, limits, tick_, x_target_);
}

// A model of our own. The acceleration is always one bow value, up or down, for whole bow ticks,
// which are counted from the last write; so the motor passes the velocity that it is to reach, and
// the target, again and again. It stops first when it is to drive to a target.
void Tmc457::plan_oscillation(double velocity) {
  auto profile = plan_velocity({velocity, 0}, 0, forces());
  if (mode_ == Mode::velocity) {
    track_.coast(tick_, to_fixed(std::rint(velocity / v_unit) * v_unit));
    profile = leg_to_velocity(to_double(track_.at(tick_).v));
  } else if (velocity == 0) {
    profile = leg_to_target();
  }
  track_.begin(profile, 0, forces(), tick_, x_target_);
}

// Straight on until v_target is reached or just passed.
Profile Tmc457::leg_to_velocity(double velocity) const {
  const double gap = permitted(v_target_ * v_unit) - velocity;
  const double quantum = bow_value() * a_unit * bow_ticks;
  const double count = std::ceil(std::abs(gap) / quantum);
  Profile leg;
  leg.end_velocity = velocity;
  if (gap == 0) return leg;
  leg.append({ramp::Course::Force::acceleration, gap < 0}, count * bow_ticks);
  leg.end_velocity += std::copysign(count * quantum, gap);
  return leg;
}

// From standstill to standstill, until the target is just passed. Only a motor that stands on its
// target from the beginning stays there.
Profile Tmc457::leg_to_target() const {
  const double gap = distance();
  const double quantum = bow_value() * a_unit * bow_ticks;
  Profile leg;
  leg.arrives = gap == 0;
  if (gap == 0 || v_max_ == 0 || barred(gap)) return leg;
  // In units of what one bow tick up and one down make.
  const double units = std::abs(gap) / (quantum * bow_ticks);
  const double fastest = std::max(1.0, std::floor(v_max_ * v_unit / quantum));
  const double count = std::min(fastest, std::floor(std::sqrt(units)) + 1);
  const double cruise = std::max(0.0, std::floor(units / count - count) + 1);
  const bool back = gap < 0;
  leg.append({ramp::Course::Force::acceleration, back}, count * bow_ticks);
  if (cruise > 0) leg.append({ramp::Course::Force::none, back}, cruise * bow_ticks);
  leg.append({ramp::Course::Force::deceleration, !back}, count * bow_ticks);
  return leg;
}

void Tmc457::next_stretch() {
  tick_ = track_.until();
  track_.next(forces(), x_target_);
  const bool goes_on = course_ == Course::stop || course_ == Course::oscillation;
  if (track_.over() && goes_on) plan();
}

// An oscillation that has come near repeats itself: after two legs, of three stretches at the most.
// Jumps over as many of those periods as there is time for.
void Tmc457::skip_periods(Tick until) {
  constexpr int most = 6;
  auto ahead = *this;
  for (int stretches = 0; stretches < most && ahead.track_.ends_by(until); ++stretches) {
    ahead.next_stretch();
    const Tick period = ahead.track_.from() - track_.from();
    const Fixed progress = ahead.track_.start().x - track_.start().x;
    auto later = track_;
    later.skip(period, progress);
    const bool stays = progress == 0 || mode_ == Mode::velocity;
    if (!stays || !(later == ahead.track_)) continue;
    const Tick periods = (until - track_.from()) / period;
    return track_.skip(periods * period, periods * progress);
  }
}

// To the stretch in which the tick lies.
void Tmc457::run_to(Tick tick) {
  if (!planned_) plan();
  while (track_.ends_by(tick)) {
    if (course_ == Course::oscillation) skip_periods(tick);
    if (track_.ends_by(tick)) next_stretch();
  }
}

Motion Tmc457::motion() const {
  if (!planned_) return planned().motion();
  const auto now = track_.at(tick_);
  return {rounded(now.x, 0), rounded(now.v, v_bits), rounded(2 * now.h, a_bits)};
}

int Tmc457::heading() const {
  if (!planned_) return planned().heading();
  const auto v = static_cast<SignedFixed>(track_.at(tick_).v);
  return (v > 0) - (v < 0);
}

std::string_view Tmc457::phase() const {
  if (!planned_) return planned().phase();
  if (course_ == Course::stop) return "stop";
  if (course_ == Course::hold) return "hold";
  if (course_ == Course::oscillation && !track_.over()) return "oscillate";
  return bow_max_ == 0 ? trapezoid_name(track_.part()) : s_curve_name(track_.part());
}

Tick Tmc457::next_change() {
  if (!planned_) plan();
  return track_.until();
}

bool Tmc457::arrived() const {
  if (!planned_) return planned().arrived();
  return mode_ == Mode::position && track_.arrived();
}

Tmc457::Status Tmc457::status() const {
  if (!planned_) return planned().status();
  const auto v = motion().velocity;
  const bool reached = mode_ == Mode::position ? track_.part() == Part::iv && std::abs(v) == v_max_
                                               : track_.over() && v == v_target_;
  return {arrived(), reached, track_.part() == Part::rest};
}

}  // namespace tmcl::ramp
