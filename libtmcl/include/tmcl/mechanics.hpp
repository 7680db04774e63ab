/// What stands around a motor: the encoder that watches an axis, and where the axis must not go.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "tmcl/conversion.hpp"

namespace tmcl {

/// The most lines that an encoder can have.
constexpr std::int32_t max_encoder_lines = 1'000'000;

/// An encoder on the shaft of the motor.
struct ShaftEncoder {
  std::int32_t lines = 1000;  ///< Of a turn: 1..max_encoder_lines.
  bool quadrature = true;     ///< Every edge of both channels counts: four to a line.

  constexpr std::int32_t counts_per_revolution() const { return quadrature ? 4 * lines : lines; }
  bool operator==(const ShaftEncoder&) const = default;
};

/// How many counts one unit of the user is: counts of a turn, times gear ratio, by what a turn of
/// the output is. 1000 lines behind a gear of 3:1 and a pitch of 10 mm are 1200 a mm. A linear
/// encoder says this number itself, and its counts are not multiplied.
double counts_per_unit(const ShaftEncoder& encoder, const UserScale& scale);

/// The same axis counted by its encoder: what the conversions take for microsteps are its counts
/// then. `counts_per_unit` greater than 0.
UserScale encoder_scale(double counts_per_unit, const UserScale& scale);

/// Whether a parameter holds what the encoder of the axis reads: encoder_position, and the one that
/// its null channel latches. Modules bring those to microsteps if their encoder_prescaler or
/// encoder_resolution is set so; otherwise they are counts.
bool is_encoder_position(const ParameterInfo& row);

/// The parameter that tells whether an axis turns by velocity, and its value then; nothing for
/// models that do not tell.
struct ModeParameter {
  std::uint8_t number = 0;
  std::int32_t velocity = 0;
};
std::optional<ModeParameter> mode_parameter(std::span<const ParameterInfo> table);

/// Where an axis may go, both ends included.
struct SoftLimits {
  UserPosition least;
  UserPosition greatest;  ///< Greater than `least`.
  bool operator==(const SoftLimits&) const = default;
};

/// The limits in microsteps, each rounded as a move to it is, so that it can be reached, and
/// clipped to what a module can hold.
ValueRange microsteps_within(const SoftLimits& limits, const UserScale& scale);

/// A position that an axis must not take.
struct BeyondLimit {
  double position = 0;  ///< In `unit`, as `limit`.
  double limit = 0;
  std::string unit;
};
/// "120 mm is beyond the soft limit of 100 mm"
std::string describe(const BeyondLimit& error);

/// Nothing for a position within the limits.
std::optional<BeyondLimit> beyond(const SoftLimits& limits, Microsteps position,
                                  const UserScale& scale);

}  // namespace tmcl
