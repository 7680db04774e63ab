#include "config/draft.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::size_t max_name_length = 32;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A name that starts with a letter and has no '/' can never be taken for ADDRESS/MOTOR.
bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= max_name_length && is_letter(text.front()) &&
         std::ranges::all_of(text, [](char c) {
           return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.';
         });
}

}  // namespace

Draft::Draft(ConfigText& text) : problems_(text.problems) {
  for (const auto& bus : text.buses) {
    if (bus.name) declared_buses_.push_back(*bus.name);
    has_nameless_bus_ = has_nameless_bus_ || !bus.name;
  }
}

bool Draft::has_usable_name(const Said<std::string>& name) {
  if (!name || is_name(*name)) return name.has_value();
  complain(name,
           "the name " + quoted(*name) +
               " must start with a letter and have at most 32 letters, digits, '_', '-', '.'");
  return false;
}

void Draft::complain_of_second(const Said<std::string>& name, std::string_view title) {
  complain(name, fmt::format("the name {} is given twice in {}", quoted(*name), title));
}

BusConfig* Draft::find_bus(const Said<std::string>& name, std::string_view about) {
  if (!name) return nullptr;
  const auto found = std::ranges::find(config.buses, *name, &BusConfig::name);
  if (found != config.buses.end()) return &*found;
  // A bus that was refused has been complained about already; its axes are innocent.
  if (has_nameless_bus_ || std::ranges::count(declared_buses_, *name) != 0) return nullptr;
  const std::vector<std::string_view> known(declared_buses_.begin(), declared_buses_.end());
  complain(name, fmt::format("{}there is no bus {}.{}", about, quoted(*name),
                             tmcl::did_you_mean(*name, known)));
  return nullptr;
}

void Draft::check_positive(const Said<double>& said, std::string_view advice) {
  if (*said > 0 && std::isfinite(*said)) return;
  complain(said, fmt::format("'{}' is {}, but must be greater than 0{}", said.key, *said, advice));
}

std::optional<std::size_t> Draft::choice(const Said<std::string>& said,
                                         std::span<const std::string_view> names) {
  if (!said) return std::nullopt;
  const auto found = std::ranges::find(names, *said);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  complain(said, fmt::format("'{}' is '{}', but must be {} or {}.{}", said.key, *said,
                             fmt::join(names.first(names.size() - 1), ", "), names.back(),
                             tmcl::did_you_mean(*said, names)));
  return std::nullopt;
}

}  // namespace tmcld
