/// The methods of one axis.
#pragma once

#include "tmcl/api/field.hpp"
#include "tmcl/jerk.hpp"

namespace tmcl::api::axis {

constexpr std::string_view axis_summary = "name of the axis";
constexpr std::string_view unit_summary = "what it measures in; null if the axis has no unit";
constexpr std::string_view deadline_summary =
    "refused instead of sent when it could not be sent so soon after it came in";
constexpr std::string_view in_unit_summary = "the same, instead; a number: in the axis' unit";
constexpr std::string_view faults_summary =
    "what is wrong with its driver or its supply, as axis.get_errors names it";
constexpr std::int64_t longest_ms = 86'400'000;
constexpr Bounds milliseconds{0, longest_ms};

/// Every method takes it.
struct Sent {
  TMCL_STRUCT(Sent);
  TMCL_FIELD(std::int64_t, sent_at_ms, "when the call was sent, by CLOCK_MONOTONIC",
             {0, std::int64_t{1} << 53});
};

struct Axis {
  TMCL_STRUCT(Axis);
  TMCL_FIELD(std::string, name, axis_summary);
  TMCL_FIELD(std::string, bus, "name of its bus");
  TMCL_FIELD(std::uint16_t, address, "address of its module");
  TMCL_FIELD(std::uint8_t, motor, "number of its motor");
  TMCL_FIELD(std::optional<std::string>, model, "model of its module; null if it is not known");
  TMCL_FIELD(std::string, state, "unknown, ready, silent, in_bootloader, no_such_motor");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::vector<std::string>, faults, faults_summary);
};
struct Axes {
  TMCL_STRUCT(Axes);
  TMCL_FIELD(std::vector<Axis>, axes, "the axes");
};
struct List {
  TMCL_METHOD("axis.list", reads, Axes, "the axes and how they are", List);
  TMCL_FIELD(std::optional<bool>, all,
             "also those that were named as BUS:ADDRESS/MOTOR; only configured ones if absent");
};

// ---- moves ----

constexpr std::string_view warnings_summary =
    "warnings about its settings, and why the move cannot be foreseen";

constexpr std::string_view settings_summary = "warnings about moves with its settings";

struct StartedMove {
  TMCL_STRUCT(StartedMove);
  TMCL_FIELD(std::int32_t, target_microsteps, "where the move ends");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, target, "where it ends, in the unit");
  TMCL_FIELD(std::optional<double>, predicted_s,
             "how many seconds it will take; null where it cannot be foreseen");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings, warnings_summary);
};

constexpr std::string_view predict_summary =
    "foresee how long it takes; true if absent. Costs two readings, and more after a change of "
    "settings";

struct MoveTo {
  TMCL_METHOD("axis.move_to", moves, StartedMove,
              "starts a move to a position; does not wait for its end", MoveTo);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, position_microsteps, "where to go");
  TMCL_FIELD(std::optional<Amount>, position, in_unit_summary);
  TMCL_FIELD(std::optional<bool>, predict, predict_summary);
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, deadline_summary, milliseconds);
};

struct MoveBy {
  TMCL_METHOD("axis.move_by", moves, StartedMove,
              "starts a move over a distance; does not wait for its end", MoveBy);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, distance_microsteps, "how far to go from here");
  TMCL_FIELD(std::optional<Amount>, distance, in_unit_summary);
  TMCL_FIELD(std::optional<bool>, predict, predict_summary);
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, deadline_summary, milliseconds);
};

struct Turning {
  TMCL_STRUCT(Turning);
  TMCL_FIELD(std::int32_t, velocity_internal, "speed in the module's own unit");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, velocity, "speed in the unit per second");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings,
             "such as that it is faster than max_velocity, which holds for positions");
};
struct Rotate {
  TMCL_METHOD("axis.rotate", moves, Turning, "turns without end", Rotate);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, velocity_internal,
             "speed in the module's own unit; the sign is the direction");
  TMCL_FIELD(std::optional<Amount>, velocity,
             "the same, instead; a number: in the axis' unit per second");
  TMCL_FIELD(std::optional<bool>, unattended,
             "it turns on when the connection ends; it stops then if absent");
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, deadline_summary, milliseconds);
};

constexpr std::int64_t shortest_hold_ms = 100;
constexpr std::int64_t longest_hold_ms = 1'000;

struct Jogging {
  TMCL_STRUCT(Jogging);
  TMCL_FIELD(std::int32_t, target_microsteps, "where it comes to rest without a further call");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, target, "the same in the unit");
  TMCL_FIELD(std::int64_t, until_ms,
             "when it begins to brake without a further call, by CLOCK_MONOTONIC of tmcld's "
             "computer");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings,
             "such as that the journal cannot be written");
};
struct Jog {
  TMCL_METHOD("axis.jog", moves, Jogging,
              "goes one way for as long as it is called again; needs a lease", Jog);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, velocity_internal,
             "speed in the module's own unit; the sign is the direction, and 0 ends it");
  TMCL_FIELD(std::optional<Amount>, velocity,
             "the same, instead; a number: in the axis' unit per second");
  TMCL_FIELD(std::int64_t, hold_ms, "for how long it goes on without a further call",
             {shortest_hold_ms, longest_hold_ms});
};

struct Stop {
  TMCL_METHOD("axis.stop", stops, Nothing,
              "ramps down to standstill; goes out before everything else", Stop);
  TMCL_FIELD(std::string, axis, axis_summary);
};

struct Place {
  TMCL_STRUCT(Place);
  TMCL_FIELD(std::int32_t, position_microsteps, "where it is");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, position, "where it is, in the unit");
};
/// Where it has come to stand.
struct Standing : Place {
  TMCL_STRUCT(Standing, Place);
  TMCL_FIELD(std::vector<std::string>, warnings, settings_summary);
};
constexpr std::string_view timeout_summary = "how long at most; 0 or absent: as it takes";
struct Wait {
  TMCL_METHOD("axis.wait", reads, Standing, "answers when the axis stands at its target", Wait);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int64_t>, timeout_ms, timeout_summary, milliseconds);
  TMCL_FIELD(std::optional<std::int32_t>, target_microsteps,
             "which target; the one that it has then if absent");
};

// ---- reference searches ----

constexpr std::string_view mode_summary = "axis parameter 193, set before; as it is set if absent";
constexpr Bounds search_modes{1, 255};

constexpr std::string_view search_limit_summary =
    "how far it may go one way without turning: it is stopped beyond that; null: nothing bounds it";
constexpr std::string_view search_warnings_summary = "such as that nothing bounds the search";

struct HomedAxis {
  TMCL_STRUCT(HomedAxis);
  TMCL_FIELD(std::optional<std::int32_t>, correction_microsteps,
             "where the axis believed to be at what is zero now; null if the module does not say");
  TMCL_FIELD(std::optional<std::int32_t>, switch_distance_microsteps,
             "from one end switch to the other; null if this search did not visit both, or the "
             "module does not say");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, correction, "the same correction in the unit");
  TMCL_FIELD(std::optional<double>, switch_distance, "the same way between the switches");
  TMCL_FIELD(std::optional<std::int32_t>, max_travel_microsteps, search_limit_summary);
  TMCL_FIELD(std::optional<double>, max_travel, "the same in the unit");
  TMCL_FIELD(std::vector<std::string>, warnings, search_warnings_summary);
};
struct StartedSearch {
  TMCL_STRUCT(StartedSearch);
  TMCL_FIELD(std::optional<std::int32_t>, max_travel_microsteps, search_limit_summary);
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(std::optional<double>, max_travel, "the same in the unit");
  TMCL_FIELD(std::vector<std::string>, warnings, search_warnings_summary);
};
constexpr std::string_view max_travel_summary =
    "how far it may go one way without turning; as the configuration says if absent";
struct Home {
  TMCL_METHOD("axis.home", moves, HomedAxis,
              "searches the reference and answers when that has ended", Home);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::uint8_t>, mode, mode_summary, search_modes);
  TMCL_FIELD(std::optional<std::int64_t>, timeout_ms, timeout_summary, milliseconds);
  TMCL_FIELD(std::optional<std::int32_t>, max_travel_microsteps, max_travel_summary,
             {.minimum = 1});
  TMCL_FIELD(std::optional<Amount>, max_travel, in_unit_summary);
  TMCL_FIELD(std::optional<bool>, leave,
             "the search goes on after the timeout; it is stopped then if absent");
};
struct StartHome {
  TMCL_METHOD("axis.start_home", moves, StartedSearch,
              "starts a reference search; does not wait for its end", StartHome);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::uint8_t>, mode, mode_summary, search_modes);
  TMCL_FIELD(std::optional<std::int32_t>, max_travel_microsteps, max_travel_summary,
             {.minimum = 1});
  TMCL_FIELD(std::optional<Amount>, max_travel, in_unit_summary);
};
struct StopHome {
  TMCL_METHOD("axis.stop_home", stops, Nothing, "ends a reference search", StopHome);
  TMCL_FIELD(std::string, axis, axis_summary);
};

struct Recover {
  TMCL_METHOD("axis.recover", writes, Nothing,
              "says that an axis may move again whose module is not what it was", Recover);
  TMCL_FIELD(std::string, axis, axis_summary);
};

// ---- how it speeds up and brakes ----

/// What a ramp should be like; a ramp is the same in both directions.
struct OfRamp {
  TMCL_STRUCT(OfRamp);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<Amount>, velocity,
             "of positioning moves; a number: in the axis' unit per second");
  TMCL_FIELD(std::optional<std::int32_t>, velocity_internal,
             "the same, instead, in the module's own unit");
  TMCL_FIELD(std::optional<Amount>, acceleration,
             "of every ramp; a number: in the axis' unit per second squared");
  TMCL_FIELD(std::optional<std::int32_t>, acceleration_internal,
             "the same, instead, in the module's own unit");
  TMCL_FIELD(std::optional<Amount>, deceleration,
             "to brake with, where the module has it apart; as the acceleration if absent");
  TMCL_FIELD(std::optional<std::int32_t>, deceleration_internal,
             "the same, instead, in the module's own unit");
  TMCL_FIELD(std::optional<Amount>, jerk,
             "how fast the acceleration may change; a number: in the axis' unit per second cubed; "
             "'max': as fast as it can without swinging; as it is if absent");
  TMCL_FIELD(std::optional<std::int32_t>, bow, "the same, instead, as a TMC457 counts it",
             {1, greatest_bow});
};
struct RampSetting {
  TMCL_STRUCT(RampSetting);
  TMCL_FIELD(std::string, parameter, "standard name of the axis parameter");
  TMCL_FIELD(std::uint8_t, number, "its number");
  TMCL_FIELD(std::int32_t, value, "what it is set to");
};
struct Ramp {
  TMCL_STRUCT(Ramp);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::string, model, "model of its module");
  TMCL_FIELD(std::optional<std::string>, unit, unit_summary);
  TMCL_FIELD(double, velocity_pps, "what the settings give, in microsteps per second");
  TMCL_FIELD(std::optional<double>, velocity, "the same in the unit per second");
  TMCL_FIELD(double, acceleration_pps2, "the same, per second squared");
  TMCL_FIELD(std::optional<double>, acceleration, "the same in the unit");
  TMCL_FIELD(double, deceleration_pps2, "the same, of braking");
  TMCL_FIELD(std::optional<double>, deceleration, "the same in the unit");
  TMCL_FIELD(std::optional<double>, jerk_pps3,
             "the same, per second cubed; null for an acceleration that changes at once");
  TMCL_FIELD(std::optional<double>, jerk, "the same in the unit");
  TMCL_FIELD(double, ramp_s, "how long it takes to get up to speed");
  TMCL_FIELD(double, ramp_microsteps, "how far it goes meanwhile");
  TMCL_FIELD(std::vector<RampSetting>, settings, "what makes the ramp");
  TMCL_FIELD(std::vector<std::string>, remarks,
             "what it will do instead where the module cannot do what was asked");
  TMCL_FIELD(std::vector<std::string>, warnings, settings_summary);
};
struct PlanRamp : OfRamp {
  TMCL_METHOD("axis.plan_ramp", reads, Ramp,
              "chooses the parameters that make a ramp; writes nothing", PlanRamp, OfRamp);
};
struct SetRamp : OfRamp {
  TMCL_METHOD("axis.set_ramp", writes, Ramp, "chooses them, and sets them on an axis that stands",
              SetRamp, OfRamp);
  TMCL_FIELD(std::optional<bool>, store, "keeps them in the module's EEPROM, too");
};

struct ModuleTrait {
  TMCL_STRUCT(ModuleTrait);
  TMCL_FIELD(std::string, trait, "as a report of axis.verify names it, such as last_step");
  TMCL_FIELD(std::string, variant, "which one the module has, such as r3");
};
struct HeldRamp {
  TMCL_STRUCT(HeldRamp);
  TMCL_FIELD(std::string, model, "model of its module");
  TMCL_FIELD(std::int32_t, position_microsteps,
             "where it stands; with `in_motion`, where it was a moment ago");
  TMCL_FIELD(std::vector<RampSetting>, settings,
             "every parameter that makes a difference to its ramps, in the order in which to give "
             "them to its twin");
  TMCL_FIELD(std::vector<ModuleTrait>, traits, "what the configuration says of its module");
};
struct GetRamp {
  TMCL_METHOD("axis.get_ramp", reads, HeldRamp, "what its movements can be foreseen from", GetRamp);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<bool>, in_motion, "true: answer also while it moves");
};

// ---- what it does, and what it counts in ----

struct State {
  TMCL_STRUCT(State);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::int32_t, position_microsteps, "where it is");
  TMCL_FIELD(std::int32_t, velocity_internal, "speed in the module's own unit");
  TMCL_FIELD(std::optional<double>, velocity_pps,
             "speed in microsteps per second; null if unknown");
  TMCL_FIELD(std::int32_t, target_microsteps, "where it is to go");
  TMCL_FIELD(bool, position_reached, "position equals target, perhaps only in passing");
  TMCL_FIELD(bool, moving,
             "its speed is not zero, or it turns round to come to its target from one side");
  TMCL_FIELD(std::optional<std::string>, unit,
             "what the next three are in; null if the axis has none");
  TMCL_FIELD(std::optional<double>, position, "where it is");
  TMCL_FIELD(std::optional<double>, velocity, "speed per second");
  TMCL_FIELD(std::optional<double>, target, "where it is to go");
  TMCL_FIELD(bool, latched,
             "its module has started again, or is another one: nothing moves it until axis.recover "
             "or axis.home");
  TMCL_FIELD(bool, referenced,
             "it has searched its reference, or was told where it is, while tmcld was there, and "
             "its module has not started again since");
  TMCL_FIELD(std::optional<std::string>, stop_cause,
             "why it stands short of its target: stall, deviation, left_limit, right_limit, "
             "deadman, supply, client, lease_lost, search_limit, daemon, velocity_mode (something "
             "else than tmcld has "
             "stopped it) or unknown; null while it moves or where that is not known");
  TMCL_FIELD(std::int64_t, age_ms, "how old the oldest of these values is");
  TMCL_FIELD(std::optional<std::int32_t>, lease, "number of its lease; null if it has none");
  TMCL_FIELD(bool, unattended, "it turns, and does not stop when a connection ends");
  TMCL_FIELD(std::optional<std::string>, owner,
             "the client that it turns for, or that has its lease; null if there is none");
  TMCL_FIELD(
      std::vector<RampSetting>, unrestored,
      "what a line, a path or a Mint program has changed, as it was before: set back as soon "
      "as its module takes it");
  TMCL_FIELD(std::vector<std::string>, faults, faults_summary);
  TMCL_FIELD(std::uint64_t, last_stop,
             "grows whenever a client, or tmcld itself, has it stopped: also where it stands");
};
struct GetState {
  TMCL_METHOD("axis.get_state", reads, State, "where the axis is and what it does", GetState);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::uint16_t>, max_age_ms,
             "so old it may be; the module is asked if absent", {0, 60'000});
};

struct Units {
  TMCL_STRUCT(Units);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::string>, model, "model of its module; null if it is not known");
  TMCL_FIELD(std::optional<std::string>, unit,
             "what positions are measured in; null if nothing is set");
  TMCL_FIELD(std::optional<double>, units_per_revolution,
             "how many of these a turn of the motor is");
  TMCL_FIELD(std::optional<double>, units_per_output_revolution,
             "how many of these a turn of what its gear drives is");
  TMCL_FIELD(std::optional<double>, gear_ratio, "turns of the motor for one of those");
  TMCL_FIELD(std::optional<bool>, reverse, "they grow in the motor's negative direction");
  TMCL_FIELD(std::optional<std::int32_t>, microsteps_per_revolution,
             "null where the module tells none");
  TMCL_FIELD(std::optional<std::int32_t>, full_steps, "full steps of a turn");
  TMCL_FIELD(std::optional<double>, velocity_unit_pps,
             "what the module's unit of velocity is, in microsteps per second");
  TMCL_FIELD(std::optional<double>, acceleration_unit_pps2,
             "what its unit of acceleration is, in microsteps per second squared");
  TMCL_FIELD(std::optional<double>, soft_limit_minimum,
             "least position that moves may end at, in the unit; null without soft limits");
  TMCL_FIELD(std::optional<double>, soft_limit_maximum, "the greatest");
  TMCL_FIELD(std::optional<std::int32_t>, soft_limit_minimum_microsteps,
             "the least one in microsteps; also without a unit");
  TMCL_FIELD(std::optional<std::int32_t>, soft_limit_maximum_microsteps, "the greatest");
  TMCL_FIELD(std::optional<double>, encoder_counts_per_unit,
             "what encoder positions count in; null where that is microsteps");
};
struct GetUnits {
  TMCL_METHOD("axis.get_units", reads, Units, "what the axis counts in", GetUnits);
  TMCL_FIELD(std::string, axis, axis_summary);
};

}  // namespace tmcl::api::axis
