#include "profile/known_values.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "command_line/form.hpp"
#include "tmcl/spelling.hpp"

namespace tmclctl::profile {
namespace {

using tmcl::plan::Assumption;
using tmcl::plan::Quantity;

struct NamedUnit {
  std::string_view name;
  double size;
  int kind = 0;
};

// Lengths of one kind can be converted.
constexpr int linear = 1;
constexpr int angular = 2;
constexpr std::array length_units{
    NamedUnit{"mm", 1e-3, linear},       NamedUnit{"um", 1e-6, linear},
    NamedUnit{"\u00b5m", 1e-6, linear},  NamedUnit{"cm", 1e-2, linear},
    NamedUnit{"m", 1, linear},           NamedUnit{"in", 0.0254, linear},
    NamedUnit{"deg", 1. / 360, angular}, NamedUnit{"rad", 1 / (2 * std::numbers::pi), angular},
    NamedUnit{"rev", 1, angular}};
constexpr std::array time_units{NamedUnit{"s", 1}, NamedUnit{"ms", 1e-3}, NamedUnit{"us", 1e-6},
                                NamedUnit{"\u00b5s", 1e-6}, NamedUnit{"min", 60}};

template <std::size_t N>
const NamedUnit* find(const std::array<NamedUnit, N>& units, std::string_view name) {
  const auto* found = std::ranges::find(units, name, &NamedUnit::name);
  return found == units.end() ? nullptr : found;
}

Error bad_value(const std::string& word, const std::string& problem) {
  return usage_error("bad_value", fmt::format("{}: {}", word, problem),
                     "'tmclctl profile solve --help' has examples");
}

/// How often a quantity is divided by a time; lengths are in all but the times.
int times_below(Quantity quantity) {
  using enum Quantity;
  switch (quantity) {
    case speed:
    case initial_speed:
    case final_speed: return 1;
    case acceleration:
    case deceleration: return 2;
    default: return 0;
  }
}
bool is_time(Quantity quantity) {
  return quantity >= Quantity::acceleration_time && quantity <= Quantity::total_time;
}

/// "mm/s2", "mm/s^2" and "mm/s/s" are a length and, below it, times.
struct UnitParts {
  std::string_view length;
  std::vector<std::string_view> below;
};

UnitParts unit_parts(std::string_view unit) {
  UnitParts parts;
  for (bool first = true; !unit.empty() || first; first = false) {
    const auto slash = std::min(unit.find('/'), unit.size());
    auto part = unit.substr(0, slash);
    unit.remove_prefix(std::min(slash + 1, unit.size()));
    if (first) {
      parts.length = part;
      continue;
    }
    const bool squared = part.ends_with('2');
    if (squared) part.remove_suffix(part.ends_with("^2") ? 2 : 1);
    parts.below.push_back(part);
    if (squared) parts.below.push_back(part);
  }
  return parts;
}

class ValueReader {
 public:
  Result<KnownValues> read(const std::vector<std::string>& words) {
    for (const auto& word : words) {
      if (auto taken = take(word); !taken) return tl::unexpected(taken.error());
    }
    return known_;
  }

 private:
  Result<void> take(const std::string& word) {
    const auto equals = word.find('=');
    return equals == std::string::npos ? take_assumption(word) : take_value(word, equals);
  }

  Result<void> take_assumption(const std::string& word) {
    const auto assumption = tmcl::plan::assumption_named(word);
    if (!assumption) {
      static constexpr std::string_view names[] = {"symmetric", "thirds"};
      return tl::unexpected(usage_error(
          "bad_value", fmt::format("'{}' is neither QUANTITY=VALUE nor an assumption", word),
          "The assumptions are symmetric and thirds." + tmcl::did_you_mean(word, names)));
    }
    // Thirds are symmetric, too.
    known_.assumption = std::max(known_.assumption, *assumption);
    return {};
  }

  Result<void> take_value(const std::string& word, std::size_t equals) {
    const auto name = std::string_view(word).substr(0, equals);
    const auto quantity = tmcl::plan::quantity_named(name);
    if (!quantity) return tl::unexpected(unknown_quantity(name));
    if (known_.given[*quantity]) return tl::unexpected(bad_value(word, "it is given twice"));
    const auto text = std::string_view(word).substr(equals + 1);
    const auto unit_begin = std::min(end_of_number(text), text.size());
    const auto number = parse_number<double>(unit_begin == 0 ? text : text.substr(0, unit_begin));
    if (!number) return tl::unexpected(bad_value(word, number.error()));
    const auto factor = factor_of(text.substr(unit_begin), *quantity);
    if (!factor) return tl::unexpected(bad_value(word, factor.error()));
    known_.given[*quantity] = *number * *factor;
    return {};
  }

  static Error unknown_quantity(std::string_view name) {
    std::vector<std::string_view> names;
    for (const auto quantity : tmcl::plan::quantities) names.push_back(name_of(quantity));
    for (const auto quantity : tmcl::plan::side_quantities) names.push_back(name_of(quantity));
    return usage_error(
        "bad_value", fmt::format("there is no quantity '{}'", name),
        fmt::format("They are {}.{}", fmt::join(names, ", "), tmcl::did_you_mean(name, names)));
  }

  // An e belongs to the number only if digits follow.
  static std::size_t end_of_number(std::string_view text) {
    const auto end = text.find_first_not_of("0123456789.+-");
    if (end == std::string_view::npos || (text[end] != 'e' && text[end] != 'E')) return end;
    const auto digits = text.find_first_not_of("+-", end + 1);
    const bool exponent = digits != std::string_view::npos && digits <= end + 2 &&
                          text[digits] >= '0' && text[digits] <= '9';
    return exponent ? text.find_first_not_of("0123456789", digits) : end;
  }

  tl::expected<double, std::string> factor_of(std::string_view unit, Quantity quantity) {
    if (unit.empty()) return 1;
    return is_time(quantity) ? time_factor(unit, quantity) : length_factor(unit, quantity);
  }

  static tl::expected<double, std::string> time_factor(std::string_view unit, Quantity quantity) {
    const auto* time = find(time_units, unit);
    if (time != nullptr) return time->size;
    return tl::unexpected(
        fmt::format("{} is a time; '{}' is none of s, ms, us and min", name_of(quantity), unit));
  }

  tl::expected<double, std::string> length_factor(std::string_view unit, Quantity quantity) {
    const auto parts = unit_parts(unit);
    const auto below = static_cast<std::size_t>(times_below(quantity));
    static constexpr std::string_view examples[] = {"mm", "mm/s", "mm/s^2"};
    if (parts.below.size() != below || parts.length.empty() || find(time_units, parts.length) ||
        std::ranges::any_of(parts.below,
                            [](auto name) { return find(time_units, name) == nullptr; })) {
      return tl::unexpected(fmt::format("{} has a unit such as {}, not '{}'", name_of(quantity),
                                        examples[below], unit));
    }
    auto factor = to_first_length(parts.length);
    if (!factor) return factor;
    for (const auto name : parts.below) *factor /= find(time_units, name)->size;
    return factor;
  }

  tl::expected<double, std::string> to_first_length(std::string_view unit) {
    if (known_.unit.empty()) known_.unit = unit;
    if (unit == known_.unit) return 1;
    const auto* from = find(length_units, unit);
    const auto* to = find(length_units, known_.unit);
    if (from != nullptr && to != nullptr && from->kind == to->kind) return from->size / to->size;
    return tl::unexpected(
        fmt::format("'{}' cannot be converted to '{}', which stands before it", unit, known_.unit));
  }

  KnownValues known_;
};

}  // namespace

Result<KnownValues> read_known_values(const std::vector<std::string>& words) {
  return ValueReader().read(words);
}

}  // namespace tmclctl::profile
