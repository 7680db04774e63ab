/// What the command line says, as plain values.
#pragma once

#include <any>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "axis/module_lists.hpp"
#include "connection/gateway.hpp"
#include "exit_code.hpp"
#include "plot/shown.hpp"
#include "profile/ramp_export.hpp"
#include "tmcl/command.hpp"
#include "tmcl/plan/motor_torque.hpp"
#include "tmcl/plan/stream.hpp"
#include "verb_info.hpp"

namespace tmclctl {

struct Fleet;

/// How far an axis may go that is measured: as typed, from where it stands; empty: to its soft
/// limits.
struct MeasuredTravel {
  std::string from;
  std::string to;
};

namespace verb {

struct Scan {
  ScanRange range;
  bool bauds = false;      ///< The baud rate is looked for, too.
  bool all_ports = false;  ///< And the port.
};
struct Modules {};
struct Axes {};
/// Of an axis, or of a model that need not be there.
struct Params {
  std::string axis;
  bool values = false;
  bool internal = false;
  std::string model;
  bool globals = false;
};
struct Models {};
/// What this computer has that may lead to modules.
struct Ports {};
struct Get {
  std::string axis;
  std::string parameter;
  bool in_units = false;
};
struct Set {
  std::string axis;
  std::string parameter;
  std::string value;
};
// Positions, distances, velocities and accelerations are kept as they were typed.
struct Move {
  std::string axis;
  std::string position;
  bool by = false;
  bool wait = false;
  std::optional<double> timeout_s;
  bool internal = false;  ///< Say and tell what the module counts in, here and below.
};
/// For what another program started.
struct Wait {
  std::vector<std::string> axes;
  std::optional<double> timeout_s;
  bool internal = false;
};
/// Several axes at once.
struct Line {
  struct Goal {
    std::string axis;
    std::string position;
  };
  std::vector<Goal> goals;
  std::string velocity, acceleration;  ///< Empty: none.
  std::optional<double> time_s;
  bool wait = false;
  std::optional<double> timeout_s;
  bool internal = false;
};
struct Rotate {
  std::string axis;
  std::string velocity;
  bool unattended = false;
  bool internal = false;
};
struct Jog {
  std::vector<std::string> axes;
  std::string velocity;  ///< Empty: a part of max_velocity.
  bool internal = false;
};
struct Stop {
  std::string axis;
  bool all = false;
};
struct State {
  std::string axis;  ///< Empty: all.
  bool internal = false;
};
struct Watch {
  std::vector<std::string> axes;
  bool all = false;
  std::vector<std::string> also;  ///< Further parameters.
  std::string csv;                ///< Empty: none; "-": standard output instead of the text.
  std::chrono::milliseconds interval{100};
  std::optional<double> for_s;
  bool internal = false;
};
/// All axes on the whole terminal.
struct Top {
  std::chrono::milliseconds interval{200};
  bool internal = false;
};
struct Buses {
  double for_s = 1;  ///< So long the load is measured.
};
/// What goes over a bus.
struct Trace {
  std::string bus;                   ///< Empty: the only one.
  std::optional<std::int32_t> last;  ///< So many of those that went before, first.
  std::optional<double> for_s;
  std::string file;                 ///< Empty: none; "-": standard output.
  std::string read;                 ///< A file to show instead; empty: none.
  std::vector<tmcl::Command> only;  ///< Empty: all commands.
  bool not_mine = false;            ///< Nothing that programs of this terminal have asked.
};
struct Plot {
  std::vector<std::string> axes;  ///< At least one; the first is moved.
  std::vector<std::string> also;  ///< Further parameters.
  std::string to;                 ///< Empty: none.
  std::string by;                 ///< Empty: none.
  std::optional<double> for_s;
  std::string svg;   ///< Empty: none.
  std::string csv;   ///< Empty: none; "-": standard output instead of the drawing.
  plot::Shown show;  ///< Empty: as usual.
  bool compare = false;
  bool internal = false;
};
/// One position after the other.
struct ScanPositions {
  std::string axis;
  std::string from;
  std::string to;
  std::int32_t steps = 0;  ///< Positions, both ends included.
  double dwell_s = 0;
  std::int32_t repeat = 1;
  bool both_ways = false;
  std::string command;  ///< Run at each position; empty: none.
  std::string csv;      ///< Empty: none; "-": standard output instead of the statistics.
  bool resume = false;
  bool encoder = false;  ///< There is one, although the configuration does not say so.
  bool internal = false;
};
/// What a module records by itself, at the ticks of its own clock.
struct Capture {
  struct Trigger {
    std::string parameter;
    std::string edge;  ///< rising, falling or both.
    std::int32_t value = 0;
  };
  std::string axis;
  std::vector<std::string> channels;
  std::optional<double> rate_hz;
  std::optional<std::int32_t> samples;
  std::optional<double> for_s;
  std::optional<Trigger> trigger;
  std::optional<std::int32_t> pretrigger_percent;
  std::string svg;  ///< Empty: none.
  std::string csv;  ///< Empty: none; "-": standard output, as without a file.
  bool resume = false;
};
struct Raw {
  std::string bus;
  std::uint16_t address = 0;
  std::string command;
  std::string type;
  std::uint8_t motor = 0;
  std::int32_t value = 0;
};
/// An axis that need not be there.
struct OfflineAxis {
  std::string model;                       ///< Empty: none is meant.
  std::optional<std::int32_t> microsteps;  ///< Of a full step; nothing: as the model starts.
  std::int32_t full_steps = 200;
  std::string unit;  ///< Empty: mm with a screw pitch, or none.
  std::optional<double> screw_pitch, units_per_revolution;
  double gear_ratio = 1;

  bool is_meant() const { return !model.empty(); }
  bool has_scale() const { return screw_pitch.has_value() || units_per_revolution.has_value(); }
};
/// A ramp generator without a module around it, by its registers or by the parameters
/// of a module. Times are in seconds, or in the cycles of a
/// generator that counts in those.
struct Simulate {
  struct Change {
    double time = 0;
    std::string setting;  ///< REGISTER=VALUE
  };
  std::string generator;  ///< Empty with an axis.
  OfflineAxis axis;
  std::vector<std::string> settings;
  std::vector<Change> changes;
  std::vector<double> samples;
  std::optional<double> until;
  std::optional<double> csv_step;
  std::string svg;                ///< Empty: none.
  plot::Shown show;               ///< Empty: as usual.
  std::vector<std::string> with;  ///< Of each profile beside: REGISTER=VALUE,...
  std::optional<double> resonance_hz;
  double damping = 0.05;
  std::optional<double> tolerance;
};
/// The whole of a trapezoid from some of its values.
struct SolveProfile {
  std::vector<std::string> words;  ///< QUANTITY=VALUE[UNIT], or an assumption.
  std::string svg;                 ///< Empty: none.
  plot::Shown show;                ///< Empty: as usual.
  std::optional<double> csv_step;
};
/// A Mint program, run without axes.
struct CheckMint {
  std::string file;
};
/// And on axes.
struct RunMint {
  std::string file;
  std::vector<std::string> axes;  ///< NUMBER=AXIS
  bool counts_encoder = false;
};
/// Input shaping, without a shaper none; and loads that swing.
struct ShapedPath {
  std::optional<tmcl::plan::Shaper> shaper;
  std::optional<double> resonance_hz;
  std::optional<double> damping;
};
/// A path file, planned without axes. Limits are in its units.
struct CheckPath {
  std::string file;
  double tolerance = 0.05;
  double velocity = 100;
  double acceleration = 1000;
  std::optional<double> feed, corner_jump, jerk;
  std::string svg;   ///< Empty: none.
  plot::Shown show;  ///< Empty: the path is not drawn on the screen.
  bool legs = false;
  std::optional<double> microsteps_per_unit;
  double clock_hz = 16e6;
  std::optional<profile::ExportForm> as;  ///< The legs for other programs.
  std::string csv;                        ///< Of all axes over time; empty: none.
  double csv_step = 0.001;                ///< Seconds between its rows.
  bool lenient = false;
  std::string machine;  ///< A configuration of tmcld; empty: none.
  ShapedPath shaping;
};
/// And run on axes.
struct RunPath {
  std::string file;
  std::vector<std::string> axes;  ///< LETTER=AXIS
  tmcl::plan::StreamMode mode = tmcl::plan::StreamMode::velocity;
  double tolerance = 0.05;
  std::string velocity, acceleration, feed, corner_jump, jerk;  ///< As typed; empty: none.
  std::optional<double> per_turn, deviation;
  std::chrono::milliseconds period{5};
  bool dry_run = false;
  std::string svg;  ///< Empty: none.
  bool lenient = false;
  ShapedPath shaping;
};
/// Of a path that is passed.
struct FeedPath {
  std::string axis;
  std::optional<double> factor;  ///< Nothing: as it is.
  std::optional<bool> hold;      ///< Nothing: as it is.
};
struct PathStatus {
  std::vector<std::string> axes;  ///< None: all paths.
};
/// The text of a stand-alone program into a program file.
struct Assemble {
  std::string file;
  std::string model;   ///< Empty: not known.
  std::string output;  ///< Empty: none.
  bool listing = false;
};
/// And the other way.
struct Disassemble {
  std::string file;
  std::string output;  ///< Empty: to standard output.
};
struct FirmwareInfo {
  std::string file;
};
struct CheckFirmware {
  std::string file;
  std::string module;
};
struct UploadFirmware {
  std::string file;
  std::string module;
  bool force = false;
};
/// Makes a ramp of a velocity and an acceleration: dividers and registers, or plain parameters.
struct Ramp {
  std::string axis;  ///< Empty with one that need not be there.
  OfflineAxis offline;
  std::string velocity;
  std::string acceleration;
  std::string deceleration;  ///< Empty: the acceleration.
  std::string jerk;          ///< Or "max"; empty: the bow is left as it is.
  std::optional<profile::ExportForm> as;
  std::uint8_t motor = 0;  ///< That `as` is for.
  bool compare = false;    ///< All ramps of the model, for a move and a load:
  std::string distance;
  std::optional<double> resonance_hz;
  std::optional<double> damping;
  std::string tolerance;         ///< Empty: a thousandth of the distance.
  std::optional<double> time_s;  ///< The gentlest ramp is sought that makes the move in it.
  bool fastest = false;          ///< The quickest ramp is sought that this motor can drive:
  tmcl::plan::MotorTorque torque;
  double margin = 0.3;  ///< Of its torque, in parts of what is asked.
  bool dry_run = false;
  bool store = false;
  bool internal = false;
};
/// How a load swings, by a small move.
struct Resonance {
  std::string axis;
  std::string distance;  ///< Empty: a quarter of a turn.
  std::optional<double> for_s;
  bool internal = false;
};
/// One quantity in all its forms, on a module that need not be there.
struct Convert {
  std::string model;
  std::optional<std::int32_t> pulse_div;
  std::optional<std::int32_t> ramp_div;
  std::optional<std::int32_t> unit_mode;
  std::int32_t microsteps = 256;
  std::int32_t full_steps = 200;
  std::optional<std::int32_t> bow;
  std::string acceleration;  ///< Of a ramp to the quantity, a velocity; empty without one.
  std::string quantity;      ///< May be empty with a bow.
};
/// What is one method of tmcld (docs/PROTOCOL.md), done with or without it.
struct Ask {
  std::string method;
  std::string axis;
  std::string module;     ///< ADDRESS or BUS:ADDRESS
  std::string parameter;  ///< Number or name.
  std::optional<std::int32_t> bank, number, port, value, at, first_address;
  std::string position;  ///< Empty: none.
  std::vector<std::uint8_t> motors;
  std::vector<std::string> axes;
  bool interpolated = false;
  bool all = false;  ///< Of the axis, instead of one parameter.
  bool sure = false;
  bool internal = false;
};
/// Axes whose module is not what it was may move again.
struct Recover {
  std::string axis;
  bool all = false;
};
/// What keeps axes from moving.
struct Doctor {
  std::string what;  ///< An axis or a bus; empty: everything.
  bool all = false;
};
/// What modules say is wrong.
struct Errors {
  std::string axis;  ///< Empty: all there are.
};
/// Of the module of an axis: whether it stops its motors when no host sends it anything.
struct SetDeadman {
  std::string axis;
  std::int32_t ms = 0;  ///< 0: off.
};
struct TestDeadman {
  std::string axis;
};
/// The settings of a module.
struct SettingsSave {
  std::string module;  ///< Empty: all modules of `bus`.
  std::string bus;
  std::string file;  ///< Empty: standard output; with `bus`, a folder.
};
struct SettingsShow {
  std::string module;
  bool changed = false;  ///< Only those that a new module has otherwise.
};
/// Files or modules.
struct SettingsDiff {
  std::string wanted, present;
};
struct SettingsLoad {
  std::string file, module;
  bool dry_run = false;
  bool store = false;
};
/// In what the module of an axis is not like its twin.
struct Verify {
  std::string axis;
  MeasuredTravel travel;
  std::string report;  ///< Empty: none; "-": to standard output, and nothing else.
  bool yes = false;
  bool internal = false;
};
/// Finds what an axis bears.
struct Tune {
  std::string axis;
  std::int32_t max_current = 0;
  MeasuredTravel travel;
  std::string by_switch;
  std::optional<double> margin_percent;
  bool store = false;
  bool yes = false;
  bool internal = false;
};
/// Lets a module tell when motors arrive, and shows that.
struct Arrivals {
  std::string module;
  std::vector<std::uint8_t> motors;
  bool next = false;
  bool off = false;
  std::optional<double> for_s;
};
struct Home {
  std::vector<std::string> axes;  ///< One after the other.
  std::string axis;               ///< The one whose turn it is.
  std::string mode;               ///< A number or a word; empty: as it is set.
  std::optional<double> timeout_s;
  std::string max_travel;  ///< Empty: as the configuration says.
  bool leave = false;
  bool no_wait = false;
  bool internal = false;
  bool stop = false;
};
/// A program into a module, or compared with what is there.
struct Upload {
  std::string file;
  std::string module;
  std::optional<std::int32_t> first_address;
  bool only_compare = false;
  bool no_compare = false;
  bool run = false;
};
/// And out of it.
struct Download {
  std::string module;
  std::string output;  ///< Empty: as text to standard output; *.bin: a program file; else text.
  std::optional<std::int32_t> first_address, length;
};
/// A program in a module, command by command.
struct DebugProgram {
  std::string file;
  std::string module;
  bool upload = false;
};
/// A program that has some axes for itself.
struct RunLeased {
  std::vector<std::string> axes;
  std::optional<double> ttl_s;
  std::vector<std::string> command;  ///< What stands behind "--".
};
struct Leases {};
struct AddToken {
  std::string role;
  std::string name;  ///< Empty: the daemon gives it one.
};
struct Tokens {};
struct Clients {};
struct Audit {
  std::optional<std::int32_t> last;  ///< So many lines.
};
struct RevokeToken {
  std::string name;
};
struct Page {
  bool phone = false;
  std::string token = "phone";
};
/// Any method, by its name.
struct Call {
  std::string method;
  std::string params;  ///< A JSON object; empty: none.
  std::string role;    ///< With --fleet; empty: the one that the method needs.
  std::optional<double> timeout_s;
};
struct FleetGateways {};
/// What files in a folder say of gateways.
struct FleetApply {
  std::string folder;
  bool dry_run = false;
  bool store = false;
};
struct FleetTop {
  std::chrono::milliseconds interval{500};
  bool axes = false;
  bool internal = false;
};
struct BreakLease {
  std::string axis;
};
/// For the shell's completion: prints words, one a line, and never complains. Only "axes" needs a
/// target; everything else is answered by the parser.
struct Complete {
  std::string what;
};

}  // namespace verb

/// A verb, and what was typed with it.
struct Verb {
  std::any said;                                       ///< One of namespace `verb`.
  std::function<Result<ExitCode>(Context&)> run;       ///< Empty where no gateway is needed.
  std::function<Result<ExitCode>(Output&)> run_alone;  ///< Empty where one is.
  /// Instead of both: opens what it needs by itself.
  std::function<Result<ExitCode>(const Where&, Output&, Host&)> run_on_ports{};
  /// With --fleet; empty where the verb is for one gateway.
  std::function<Result<ExitCode>(Fleet&)> run_in_fleet{};
  /// Instead of the error that no gateway is reached; empty: that is the end.
  std::function<Result<ExitCode>(const Error&, const Where&, Output&)> run_unreached{};
};

struct Options {
  Where where;
  bool json = false;
  TableStyle tables{};
  Verb verb;
  std::optional<VerbInfo> info;  ///< Nothing for what only the shell's completion asks.
};

/// The command line was about tmclctl itself: print this and end.
struct Information {
  std::string text;
};

/// `arguments` without the program's name.
Result<std::variant<Options, Information>> parse_options(const std::vector<std::string>& arguments);

}  // namespace tmclctl
