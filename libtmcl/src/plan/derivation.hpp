/// What follows from some quantities of a profile.
#pragma once

#include "tmcl/plan/profile.hpp"

namespace tmcl::plan {

/// Applies the equations until nothing new comes out. What is given is never replaced, and what
/// follows in several ways is not compared.
///
/// This finds everything there is to find. Where the speed is known, the others are linear, and
/// each equation is solved for each of its quantities. Where it is not, every time is given, or the
/// speed over a given rate, or unknown; two values of one ramp give the speed; and otherwise four
/// of {ramp up, ramp down, slew_time, distance, total_time} are needed. Each of these five choices
/// has its formula in speed_from_...().
class Derivation {
 public:
  Derivation(const Given& given, Assumption assumption);

  const Given& known() const { return known_; }
  bool complete() const;
  /// The quantity for which nothing possible is left; its `impossible_value` is NaN if it does not
  /// even have an impossible one.
  const std::optional<Quantity>& impossible() const { return impossible_; }
  double impossible_value() const { return impossible_value_; }

 private:
  /// A time as constant + per_speed * speed.
  struct Term {
    double constant = 0;
    double per_speed = 0;
  };

  bool has(Quantity quantity) const { return known_[quantity].has_value(); }
  template <class... Quantities>
  bool all(Quantities... wanted) const {
    return (has(wanted) && ...);
  }
  double value(Quantity quantity) const { return *known_[quantity]; }
  std::optional<Term> term(Quantity time, Quantity rate) const;
  std::optional<Term> ramps() const;
  std::optional<Term> slew() const;

  double longest_time() const;

  void learn(Quantity quantity, double value);
  void copy(Quantity from, Quantity to);
  void apply_assumption();
  void apply_ramp(Quantity rate, Quantity time);
  void apply_sum_of_times();
  void apply_area();
  void apply_unknown_speed();
  void speed_from_distance_and_parts(Term ramps, Term slew);
  void speed_from_distance_and_total(Term ramps);
  void speed_from_times(Term ramps, Term slew);

  Given known_;
  Assumption assumption_;
  std::optional<Quantity> impossible_{};
  double impossible_value_ = 0;
  bool learnt_ = false;
};

/// The greatest relative difference of both sides of an equation; all quantities must be known.
double residual_of(const Given& complete, Assumption assumption);

}  // namespace tmcl::plan
