/// A configuration while it is put together from the sections of its files.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "config/sections.hpp"

namespace tmcld {

inline bool is_can(const tmcl::LinkName& link) {
  return std::holds_alternative<tmcl::CanName>(link);
}

class Draft {
 public:
  /// What is wrong is appended to the problems of the text.
  explicit Draft(ConfigText& text);

  void complain(const Place& place, std::string message) {
    problems_.push_back(place.problem(std::move(message)));
  }
  void complain(const Given& key, std::string message) { complain(key.place, std::move(message)); }
  /// Of a section. False, and a complaint, if its name is malformed or one of `taken` has it.
  template <class S, class List>
  bool has_new_name(const S& section, const List& taken) {
    if (!has_usable_name(section.name)) return false;
    if (std::ranges::count(taken, *section.name, &List::value_type::name) == 0) return true;
    complain_of_second(section.name, S::title);
    return false;
  }
  /// Null if none is named, or if there is none: then with a complaint, unless there was one.
  /// `about` begins the complaint.
  BusConfig* find_bus(const Said<std::string>& name, std::string_view about = {});
  /// A number that must be greater than 0.
  template <class Target>
  void set_positive(const Said<double>& said, Target& target, std::string_view advice = {}) {
    if (!said) return;
    target = *said;
    check_positive(said, advice);
  }
  /// One of the names of an enumeration, in its order.
  template <class Choice>
  void set_choice(const Said<std::string>& said, std::span<const std::string_view> names,
                  Choice& into) {
    if (const auto chosen = choice(said, names)) into = static_cast<Choice>(*chosen);
  }

  Config config;

 private:
  bool has_usable_name(const Said<std::string>& name);
  void complain_of_second(const Said<std::string>& name, std::string_view title);
  void check_positive(const Said<double>& said, std::string_view advice);
  std::optional<std::size_t> choice(const Said<std::string>& said,
                                    std::span<const std::string_view> names);

  tmcl::TextProblems& problems_;
  std::vector<std::string> declared_buses_;
  bool has_nameless_bus_ = false;
};

/// Leaves `target` if nothing was said.
template <class T, class Target>
void set(const Said<T>& said, Target& target) {
  if (said) target = *said;
}

}  // namespace tmcld
