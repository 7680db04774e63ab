/// What the command line of a verb is made of. Behind it is CLI11, which is slow to compile: only
/// grammar.cpp and options.cpp include it.
#pragma once

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <tl/expected.hpp>

#include "tmcl/hex.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tmclctl {

constexpr std::uint16_t greatest_address = 2047;
constexpr double shortest_time_s = 0.001;
constexpr double longest_time_s = 1e6;
/// Of the word AXIS.
constexpr const char* axis_meaning = "A configured name, or [BUS:]ADDRESS/MOTOR";
/// And MODULE.
constexpr const char* module_meaning = "Its address, or BUS:ADDRESS where tmcld has several buses";

/// Takes what was typed; otherwise a sentence on what is wrong with it.
using Reading = tl::expected<void, std::string>;
using Read = std::function<Reading(const std::string& text)>;

/// All of it: 010 is ten, and no decimal number wraps around. Whole ones may be hexadecimal.
template <class Number>
tl::expected<Number, std::string> parse_number(
    std::string_view text, Number least = std::numeric_limits<Number>::lowest(),
    Number greatest = std::numeric_limits<Number>::max()) {
  auto digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  Number value{};
  std::string decimal;
  if constexpr (std::is_integral_v<Number>) {
    if (const auto hexadecimal = tmcl::parse_hexadecimal(digits))
      digits = decimal = std::to_string(*hexadecimal);
  }
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = end == digits.data() + digits.size() && error != std::errc::invalid_argument;
  if (!whole) {
    return tl::unexpected(
        fmt::format("'{}' is no {}number", text, std::is_integral_v<Number> ? "whole " : ""));
  }
  if constexpr (std::is_floating_point_v<Number>) {
    if (!std::isfinite(value)) return tl::unexpected(fmt::format("'{}' is not finite", text));
  }
  if (error != std::errc{} || !(value >= least && value <= greatest)) {
    return tl::unexpected(fmt::format("{} is not within {} to {}", text, least, greatest));
  }
  return value;
}

/// Reads a number into `into`, which must live as long as the form.
template <class Number>
Read number(Number& into,
            std::type_identity_t<Number> least = std::numeric_limits<Number>::lowest(),
            std::type_identity_t<Number> greatest = std::numeric_limits<Number>::max()) {
  return [&into, least, greatest](const std::string& text) {
    return parse_number<Number>(text, least, greatest).map([&](Number value) { into = value; });
  };
}
template <class Number>
Read number(std::optional<Number>& into,
            std::type_identity_t<Number> least = std::numeric_limits<Number>::lowest(),
            std::type_identity_t<Number> greatest = std::numeric_limits<Number>::max()) {
  return [&into, least, greatest](const std::string& text) {
    return parse_number<Number>(text, least, greatest).map([&](Number value) { into = value; });
  };
}
/// Each time one more.
template <class Number>
Read numbers(std::vector<Number>& into, std::type_identity_t<Number> least,
             std::type_identity_t<Number> greatest) {
  return [&into, least, greatest](const std::string& text) {
    return parse_number<Number>(text, least, greatest).map([&](Number value) {
      into.push_back(value);
    });
  };
}
Read text(std::string& into);
/// Each time one more.
Read texts(std::vector<std::string>& into);
/// With commas between them.
Read list(std::vector<std::string>& into);
/// Each time one more: NAME=AXIS.
Read named_axes(std::vector<std::string>& into);
/// "200ms", "0.2s" or "0.2".
Reading read_time(const std::string& text, double least_s, double greatest_s, double& seconds);
/// In Hz, with or without that.
Read resonance(std::optional<double>& hertz);
/// How often something is shown: 10 ms to a minute.
Read milliseconds(std::chrono::milliseconds& into);
/// The name of a drawing, which is SVG: that of another kind of picture is refused.
Read svg_file(std::string& into);

/// Of one verb, or of a group of verbs.
class Form {
 public:
  explicit Form(CLI::App& app) : app_(&app) {}
  CLI::App& app() const { return *app_; }

  /// A word that must be there, at its place.
  void word(const std::string& name, const std::string& description, const Read& read);
  void optional_word(const std::string& name, const std::string& description, const Read& read);
  /// Any number of words, after all others.
  void words(const std::string& name, const std::string& description, const Read& read);
  /// The word MODULE.
  void module(std::string& into);
  /// The word AXIS.
  void axis(std::string& into);
  /// `value` is what stands for its value in the help.
  void option(const std::string& name, const std::string& value, const std::string& description,
              const Read& read);
  void required_option(const std::string& name, const std::string& value,
                       const std::string& description, const Read& read);
  /// May be given many times; each time is read.
  void repeated_option(const std::string& name, const std::string& value,
                       const std::string& description, const Read& read);
  void flag(const std::string& name, const std::string& description, bool& into);
  /// The flag --internal.
  void internal(bool& into);

 private:
  CLI::App* app_;
};

}  // namespace tmclctl
