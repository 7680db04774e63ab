/// A module held against what is known of its model: a course of small moves, and some questions,
/// that tell which of the known variants of each trait it has.
///
/// Sets nothing that a motor could suffer from: speeds, accelerations and dividers only, for slow
/// movements within the travel, and one value out of range that a module without a check cuts to
/// what it had. The axis ends where it began, and everything that was set is as it was, whatever
/// failed; but if something fails, the axis stands where it was stopped.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/script.hpp"
#include "tmcl/version.hpp"

namespace tmcl {

/// What a module was found to do, or why that was not found out.
struct TraitFinding {
  Trait trait{};
  std::uint8_t expected = 0;  ///< The variant that its twin has.
  bool measured = false;
  std::vector<std::uint8_t> fits{};  ///< Which variants do: none, if it is like no known one.
  std::string text{};                ///< What was seen, or why it was not measured.

  /// The one variant that it is.
  std::optional<std::uint8_t> found() const {
    return measured && fits.size() == 1 ? std::optional(fits.front()) : std::nullopt;
  }
};

/// A movement of the course, and what its twin had foreseen.
struct VerifiedMove {
  std::int32_t distance = 0;
  std::string settings;  ///< In words of a ramp generator.
  Duration foreseen{};
  Duration least{};  ///< It took longer than this ...
  Duration most{};   ///< ... and no longer than this.
};

struct Verification {
  const Model* model = nullptr;
  FirmwareVersion version{};
  std::optional<Duration> answer{};    ///< The quickest.
  std::vector<TraitFinding> traits{};  ///< Those that concern the model, in their order.
  std::vector<VerifiedMove> moves{};

  ModuleTraits found() const;
};

struct VerifyOptions {
  const Model* model = nullptr;  ///< Of the module.
  ModuleTraits expected{};       ///< Of its twin.
  /// What the settings are that the course changes: verify_parameters(), read just before. They are
  /// given back.
  std::vector<plan::Setting> settings{};
  /// Where the axis may go, in microsteps.
  ValueRange travel{};
  /// What it must not exceed.
  std::optional<PulsesPerSecond> greatest_velocity{};
  std::optional<PulsesPerSecond2> greatest_acceleration{};
  /// What the wire takes of an exchange.
  Duration wire_time{};
  /// No module has this address; nothing on CAN, and where that is not known.
  std::optional<ModuleAddress> free_address{};
  /// How many replies have come on this link that answered nothing.
  std::function<std::uint64_t()> strays{};
  /// Told what is done next.
  std::function<void(const std::string& what)> tell{};
};

/// Which settings a course changes.
std::vector<std::uint8_t> verify_parameters(const Model& model);

namespace verbs {

/// The axis stands, and no other client moves it, or sets anything in its module.
/// Errors: Errc::bad_argument if it moves; Errc::move_interrupted if it does not arrive where it is
/// sent to; those of the exchanges, which are with Outcome::unknown if something was set that could
/// not be given back.
Script<Result<Verification>> verify(AxisAddress axis, VerifyOptions options);

}  // namespace verbs

/// As a file: for tmclsim --as and for `as` of a [[module]], and for people. `of`: which axis it
/// was.
std::string report_of(const Verification& verification, std::string_view of);

}  // namespace tmcl
