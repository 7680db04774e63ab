#include "tmcl/plan/profile.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "motion/solve/derivation.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

using enum Quantity;
using Kind = SolveError::Kind;

constexpr std::array<std::string_view, every_quantity_count> quantity_names{
    "distance",
    "speed",
    "acceleration",
    "deceleration",
    "acceleration_time",
    "slew_time",
    "deceleration_time",
    "total_time",
    "initial_speed",
    "final_speed",
    "acceleration_distance",
    "slew_distance",
    "deceleration_distance"};
constexpr std::array<std::string_view, 3> assumption_names{"none", "symmetric", "thirds"};
constexpr std::array assumptions{Assumption::none, Assumption::symmetric, Assumption::thirds};

/// One bit for each quantity.
using Set = unsigned;
constexpr Set no_quantity = 0;
constexpr Set every_quantity = (1U << every_quantity_count) - 1;
/// Those that determine a profile: what comes after them follows from them.
constexpr Set main_quantities = (1U << quantity_count) - 1;

constexpr Set bit(Quantity quantity) { return 1U << static_cast<unsigned>(quantity); }
/// They say what is asked, and are no part of an answer.
constexpr Set end_speeds = bit(initial_speed) | bit(final_speed);

std::vector<Quantity> members(Set set) {
  std::vector<Quantity> list;
  for (unsigned i = 0; i < every_quantity_count; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    if (set & bit(quantity)) list.push_back(quantity);
  }
  return list;
}

Set with_ends(const Given& given) {
  Set set = no_quantity;
  for (const auto quantity : members(every_quantity))
    set |= given[quantity] ? bit(quantity) : no_quantity;
  return set;
}
Set set_of(const Given& given) { return with_ends(given) & ~end_speeds; }

Given only(Set set, const Given& given) {
  Given part;
  for (const auto quantity : members(set | end_speeds)) part[quantity] = given[quantity];
  return part;
}

/// The subsets of a set, the small ones first; itself among them.
std::vector<Set> subsets(Set whole) {
  std::vector<Set> all{no_quantity};
  for (Set set = whole & (~whole + 1); set != no_quantity; set = (set - whole) & whole)
    all.push_back(set);
  std::ranges::stable_sort(all, {}, [](Set set) { return std::popcount(set); });
  return all;
}

// What is enough does not depend on the values, so any ordinary profile tells: one whose ends are
// as different as those of the question.
Given ordinary(Assumption assumption, const Given& ends) {
  const double top = 8;
  const double u = ends[initial_speed].value_or(0) > 0 ? 2 : 0;
  const bool alike = ends[initial_speed].value_or(0) == ends[final_speed].value_or(0);
  const double w = alike ? u : 3;
  const double up = 0.3;
  const double slew = assumption == Assumption::thirds ? up : 1.1;
  const bool equal_times = assumption == Assumption::thirds || alike;
  const double of_equal_rates = equal_times ? up : up * (top - w) / (top - u);
  const double down = assumption == Assumption::none ? 0.7 : of_equal_rates;
  Given profile;
  profile[initial_speed] = u;
  profile[final_speed] = w;
  profile[acceleration_distance] = (u + top) * up / 2;
  profile[slew_distance] = top * slew;
  profile[deceleration_distance] = (top + w) * down / 2;
  profile[distance] = (u + top) * up / 2 + top * slew + (top + w) * down / 2;
  profile[speed] = top;
  profile[acceleration] = (top - u) / up;
  profile[deceleration] = (top - w) / down;
  profile[acceleration_time] = up;
  profile[slew_time] = slew;
  profile[deceleration_time] = down;
  profile[total_time] = up + slew + down;
  return profile;
}

bool suffices(Set set, Assumption assumption, const Given& ends) {
  return Derivation(only(set, ordinary(assumption, ends)), assumption).complete();
}

/// The smallest sets that make it enough.
std::vector<Set> completions(Set known, Assumption assumption, const Given& ends) {
  std::vector<Set> smallest;
  for (const auto more : subsets(main_quantities & ~known)) {
    if (!smallest.empty() && std::popcount(more) > std::popcount(smallest.front())) break;
    if (suffices(known | more, assumption, ends)) smallest.push_back(more);
  }
  return smallest;
}

bool is_possible(Quantity quantity, double value) {
  const bool may_be_nothing =
      (bit(quantity) & (end_speeds | bit(slew_time) | bit(slew_distance))) != no_quantity;
  return std::isfinite(value) && (may_be_nothing ? value >= 0 : value > 0);
}

/// What a solve was asked.
struct Question {
  Given given;
  Assumption assumption;

  SolveError error(Kind kind, Set culprits) const {
    SolveError made;
    made.kind = kind;
    made.assumption = assumption;
    made.known = given;
    made.culprits = members(culprits);
    return made;
  }
};

Set invalid_values(const Given& given) {
  Set invalid = no_quantity;
  for (const auto quantity : members(with_ends(given)))
    invalid |= is_possible(quantity, *given[quantity]) ? no_quantity : bit(quantity);
  return invalid;
}

SolveError insufficient(const Question& question) {
  auto error = question.error(Kind::insufficient, no_quantity);
  const auto smallest = completions(set_of(question.given), question.assumption, question.given);
  error.missing = static_cast<std::size_t>(std::popcount(smallest.front()));
  Set candidates = smallest.front();
  if (error.missing == 1) {
    for (const auto set : smallest) candidates |= set;
  }
  error.candidates = members(candidates);
  for (const auto assumption : assumptions) {
    if (assumption > question.assumption && solve(question.given, assumption))
      error.sufficient_assumptions.push_back(assumption);
  }
  return error;
}

// A quantity that is not what it should be: where it begins to be possible.
class Boundary {
 public:
  Boundary(Given given, Quantity quantity, Assumption assumption)
      : given_(std::move(given)), quantity_(quantity), assumption_(assumption) {}

  std::optional<Bound> find() {
    const double here = *given_[quantity_];
    for (double factor = 2; factor < farthest; factor *= 2) {
      if (possible(here * factor)) return between(here, here * factor);
      if (possible(here / factor)) return between(here, here / factor);
    }
    return std::nullopt;
  }

 private:
  static constexpr double farthest = 1e12;
  static constexpr int halvings = 64;

  bool possible(double value) {
    given_[quantity_] = value;
    return is_possible(quantity_, value) && !Derivation(given_, assumption_).impossible();
  }

  Bound between(double bad, double good) {
    for (int i = 0; i < halvings; ++i) {
      const double middle = bad + (good - bad) / 2;
      (possible(middle) ? good : bad) = middle;
    }
    Bound bound{quantity_, good >= bad, true, 0};
    bound.value = rounded(good, bound.at_least);
    bound.inclusive = possible(bound.value);
    return bound;
  }

  // To six digits; but what lies next to such a number is this number.
  static double rounded(double value, bool up) {
    constexpr double noise = 1e-5;
    const double digit = std::pow(10, std::floor(std::log10(value)) - 5);
    const double count = up ? std::ceil(value / digit - noise) : std::floor(value / digit + noise);
    // A division by a power of ten is exact more often than a product with its inverse.
    return digit < 1 ? count / std::round(1 / digit) : count * digit;
  }

  Given given_;
  Quantity quantity_;
  Assumption assumption_;
};

SolveError impossible(const Question& question, Set culprits, const Derivation& derivation) {
  auto error = question.error(Kind::impossible, culprits);
  error.quantity = derivation.impossible();
  error.implied = derivation.impossible_value();
  for (const auto quantity : error.culprits) {
    if (*question.given[quantity] == 0) continue;
    Boundary boundary(only(culprits, question.given), quantity, question.assumption);
    if (const auto bound = boundary.find()) error.bounds.push_back(*bound);
  }
  return error;
}

constexpr double no_difference_yet = std::numeric_limits<double>::infinity();

double difference(double a, double b) {
  return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

/// The quantity that comes out differently, but least so: the others need the least belief.
void compare(const Question& question, Set set, const Derivation& derivation, double& least,
             std::optional<SolveError>& error) {
  for (const auto quantity : members(set_of(question.given) & ~set)) {
    if (!derivation.known()[quantity]) continue;
    const double given = *question.given[quantity];
    const double implied = *derivation.known()[quantity];
    const double differs = difference(given, implied);
    if (differs <= solve_tolerance || differs >= least) continue;
    least = differs;
    error = question.error(Kind::contradiction, set);
    error->quantity = quantity;
    error->given = given;
    error->implied = implied;
  }
}

/// Values that cannot all be right: the fewest of them that show it.
SolveError conflict(const Question& question) {
  double least = no_difference_yet;
  std::optional<SolveError> contradiction;
  const auto sets = subsets(set_of(question.given));
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const bool larger = i > 0 && std::popcount(sets[i]) > std::popcount(sets[i - 1]);
    if (larger && contradiction) break;
    const Derivation derivation(only(sets[i], question.given), question.assumption);
    if (derivation.impossible()) return impossible(question, sets[i], derivation);
    compare(question, sets[i], derivation, least, contradiction);
  }
  return contradiction.value_or(question.error(Kind::contradiction, set_of(question.given)));
}

/// Whether everything that is known already agrees; what is not known cannot disagree.
bool agrees(const Question& question, const Derivation& derivation) {
  if (derivation.impossible()) return false;
  if (derivation.complete())
    return residual_of(derivation.known(), question.assumption) <= solve_tolerance;
  double least = no_difference_yet;
  std::optional<SolveError> error;
  for (const auto set : subsets(set_of(question.given))) {
    const Derivation part(only(set, question.given), question.assumption);
    if (part.impossible()) return false;
    compare(question, set, part, least, error);
  }
  return !error;
}

Profile profile_of(const Given& known) {
  const auto of = [&](Quantity quantity) { return *known[quantity]; };
  const double u = known[initial_speed].value_or(0);
  const double w = known[final_speed].value_or(0);
  return {of(distance),
          of(speed),
          of(acceleration),
          of(deceleration),
          of(acceleration_time),
          of(slew_time),
          of(deceleration_time),
          of(total_time),
          u,
          w,
          (u + of(speed)) / 2 * of(acceleration_time),
          of(speed) * of(slew_time),
          (of(speed) + w) / 2 * of(deceleration_time)};
}

// ---- What is said of an error

/// "a, b and c"
std::string enumerated(const std::vector<std::string>& items, std::string_view last_link) {
  if (items.size() < 2) return items.empty() ? "" : items.front();
  return fmt::format("{} {} {}", fmt::join(items.begin(), items.end() - 1, ", "), last_link,
                     items.back());
}

template <class T>
std::string names(const std::vector<T>& list, std::string_view last_link,
                  std::string_view quote = "") {
  std::vector<std::string> items;
  for (const auto item : list) items.push_back(fmt::format("{0}{1}{0}", quote, name_of(item)));
  return enumerated(items, last_link);
}

class Wording {
 public:
  Wording(const SolveError& error, std::string_view length_unit, std::string_view time_unit)
      : error_(error), length_unit_(length_unit), time_unit_(time_unit) {}

  std::string text() const {
    switch (error_.kind) {
      case Kind::invalid: return invalid();
      case Kind::insufficient: return insufficient();
      case Kind::contradiction: return contradiction();
      case Kind::impossible: return impossible();
    }
    return {};
  }

 private:
  std::string value(Quantity quantity, double number) const {
    return with_unit(quantity, number, length_unit_, time_unit_);
  }
  /// "speed 8 mm/s and acceleration 16 mm/s^2"
  std::string culprits() const {
    std::vector<std::string> items;
    for (const auto quantity : error_.culprits)
      items.push_back(
          fmt::format("{} {}", name_of(quantity), value(quantity, *error_.known[quantity])));
    for (const auto quantity : members(with_ends(error_.known) & end_speeds))
      items.push_back(
          fmt::format("{} {}", name_of(quantity), value(quantity, *error_.known[quantity])));
    if (error_.assumption != Assumption::none)
      items.push_back(fmt::format("the assumption '{}'", name_of(error_.assumption)));
    return enumerated(items, "and");
  }

  std::string invalid() const {
    const auto quantity = error_.culprits.front();
    return fmt::format("{} must be a finite number {}, not {}", name_of(quantity),
                       is_possible(quantity, 0) ? "of at least 0" : "above 0",
                       *error_.known[quantity]);
  }

  std::string insufficient() const {
    const auto known = members(set_of(error_.known));
    auto text = known.empty() ? std::string("nothing is given")
                              : fmt::format("{} {} not enough", names(known, "and"),
                                            known.size() == 1 ? "is" : "are");
    if (error_.assumption != Assumption::none)
      text += fmt::format(" with the assumption '{}'", name_of(error_.assumption));
    text += error_.missing == 1 ? fmt::format("; {} is missing", names(error_.candidates, "or"))
                                : fmt::format("; {} more are missing, such as {}", error_.missing,
                                              names(error_.candidates, "and"));
    if (!error_.sufficient_assumptions.empty())
      text +=
          fmt::format(", or the assumption {}", names(error_.sufficient_assumptions, "or", "'"));
    return text;
  }

  std::string contradiction() const {
    if (!error_.quantity) return fmt::format("{} contradict each other", culprits());
    const auto quantity = *error_.quantity;
    return fmt::format("{} make {} {}, and it is given as {}: {} too {}", culprits(),
                       name_of(quantity), precise(error_.implied), precise(error_.given),
                       value(quantity, std::abs(error_.given - error_.implied)),
                       error_.given > error_.implied ? "much" : "little");
  }
  /// With so many digits that the two differ.
  std::string precise(double number) const {
    const bool near = difference(error_.given, error_.implied) < 1e-4;
    const auto unit = value(*error_.quantity, 0).substr(1);
    return near ? plain_number(number, 13) + unit : value(*error_.quantity, number);
  }

  std::string impossible() const {
    auto text = fmt::format("{} are impossible together: ", culprits());
    text += std::isfinite(error_.implied)
                ? fmt::format("{} would be {}", name_of(*error_.quantity),
                              value(*error_.quantity, error_.implied))
                : fmt::format("there is no {} for them", name_of(*error_.quantity));
    std::vector<std::string> ways;
    for (const auto& bound : error_.bounds) {
      const char* relation = bound.at_least ? (bound.inclusive ? "at least" : "more than")
                                            : (bound.inclusive ? "at most" : "less than");
      ways.push_back(fmt::format("{} {} {}", name_of(bound.quantity), relation,
                                 value(bound.quantity, bound.value)));
    }
    if (!ways.empty()) text += "; possible with " + enumerated(ways, "or");
    return text;
  }

  const SolveError& error_;
  std::string_view length_unit_;
  std::string_view time_unit_;
};

}  // namespace

std::string_view name_of(Quantity quantity) {
  return quantity_names[static_cast<std::size_t>(quantity)];
}

std::optional<Quantity> quantity_named(std::string_view name) {
  const auto* found = std::ranges::find(quantity_names, name);
  if (found == quantity_names.end()) return std::nullopt;
  return static_cast<Quantity>(found - quantity_names.begin());
}

std::string_view name_of(Assumption assumption) {
  return assumption_names[static_cast<std::size_t>(assumption)];
}

std::optional<Assumption> assumption_named(std::string_view name) {
  const auto* found = std::ranges::find(assumption_names, name);
  if (found == assumption_names.end()) return std::nullopt;
  return assumptions[static_cast<std::size_t>(found - assumption_names.begin())];
}

double Profile::operator[](Quantity quantity) const {
  switch (quantity) {
    case Quantity::distance: return distance;
    case Quantity::speed: return speed;
    case Quantity::acceleration: return acceleration;
    case Quantity::deceleration: return deceleration;
    case Quantity::acceleration_time: return acceleration_time;
    case Quantity::slew_time: return slew_time;
    case Quantity::deceleration_time: return deceleration_time;
    case Quantity::total_time: return total_time;
    case Quantity::initial_speed: return initial_speed;
    case Quantity::final_speed: return final_speed;
    case Quantity::acceleration_distance: return acceleration_distance;
    case Quantity::slew_distance: return slew_distance;
    case Quantity::deceleration_distance: return deceleration_distance;
  }
  return 0;
}

double Profile::position_at(double time) const {
  if (time <= 0) return 0;
  if (time >= total_time) return distance;
  if (time < acceleration_time) return time * (initial_speed + acceleration * time / 2);
  const double left = total_time - time;
  if (left < deceleration_time) return distance - left * (final_speed + deceleration * left / 2);
  return speed * (time - acceleration_time) + (initial_speed + speed) / 2 * acceleration_time;
}

double Profile::speed_at(double time) const {
  if (time <= 0) return initial_speed;
  if (time >= total_time) return final_speed;
  return std::min({speed, initial_speed + acceleration * time,
                   final_speed + deceleration * (total_time - time)});
}

std::string with_unit(Quantity quantity, double value, std::string_view length_unit,
                      std::string_view time_unit) {
  const auto number = plain_number(value, 6);
  switch (quantity) {
    case distance:
    case acceleration_distance:
    case slew_distance:
    case deceleration_distance:
      return length_unit.empty() ? number : fmt::format("{} {}", number, length_unit);
    case speed:
    case initial_speed:
    case final_speed:
    case acceleration:
    case deceleration: {
      if (length_unit.empty() || time_unit.empty()) return number;
      const bool is_rate = quantity == acceleration || quantity == deceleration;
      return fmt::format("{} {}/{}{}", number, length_unit, time_unit, is_rate ? "^2" : "");
    }
    default: return time_unit.empty() ? number : fmt::format("{} {}", number, time_unit);
  }
}

std::string describe(const SolveError& error, std::string_view length_unit,
                     std::string_view time_unit) {
  return Wording(error, length_unit, time_unit).text();
}

bool is_sufficient(const std::vector<Quantity>& known, Assumption assumption) {
  Set set = no_quantity;
  for (const auto quantity : known) set |= bit(quantity);
  return suffices(set, assumption, {});
}

tl::expected<Profile, SolveError> solve(const Given& given, Assumption assumption) {
  const Question question{given, assumption};
  if (const auto invalid = invalid_values(given); invalid != no_quantity)
    return tl::unexpected(question.error(Kind::invalid, invalid));
  const Derivation derivation(given, assumption);
  if (!agrees(question, derivation)) return tl::unexpected(conflict(question));
  if (!derivation.complete()) return tl::unexpected(insufficient(question));
  return profile_of(derivation.known());
}

}  // namespace tmcl::plan
