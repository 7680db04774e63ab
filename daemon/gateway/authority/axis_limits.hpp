/// What the configuration says that an axis does not exceed: speed, acceleration, jerk and current.
///
/// Checked just before a request of any client goes out: a command, a parameter, a line or
/// a path. No setting is written that would be beyond a limit, also where that comes from another
/// one that scales it; and nothing moves the axis while one of its settings is beyond, as its
/// EEPROM may have it. What a program in the module does is not seen here.
///
/// The settings are read once, and known until something else than these requests may have changed
/// them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "gateway/module/module.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

class AxisLimits {
 public:
  /// The module must outlive it.
  AxisLimits(const AxisConfig& config, GatewayModule& module) : config_(config), module_(module) {}

  /// Errors: Errc::not_permitted; those of reading the settings, with Outcome::not_sent.
  tmcl::Script<tmcl::Result<void>> check(tmcl::Request request);
  /// check() would have to read settings first.
  bool must_read(const tmcl::Request& request) const;
  /// What check() says by the settings that are known.
  std::optional<tmcl::Error> objection(const tmcl::Request& request) const;
  /// What the limits are in the module's own unit; nothing where there is none.
  struct Greatest {
    std::optional<std::int32_t> velocity{};
    std::optional<std::int32_t> acceleration{};  ///< And deceleration: the smaller one.
  };
  /// Of an axis that may move now: errors as of check().
  tmcl::Script<tmcl::Result<Greatest>> greatest();
  /// It went out, and this came of it.
  void note(const tmcl::Request& request, const tmcl::Result<tmcl::Answer>& answer);

 private:
  enum class Kind : std::uint8_t { velocity, acceleration, deceleration, jerk, current };
  struct Limited {
    const tmcl::ParameterInfo* row;
    Kind kind;
  };
  using Values = std::map<std::uint8_t, std::int32_t>;  ///< By the number of the parameter.

  bool is_of_axis(const tmcl::Request& request) const;
  bool matters(const tmcl::Request& request) const;
  bool is_limited(std::uint8_t parameter) const;
  bool is_scale(std::uint8_t parameter) const;
  std::vector<Limited> limited() const;
  std::vector<Kind> limited_kinds(const tmcl::ParameterInfo& row) const;
  std::vector<std::uint8_t> scales() const;

  tmcl::Script<tmcl::Result<void>> read();
  std::optional<tmcl::Error> objection_to_write(std::uint8_t parameter, std::int32_t value) const;
  std::optional<tmcl::Error> objection_to_turn(std::int32_t velocity) const;
  std::optional<tmcl::Error> objection_to_settings() const;

  tmcl::UserScale scale_with(const Values& values) const;
  /// One of the module's numbers is so much of what the limit is in; not of a jerk.
  double unit_of(Kind kind, const Values& values) const;
  /// What the module's number is, in what the limit is in.
  double amount_of(Kind kind, std::int32_t value, const Values& values) const;
  /// The greatest of the module's numbers that is within.
  double greatest(Kind kind, const Values& values) const;
  bool exceeds(Kind kind, std::int32_t value, const Values& values) const;
  double limit(Kind kind) const;
  std::string in_words(Kind kind, double value) const;
  tmcl::Error beyond(Kind kind, const std::string& what, std::int32_t value,
                     const Values& values) const;
  tmcl::Error error(std::string what, std::string hint) const;

  AxisConfig config_;
  GatewayModule& module_;
  Values values_;            ///< Empty: not known.
  std::uint64_t epoch_ = 0;  ///< Of the module's settings, when they were read.
};

}  // namespace tmcld
