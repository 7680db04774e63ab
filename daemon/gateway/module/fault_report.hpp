/// What the module of an axis says of itself when it is asked what is wrong.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

/// By name, such as short_to_ground_a: see tmcl/status_flags.hpp. A supply that is too low for any
/// driver is undervoltage.
using Faults = std::vector<std::string_view>;

struct FaultReport {
  Faults flags{};
  std::vector<std::string_view> switches{};  ///< Those that are closed: left, right, home.
  std::optional<double> supply_volts{};      ///< Nothing where it does not tell.
  std::optional<double> temperature_celsius{};

  bool has_flag(std::string_view flag) const;
  /// Those that are of the driver or the supply.
  Faults driver_faults() const;
  bool has_switch(std::string_view name) const;
};

/// All that may be among the faults of a driver.
std::vector<std::string_view> driver_flags();
/// "short circuit to ground of coil A, undervoltage"
std::string words_for(const Faults& faults);
/// They are worth a stop or a look: the driver is off, or has no current in a coil. Others only say
/// that this is near.
bool keeps_from_moving(const Faults& faults);
/// An open load of a coil.
bool is_open_load(std::string_view fault);

struct DriverReading {
  Faults faults{};
  bool turns_slowly = false;             ///< Looked at only where the driver reports an open load.
  std::optional<double> supply_volts{};  ///< Nothing where its module does not tell.
};

/// The drivers of these modules report an open load falsely at standstill, with little current and
/// in fast motion: "check during slow motion only" (data sheets of TMC2660, TMC2130, TMC5160). So
/// it is one when it was seen twice in a row in slow motion, until it is not there any more.
class OpenLoads {
 public:
  /// Takes those out that are not proven.
  Faults judge(DriverReading reading);
  const Faults& unproven() const { return unproven_; }

 private:
  std::map<std::string_view, int> seen_;  ///< In slow motion, in a row.
  Faults unproven_;
};

/// The value of a parameter, 0 where the module has none of this name.
/// Errors: those of the exchange, but not a refusal.
tmcl::Script<tmcl::Result<std::int32_t>> read_if_any(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters, std::string_view name);

/// What keeps the driver of the axis from moving its motor, or soon will. Clears nothing. `units`:
/// what its velocities are counted in, nothing if that is not known. `velocity`: where it has just
/// been read.
/// Errors: those of the exchanges, but not refusals.
tmcl::Script<tmcl::Result<DriverReading>> read_driver(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters,
    std::optional<tmcl::ModuleUnits> units, std::optional<tmcl::InternalVelocity> velocity = {});
/// Of its module, in degrees Celsius; nothing where it does not tell. Errors: the same.
tmcl::Script<tmcl::Result<std::optional<double>>> read_temperature(tmcl::ModuleAddress module);
/// Whether it turns slowly enough, and not too slowly, for an open load to be told. Parameters and
/// errors: the same.
tmcl::Script<tmcl::Result<bool>> turns_slowly(tmcl::AxisAddress axis,
                                              std::span<const tmcl::ParameterInfo> parameters,
                                              std::optional<tmcl::ModuleUnits> units,
                                              std::optional<tmcl::InternalVelocity> velocity = {});

/// Reading clears the flags stall and deviation.
/// Errors: those of the exchanges, but not refusals.
tmcl::Script<tmcl::Result<FaultReport>> read_faults(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

}  // namespace tmcld
