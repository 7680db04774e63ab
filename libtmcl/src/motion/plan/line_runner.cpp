#include "motion/plan/line_runner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/twin/divisors.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// Register values that come about as near to a time as the ramp generator's ticks allow.
constexpr Duration near_enough = std::chrono::microseconds(50);
// What a candidate is worth is only known once a twin has tried it; so many are tried.
constexpr std::size_t tried_first = 8;
constexpr std::size_t tried_then = 24;
// A ramp that is less steep or steeper than the line wants by more than this leaves the line too
// far.
constexpr double most_acceleration_change = 0.15;
// Unless the ramp is such a small part of the time that it does not take it off.
constexpr double short_ramp = 0.005;
constexpr std::int32_t least_speeds_tried = 3;  // to either side
constexpr std::int32_t speeds_tried_part = 60;
constexpr double most_time_change = 0.005;  // less than 1 / speeds_tried_part
constexpr std::uint8_t greatest_divider = 13;
constexpr std::int32_t greatest_register = 2047;
// So that it can be chosen to 1 %.
constexpr std::int32_t fine_acceleration = 64;
constexpr std::size_t dividers_tried = 2;

// Of a trapezoid or a triangle.
double time_of(double way, double velocity, double acceleration) {
  if (velocity * velocity > way * acceleration) return 2 * std::sqrt(way / acceleration);
  return way / velocity + velocity / acceleration;
}

/// What makes a plain trapezoid, with everything else that makes a difference to it: the other
/// accelerations, bow, minimum velocity.
std::vector<Setting> trapezoid_settings(const AxisTwin& twin, InternalVelocity velocity,
                                        InternalAcceleration acceleration) {
  const auto v = velocity.value;
  const auto a = acceleration.value;
  if (const auto* chip = twin.tmc429()) {
    return {{ap::max_velocity, v},
            {ap::max_acceleration, a},
            {number_of("minimum_velocity"),
             std::min(speed_within_a_microstep(chip->dividers(), acceleration).value, v)}};
  }
  constexpr auto deceleration = number_of("max_deceleration");
  if (twin.model().family == Family::tmc457) {
    return {{ap::max_velocity, v},
            {number_of("acceleration"), a},
            {deceleration, a},
            {number_of("max_bow"), 0}};
  }
  return {{ap::max_velocity, v},
          {ap::max_acceleration, a},
          {number_of("velocity_v1"), 0},
          {deceleration, a},
          {number_of("deceleration_d1"), a}};
}

/// The smallest ramp divider with which the acceleration is fine: arrivals are on the grid of the
/// ramp's ticks.
std::optional<Tmc429Dividers> least_ramp_divider(std::uint8_t pulse,
                                                 PulsesPerSecond2 acceleration) {
  for (std::uint8_t ramp = 0; ramp <= greatest_divider; ++ramp) {
    const Tmc429Dividers dividers{pulse, ramp};
    const auto value = acceleration.value / module_units(dividers).acceleration.value;
    const auto valid = tmc429_acceleration_range(dividers);
    if (value >= std::max(valid.least, fine_acceleration) && value <= valid.greatest)
      return dividers;
  }
  return std::nullopt;
}

/// Those with which a TMC429's registers can say the speed of a slow axis, the finest first.
std::vector<Tmc429Dividers> finer_dividers(Tmc429Dividers present, PulsesPerSecond velocity,
                                           PulsesPerSecond2 acceleration) {
  std::vector<Tmc429Dividers> all;
  for (auto pulse = greatest_divider; pulse >= present.pulse; --pulse) {
    const auto unit = module_units(Tmc429Dividers{pulse, 0}).velocity.value;
    if (velocity.value / unit > greatest_register) continue;
    const auto dividers = least_ramp_divider(pulse, acceleration);
    if (dividers && *dividers != present) all.push_back(*dividers);
    if (all.size() == dividers_tried || pulse == 0) break;
  }
  return all;
}

AxisTwin with_dividers(AxisTwin twin, std::optional<Tmc429Dividers> dividers) {
  if (!dividers) return twin;
  twin.set({pulse_divisor, dividers->pulse});
  twin.set({ramp_divisor, dividers->ramp});
  return twin;
}

/// Less is nothing to the generator, which would not even stop then. A TMC429 has a range of its
/// own.
std::int32_t least_acceleration(const AxisTwin& twin) {
  const bool is_tmc457 = twin.model().family == Family::tmc457;
  const auto unit = is_tmc457 ? tmc457_acceleration_unit : sixpoint_acceleration_unit;
  if (twin.tmc429() != nullptr) return 1;
  const auto pps2 = static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
  return static_cast<std::int32_t>(std::ceil(pps2 / twin.to_pps2(InternalAcceleration{1}).value));
}

}  // namespace

LineRunner::LineRunner(const LineAxis& axis, double part_of_longest,
                       std::optional<Tmc429Dividers> dividers)
    : axis_(&axis),
      dividers_(dividers),
      standing_(with_dividers(axis.twin, dividers)),
      way_(static_cast<double>(std::abs(way_of(axis)))),
      part_(part_of_longest),
      v_unit_(standing_.to_pps(InternalVelocity{1}).value),
      a_unit_(standing_.to_pps2(InternalAcceleration{1}).value),
      v_range_(range(ap::max_velocity, axis.velocity.value / v_unit_)),
      a_range_(range(ap::max_acceleration, axis.acceleration.value / a_unit_)) {
  a_range_.least = std::max(a_range_.least, least_acceleration(standing_));
  const auto* chip = standing_.tmc429();
  if (chip == nullptr) return;
  const auto valid = tmc429_acceleration_range(chip->dividers());
  a_range_.least = std::max(a_range_.least, valid.least);
  a_range_.greatest = std::min(a_range_.greatest, valid.greatest);
}

std::vector<LineRunner> LineRunner::finer(const LineAxis& axis, double part_of_longest,
                                          const SharedRamp& ramp) {
  std::vector<LineRunner> runners;
  const auto* chip = axis.twin.tmc429();
  if (chip == nullptr) return runners;
  const double way = static_cast<double>(std::abs(way_of(axis)));
  const double velocity = ramp.velocity * part_of_longest;
  // A short ramp may be longer, if that lets the speed be finer.
  const double gentle = velocity * velocity / (way * short_ramp);
  const double acceleration = std::min(ramp.acceleration * part_of_longest, gentle);
  for (const auto dividers : finer_dividers(chip->dividers(), {velocity}, {acceleration})) {
    LineRunner runner(axis, part_of_longest, dividers);
    if (runner.choose(ramp.velocity, ramp.acceleration)) runners.push_back(std::move(runner));
  }
  return runners;
}

bool LineRunner::choose(double velocity, double acceleration) {
  v_ideal_ = velocity * part_ / v_unit_;
  a_ideal_ = acceleration * part_ / a_unit_;
  const auto v = std::round(std::min<double>(v_ideal_, v_range_.greatest));
  const auto a = std::round(std::min<double>(a_ideal_, a_range_.greatest));
  if (v < v_range_.least || a < a_range_.least) return false;
  return take({static_cast<std::int32_t>(v), static_cast<std::int32_t>(a)});
}

void LineRunner::fit(Duration wanted) {
  if (try_out(chosen_, wanted)) return;
  for (const auto count : {tried_first, tried_then}) {
    const double bias = seconds(arrival_) - formula(chosen_);
    for (const auto& candidate : candidates(seconds(wanted) - bias, count)) {
      if (try_out(candidate, wanted)) return;
    }
  }
}

bool LineRunner::is_coarse() const {
  const double ideal = time_of(way_, v_ideal_ * v_unit_, a_ideal_ * a_unit_);
  return std::abs(formula(chosen_) / ideal - 1) > most_time_change;
}

AxisOfLine LineRunner::result(Duration start) const {
  return {settings_to_write(), run(chosen_), start, start + arrival_};
}

ValueRange LineRunner::range(std::uint8_t parameter, double limit) const {
  const auto& row = *find_parameter(axis_parameters(axis_->twin.model()), parameter);
  return {1,
          static_cast<std::int32_t>(std::min<double>(row.maximum, std::floor(limit * (1 + 1e-9))))};
}

std::vector<Setting> LineRunner::settings_to_write() const {
  auto settings = settings_of(chosen_);
  if (!dividers_) return settings;
  settings.insert(settings.begin(),
                  {{pulse_divisor, dividers_->pulse}, {ramp_divisor, dividers_->ramp}});
  return in_safe_order(std::move(settings), axis_->twin.tmc429()->dividers().pulse);
}

std::vector<Setting> LineRunner::settings_of(Registers registers) const {
  auto settings = trapezoid_settings(standing_, {registers.velocity}, {registers.acceleration});
  if (registers.minimum != 0) settings.back().value = registers.minimum;
  return settings;
}

AxisTwin LineRunner::run(Registers registers) const {
  auto twin = standing_;
  twin.set(settings_of(registers));
  twin.move_to(axis_->target);
  return twin;
}

bool LineRunner::take(Registers registers) {
  const auto arrival = run(registers).time_to_arrival();
  if (!arrival) return false;
  chosen_ = registers;
  arrival_ = *arrival;
  return true;
}

// True if that is near enough.
bool LineRunner::try_out(Registers registers, Duration wanted) {
  const auto arrival = run(registers).time_to_arrival();
  if (!arrival) return false;
  keep_if_nearer(registers, *arrival, wanted);
  if (*arrival < wanted) creep_at_the_end(registers, wanted);
  return std::chrono::abs(arrival_ - wanted) <= near_enough;
}

void LineRunner::keep_if_nearer(Registers registers, Duration arrival, Duration wanted) {
  if (std::chrono::abs(arrival - wanted) >= std::chrono::abs(arrival_ - wanted)) return;
  chosen_ = registers;
  arrival_ = arrival;
}

// What is missing to the time is spent on the last microsteps, where it takes no axis off the
// line: the lower a TMC429's minimum velocity, the later it arrives.
void LineRunner::creep_at_the_end(Registers registers, Duration wanted) {
  if (axis_->twin.tmc429() == nullptr) return;
  std::int32_t late = 0;
  auto early = settings_of(registers).back().value;
  while (early - late > 1) {
    registers.minimum = (early + late) / 2;
    const auto arrival = run(registers).time_to_arrival();
    if (!arrival) return;
    keep_if_nearer(registers, *arrival, wanted);
    (*arrival < wanted ? early : late) = registers.minimum;
  }
}

double LineRunner::formula(Registers registers) const {
  return time_of(way_, registers.velocity * v_unit_, registers.acceleration * a_unit_);
}

// The best first.
std::vector<LineRunner::Registers> LineRunner::candidates(double time_s, std::size_t count) const {
  std::vector<std::pair<double, Registers>> ranked;
  const auto consider = [&](double velocity, double acceleration) {
    for (const double a : {std::floor(acceleration), std::ceil(acceleration)}) {
      if (!(a >= a_range_.least && a <= a_range_.greatest)) continue;
      const double ramp_s = velocity * v_unit_ / (a * a_unit_);
      const bool is_near =
          std::abs(a / a_ideal_ - 1) <= most_acceleration_change || ramp_s <= short_ramp * time_s;
      if (!is_near && a != chosen_.acceleration) continue;
      const Registers registers{static_cast<std::int32_t>(velocity), static_cast<std::int32_t>(a)};
      ranked.emplace_back(std::abs(formula(registers) - time_s), registers);
    }
  };
  const auto middle = static_cast<std::int32_t>(std::lround(v_ideal_));
  const auto reach = std::max(least_speeds_tried, middle / speeds_tried_part);
  const auto last = std::min(middle + reach, v_range_.greatest);
  const auto step = std::max(1, reach / 50);
  for (auto v = std::max(middle - reach, v_range_.least); v <= last; v += step) {
    const double velocity = v * v_unit_;
    const double ramp_s = time_s - way_ / velocity;
    const double triangle = 4 * way_ / (time_s * time_s);
    const bool is_triangle = velocity * velocity > way_ * triangle;
    if (!is_triangle && ramp_s <= 0) continue;
    consider(v, (is_triangle ? triangle : velocity / ramp_s) / a_unit_);
  }
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(count, ranked.size()));
  std::partial_sort(ranked.begin(), end, ranked.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Registers> best;
  for (auto it = ranked.begin(); it != end; ++it) best.push_back(it->second);
  return best;
}

}  // namespace tmcl::plan
