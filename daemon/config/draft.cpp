#include "config/draft.hpp"

#include <cmath>
#include <optional>
#include <variant>

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

LinkScope scope_of(const tmcl::LinkName& link) {
  if (std::holds_alternative<tmcl::CanName>(link)) return LinkScope::can;
  if (std::holds_alternative<tmcl::TcpName>(link)) return LinkScope::tcp;
  return LinkScope::serial_framing;
}

Draft::Draft(std::span<const ConfigSection> sections, tmcl::TextProblems& problems)
    : problems_(problems) {
  for (const auto& section : sections) {
    if (section.kind != SectionKind::bus) continue;
    const auto* name = section.get<std::string>("name");
    if (name != nullptr) declared_buses_.push_back(*name);
    has_nameless_bus_ = has_nameless_bus_ || name == nullptr;
  }
}

const std::string* Draft::usable_name(const ConfigSection& section) {
  const auto* name = section.get<std::string>("name");
  if (name == nullptr || is_name(*name)) return name;
  complain(section.place_of("name"),
           "the name " + quoted(*name) +
               " must start with a letter and have at most 32 letters, digits, '_', '-', '.'");
  return nullptr;
}

void Draft::complain_of_second(const ConfigSection& section, const std::string& name) {
  complain(section.place_of("name"), "the name " + quoted(name) + " is given twice in " +
                                         std::string(title_of(section.kind)));
}

BusConfig* Draft::find_bus(const ConfigSection& section, const std::string& name) {
  const auto found = std::ranges::find(config.buses, name, &BusConfig::name);
  if (found != config.buses.end()) return &*found;
  // A bus that was refused has been complained about already; its axes are innocent.
  if (has_nameless_bus_ || std::ranges::count(declared_buses_, name) != 0) return nullptr;
  const std::vector<std::string_view> known(declared_buses_.begin(), declared_buses_.end());
  complain(section.place_of("bus"),
           "there is no bus " + quoted(name) + "." + tmcl::did_you_mean(name, known));
  return nullptr;
}

void Draft::set_positive(const ConfigSection& section, std::string_view key,
                         std::string_view advice, double& target) {
  const auto* value = section.get<double>(key);
  if (value == nullptr) return;
  target = *value;
  if (*value > 0 && std::isfinite(*value)) return;
  complain(section.place_of(key),
           fmt::format("'{}' is {}, but must be greater than 0{}", key, *value, advice));
}

std::optional<std::size_t> Draft::choice(const ConfigSection& section, std::string_view key,
                                         std::span<const std::string_view> names) {
  const auto* said = section.get<std::string>(key);
  if (said == nullptr) return std::nullopt;
  const auto found = std::ranges::find(names, *said);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  complain(section.place_of(key), fmt::format("'{}' is '{}', but must be {} or {}.{}", key, *said,
                                              fmt::join(names.first(names.size() - 1), ", "),
                                              names.back(), tmcl::did_you_mean(*said, names)));
  return std::nullopt;
}

}  // namespace tmcld
