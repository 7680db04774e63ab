#include <algorithm>
#include <array>

#include "api/handlers.hpp"
#include "api/method.hpp"

namespace tmcld {
namespace {

using enum FieldType;
using tmcl::Effect;
constexpr bool required = true;
constexpr bool optional = false;

constexpr ParamInfo axis{"axis", text, required, "name of the axis"};
constexpr ParamInfo deadline{
    "deadline_ms",
    integer,
    optional,
    "refused instead of sent when it could not be sent so soon after it came in",
    0,
    86'400'000};
constexpr ParamInfo parameter{"parameter", text_or_integer,
                              required,    "standard name or number of the axis parameter",
                              0,           255};

// ---- rpc ----

constexpr std::array discover_result{
    ResultInfo{"methods", objects, "name, summary, params and result of every method"}};

// ---- bus, module ----

constexpr std::array list_buses_result{
    ResultInfo{"buses", objects, "name, link, state (opening, open, lost), error, counters"}};
constexpr std::array scan_params{
    ParamInfo{"bus", text, optional, "name of the bus; all buses if absent"},
    ParamInfo{"first", integer, optional, "first address; 1 if absent", 0, 2047},
    ParamInfo{"last", integer, optional, "last address; 255 if absent, and at most on serial lines",
              0, 2047}};
constexpr std::array scan_result{
    ResultInfo{"modules", objects,
               "bus, address, model, model_number, firmware, axes, duplicate_suspected"},
    ResultInfo{"failed", objects, "bus and error of each bus that could not be scanned"}};
constexpr std::array list_modules_result{
    ResultInfo{"modules", objects,
               "bus, address, model, model_number, firmware, axes, state (unknown, ready, silent), "
               "duplicate_suspected"}};
constexpr std::array execute_params{
    ParamInfo{"bus", text, required, "name of the bus"},
    ParamInfo{"address", integer, required, "address of the module", 0, 2047},
    ParamInfo{"command", text_or_integer, required, "TMCL mnemonic or number", 0, 255},
    ParamInfo{"type", text_or_integer, optional, "type field; 0 if absent", 0, 255},
    ParamInfo{"motor", integer, optional, "motor or bank; 0 if absent", 0, 255},
    ParamInfo{"value", integer, optional, "value field; 0 if absent"},
    deadline};
constexpr std::array execute_result{
    ResultInfo{"status", integer, "status byte of the reply"},
    ResultInfo{"status_name", text, "its standard name"},
    ResultInfo{"command", integer, "command byte of the reply"},
    ResultInfo{"value", integer, "value of the reply"},
    ResultInfo{"text", nullable_text, "the firmware version where it came as text"}};

// ---- axis ----

constexpr std::array list_axes_result{
    ResultInfo{"axes", objects,
               "name, bus, address, motor, model, state (unknown, ready, silent, no_such_motor)"}};
constexpr std::array move_to_params{
    axis, ParamInfo{"position_microsteps", integer, optional, "where to go"},
    ParamInfo{"position", number, optional, "the same in the axis' unit, instead"}, deadline};
constexpr std::array move_by_params{
    axis, ParamInfo{"distance_microsteps", integer, optional, "how far to go from here"},
    ParamInfo{"distance", number, optional, "the same in the axis' unit, instead"}, deadline};
constexpr std::array target_result{ResultInfo{"target_microsteps", integer, "where the move ends"}};
constexpr std::array rotate_params{
    axis,
    ParamInfo{"velocity_internal", integer, optional,
              "speed in the module's own unit; the sign is the direction"},
    ParamInfo{"velocity", number, optional, "the same in the axis' unit per second, instead"},
    deadline};
constexpr std::array only_axis{axis};
constexpr std::array wait_params{
    axis, ParamInfo{"timeout_ms", integer, optional, "how long at most; 0 or absent: as it takes",
                    0, 86'400'000}};
constexpr std::array wait_result{
    ResultInfo{"position_microsteps", integer, "where the axis stands"}};
constexpr std::array state_result{
    ResultInfo{"axis", text, "name of the axis"},
    ResultInfo{"position_microsteps", integer, "where it is"},
    ResultInfo{"velocity_internal", integer, "speed in the module's own unit"},
    ResultInfo{"velocity_pps", nullable_number, "speed in microsteps per second; null if unknown"},
    ResultInfo{"target_microsteps", integer, "where it is to go"},
    ResultInfo{"position_reached", boolean, "position equals target, perhaps only in passing"},
    ResultInfo{"moving", boolean, "its speed is not zero"},
    ResultInfo{"unit", nullable_text, "what the next three are in; null if the axis has none"},
    ResultInfo{"position", nullable_number, "where it is"},
    ResultInfo{"velocity", nullable_number, "speed per second"},
    ResultInfo{"target", nullable_number, "where it is to go"},
    ResultInfo{"age_ms", integer, "how old the oldest of these values is"}};

constexpr std::array units_result{
    ResultInfo{"axis", text, "name of the axis"},
    ResultInfo{"model", nullable_text, "model of its module; null if it is not known"},
    ResultInfo{"unit", nullable_text, "what positions are measured in; null if nothing is set"},
    ResultInfo{"units_per_revolution", nullable_number, "how many of these a turn is"},
    ResultInfo{"reverse", nullable_boolean, "they grow in the motor's negative direction"},
    ResultInfo{"microsteps_per_revolution", nullable_number, "null where the module tells none"},
    ResultInfo{"full_steps", nullable_number, "full steps of a turn"},
    ResultInfo{"velocity_unit_pps", nullable_number,
               "what the module's unit of velocity is, in microsteps per second"},
    ResultInfo{"acceleration_unit_pps2", nullable_number,
               "what its unit of acceleration is, in microsteps per second squared"}};

// ---- parameter ----

constexpr std::array get_parameter_params{axis, parameter, deadline};
constexpr std::array set_parameter_params{
    axis, parameter, ParamInfo{"value", integer, required, "what to set it to"}, deadline};
constexpr std::array parameter_result{
    ResultInfo{"parameter", nullable_text, "standard name; null if the number has none"},
    ResultInfo{"number", integer, "number of the axis parameter"},
    ResultInfo{"value", integer, "its value"}};
constexpr std::array list_parameters_result{
    ResultInfo{"parameters", objects,
               "number, name, access, minimum, maximum, initial, unit, meaning; none for a model "
               "that is not known"}};

// ---- system, subscriptions ----

constexpr std::array stop_all_result{
    ResultInfo{"stopped", objects, "axis, and milliseconds until its module had confirmed"},
    ResultInfo{"failed", objects, "axis and error of each one that did not confirm"}};
constexpr std::array subscribe_params{
    ParamInfo{"axes", texts, optional, "names of the axes; all of them if absent"},
    ParamInfo{"interval_ms", integer, optional, "least time between two states; 50 if absent", 5,
              60000}};
constexpr std::array subscribe_result{
    ResultInfo{"subscription", integer, "what unsubscribe takes"},
    ResultInfo{"states", objects, "the state of each axis now, as axis.get_state, and seq"},
    ResultInfo{"failed", objects, "axis and error of each one that does not answer now"}};
constexpr std::array unsubscribe_params{
    ParamInfo{"subscription", integer, required, "what subscribe gave", 0, int32_maximum}};

constexpr auto table = std::to_array<MethodInfo>({
    {"rpc.discover",
     "every method, as this daemon has it",
     {},
     discover_result,
     Effect::reads,
     handlers::discover},
    {"bus.list",
     "the configured buses and how they are",
     {},
     list_buses_result,
     Effect::reads,
     handlers::list_buses},
    {"bus.scan", "asks every address who is there; tells its progress by notify_progress",
     scan_params, scan_result, Effect::reads, handlers::scan},
    {"module.list",
     "the configured modules and how they are",
     {},
     list_modules_result,
     Effect::reads,
     handlers::list_modules},
    {"module.execute", "any TMCL command, exactly as given", execute_params, execute_result,
     Effect::moves, handlers::execute},
    {"axis.list",
     "the configured axes and how they are",
     {},
     list_axes_result,
     Effect::reads,
     handlers::list_axes},
    {"axis.move_to", "starts a move to a position; does not wait for its end", move_to_params,
     target_result, Effect::moves, handlers::move_to},
    {"axis.move_by", "starts a move over a distance; does not wait for its end", move_by_params,
     target_result, Effect::moves, handlers::move_by},
    {"axis.rotate", "turns without end", rotate_params, {}, Effect::moves, handlers::rotate},
    {"axis.stop",
     "ramps down to standstill; goes out before everything else",
     only_axis,
     {},
     Effect::stops,
     handlers::stop},
    {"axis.wait", "answers when the axis stands at its target", wait_params, wait_result,
     Effect::reads, handlers::wait},
    {"axis.get_state", "where the axis is and what it does", only_axis, state_result, Effect::reads,
     handlers::get_state},
    {"axis.get_units", "what the axis counts in", only_axis, units_result, Effect::reads,
     handlers::get_units},
    {"parameter.get", "reads an axis parameter", get_parameter_params, parameter_result,
     Effect::reads, handlers::get_parameter},
    {"parameter.set", "sets an axis parameter", set_parameter_params, parameter_result,
     Effect::moves, handlers::set_parameter},
    {"parameter.list", "the parameters that the model of an axis has", only_axis,
     list_parameters_result, Effect::reads, handlers::list_parameters},
    {"system.stop_all",
     "stops all axes at once",
     {},
     stop_all_result,
     Effect::stops,
     handlers::stop_all},
    {"subscribe", "tells of states by notify_state whenever they change, and of events",
     subscribe_params, subscribe_result, Effect::reads, handlers::subscribe},
    {"unsubscribe",
     "ends a subscription",
     unsubscribe_params,
     {},
     Effect::reads,
     handlers::unsubscribe},
});

}  // namespace

std::string_view name_of(FieldType type) {
  switch (type) {
    case text: return "string";
    case integer: return "integer";
    case number: return "number";
    case boolean: return "boolean";
    case text_or_integer: return "string or integer";
    case texts: return "array of strings";
    case object: return "object";
    case objects: return "array of objects";
    case nullable_text: return "string or null";
    case nullable_number: return "number or null";
    case nullable_boolean: return "boolean or null";
  }
  return {};
}

std::span<const MethodInfo> method_table() { return table; }

const MethodInfo* find_method(std::string_view name) {
  const auto* row = std::ranges::find(table, name, &MethodInfo::name);
  return row == table.end() ? nullptr : row;
}

}  // namespace tmcld
