#include <algorithm>
#include <array>

#include "api/course_json.hpp"
#include "api/handlers.hpp"
#include "api/method.hpp"
#include "api/staging.hpp"

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
               "bus, address, model, model_number, firmware, axes, in_bootloader, "
               "duplicate_suspected, address_is_reply_id"},
    ResultInfo{"failed", objects, "bus and error of each bus that could not be scanned"}};
constexpr std::array list_modules_result{
    ResultInfo{"modules", objects,
               "bus, address, model, model_number, firmware, axes, state (unknown, ready, silent, "
               "in_bootloader), duplicate_suspected"}};
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
               "name, bus, address, motor, model, state (unknown, ready, silent, in_bootloader, "
               "no_such_motor), unit"}};
constexpr ParamInfo predict{"predict", boolean, optional,
                            "foresee how long it takes; true if absent. Costs two readings, and "
                            "more after a change of settings"};
constexpr std::array move_to_params{
    axis, ParamInfo{"position_microsteps", integer, optional, "where to go"},
    ParamInfo{"position", quantity, optional, "the same, instead; a number: in the axis' unit"},
    predict, deadline};
constexpr std::array move_by_params{
    axis, ParamInfo{"distance_microsteps", integer, optional, "how far to go from here"},
    ParamInfo{"distance", quantity, optional, "the same, instead; a number: in the axis' unit"},
    predict, deadline};
constexpr std::array target_result{ResultInfo{"target_microsteps", integer, "where the move ends"}};
constexpr ResultInfo axis_unit{"unit", nullable_text,
                               "what the next one is in; null if the axis has none"};
constexpr std::array started_move_result{
    target_result.front(), axis_unit,
    ResultInfo{"target", nullable_number, "where it ends, in the unit"},
    ResultInfo{"predicted_s", nullable_number,
               "how many seconds it will take; null where nobody can tell"}};
constexpr std::array move_line_params{
    ParamInfo{"axes", texts, required, "names of the axes, on any buses"},
    ParamInfo{"positions_microsteps", integers, optional, "where each of them is to go"},
    ParamInfo{"positions", quantities, optional, "the same, instead; a number: in the axis' unit"},
    ParamInfo{"velocity", quantity, optional,
              "what no axis exceeds; a number: in the unit that all have"},
    ParamInfo{"velocity_pps", number, optional, "the same in microsteps per second, instead"},
    ParamInfo{"acceleration", quantity, optional,
              "what no axis exceeds; a number: in the unit that all have"},
    ParamInfo{"acceleration_pps2", number, optional,
              "the same in microsteps per second squared, instead"},
    ParamInfo{"time_s", number, optional,
              "how long it takes, up to 86400; as short as possible if absent"},
    deadline};
constexpr std::array move_line_result{
    ResultInfo{"axes", objects,
               "axis, target_microsteps, target in its unit or null, unit or null "
               "and predicted_s of each"},
    ResultInfo{"predicted_s", number, "when the last of them arrives"},
    ResultInfo{"spread_s", number, "how much earlier the first of them does, as predicted"},
    ResultInfo{"deviation", number,
               "how far off the line they get, as predicted; a part of the longest way"},
    ResultInfo{"one_command", boolean, "one command has started them all"},
    ResultInfo{"predicted_skew_s", number, "how long the starts were expected to take"},
    ResultInfo{"skew_s", number, "from the first start to the last, as the answers tell"}};
constexpr std::array rotate_params{
    axis,
    ParamInfo{"velocity_internal", integer, optional,
              "speed in the module's own unit; the sign is the direction"},
    ParamInfo{"velocity", quantity, optional,
              "the same, instead; a number: in the axis' unit per second"},
    deadline};
constexpr std::array rotate_result{
    ResultInfo{"velocity_internal", integer, "speed in the module's own unit"}, axis_unit,
    ResultInfo{"velocity", nullable_number, "speed in the unit per second"}};
constexpr std::array only_axis{axis};
constexpr std::array get_state_params{
    axis, ParamInfo{"max_age_ms", integer, optional,
                    "how old the state may be; 0 if absent: the module is asked", 0, 60000}};
constexpr std::array list_axes_params{
    ParamInfo{"all", boolean, optional,
              "also those that were named as BUS:ADDRESS/MOTOR; only configured ones if absent"}};
constexpr std::array wait_params{
    axis, ParamInfo{"timeout_ms", integer, optional, "how long at most; 0 or absent: as it takes",
                    0, 86'400'000}};
constexpr std::array wait_result{
    ResultInfo{"position_microsteps", integer, "where the axis stands"}, axis_unit,
    ResultInfo{"position", nullable_number, "where it stands, in the unit"}};
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
    ResultInfo{"units_per_revolution", nullable_number, "how many of these a turn of the motor is"},
    ResultInfo{"units_per_output_revolution", nullable_number,
               "how many of these a turn of what its gear drives is"},
    ResultInfo{"gear_ratio", nullable_number, "turns of the motor for one of those"},
    ResultInfo{"reverse", nullable_boolean, "they grow in the motor's negative direction"},
    ResultInfo{"microsteps_per_revolution", nullable_number, "null where the module tells none"},
    ResultInfo{"full_steps", nullable_number, "full steps of a turn"},
    ResultInfo{"velocity_unit_pps", nullable_number,
               "what the module's unit of velocity is, in microsteps per second"},
    ResultInfo{"acceleration_unit_pps2", nullable_number,
               "what its unit of acceleration is, in microsteps per second squared"},
    ResultInfo{"soft_limit_minimum", nullable_number,
               "least position that moves may end at, in the unit; null without soft limits"},
    ResultInfo{"soft_limit_maximum", nullable_number, "the greatest"},
    ResultInfo{"soft_limit_minimum_microsteps", nullable_number,
               "the least one in microsteps; also without a unit"},
    ResultInfo{"soft_limit_maximum_microsteps", nullable_number, "the greatest"},
    ResultInfo{"encoder_counts_per_unit", nullable_number,
               "what encoder positions count in; null where that is microsteps"}};

// ---- parameter ----

constexpr std::array get_parameter_params{axis, parameter, deadline};
constexpr std::array set_parameter_params{
    axis, parameter, ParamInfo{"value", integer, optional, "what to set it to"},
    ParamInfo{"value_in_unit", quantity, optional,
              "the same, instead; a number: in the axis' unit"},
    deadline};
constexpr std::array parameter_result{
    ResultInfo{"parameter", nullable_text, "standard name; null if the number has none"},
    ResultInfo{"number", integer, "number of the axis parameter"},
    ResultInfo{"value", integer, "its value"},
    ResultInfo{"unit", nullable_text,
               "what the next one is in, such as mm/s; null if there is none"},
    ResultInfo{"value_in_unit", nullable_number, "its value in the axis' unit"}};
constexpr std::array list_parameters_result{ResultInfo{
    "parameters", objects,
    "number, name, access, stored, minimum, maximum, initial, unit, meaning, axis_unit, aliases; "
    "none for a model that is not known"}};

constexpr std::array eeprom_parameter_params{axis, parameter, deadline};
constexpr std::array eeprom_parameter_result{
    ResultInfo{"parameter", nullable_text, "standard name; null if the number has none"},
    ResultInfo{"number", integer, "number of the axis parameter"}};

// ---- reference searches, coordinates ----

constexpr ParamInfo search_mode{
    "mode", integer, optional, "axis parameter 193, set before; as it is set if absent", 1, 255};
constexpr std::array home_params{
    axis, search_mode,
    ParamInfo{"timeout_ms", integer, optional, "how long at most; 0 or absent: as it takes", 0,
              86'400'000}};
constexpr std::array home_result{
    ResultInfo{
        "correction_microsteps", nullable_number,
        "where the axis believed to be at what is zero now; null if the module does not say"},
    ResultInfo{"switch_distance_microsteps", nullable_number,
               "from one end switch to the other; null if the module does not say"},
    ResultInfo{"unit", nullable_text, "what the next two are in; null if the axis has none"},
    ResultInfo{"correction", nullable_number, "the same correction"},
    ResultInfo{"switch_distance", nullable_number, "the same way between the switches"}};
constexpr std::array start_home_params{axis, search_mode};
constexpr ParamInfo coordinate{"number", integer, required, "number of the coordinate", 0, 20};
constexpr std::array coordinate_params{axis, coordinate, deadline};
constexpr std::array set_coordinate_params{
    axis, coordinate, ParamInfo{"position_microsteps", integer, optional, "what to remember"},
    ParamInfo{"position", quantity, optional, "the same, instead; a number: in the axis' unit"},
    deadline};
constexpr std::array coordinate_result{
    ResultInfo{"position_microsteps", integer, "the coordinate"}, axis_unit,
    ResultInfo{"position", nullable_number, "the same in the unit"}};
constexpr std::array start_coordinate_params{
    ParamInfo{"bus", text, required, "name of the bus"},
    ParamInfo{"address", integer, required, "address of the module", 0, 2047},
    ParamInfo{"number", integer, required, "number of the coordinate", 0, 20},
    ParamInfo{"motors", integers, required, "which motors", 0, 5},
    ParamInfo{"interpolated", boolean, optional,
              "scale their velocities so that they arrive together; false if absent"},
    deadline};
constexpr std::array eeprom_coordinate_params{
    axis, ParamInfo{"number", integer, optional, "number of the coordinate; all if absent", 1, 20},
    deadline};

// ---- global parameters, ports, modules ----

constexpr ParamInfo bus{"bus", text, required, "name of the bus"};
constexpr ParamInfo address{"address", integer, required, "address of the module", 0, 2047};
constexpr std::array module_params{bus, address, deadline};
constexpr ParamInfo global{"parameter", text_or_integer,
                           required,    "standard name or number of the global parameter",
                           0,           255};
constexpr ParamInfo bank{"bank", integer, optional, "bank of the parameter; 0 if absent", 0, 255};
constexpr std::array global_params{bus, address, global, bank, deadline};
constexpr std::array set_global_params{
    bus,     address, global, bank, ParamInfo{"value", integer, required, "what to set it to"},
    deadline};
constexpr std::array global_result{
    ResultInfo{"parameter", nullable_text, "standard name; null if it was given by number"},
    ResultInfo{"number", integer, "number of the global parameter"},
    ResultInfo{"bank", integer, "its bank"}};
constexpr std::array global_value_result{global_result[0], global_result[1], global_result[2],
                                         ResultInfo{"value", integer, "its value"}};
constexpr ParamInfo port{"port", integer, required, "number of the port", 0, 255};
constexpr std::array get_io_params{
    bus, address, port,
    ParamInfo{"bank", integer, optional,
              "0 digital inputs, 1 analog inputs, 2 digital outputs; 0 if absent", 0, 2},
    deadline};
constexpr std::array set_io_params{
    bus, address, port, ParamInfo{"value", integer, required, "what to set it to"}, deadline};
constexpr std::array io_result{ResultInfo{"value", integer, "value of the port"}};
constexpr std::array module_info_result{
    ResultInfo{"module_id", nullable_number, "what the firmware is for"},
    ResultInfo{"version", nullable_number, "its version"},
    ResultInfo{"capabilities", nullable_number,
               "1 bootloader, 2 stand-alone programs, 4 CANopen, 8 EtherCAT, 16 IO-Link"},
    ResultInfo{"release_type", nullable_number, "kind of release"},
    ResultInfo{"bootloader_id", nullable_number, "what the bootloader is for"},
    ResultInfo{"bootloader_version", nullable_number, "its version"},
    ResultInfo{"axis_parameter_width", nullable_number, "bits of an axis parameter's number"},
    ResultInfo{"register_address_width", nullable_number, "bits of a register's address"},
    ResultInfo{"git_hash", nullable_number, "what it was built from"}};

constexpr std::array report_arrivals_params{
    bus, address,
    ParamInfo{"motors", integers, required, "which motors; none of them if empty", 0, 30},
    ParamInfo{"every", boolean, optional, "every move from now on; only the next one if absent"},
    deadline};

// ---- programs ----

constexpr ParamInfo program{"program", text, required, "a program file, in hexadecimal"};
constexpr ParamInfo first_address{
    "first_address", integer, optional, "address of its first command; 0 if absent", 0, 2047};
constexpr std::array load_params{
    bus, address, program, first_address,
    ParamInfo{"compare", boolean, optional, "read it back and compare; true if absent"}};
constexpr std::array compare_params{bus, address, program, first_address};
constexpr std::array commands_result{ResultInfo{"commands", integer, "how many commands it has"}};
constexpr std::array read_program_params{
    bus, address, first_address,
    ParamInfo{"length", integer, optional, "how many commands; up to its end if absent", 1, 2048}};
constexpr std::array read_program_result{
    ResultInfo{"commands", integer, "how many commands it has"},
    ResultInfo{"program", text, "a program file, in hexadecimal"}};
constexpr std::array run_program_params{
    bus, address,
    ParamInfo{"first_address", integer, optional, "where it begins; where it stands if absent", 0,
              2047},
    deadline};
constexpr std::array program_status_result{
    ResultInfo{"state", text, "stopped, running, stepping or reset"},
    ResultInfo{"next_address", nullable_number,
               "the next command; null if the module does not say"},
    ResultInfo{"last_error", nullable_number, "0: none; null if the module does not say"}};
constexpr std::array breakpoint_params{
    bus, address, ParamInfo{"at", integer, required, "address in the program", 0, 2047}, deadline};

// ---- firmware ----

constexpr ResultInfo module_model{"model", nullable_text,
                                  "model of the module; null if it has no name"};
constexpr ResultInfo module_model_number{"model_number", integer, "its number"};
constexpr std::array firmware_status_result{
    module_model, module_model_number,
    ResultInfo{"running", text, "what answers: 1110V142, or 1110B101 for its bootloader"},
    ResultInfo{"in_bootloader", boolean, "no firmware runs"}};
constexpr std::array stage_firmware_params{
    ParamInfo{"offset", integer, required, "how many bytes were handed over before; 0: a new image",
              0, staged_image.most_bytes},
    ParamInfo{"data", text, required, "the next bytes, in hexadecimal"}};
constexpr std::array stage_firmware_result{ResultInfo{"bytes", integer, "how many there are now"}};
constexpr std::array upload_firmware_params{
    bus, address,
    ParamInfo{"start", integer, required, "address of the image's first byte", 0, int32_maximum},
    ParamInfo{"bytes", integer, required, "how many bytes were handed over", 1,
              staged_image.most_bytes},
    ParamInfo{"force", boolean, optional,
              "also an image that does not say that it is for this model"}};
constexpr std::array upload_firmware_result{
    module_model, module_model_number, ResultInfo{"before", text, "what ran before: 1110V101"},
    ResultInfo{"running", text, "what runs now"}, ResultInfo{"checksum", integer, "of the image"}};

// ---- path ----

constexpr std::array stage_path_params{
    ParamInfo{"offset", integer, required, "how many bytes were handed over before; 0: a new path",
              0, staged_path.most_bytes},
    ParamInfo{"data", text, required, "the next bytes, in hexadecimal"}};
constexpr std::array stage_path_result{ResultInfo{"bytes", integer, "how many there are now"}};
/// Of path.run, but for the last one; of path.plan, but for the first two.
constexpr std::array path_params{
    ParamInfo{"plan", integer, optional, "what path.plan has planned, instead of all but to_start"},
    ParamInfo{"to_start", boolean, optional,
              "whether the axes go to the start first; they must stand there if absent"},
    ParamInfo{"axes", texts, optional,
              "names of axes that stand, each once; path.plan takes those of the same name as the "
              "file's if absent"},
    ParamInfo{"file_axes", texts, optional,
              "which axis of the file each of them is; in the file's order if absent"},
    ParamInfo{"text", text, optional, "the file"},
    ParamInfo{"bytes", integer, optional, "how many were handed over by path.stage, instead", 1,
              staged_path.most_bytes},
    ParamInfo{"format", text, optional, "csv or gcode; as the text looks if absent"},
    ParamInfo{"mode", text, optional, "velocity or position; velocity if absent"},
    ParamInfo{"tolerance", number, optional,
              "how far from it the path may be passed, in the file's unit; 0.05 if absent"},
    ParamInfo{"velocity", number, optional,
              "no axis faster than this, a second; its max_velocity if absent"},
    ParamInfo{"acceleration", number, optional,
              "likewise, a second squared; its max_acceleration if absent"},
    ParamInfo{"feed", number, optional, "no faster along the path, a second"},
    ParamInfo{"per_turn", number, optional, "what a turn of the motor is, for axes without a unit"},
    ParamInfo{"deviation", number, optional,
              "stop when an axis is seen so far off its plan; 20 tolerances if absent"},
    ParamInfo{"period_ms", integer, optional,
              "in velocity mode, no updates more often than this; 5 if absent", 5, 1000},
    ParamInfo{"points", integer, optional, "how many of the curve are given; none if absent", 0,
              most_curve_points}};
constexpr auto run_path_params = std::span(path_params).first(path_params.size() - 1);
constexpr auto plan_path_params = std::span(path_params).subspan(2);
constexpr std::array plan_path_result{
    ResultInfo{"plan", integer, "by which path.run runs it, once; the daemon keeps the last one"},
    ResultInfo{"axes", texts, "in the order of the file's"},
    ResultInfo{"course", object,
               "length, duration_s, legs, axes (of the file: axis, least, greatest, top_speed) and "
               "slowest_corners (line, time_s, speed, position)"},
    ResultInfo{"curve", object, "times_s and positions, if points are asked for"}};
constexpr std::array run_path_result{
    ResultInfo{"tracking_error", objects, "axis, largest, rms and readings of each"},
    ResultInfo{"remarks", texts, "what else is to be said, such as of a parameter not set back"},
    ResultInfo{"passed_s", number, "how long it took"},
    ResultInfo{"updates", integer, "of velocities; legs in position mode"},
    ResultInfo{"period_ms", number, "between updates; of the shortest leg in position mode"},
    ResultInfo{"worst_delay_ms", number, "of an update, or of the load of a leg"},
    ResultInfo{"commands", integer, "sent meanwhile"},
    ResultInfo{"commands_per_s", number, "of them"},
    ResultInfo{"bus_load", number, "part of the time that they took"},
    ResultInfo{"round_trip_us", number, "of a command, measured before"}};
constexpr std::array run_mint_params{
    ParamInfo{"axes", texts, required, "names of axes that stand; each once"},
    ParamInfo{"numbers", integers, optional,
              "which axis of the program each of them is; 0, 1, ... if absent", 0, 7},
    ParamInfo{"text", text, optional, "the program"},
    ParamInfo{"bytes", integer, optional, "how many were handed over by path.stage, instead", 1,
              staged_path.most_bytes}};
constexpr std::array run_mint_result{
    ResultInfo{"groups", objects, "line, planned_s and took_s of each GO"},
    ResultInfo{"remarks", texts, "what else is to be said, such as of a parameter not set back"}};
constexpr std::array path_choice_params{
    ParamInfo{"axes", texts, optional, "of paths; all paths if absent"}};
constexpr std::array path_choice_result{ResultInfo{"axes", texts, "of the paths concerned"}};

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
    {"axis.list", "the axes and how they are", list_axes_params, list_axes_result, Effect::reads,
     handlers::list_axes},
    {"axis.move_to", "starts a move to a position; does not wait for its end", move_to_params,
     started_move_result, Effect::moves, handlers::move_to},
    {"axis.move_by", "starts a move over a distance; does not wait for its end", move_by_params,
     started_move_result, Effect::moves, handlers::move_by},
    {"axis.rotate", "turns without end", rotate_params, rotate_result, Effect::moves,
     handlers::rotate},
    {"axis.stop",
     "ramps down to standstill; goes out before everything else",
     only_axis,
     {},
     Effect::stops,
     handlers::stop},
    {"axis.wait", "answers when the axis stands at its target", wait_params, wait_result,
     Effect::reads, handlers::wait},
    {"line.move", "moves several axes so that they start and arrive together", move_line_params,
     move_line_result, Effect::moves, handlers::move_line},
    {"path.stage", "hands over the next part of a path file", stage_path_params, stage_path_result,
     Effect::reads, handlers::stage_path},
    {"path.plan", "plans a path, and says what will be run", plan_path_params, plan_path_result,
     Effect::reads, handlers::plan_path},
    {"path.run",
     "moves axes along a path and answers at its end; tells its progress by notify_progress",
     run_path_params, run_path_result, Effect::moves, handlers::run_path},
    {"path.pause", "lets axes stand on their path", path_choice_params, path_choice_result,
     Effect::writes, handlers::pause_path},
    {"path.resume", "lets them go on", path_choice_params, path_choice_result, Effect::moves,
     handlers::resume_path},
    {"path.stop", "ends paths: answers when their axes stand and have their settings again",
     path_choice_params, path_choice_result, Effect::stops, handlers::stop_path},
    {"mint.run",
     "moves axes as a Mint program says and answers at its end; tells its progress by "
     "notify_progress",
     run_mint_params, run_mint_result, Effect::moves, handlers::run_mint},
    {"axis.home", "searches the reference and answers when that has ended", home_params,
     home_result, Effect::moves, handlers::home},
    {"axis.start_home",
     "starts a reference search; does not wait for its end",
     start_home_params,
     {},
     Effect::moves,
     handlers::start_home},
    {"axis.stop_home",
     "ends a reference search",
     only_axis,
     {},
     Effect::stops,
     handlers::stop_home},
    {"axis.get_state", "where the axis is and what it does", get_state_params, state_result,
     Effect::reads, handlers::get_state},
    {"axis.get_units", "what the axis counts in", only_axis, units_result, Effect::reads,
     handlers::get_units},
    {"parameter.get", "reads an axis parameter", get_parameter_params, parameter_result,
     Effect::reads, handlers::get_parameter},
    {"parameter.set", "sets an axis parameter", set_parameter_params, parameter_result,
     Effect::moves, handlers::set_parameter},
    {"parameter.store", "copies an axis parameter to the EEPROM", eeprom_parameter_params,
     eeprom_parameter_result, Effect::writes, handlers::store_parameter},
    {"parameter.restore", "copies an axis parameter back from the EEPROM", eeprom_parameter_params,
     eeprom_parameter_result, Effect::moves, handlers::restore_parameter},
    {"parameter.list", "the parameters that the model of an axis has", only_axis,
     list_parameters_result, Effect::reads, handlers::list_parameters},
    {"coordinate.get", "reads a coordinate", coordinate_params, coordinate_result, Effect::reads,
     handlers::get_coordinate},
    {"coordinate.set",
     "remembers a position by a number",
     set_coordinate_params,
     {},
     Effect::writes,
     handlers::set_coordinate},
    {"coordinate.capture", "remembers where the axis is", coordinate_params, coordinate_result,
     Effect::writes, handlers::capture_coordinate},
    {"coordinate.move",
     "starts a move to a coordinate",
     coordinate_params,
     {},
     Effect::moves,
     handlers::move_to_coordinate},
    {"coordinate.start",
     "starts motors of a module together, each to its own coordinate of this number",
     start_coordinate_params,
     {},
     Effect::moves,
     handlers::start_coordinate},
    {"coordinate.store",
     "copies coordinates of all motors of the axis' module to the EEPROM",
     eeprom_coordinate_params,
     {},
     Effect::writes,
     handlers::store_coordinates},
    {"coordinate.load",
     "copies them back from the EEPROM",
     eeprom_coordinate_params,
     {},
     Effect::writes,
     handlers::load_coordinates},
    {"global.get", "reads a global parameter", global_params, global_value_result, Effect::reads,
     handlers::get_global},
    {"global.set", "sets a global parameter", set_global_params, global_value_result,
     Effect::writes, handlers::set_global},
    {"global.store", "copies a global parameter to the EEPROM", global_params, global_result,
     Effect::writes, handlers::store_global},
    {"global.restore", "copies a global parameter back from the EEPROM", global_params,
     global_result, Effect::writes, handlers::restore_global},
    {"io.get", "reads an input or output", get_io_params, io_result, Effect::reads,
     handlers::get_io},
    {"io.set", "sets a digital output", set_io_params, io_result, Effect::writes, handlers::set_io},
    {"module.info", "what a module's firmware says of itself", module_params, module_info_result,
     Effect::reads, handlers::module_info},
    {"module.report_arrivals",
     "lets a module tell when motors arrive: events of the kind target_reached",
     report_arrivals_params,
     {},
     Effect::writes,
     handlers::report_arrivals},
    {"module.reset", "restarts a module", module_params, {}, Effect::moves, handlers::reset_module},
    {"module.factory_reset",
     "restores everything in a module to how it was delivered",
     module_params,
     {},
     Effect::moves,
     handlers::factory_reset},
    {"program.load", "loads a program into a module; tells its progress by notify_progress",
     load_params, commands_result, Effect::writes, handlers::load_program},
    {"program.compare", "compares a program with the one in a module", compare_params,
     commands_result, Effect::reads, handlers::compare_program},
    {"program.read", "reads the program in a module", read_program_params, read_program_result,
     Effect::reads, handlers::read_program},
    {"program.run",
     "runs the program in a module",
     run_program_params,
     {},
     Effect::moves,
     handlers::run_program},
    {"program.stop",
     "ends the program; motors go on",
     module_params,
     {},
     Effect::writes,
     handlers::stop_program},
    {"program.step",
     "executes one command of the program",
     module_params,
     {},
     Effect::moves,
     handlers::step_program},
    {"program.reset",
     "ends the program and sets it back to its start",
     module_params,
     {},
     Effect::writes,
     handlers::reset_program},
    {"program.status", "what the program does", module_params, program_status_result, Effect::reads,
     handlers::program_status},
    {"program.set_breakpoint",
     "stops the program there from now on",
     breakpoint_params,
     {},
     Effect::writes,
     handlers::set_breakpoint},
    {"program.clear_breakpoint",
     "does not stop it there any more",
     breakpoint_params,
     {},
     Effect::writes,
     handlers::clear_breakpoint},
    {"program.clear_breakpoints",
     "does not stop it anywhere any more",
     module_params,
     {},
     Effect::writes,
     handlers::clear_breakpoints},
    {"firmware.status", "what runs in a module, as its updates need to know", module_params,
     firmware_status_result, Effect::reads, handlers::firmware_status},
    {"firmware.stage", "hands over the next part of a firmware image", stage_firmware_params,
     stage_firmware_result, Effect::reads, handlers::stage_firmware},
    {"firmware.upload",
     "exchanges the firmware of a module for the image that was handed over; tells its progress by "
     "notify_progress",
     upload_firmware_params, upload_firmware_result, Effect::moves, handlers::upload_firmware},
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
    case integers: return "array of integers";
    case quantity: return "quantity";
    case quantities: return "array of quantities";
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
