/// The trapezoid that a movement is, from as little as determines it.
///
/// Eight quantities and four equations (application note AN00115-001), from rest to rest:
///
///     speed = acceleration * acceleration_time = deceleration * deceleration_time
///     total_time = acceleration_time + slew_time + deceleration_time
///     distance = speed * (total_time + slew_time) / 2
///
/// A movement may begin and end with a speed below that in between; then the equations of constant
/// acceleration hold for each ramp, with that speed u, v in between, and the ramp's own distance s:
///
///     v = u + a t    s = (u + v) t / 2    s = u t + a t^2 / 2    s = v t - a t^2 / 2
///     v^2 = u^2 + 2 a s
///
/// So four quantities that do not follow from each other determine the rest; with an assumption,
/// fewer do. Units are whatever the caller takes: one of length, one of time. A triangle is a
/// trapezoid whose slew_time is 0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace tmcl::plan {

enum class Quantity : std::uint8_t {
  distance,
  speed,  ///< While neither accelerating nor decelerating; the greatest.
  acceleration,
  deceleration,  ///< As a positive number.
  acceleration_time,
  slew_time,  ///< At constant speed; the only one that may be 0.
  deceleration_time,
  total_time,
  // What may be given besides, and follows from the eight.
  initial_speed,  ///< 0 if not given, and below speed; final_speed the same.
  final_speed,
  acceleration_distance,  ///< Together with anything else of the same part.
  slew_distance,
  deceleration_distance
};
constexpr std::size_t quantity_count = 8;
/// Those that determine a profile, in the order of the enumeration.
constexpr std::array<Quantity, quantity_count> quantities{
    Quantity::distance,          Quantity::speed,
    Quantity::acceleration,      Quantity::deceleration,
    Quantity::acceleration_time, Quantity::slew_time,
    Quantity::deceleration_time, Quantity::total_time};

constexpr std::array<Quantity, 5> side_quantities{
    Quantity::initial_speed, Quantity::final_speed, Quantity::acceleration_distance,
    Quantity::slew_distance, Quantity::deceleration_distance};
constexpr std::size_t every_quantity_count = quantity_count + side_quantities.size();

/// "acceleration_time"
std::string_view name_of(Quantity quantity);
std::optional<Quantity> quantity_named(std::string_view name);

enum class Assumption : std::uint8_t {
  none,
  symmetric,  ///< acceleration = deceleration; with the same speed at both ends, equal times, too.
  thirds  ///< Each of the three parts takes a third of the time; symmetric if the ends are alike.
};
std::string_view name_of(Assumption assumption);
std::optional<Assumption> assumption_named(std::string_view name);

/// What is known of a profile.
struct Given {
  std::array<std::optional<double>, every_quantity_count> values{};
  std::optional<double>& operator[](Quantity q) { return values[static_cast<std::size_t>(q)]; }
  const std::optional<double>& operator[](Quantity q) const {
    return values[static_cast<std::size_t>(q)];
  }
};

/// All of it. The equations hold within `solve_tolerance`.
struct Profile {
  double distance = 0;
  double speed = 0;
  double acceleration = 0;
  double deceleration = 0;
  double acceleration_time = 0;
  double slew_time = 0;
  double deceleration_time = 0;
  double total_time = 0;
  double initial_speed = 0;
  double final_speed = 0;
  double acceleration_distance = 0;
  double slew_distance = 0;
  double deceleration_distance = 0;

  double operator[](Quantity quantity) const;
  /// The way made after this time; 0 before the start, `distance` after the end.
  double position_at(double time) const;
  /// initial_speed before the start, final_speed after the end.
  double speed_at(double time) const;
};

/// Relative: a given value that differs by more from what others make it is a contradiction.
constexpr double solve_tolerance = 1e-9;

/// What a quantity would have to be, the others being as they are.
struct Bound {
  Quantity quantity{};
  bool at_least = false;  ///< Otherwise at most.
  bool inclusive = true;  ///< Otherwise more than, or less than.
  double value = 0;       ///< Rounded to six digits, towards what is possible.
};

struct SolveError {
  enum class Kind : std::uint8_t {
    invalid,        ///< `culprits` are not finite and positive.
    insufficient,   ///< `candidates` would help.
    contradiction,  ///< `culprits` make `quantity` `implied`, and it is given as `given`.
    impossible      ///< `culprits` leave nothing for `quantity`.
  };
  Kind kind = Kind::invalid;
  Assumption assumption = Assumption::none;
  Given known{};  ///< What was given.
  /// As few as there can be.
  std::vector<Quantity> culprits{};
  std::optional<Quantity> quantity{};
  double given = 0;
  double implied = 0;
  /// If impossible: what would not be. May be empty.
  std::vector<Bound> bounds{};
  /// If insufficient: how many more are needed, and which of them come into question.
  std::size_t missing = 0;
  std::vector<Quantity> candidates{};
  /// If insufficient: the assumptions that would make it enough; the weakest first.
  std::vector<Assumption> sufficient_assumptions{};
};

/// One sentence, without a full stop. Numbers get the units, if there are any: "8 mm/s".
std::string describe(const SolveError& error, std::string_view length_unit = {},
                     std::string_view time_unit = {});

/// "8 mm/s^2": six significant digits and the unit of the quantity.
std::string with_unit(Quantity quantity, double value, std::string_view length_unit,
                      std::string_view time_unit);

/// Whether values of these quantities determine a profile from rest to rest.
bool is_sufficient(const std::vector<Quantity>& known, Assumption assumption = Assumption::none);

/// The profile with these values. More may be given than is needed, as long as it agrees. There is
/// never more than one profile: of the two speeds that cover a distance in a time with given ramps,
/// the greater leaves no time for slewing.
tl::expected<Profile, SolveError> solve(const Given& given,
                                        Assumption assumption = Assumption::none);

}  // namespace tmcl::plan
