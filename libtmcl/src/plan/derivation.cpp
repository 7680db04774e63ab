#include "plan/derivation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tmcl::plan {
namespace {

using enum Quantity;

constexpr double nothing_possible = std::numeric_limits<double>::quiet_NaN();
// Of the square of the mean time: what is less is a triangle but for rounding.
constexpr double rounding_of_a_root = 1e-14;
// Of the longest time: what is as little below 0 is nothing. Leaves the distance within tolerance.
constexpr double rounding_of_a_time = solve_tolerance / 4;
// Of the longest time: a ramp that is shorter is none.
constexpr double shortest_ramp = 1e-12;

double relative_difference(double a, double b) {
  return std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

}  // namespace

Derivation::Derivation(const Given& given, Assumption assumption)
    : known_(given), assumption_(assumption) {
  do {
    learnt_ = false;
    apply_assumption();
    apply_ramp(acceleration, acceleration_time);
    apply_ramp(deceleration, deceleration_time);
    apply_sum_of_times();
    apply_area();
    apply_unknown_speed();
  } while (learnt_ && !impossible_);
}

bool Derivation::complete() const {
  return !impossible_ && std::ranges::all_of(quantities, [&](Quantity q) { return has(q); });
}

void Derivation::learn(Quantity quantity, double value) {
  if (has(quantity) || impossible_) return;
  const double whole = longest_time();
  if (quantity == slew_time && std::abs(value) <= rounding_of_a_time * whole)
    value = std::max(value, 0.0);
  const double least =
      quantity == acceleration_time || quantity == deceleration_time ? shortest_ramp * whole : 0;
  const bool possible =
      std::isfinite(value) && (quantity == slew_time ? value >= 0 : value > least);
  if (!possible) {
    impossible_ = quantity;
    impossible_value_ = value;
    return;
  }
  known_[quantity] = value;
  learnt_ = true;
}

double Derivation::longest_time() const {
  double longest = 0;
  for (const auto time : {acceleration_time, slew_time, deceleration_time, total_time})
    longest = std::max(longest, known_[time].value_or(0));
  return longest;
}

void Derivation::copy(Quantity from, Quantity to) {
  if (has(from)) learn(to, value(from));
}

void Derivation::apply_assumption() {
  if (assumption_ == Assumption::none) return;
  copy(acceleration, deceleration);
  copy(deceleration, acceleration);
  copy(acceleration_time, deceleration_time);
  copy(deceleration_time, acceleration_time);
  if (all(total_time, slew_time))
    learn(acceleration_time, (value(total_time) - value(slew_time)) / 2);
  if (assumption_ != Assumption::thirds) return;
  copy(acceleration_time, slew_time);
  copy(slew_time, acceleration_time);
  if (has(total_time)) learn(acceleration_time, value(total_time) / 3);
  if (all(distance, speed)) learn(total_time, 1.5 * value(distance) / value(speed));
}

void Derivation::apply_ramp(Quantity rate, Quantity time) {
  if (all(rate, time)) learn(speed, value(rate) * value(time));
  if (all(speed, time)) learn(rate, value(speed) / value(time));
  if (all(speed, rate)) learn(time, value(speed) / value(rate));
}

void Derivation::apply_sum_of_times() {
  if (all(acceleration_time, slew_time, deceleration_time))
    learn(total_time, value(acceleration_time) + value(slew_time) + value(deceleration_time));
  if (!has(total_time)) return;
  if (all(slew_time, deceleration_time))
    learn(acceleration_time, value(total_time) - value(slew_time) - value(deceleration_time));
  if (all(acceleration_time, deceleration_time))
    learn(slew_time, value(total_time) - value(acceleration_time) - value(deceleration_time));
  if (all(acceleration_time, slew_time))
    learn(deceleration_time, value(total_time) - value(acceleration_time) - value(slew_time));
}

void Derivation::apply_area() {
  if (all(speed, total_time, slew_time))
    learn(distance, value(speed) * (value(total_time) + value(slew_time)) / 2);
  if (all(distance, total_time, slew_time))
    learn(speed, 2 * value(distance) / (value(total_time) + value(slew_time)));
  if (!all(distance, speed)) return;
  const double at_full_speed = value(distance) / value(speed);
  if (all(acceleration_time, deceleration_time))
    learn(slew_time, at_full_speed - (value(acceleration_time) + value(deceleration_time)) / 2);
  if (has(slew_time)) learn(total_time, 2 * at_full_speed - value(slew_time));
  if (has(total_time)) learn(slew_time, 2 * at_full_speed - value(total_time));
}

std::optional<Derivation::Term> Derivation::term(Quantity time, Quantity rate) const {
  if (has(time)) return Term{value(time), 0};
  if (has(rate)) return Term{0, 1 / value(rate)};
  return std::nullopt;
}

std::optional<Derivation::Term> Derivation::ramps() const {
  const auto up = term(acceleration_time, acceleration);
  const auto down = term(deceleration_time, deceleration);
  if (!up || !down) return std::nullopt;
  return Term{up->constant + down->constant, up->per_speed + down->per_speed};
}

std::optional<Derivation::Term> Derivation::slew() const {
  if (has(slew_time)) return Term{value(slew_time), 0};
  return assumption_ == Assumption::thirds ? term(acceleration_time, acceleration) : std::nullopt;
}

void Derivation::apply_unknown_speed() {
  const auto both_ramps = ramps();
  if (has(speed) || !both_ramps) return;
  const auto slewing = slew();
  if (has(distance) && slewing) {
    speed_from_distance_and_parts(*both_ramps, *slewing);
  } else if (all(distance, total_time)) {
    speed_from_distance_and_total(*both_ramps);
  } else if (has(total_time) && slewing) {
    speed_from_times(*both_ramps, *slewing);
  }
}

// distance = speed * (constant + per_speed * speed); its positive root without cancellation.
void Derivation::speed_from_distance_and_parts(Term ramps, Term slew) {
  const double constant = ramps.constant / 2 + slew.constant;
  const double per_speed = ramps.per_speed / 2 + slew.per_speed;
  const double root = std::sqrt(constant * constant + 4 * per_speed * value(distance));
  learn(speed, 2 * value(distance) / (constant + root));
}

// distance = speed * (mean - per_speed / 2 * speed): of two positive roots, the greater would leave
// a slew_time below 0.
void Derivation::speed_from_distance_and_total(Term ramps) {
  const double mean = value(total_time) - ramps.constant / 2;
  if (!(mean > 0)) return learn(slew_time, value(total_time) - ramps.constant);
  double square = mean * mean - 2 * ramps.per_speed * value(distance);
  if (square > -solve_tolerance / 2 * mean * mean && square < rounding_of_a_root * mean * mean)
    square = 0;
  learn(speed, square < 0 ? nothing_possible : 2 * value(distance) / (mean + std::sqrt(square)));
}

void Derivation::speed_from_times(Term ramps, Term slew) {
  const double per_speed = ramps.per_speed + slew.per_speed;
  // The total_time follows from the others, which say nothing of the speed.
  if (per_speed == 0) return;
  learn(speed, (value(total_time) - ramps.constant - slew.constant) / per_speed);
}

double residual_of(const Given& complete, Assumption assumption) {
  const auto of = [&](Quantity quantity) { return *complete[quantity]; };
  const double times = of(acceleration_time) + of(slew_time) + of(deceleration_time);
  double residual = std::max(
      {relative_difference(of(speed), of(acceleration) * of(acceleration_time)),
       relative_difference(of(speed), of(deceleration) * of(deceleration_time)),
       relative_difference(of(total_time), times),
       relative_difference(of(distance), of(speed) * (of(total_time) + of(slew_time)) / 2)});
  if (assumption != Assumption::none) {
    residual = std::max({residual, relative_difference(of(acceleration), of(deceleration)),
                         relative_difference(of(acceleration_time), of(deceleration_time))});
  }
  if (assumption == Assumption::thirds)
    residual = std::max(residual, relative_difference(of(slew_time), of(acceleration_time)));
  return residual;
}

}  // namespace tmcl::plan
