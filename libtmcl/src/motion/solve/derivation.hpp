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
/// has its formula in speed_from_...(). A distance of a part is used where the speed, or the time
/// or the rate of this part, is known.
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
  /// One of the ramps, with the speed at its other end.
  struct Ramp {
    Quantity rate;
    Quantity time;
    Quantity distance;
    double end_speed;
  };
  struct RampTimes {
    Term up;
    Term down;
  };
  bool ends_alike() const { return up_.end_speed == down_.end_speed; }
  bool times_are_equal() const {
    return assumption_ == Assumption::thirds ||
           (assumption_ == Assumption::symmetric && ends_alike());
  }
  bool rates_are_equal() const {
    return assumption_ == Assumption::symmetric ||
           (assumption_ == Assumption::thirds && ends_alike());
  }
  std::optional<Term> term(const Ramp& ramp) const;
  std::optional<RampTimes> ramps() const;
  std::optional<Term> slew() const;

  double longest_time() const;

  void learn(Quantity quantity, double value);
  void copy(Quantity from, Quantity to);
  void apply_assumption();
  void apply_ramp(const Ramp& ramp);
  void apply_slew();
  void apply_sum_of_times();
  void apply_area();
  void apply_alike_ends();
  void apply_unlike_ends();
  void apply_unknown_speed();
  void speed_from_distance_and_parts(RampTimes ramps, Term slew);
  void speed_from_distance_and_total(RampTimes ramps);
  void speed_from_times(RampTimes ramps, Term slew);

  Given known_;
  Assumption assumption_;
  Ramp up_;
  Ramp down_;
  std::optional<Quantity> impossible_{};
  double impossible_value_ = 0;
  bool learnt_ = false;
};

/// The greatest relative difference of both sides of an equation; all of the eight must be known.
double residual_of(const Given& complete, Assumption assumption);

}  // namespace tmcl::plan
