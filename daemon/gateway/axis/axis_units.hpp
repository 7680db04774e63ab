/// What the numbers of an axis mean, read from its module once and known until its settings may
/// have changed.
///
/// Everything is a script: who runs it does the I/O. Where a script gives nothing, the module will
/// never tell: it refuses to, or its model is not known. Errors: those of the exchange, which may
/// succeed the next time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gateway/axis/axis_context.hpp"
#include "gateway/axis/settling.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/quantity.hpp"

namespace tmcld {

/// A position or a distance.
struct Length {
  tmcl::Microsteps microsteps;
  /// What it is exactly, where it was said in the axis' own unit.
  std::optional<tmcl::UserPosition> in_unit{};
};

/// The state in the unit that the configuration gives the axis.
struct UserReading {
  tmcl::UserPosition position;
  tmcl::UserPosition target;
  std::optional<tmcl::UserVelocity> velocity;  ///< Nothing where the model is not known.
  bool operator==(const UserReading&) const = default;
};

/// One look at an axis.
struct AxisReading {
  tmcl::AxisState state;
  std::optional<double> velocity_pps;  ///< Nothing where the model is not known.
  std::optional<UserReading> user;     ///< Nothing without a unit.
  tmcl::TimePoint taken{};             ///< When the look began: nothing in it is older.
  /// It may stand for a moment, and goes on to its target then.
  bool is_bound = false;
};

/// A parameter of an axis, as it was read.
struct ParameterSample {
  std::uint8_t parameter = 0;
  std::int32_t value = 0;
  std::optional<tmcl::Quantity>
      in_unit{};            ///< Nothing without a unit, and where none belongs to it.
  tmcl::TimePoint taken{};  ///< When reading it began.
};

/// Whether the settings of a ramp are read where they are not known.
enum class RampKnowledge : std::uint8_t { as_it_is, read };

class AxisUnits {
 public:
  template <class T>
  using Script = tmcl::Script<tmcl::Result<T>>;
  /// Of the settings: changes whenever they may have been changed, also while they are read.
  struct Epoch {
    std::uint64_t settings;
    std::uint64_t changes;
    bool operator==(const Epoch&) const = default;
  };

  explicit AxisUnits(const AxisContext& axis) : axis_(axis) {}

  /// What its module counts in.
  Script<std::optional<tmcl::ModuleUnits>> module_units();
  /// As the configuration has it, with the microsteps of the module unless the configuration gives
  /// them. `unit` is empty if it has none.
  Script<std::optional<tmcl::UserScale>> scale();
  /// The scale that soft limits and distances in the unit need; microsteps without a unit.
  /// Errors: Errc::bad_argument where it cannot be known.
  Script<tmcl::UserScale> known_scale();
  /// The twin of the axis as it is now; `proof`: of its position.
  Script<std::optional<tmcl::plan::AxisTwin>> twin(tmcl::Proof proof = tmcl::Proof::none);
  /// Warnings about moves with its settings: what its twin finds. Nothing where its
  /// ramps are not described, and where they are not known and must not be read.
  Script<std::vector<std::string>> warnings(RampKnowledge from = RampKnowledge::read);
  /// The warnings of a twin, by the names of parameters and in what is known of its units.
  std::vector<std::string> warnings_of(const tmcl::plan::AxisTwin& twin) const;
  /// The settings of its ramp, as twin() or warnings() has found them.
  std::vector<tmcl::plan::Setting> ramp_settings() const {
    return ramp_ ? ramp_->value : std::vector<tmcl::plan::Setting>{};
  }
  /// `bound_for`: where it goes on to, whatever its module has as its target.
  Script<AxisReading> reading(std::optional<tmcl::Microsteps> bound_for = {});
  /// What its encoder is to read when it stands there, by `in_position` of the configuration.
  /// Nothing where its module has no encoder. Errors: Errc::bad_argument where its scale cannot be
  /// known.
  Script<std::optional<EncoderWindow>> encoder_window(tmcl::Microsteps there, double width);
  Script<ParameterSample> sample(std::uint8_t parameter);

  /// This parameter may have been set: said before and after it is. `held`: its module says that
  /// it has this value now, so that what was known of its ramp before stays known.
  void note_set(std::uint8_t parameter, std::optional<std::int32_t> held = {});
  /// Of what scale() and module_units() depend on.
  Epoch epoch() const { return {axis_.module().settings_epoch(), unit_changes_}; }

 private:
  template <class T>
  struct Known {
    Epoch epoch;
    T value;
  };
  Epoch ramp_epoch() const { return {axis_.module().settings_epoch(), changes_}; }
  /// Reads the settings of its ramp, if they are not known. False where the module has none.
  Script<bool> know_ramp(const tmcl::Model& model);
  void hold_in_ramp(tmcl::plan::Setting setting);

  const AxisContext& axis_;
  std::uint64_t unit_changes_ = 0;
  std::uint64_t changes_ = 0;
  std::optional<Known<tmcl::ModuleUnits>> module_units_;
  std::optional<Known<std::int32_t>> microstep_resolution_;
  std::optional<Known<std::vector<tmcl::plan::Setting>>> ramp_;
  /// What was written last: a module may read back less than that.
  std::optional<Known<tmcl::plan::Setting>> written_;
};

}  // namespace tmcld
