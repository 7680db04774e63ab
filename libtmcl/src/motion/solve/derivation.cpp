#include "motion/solve/derivation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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
  return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

double mean(double a, double b) { return (a + b) / 2; }

}  // namespace

Derivation::Derivation(const Given& given, Assumption assumption)
    : known_(given),
      assumption_(assumption),
      up_{acceleration, acceleration_time, acceleration_distance, given[initial_speed].value_or(0)},
      down_{deceleration, deceleration_time, deceleration_distance,
            given[final_speed].value_or(0)} {
  do {
    learnt_ = false;
    apply_assumption();
    apply_ramp(up_);
    apply_ramp(down_);
    apply_slew();
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
  const bool may_be_nothing = quantity == slew_time || quantity == slew_distance;
  const bool possible = std::isfinite(value) && (may_be_nothing ? value >= 0 : value > least);
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
  if (rates_are_equal()) {
    copy(acceleration, deceleration);
    copy(deceleration, acceleration);
  }
  if (!times_are_equal()) return;
  copy(acceleration_time, deceleration_time);
  copy(deceleration_time, acceleration_time);
  if (all(total_time, slew_time))
    learn(acceleration_time, (value(total_time) - value(slew_time)) / 2);
  if (assumption_ != Assumption::thirds) return;
  copy(acceleration_time, slew_time);
  copy(slew_time, acceleration_time);
  if (has(total_time)) learn(acceleration_time, value(total_time) / 3);
  if (all(distance, speed))
    learn(total_time,
          3 * value(distance) / (2 * value(speed) + mean(up_.end_speed, down_.end_speed)));
}

// The equations of constant acceleration, each for each of its quantities.
void Derivation::apply_ramp(const Ramp& ramp) {
  const auto& [rate, time, way, end] = ramp;
  if (all(rate, time)) learn(speed, end + value(rate) * value(time));
  if (all(way, time)) learn(speed, 2 * value(way) / value(time) - end);
  if (all(way, rate)) learn(speed, std::sqrt(end * end + 2 * value(rate) * value(way)));
  if (!has(speed)) return;
  if (has(way)) learn(time, value(way) / mean(end, value(speed)));
  if (has(time)) learn(rate, (value(speed) - end) / value(time));
  if (has(rate)) learn(time, (value(speed) - end) / value(rate));
  if (has(time)) learn(way, mean(end, value(speed)) * value(time));
}

void Derivation::apply_slew() {
  if (all(speed, slew_time)) learn(slew_distance, value(speed) * value(slew_time));
  if (all(slew_distance, speed)) learn(slew_time, value(slew_distance) / value(speed));
  if (all(slew_distance, slew_time) && value(slew_time) > 0)
    learn(speed, value(slew_distance) / value(slew_time));
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
  if (has(speed) && all(acceleration_time, deceleration_time)) {
    const double of_ramps = mean(up_.end_speed, value(speed)) * value(acceleration_time) +
                            mean(down_.end_speed, value(speed)) * value(deceleration_time);
    if (has(slew_time)) learn(distance, of_ramps + value(speed) * value(slew_time));
    if (has(distance)) learn(slew_time, (value(distance) - of_ramps) / value(speed));
  }
  ends_alike() ? apply_alike_ends() : apply_unlike_ends();
}

// Which part of their time each of the ramps takes makes no difference.
void Derivation::apply_alike_ends() {
  const double end = up_.end_speed;
  if (all(distance, total_time, slew_time))
    learn(speed, (2 * value(distance) - end * (value(total_time) - value(slew_time))) /
                     (value(total_time) + value(slew_time)));
  if (!has(speed)) return;
  const double sum = value(speed) + end;
  const double difference = value(speed) - end;
  if (all(total_time, slew_time))
    learn(distance, (sum * value(total_time) + difference * value(slew_time)) / 2);
  if (all(distance, slew_time))
    learn(total_time, (2 * value(distance) - difference * value(slew_time)) / sum);
  if (all(distance, total_time))
    learn(slew_time, (2 * value(distance) - sum * value(total_time)) / difference);
}

// With the speed, two of the three times follow from distance and total_time.
void Derivation::apply_unlike_ends() {
  if (!all(speed, distance, total_time)) return;
  struct Part {
    Quantity time;
    double mean_speed;
  };
  const Part parts[] = {{acceleration_time, mean(up_.end_speed, value(speed))},
                        {slew_time, value(speed)},
                        {deceleration_time, mean(down_.end_speed, value(speed))}};
  for (std::size_t i = 0; i < std::size(parts); ++i) {
    const auto& [known, its_speed] = parts[i];
    const auto& [first, first_speed] = parts[(i + 1) % std::size(parts)];
    const auto& [second, second_speed] = parts[(i + 2) % std::size(parts)];
    if (!has(known) || has(first) || has(second)) continue;
    const double time = value(total_time) - value(known);
    const double way = value(distance) - its_speed * value(known);
    learn(first, (way - second_speed * time) / (first_speed - second_speed));
  }
}

std::optional<Derivation::Term> Derivation::term(const Ramp& ramp) const {
  if (has(ramp.time)) return Term{value(ramp.time), 0};
  if (!has(ramp.rate)) return std::nullopt;
  return Term{-ramp.end_speed / value(ramp.rate), 1 / value(ramp.rate)};
}

std::optional<Derivation::RampTimes> Derivation::ramps() const {
  auto up = term(up_);
  auto down = term(down_);
  const auto other = [&](const Term& one) -> std::optional<Term> {
    if (times_are_equal()) return one;
    if (!all(total_time, slew_time)) return std::nullopt;
    return Term{value(total_time) - value(slew_time) - one.constant, -one.per_speed};
  };
  if (up && !down) down = other(*up);
  if (down && !up) up = other(*down);
  if (!up || !down) return std::nullopt;
  return RampTimes{*up, *down};
}

std::optional<Derivation::Term> Derivation::slew() const {
  if (has(slew_time)) return Term{value(slew_time), 0};
  return assumption_ == Assumption::thirds ? term(up_) : std::nullopt;
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

// distance = at_rest + speed * (constant + per_speed * speed); its positive root without
// cancellation.
void Derivation::speed_from_distance_and_parts(RampTimes ramps, Term slew) {
  const auto& [up, down] = ramps;
  const double u = up_.end_speed;
  const double w = down_.end_speed;
  const double per_speed = mean(up.per_speed, down.per_speed) + slew.per_speed;
  const double constant =
      mean(up.constant + u * up.per_speed, down.constant + w * down.per_speed) + slew.constant;
  const double rest = value(distance) - mean(u * up.constant, w * down.constant);
  const double root = std::sqrt(constant * constant + 4 * per_speed * rest);
  learn(speed, 2 * rest / (constant + root));
}

// distance = at_rest + speed * (mean - per_speed / 2 * speed): of two positive roots, the greater
// would leave a slew_time below 0.
void Derivation::speed_from_distance_and_total(RampTimes ramps) {
  const auto& [up, down] = ramps;
  const double u = up_.end_speed;
  const double w = down_.end_speed;
  const double per_speed = up.per_speed + down.per_speed;
  const double rest = value(distance) - mean(u * up.constant, w * down.constant);
  const double constant = value(total_time) - mean(up.constant, down.constant) +
                          mean(u * up.per_speed, w * down.per_speed);
  if (!(constant > 0)) return learn(slew_time, value(total_time) - up.constant - down.constant);
  double square = constant * constant - 2 * per_speed * rest;
  const double noise = constant * constant;
  if (square > -solve_tolerance / 2 * noise && square < rounding_of_a_root * noise) square = 0;
  learn(speed, square < 0 ? nothing_possible : 2 * rest / (constant + std::sqrt(square)));
}

void Derivation::speed_from_times(RampTimes ramps, Term slew) {
  const double per_speed = ramps.up.per_speed + ramps.down.per_speed + slew.per_speed;
  // The total_time follows from the others, which say nothing of the speed.
  if (per_speed == 0) return;
  const double constant = ramps.up.constant + ramps.down.constant + slew.constant;
  learn(speed, (value(total_time) - constant) / per_speed);
}

double residual_of(const Given& complete, Assumption assumption) {
  const auto of = [&](Quantity quantity) { return *complete[quantity]; };
  const double u = complete[initial_speed].value_or(0);
  const double w = complete[final_speed].value_or(0);
  const double times = of(acceleration_time) + of(slew_time) + of(deceleration_time);
  const double ways[] = {mean(u, of(speed)) * of(acceleration_time), of(speed) * of(slew_time),
                         mean(of(speed), w) * of(deceleration_time)};
  double residual =
      std::max({relative_difference(of(speed), u + of(acceleration) * of(acceleration_time)),
                relative_difference(of(speed), w + of(deceleration) * of(deceleration_time)),
                relative_difference(of(total_time), times),
                relative_difference(of(distance), ways[0] + ways[1] + ways[2])});
  const auto compare = [&](double a, double b) {
    residual = std::max(residual, relative_difference(a, b));
  };
  compare(complete[acceleration_distance].value_or(ways[0]), ways[0]);
  compare(complete[slew_distance].value_or(ways[1]), ways[1]);
  compare(complete[deceleration_distance].value_or(ways[2]), ways[2]);
  if (assumption == Assumption::none) return residual;
  if (assumption == Assumption::symmetric || u == w) compare(of(acceleration), of(deceleration));
  if (assumption == Assumption::thirds || u == w)
    compare(of(acceleration_time), of(deceleration_time));
  if (assumption == Assumption::thirds) compare(of(slew_time), of(acceleration_time));
  return residual;
}

}  // namespace tmcl::plan
