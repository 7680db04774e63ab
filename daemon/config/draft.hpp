/// A configuration while it is put together from the sections of its files.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "config/section.hpp"

namespace tmcld {

LinkScope scope_of(const tmcl::LinkName& link);

class Draft {
 public:
  /// What is wrong is appended to `problems`.
  Draft(std::span<const ConfigSection> sections, tmcl::TextProblems& problems);

  void complain(const Place& place, std::string message) {
    problems_.push_back(place.problem(std::move(message)));
  }
  /// The name of a section; null, and a complaint, if it is malformed or one of `taken` has it.
  template <class List>
  const std::string* new_name(const ConfigSection& section, const List& taken) {
    const auto* name = usable_name(section);
    if (name == nullptr || std::ranges::count(taken, *name, &List::value_type::name) == 0)
      return name;
    complain_of_second(section, *name);
    return nullptr;
  }
  /// Null, and a complaint unless it has been complained about already, if there is none.
  BusConfig* find_bus(const ConfigSection& section, const std::string& name);
  /// A number that must be greater than 0.
  void set_positive(const ConfigSection& section, std::string_view key, std::string_view advice,
                    double& target);
  /// One of the names of an enumeration, in its order.
  template <class Choice>
  void set_choice(const ConfigSection& section, std::string_view key,
                  std::span<const std::string_view> names, Choice& into) {
    if (const auto chosen = choice(section, key, names)) into = static_cast<Choice>(*chosen);
  }

  Config config;

 private:
  const std::string* usable_name(const ConfigSection& section);
  void complain_of_second(const ConfigSection& section, const std::string& name);
  std::optional<std::size_t> choice(const ConfigSection& section, std::string_view key,
                                    std::span<const std::string_view> names);

  tmcl::TextProblems& problems_;
  std::vector<std::string> declared_buses_;
  bool has_nameless_bus_ = false;
};

/// Sets `target` to the number of a key, milliseconds for a duration; leaves it if there is none.
template <class T>
void set(const ConfigSection& section, std::string_view key, T& target) {
  if (const auto* value = section.get<std::int64_t>(key)) target = static_cast<T>(*value);
}
inline void set(const ConfigSection& section, std::string_view key, tmcl::Duration& target) {
  if (const auto* value = section.get<std::int64_t>(key))
    target = std::chrono::milliseconds(*value);
}

}  // namespace tmcld
