/// The methods of axis parameters and coordinates.
#pragma once

#include "tmcl/api/module.hpp"

namespace tmcl::api {

namespace parameter {

/// A parameter of an axis.
struct OnParameter {
  TMCL_STRUCT(OnParameter);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(NameOrNumber, parameter, "standard name or number of the axis parameter", {0, 255});
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, axis::deadline_summary, axis::milliseconds);
};

struct Number {
  TMCL_STRUCT(Number);
  TMCL_FIELD(std::optional<std::string>, parameter, "standard name; null if the number has none");
  TMCL_FIELD(std::uint8_t, number, "number of the axis parameter");
};
struct Value : Number {
  TMCL_STRUCT(Value, Number);
  TMCL_FIELD(std::int32_t, value, "its value");
  TMCL_FIELD(std::optional<std::string>, unit,
             "what the next one is in, such as mm/s; null if there is none");
  TMCL_FIELD(std::optional<double>, value_in_unit, "its value in the axis' unit");
};

struct Held : Value {
  TMCL_STRUCT(Held, Value);
  TMCL_FIELD(std::vector<std::string>, warnings, axis::settings_summary);
};

struct Get : OnParameter {
  TMCL_METHOD("parameter.get", reads, Value, "reads an axis parameter", Get, OnParameter);
};
struct Set : OnParameter {
  TMCL_METHOD("parameter.set", moves, Held, "sets an axis parameter", Set, OnParameter);
  TMCL_FIELD(std::optional<std::int32_t>, value, "what to set it to");
  TMCL_FIELD(std::optional<Amount>, value_in_unit, axis::in_unit_summary);
};
struct Store : OnParameter {
  TMCL_METHOD("parameter.store", writes, Number, "copies an axis parameter to the EEPROM", Store,
              OnParameter);
};
struct Restore : OnParameter {
  TMCL_METHOD("parameter.restore", moves, Number, "copies an axis parameter back from the EEPROM",
              Restore, OnParameter);
};

/// What the model of an axis has.
struct Parameter {
  TMCL_STRUCT(Parameter);
  TMCL_FIELD(std::uint8_t, number, "its number");
  TMCL_FIELD(std::string, name, "its standard name");
  TMCL_FIELD(std::string, access, "read or read_write");
  TMCL_FIELD(bool, stored, "can be kept in the EEPROM");
  TMCL_FIELD(std::int32_t, minimum, "least value");
  TMCL_FIELD(std::int32_t, maximum, "greatest value");
  TMCL_FIELD(std::int32_t, initial, "factory default");
  TMCL_FIELD(std::string, unit, "what the module counts in");
  TMCL_FIELD(std::string, meaning, "what it is");
  TMCL_FIELD(std::optional<std::string>, axis_unit, "what value_in_unit is in");
  TMCL_FIELD(std::vector<std::string>, aliases, "other names that are understood");
};
struct Parameters {
  TMCL_STRUCT(Parameters);
  TMCL_FIELD(std::vector<Parameter>, parameters, "ascending; none for a model that is not known");
};
struct List {
  TMCL_METHOD("parameter.list", reads, Parameters, "the parameters that the model of an axis has",
              List);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
};

}  // namespace parameter

namespace coordinate {

constexpr std::string_view number_summary = "number of the coordinate";
constexpr Bounds numbers{0, 20};

/// A coordinate of an axis.
struct OnCoordinate {
  TMCL_STRUCT(OnCoordinate);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::uint8_t, number, number_summary, numbers);
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, axis::deadline_summary, axis::milliseconds);
};

struct Get : OnCoordinate {
  TMCL_METHOD("coordinate.get", reads, axis::Place, "reads a coordinate", Get, OnCoordinate);
};
struct Set : OnCoordinate {
  TMCL_METHOD("coordinate.set", writes, Nothing, "remembers a position by a number", Set,
              OnCoordinate);
  TMCL_FIELD(std::optional<std::int32_t>, position_microsteps, "what to remember");
  TMCL_FIELD(std::optional<Amount>, position, axis::in_unit_summary);
};
struct Capture : OnCoordinate {
  TMCL_METHOD("coordinate.capture", writes, axis::Place, "remembers where the axis is", Capture,
              OnCoordinate);
};
struct Move : OnCoordinate {
  TMCL_METHOD("coordinate.move", moves, Nothing, "starts a move to a coordinate", Move,
              OnCoordinate);
};
struct Start : SoonOnModule {
  TMCL_METHOD("coordinate.start", moves, Nothing,
              "starts motors of a module together, each to its own coordinate of this number",
              Start, SoonOnModule);
  TMCL_FIELD(std::uint8_t, number, number_summary, numbers);
  TMCL_FIELD(std::vector<std::uint8_t>, motors, "which motors", {0, 5});
  TMCL_FIELD(std::optional<bool>, interpolated,
             "scale their velocities so that they arrive together; false if absent");
};

/// One that a module keeps, or all.
struct InEeprom {
  TMCL_STRUCT(InEeprom);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::optional<std::uint8_t>, number, "number of the coordinate; all if absent",
             {1, 20});
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, axis::deadline_summary, axis::milliseconds);
};
struct Store : InEeprom {
  TMCL_METHOD("coordinate.store", writes, Nothing,
              "copies coordinates of all motors of the axis' module to the EEPROM", Store,
              InEeprom);
};
struct Load : InEeprom {
  TMCL_METHOD("coordinate.load", writes, Nothing, "copies them back from the EEPROM", Load,
              InEeprom);
};

}  // namespace coordinate
}  // namespace tmcl::api
