/// The method that finds what an axis bears: see tmcl/tuning.hpp.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::axis {

struct TunedSetting {
  TMCL_STRUCT(TunedSetting);
  TMCL_FIELD(std::int32_t, parameter, "its number");
  TMCL_FIELD(std::string, name, "of the parameter");
  TMCL_FIELD(std::int32_t, value, "what is proposed");
  TMCL_FIELD(std::int32_t, before, "what the axis has");
};
struct TunedValue {
  TMCL_STRUCT(TunedValue);
  TMCL_FIELD(double, limit, "the greatest that held, or of the current the least");
  TMCL_FIELD(double, proposed, "with the margin");
  TMCL_FIELD(
      std::string, limited_by,
      "motor: a trial beyond it failed; travel: that is too short for more; bounds: those of "
      "the axis and of its module");
};
struct TuneTrial {
  TMCL_STRUCT(TuneTrial);
  TMCL_FIELD(std::string, sought,
             "velocity, acceleration, current, threshold, confirmation, hold, or bow");
  TMCL_FIELD(double, velocity_pps, "in microsteps per second");
  TMCL_FIELD(double, acceleration_pps2, "per second squared");
  TMCL_FIELD(std::int32_t, current, "of parameter 6; for hold, of parameter 7");
  TMCL_FIELD(bool, held, "the encoder was where the motor should be, there and back");
  TMCL_FIELD(double, deviation, "the greatest that the encoder had, in microsteps");
  TMCL_FIELD(std::optional<std::int32_t>, load_value, "the least at full speed, where it was read");
  TMCL_FIELD(std::optional<std::int32_t>, threshold, "of stallGuard2, with which that was");
  TMCL_FIELD(std::string, trouble, "why it did not hold; empty if it did");
  TMCL_FIELD(std::optional<double>, swing,
             "of the load at rest, to either side, in microsteps, where it was looked at");
};
struct TunedBow {
  TMCL_STRUCT(TunedBow);
  TMCL_FIELD(std::int32_t, value, "what is proposed; what the axis has where no other is better");
  TMCL_FIELD(std::optional<double>, resonance_hz, "of the load; null where none was found");
  TMCL_FIELD(std::optional<double>, damping, "0 to less than 1");
  TMCL_FIELD(double, swing, "with it, at rest, to either side, in microsteps");
  TMCL_FIELD(double, swing_before, "with the bow that the axis has");
};
struct Tuned {
  TMCL_STRUCT(Tuned);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(TunedValue, velocity, "in microsteps per second, with the acceleration of the axis");
  TMCL_FIELD(TunedValue, acceleration, "per second squared, at the proposed velocity");
  TMCL_FIELD(TunedValue, current, "of parameter 6, for both that are proposed");
  TMCL_FIELD(std::optional<std::int32_t>, threshold,
             "of stallGuard2: the least with which the load value keeps off 0 by a tenth of its "
             "range; null where the module has none, or none does");
  TMCL_FIELD(double, backlash, "between motor and encoder, in microsteps");
  TMCL_FIELD(double, counts_per_microstep, "of the encoder; below 0 if it counts the other way");
  TMCL_FIELD(
      bool, lost_steps,
      "the position of the axis was set again, by its encoder or switch: search the reference");
  TMCL_FIELD(std::vector<TuneTrial>, trials, "all that were made, in their order");
  TMCL_FIELD(std::vector<TunedSetting>, settings, "what is proposed, in the order to set it");
  TMCL_FIELD(bool, stored, "they are set, and in the module's EEPROM where that keeps them");
  TMCL_FIELD(std::vector<std::string>, warnings, "about what was found");
  TMCL_FIELD(
      std::optional<TunedValue>, hold_current,
      "of parameter 7, with which the axis stands; bounds: nothing moved it with less either, "
      "and what it has is proposed; null where the module has none, or none was enough");
  TMCL_FIELD(std::optional<TunedBow>, bow,
             "with which the load stands first; null where the module has none");
};
struct Tune {
  TMCL_METHOD("axis.tune", moves, Tuned,
              "finds by trials the greatest velocity and acceleration that an axis bears", Tune);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::int32_t, max_current, "of parameter 6: no more flows in the trials");
  TMCL_FIELD(
      std::optional<std::int32_t>, from_microsteps,
      "how far it may go down from where it stands: 0 or less; to its soft limits if absent");
  TMCL_FIELD(std::optional<Amount>, from, in_unit_summary);
  TMCL_FIELD(std::optional<std::int32_t>, to_microsteps,
             "how far it may go up from there: 0 or more");
  TMCL_FIELD(std::optional<Amount>, to, in_unit_summary);
  TMCL_FIELD(std::optional<double>, margin,
             "so much more than what is proposed has held, in parts; 0.2 if absent");
  TMCL_FIELD(std::optional<bool>, store,
             "sets what is proposed, and keeps it in the EEPROM of its module");
  TMCL_FIELD(std::optional<std::string>, by_switch,
             "left or right: the limit switch that tells lost steps; the encoder does if absent");
};
struct TuneProgress {
  TMCL_STRUCT(TuneProgress);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::string, text, "what was done, or is done next");
};

}  // namespace tmcl::api::axis
