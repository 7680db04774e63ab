// scan-positions.
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "axis/held_lease.hpp"
#include "axis/position_visits.hpp"
#include "axis/recording_csv.hpp"
#include "command_line/child_process.hpp"
#include "command_line/input_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/quantity.hpp"
#include "tmcl/utc_text.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

constexpr std::int32_t most_steps = 10'000;
constexpr std::int32_t most_passes = 1'000;
constexpr std::size_t most_visits = 1'000'000;
constexpr std::size_t most_bytes_of_file = std::size_t{1} << 28;
constexpr double longest_dwell_s = 3600;
constexpr std::int64_t scan_lease_ttl_ms = 5'000;
constexpr tmcl::Duration scan_look_interval = std::chrono::milliseconds(20);
constexpr int digits_of_targets = 12;
constexpr const char* encoder_parameter = "encoder_position";
constexpr const char* resume_hint = "The same command with --resume goes on behind the last row";

// ---- Where the axis is to go

struct Span {
  double from = 0;
  double to = 0;
  std::string unit;  ///< As it was typed.

  tmcl::Quantity at(std::int32_t index, std::int32_t steps) const {
    const auto part = static_cast<double>(index) / (steps - 1);
    auto number = from + part * (to - from);
    // What has no unit is counted.
    if (unit.empty()) number = std::round(number);
    return {number, unit};
  }
};

Result<Span> span_of(const verb::ScanPositions& verb) {
  const auto from = attempt(tmcl::parse_quantity(verb.from));
  if (!from) return tl::unexpected(from.error());
  const auto to = attempt(tmcl::parse_quantity(verb.to));
  if (!to) return tl::unexpected(to.error());
  // Zero is the same in every unit.
  const auto is_bare_zero = [](const auto& said) {
    return said->number == 0 && said->unit.empty();
  };
  if (from->unit != to->unit && !is_bare_zero(from) && !is_bare_zero(to))
    return tl::unexpected(
        usage_error("two_units", "--from and --to have different units", "say both in one unit"));
  return Span{from->number, to->number, is_bare_zero(from) ? to->unit : from->unit};
}

std::string text_of(const tmcl::Quantity& quantity) {
  return tmcl::plain_number(quantity.number, digits_of_targets) + quantity.unit;
}

// ---- The scan

/// What is known of the axis before it moves.
struct ScannedAxis {
  plot::Recording recording;
  tmcl::AxisUnits units;
  bool has_unit = false;
  bool has_encoder = false;

  std::string unit() const { return has_unit ? units.scale->unit : "microsteps"; }
};

Result<ScannedAxis> look_at(const verb::ScanPositions& verb, Context& context) {
  auto recording = begin_recording(verb.axis, {}, verb.internal, context);
  if (!recording) return tl::unexpected(recording.error());
  auto units = units_of(verb.axis, context);
  if (!units) return tl::unexpected(units.error());
  ScannedAxis axis{std::move(*recording), std::move(*units)};
  axis.has_unit = axis.recording.user.has_value();
  axis.has_encoder = verb.encoder || axis.units.encoder_counts_per_unit.has_value();
  if (!axis.has_encoder) return axis;
  // Before anything moves: whether it can be read.
  const auto read = context.call(api::parameter::Get{{verb.axis, encoder_parameter}});
  if (!read) return tl::unexpected(read.error());
  return axis;
}

/// Both ends, before the axis is sent to the first: the positions between them are as good.
Result<void> check_limits(const Span& span, const ScannedAxis& axis) {
  const auto& limits = axis.units.limits;
  if (!limits) return {};
  for (const auto number : {span.from, span.to}) {
    const tmcl::Quantity end{number, span.unit};
    const auto there = in_own_unit(end, axis.units);
    if (!there || (*there >= limits->least.value && *there <= limits->greatest.value)) continue;
    return tl::unexpected(usage_error(
        std::string(name_of(tmcl::Errc::beyond_soft_limit)),
        fmt::format("{} is beyond the soft limits of {}", text_of(end), axis.recording.axis),
        fmt::format("{} to {}", tmcl::plain_number(limits->least.value, digits_of_targets),
                    tmcl::plain_number(limits->greatest.value, digits_of_targets))));
  }
  return {};
}

std::string about(const verb::ScanPositions& verb, const ScannedAxis& axis) {
  return fmt::format("# scan of {} from {} to {} in {} positions, {} times{}; reached: {}\n",
                     axis.recording.axis, verb.from, verb.to, verb.steps, verb.repeat,
                     verb.both_ways ? ", both ways" : "",
                     axis.has_encoder ? "as the encoder says" : "as commanded, without an encoder");
}

class PositionScan {
 public:
  PositionScan(const verb::ScanPositions& verb, Span span, ScannedAxis axis, Context& context)
      : verb_(verb),
        span_(std::move(span)),
        axis_(std::move(axis)),
        context_(context),
        line_(context.output),
        visits_(visits_of(verb.steps, verb.repeat, verb.both_ways)) {}

  /// Before anything is sent to a module.
  Result<void> open_file();
  Result<void> run();
  const std::vector<Reached>& reached() const { return reached_; }
  const ScannedAxis& axis() const { return axis_; }

 private:
  Result<void> begin_file();
  Result<void> write(const std::string& text);
  Result<void> go_on();
  Result<void> visit(const Visit& visit);
  Result<api::axis::StartedMove> move_to(const tmcl::Quantity& target);
  Result<void> wait(const api::axis::StartedMove& move);
  /// Errors: it is lost.
  Result<void> keep_lease();
  /// Also: a signal came.
  Result<void> attend();
  Result<void> rest();
  Result<void> run_command(const Visit& visit, const Reached& reached);
  Result<void> note(const Reached& reached, RowContext row);
  Result<std::optional<api::parameter::Value>> read_encoder();
  Reached reached_of(const Visit& visit, Approach approach, double target,
                     const AxisReading& reading,
                     const std::optional<api::parameter::Value>& encoder) const;
  double target_of(const tmcl::Quantity& quantity, const api::axis::StartedMove& move) const;
  Error stopped_meanwhile() const;
  /// What has ended the scan, with what became of it.
  Error ended_by(Error failure);

  const verb::ScanPositions& verb_;
  Span span_;
  ScannedAxis axis_;
  Context& context_;
  ProgressLine line_;
  std::vector<Visit> visits_;
  std::vector<Reached> reached_;
  HeldLease lease_;
  OutputFile file_;
  bool begins_file_ = true;
  bool was_sent_ = false;                   ///< The axis, somewhere.
  std::optional<std::uint64_t> last_stop_;  ///< When the scan began.
};

Result<void> PositionScan::open_file() {
  if (verb_.csv.empty() || verb_.csv == "-") return {};
  // An empty one was left by a scan that did not begin.
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(verb_.csv, unknown);
  if (unknown || bytes == 0) return file_.open(verb_.csv);
  if (!verb_.resume)
    return tl::unexpected(usage_error("file_exists", verb_.csv + " is there already",
                                      "--resume goes on with the scan that it is of"));
  const auto text = read_file(verb_.csv, most_bytes_of_file);
  if (!text) return tl::unexpected(usage_error("cannot_read", verb_.csv + ": " + text.error()));
  auto found = read_scan(*text, about(verb_, axis_), scan_columns(axis_.unit()), visits_);
  if (!found)
    return tl::unexpected(usage_error("other_scan",
                                      "cannot go on with " + verb_.csv + ": " + found.error(),
                                      "name another file, or repeat the command that began it"));
  reached_ = std::move(found->visits);
  begins_file_ = found->bytes == 0;
  return file_.open_behind(verb_.csv, found->bytes);
}

Result<void> PositionScan::begin_file() {
  if (verb_.csv.empty()) return {};
  if (!begins_file_) return write("# resumed " + tmcl::to_text(context_.host.utc()) + '\n');
  return write(csv_comments({axis_.recording}, context_) + about(verb_, axis_) +
               scan_columns(axis_.unit()));
}

Result<void> PositionScan::write(const std::string& text) {
  if (verb_.csv != "-") return file_.append(text);
  context_.output.out << text << std::flush;
  return {};
}

Result<void> PositionScan::run() {
  if (reached_.size() == visits_.size()) return {};
  auto lease = HeldLease::take({verb_.axis}, scan_lease_ttl_ms, context_);
  if (!lease) return tl::unexpected(lease.error());
  lease_ = std::move(*lease);
  lease_.pass_on();
  auto ended = go_on();
  line_.clear();
  if (!ended) return tl::unexpected(ended_by(std::move(ended.error())));
  return lease_.release(context_);
}

Result<void> PositionScan::go_on() {
  const auto now = state_of(verb_.axis, context_);
  if (!now) return tl::unexpected(now.error());
  last_stop_ = now->last_stop;
  if (auto begun = begin_file(); !begun) return begun;
  while (reached_.size() < visits_.size()) {
    const auto& next = visits_[reached_.size()];
    line_.show(fmt::format("{}: position {} of {}, pass {} of {}", axis_.recording.axis,
                           next.index + 1, verb_.steps, next.pass, verb_.repeat));
    if (auto visited = visit(next); !visited) return visited;
  }
  return {};
}

Result<void> PositionScan::visit(const Visit& visit) {
  if (auto attended = attend(); !attended) return attended;
  const auto before = state_of(verb_.axis, context_);
  if (!before) return tl::unexpected(before.error());
  if (before->last_stop != last_stop_) return tl::unexpected(stopped_meanwhile());
  const auto quantity = span_.at(visit.index, verb_.steps);
  const auto move = move_to(quantity);
  if (move || move.error().outcome != tmcl::Outcome::not_sent) was_sent_ = true;
  if (!move) return tl::unexpected(move.error());
  if (auto stands = wait(*move); !stands) return stands;
  if (auto rested = rest(); !rested) return rested;
  const auto reading = state_of(verb_.axis, context_);
  if (!reading) return tl::unexpected(reading.error());
  if (reading->last_stop != last_stop_) return tl::unexpected(stopped_meanwhile());
  const auto encoder = read_encoder();
  if (!encoder) return tl::unexpected(encoder.error());
  const auto way = std::int64_t{move->target_microsteps} - before->position_microsteps;
  // In the unit of the axis, which may count the other way.
  const bool is_reverse = axis_.has_unit && axis_.units.scale->reverse;
  const auto approach = way == 0                   ? Approach::none
                        : (way > 0) == !is_reverse ? Approach::up
                                                   : Approach::down;
  const auto reached = reached_of(visit, approach, target_of(quantity, *move), *reading, *encoder);
  if (auto done = run_command(visit, reached); !done) return done;
  RowContext row{tmcl::to_text(context_.host.utc()), move->target_microsteps,
                 reading->position_microsteps};
  if (*encoder) row.encoder = (*encoder)->value;
  return note(reached, std::move(row));
}

Result<api::axis::StartedMove> PositionScan::move_to(const tmcl::Quantity& target) {
  return start_move(verb_.axis, {text_of(target), verb_.internal}, false, context_);
}

Result<void> PositionScan::wait(const api::axis::StartedMove& move) {
  Journey journey{verb_.axis, {move.target_microsteps}, context_.host.now(), follow_interval};
  if (axis_.has_unit) journey.goal_in_unit = in_unit(move.target, move.unit);
  std::optional<Error> lost;
  journey.meanwhile = [&] {
    auto kept = keep_lease();
    if (!kept) lost = kept.error();
    return kept;
  };
  const auto stands = follow(journey, context_, [](const AxisReading&) {});
  if (lost) return tl::unexpected(*lost);
  if (!stands) return tl::unexpected(stands.error());
  return {};
}

Result<void> PositionScan::keep_lease() {
  auto kept = lease_.renew(context_);
  if (!kept) kept.error().kind = ErrorKind::ended_early;
  return kept;
}

Result<void> PositionScan::attend() {
  if (context_.host.signal() != 0)
    return tl::unexpected(interrupted_error(context_.host.signal(), "interrupted", ""));
  return keep_lease();
}

Result<void> PositionScan::rest() {
  const auto end = context_.host.now() + std::chrono::duration_cast<tmcl::Duration>(
                                             std::chrono::duration<double>(verb_.dwell_s));
  while (context_.host.now() < end) {
    if (auto attended = attend(); !attended) return attended;
    context_.sleep(std::min<tmcl::Duration>(scan_look_interval, end - context_.host.now()));
  }
  return {};
}

Result<std::optional<api::parameter::Value>> PositionScan::read_encoder() {
  using Encoder = std::optional<api::parameter::Value>;
  if (!axis_.has_encoder) return Encoder();
  return context_.call(api::parameter::Get{{verb_.axis, encoder_parameter}})
      .map([](api::parameter::Value value) { return Encoder(std::move(value)); });
}

double PositionScan::target_of(const tmcl::Quantity& quantity,
                               const api::axis::StartedMove& move) const {
  if (!axis_.has_unit) return move.target_microsteps;
  // What the position was rounded by is a deviation, too.
  const auto wanted = in_own_unit(quantity, axis_.units);
  return wanted.value_or(move.target.value_or(0));
}

Reached PositionScan::reached_of(const Visit& visit, Approach approach, double target,
                                 const AxisReading& reading,
                                 const std::optional<api::parameter::Value>& encoder) const {
  Reached reached{visit, approach, target};
  if (encoder) {
    reached.reached = axis_.has_unit ? encoder->value_in_unit.value_or(0) : encoder->value;
  } else {
    reached.reached = axis_.has_unit ? reading.position.value_or(0) : reading.position_microsteps;
  }
  return reached;
}

/// For the command: "TMCL_INDEX=3".
void set_for_command(const char* name, const std::string& value) {
  ::setenv(name, value.c_str(), 1);
}

Result<void> PositionScan::run_command(const Visit& visit, const Reached& reached) {
  if (verb_.command.empty()) return {};
  set_for_command("TMCL_AXIS", axis_.recording.axis);
  set_for_command("TMCL_INDEX", std::to_string(visit.index));
  set_for_command("TMCL_PASS", std::to_string(visit.pass));
  set_for_command("TMCL_APPROACH", std::string(name_of(reached.approach)));
  set_for_command("TMCL_TARGET", tmcl::plain_number(reached.target, digits_of_targets));
  set_for_command("TMCL_POSITION", tmcl::plain_number(reached.reached, digits_of_targets));
  set_for_command("TMCL_UNIT", axis_.unit());
  const bool is_output_taken = context_.output.json || verb_.csv == "-";
  line_.clear();
  context_.output.out << std::flush;
  auto program = ChildProcess::start({"/bin/sh", "-c", verb_.command},
                                     is_output_taken ? ChildProcess::Prints::to_standard_error
                                                     : ChildProcess::Prints::as_this_one);
  if (!program) return tl::unexpected(program.error());
  while (!program->exit_code()) {
    if (auto attended = attend(); !attended) {
      program->send(SIGTERM);
      return attended;
    }
    context_.sleep(scan_look_interval);
  }
  const int code = *program->exit_code();
  if (code == 0) return {};
  Error failure{"command_failed", ErrorKind::ended_early, tmcl::Outcome::done,
                fmt::format("'{}' ended with exit code {}", verb_.command, code), ""};
  failure.subject = {{"axis", axis_.recording.axis}, {"command_exit_code", code}};
  return tl::unexpected(std::move(failure));
}

Result<void> PositionScan::note(const Reached& reached, RowContext row) {
  reached_.push_back(reached);
  auto written = write(scan_row(reached, row));
  if (!written) reached_.pop_back();
  return written;
}

Error PositionScan::stopped_meanwhile() const {
  Error failure{"move_interrupted", ErrorKind::ended_early, tmcl::Outcome::done,
                axis_.recording.axis + " was stopped by another program; cause: client",
                "Nothing has moved it since"};
  failure.subject = {{"axis", axis_.recording.axis}, {"stop_cause", "client"}};
  return failure;
}

Error PositionScan::ended_by(Error failure) {
  const auto done = fmt::format("the scan of {} was ended behind {} of {} positions",
                                axis_.recording.axis, reached_.size(), visits_.size());
  const int signal = context_.host.take_signal();
  // Also where the lease is not this program's own, or is lost.
  const bool stopped = !was_sent_ || context_.call(api::axis::Stop{verb_.axis});
  (void)lease_.release(context_);
  const auto hint = file_.is_open() ? std::string(resume_hint) : std::string();
  if (signal != 0) {
    auto interrupted = interrupted_error(
        signal, done + (stopped ? ", and it was stopped" : ", and it may still move"), hint);
    return interrupted;
  }
  failure.message = done + ": " + failure.message;
  if (!failure.hint.empty() && !hint.empty()) failure.hint += ". ";
  failure.hint += hint;
  return failure;
}

// ---- What it says

json::value or_null(const std::optional<double>& value) {
  return value ? json::value(*value) : json::value(nullptr);
}

json::object to_json(const verb::ScanPositions& verb, const PositionScan& scan) {
  const auto found = statistics_of(scan.reached());
  json::array positions;
  for (const auto& position : found.positions)
    positions.push_back(json::object{{"index", position.index},
                                     {"target", position.target},
                                     {"count", position.count},
                                     {"mean_deviation", position.mean_deviation},
                                     {"spread", position.spread},
                                     {"backlash", or_null(position.backlash)}});
  return {{"axis", scan.axis().recording.axis},
          {"unit", scan.axis().unit()},
          {"encoder", scan.axis().has_encoder},
          {"visits", scan.reached().size()},
          {"positions", std::move(positions)},
          {"repeatability", found.repeatability},
          {"backlash", or_null(found.backlash)},
          {"csv", verb.csv.empty() ? json::value(nullptr) : json::value(verb.csv)}};
}

constexpr int digits_of_statistics = 6;

std::string number_text(const std::optional<double>& value) {
  return value ? tmcl::plain_number(*value, digits_of_statistics) : "-";
}

void show(const PositionScan& scan, Output& output) {
  const auto found = statistics_of(scan.reached());
  const auto unit = scan.axis().unit();
  Table table({"POSITION [" + unit + "]", "VISITS", "MEAN DEVIATION", "SPREAD", "BACKLASH"});
  for (const auto& position : found.positions)
    table.add({number_text(position.target), std::to_string(position.count),
               number_text(position.mean_deviation), number_text(position.spread),
               number_text(position.backlash)});
  table.print(output);
  output.out << fmt::format("repeatability {} {}, backlash {}{}\n",
                            number_text(found.repeatability), unit, number_text(found.backlash),
                            found.backlash ? ' ' + unit : "");
  if (!scan.axis().has_encoder)
    output.out << "These are positions as commanded: the configuration names no encoder "
                  "(encoder_lines). --encoder reads it all the same.\n";
}

Result<ExitCode> run(const verb::ScanPositions& verb, Context& context) {
  auto span = span_of(verb);
  if (!span) return tl::unexpected(span.error());
  auto axis = look_at(verb, context);
  if (!axis) return tl::unexpected(axis.error());
  if (auto within = check_limits(*span, *axis); !within) return tl::unexpected(within.error());
  PositionScan scan(verb, std::move(*span), std::move(*axis), context);
  if (auto opened = scan.open_file(); !opened) return tl::unexpected(opened.error());
  if (auto scanned = scan.run(); !scanned) return tl::unexpected(scanned.error());
  if (context.output.json) {
    print_json(to_json(verb, scan), context.output);
  } else if (verb.csv != "-") {
    show(scan, context.output);
  }
  return ExitCode::done;
}

constexpr const char* scan_positions_help = R"(
Moves to --steps positions, both ends included, one after the other, stands there for --dwell, runs the
command of --at, and writes a row with what was really reached: what the encoder says where the axis has
one (encoder_lines in the configuration, or --encoder), else the position as commanded. --repeat goes
through them again, --both-ways back from the last to the first as well. In the end it says of each
position by how much the axis was off in the mean, how far apart it came to stand from one side (spread),
and between what came from above and from below (backlash).

The command runs in a shell, with TMCL_AXIS, TMCL_INDEX (from 0), TMCL_PASS (from 1), TMCL_APPROACH (up,
down, none), TMCL_TARGET, TMCL_POSITION (what was reached) and TMCL_UNIT. One that fails ends the scan.

The axis is leased meanwhile. Ctrl-C, a stop by another program and every error end the scan, and the axis
is stopped. The same command with --resume goes on behind the last row of its file.

  exit 2   also: the file is there already, or is of another scan
       5   the axis was stopped, or the command failed: the row of that position is not written

  tmclctl scan-positions x --from 0mm --to 10mm --steps 21 --dwell 0.2s --csv scan.csv
  tmclctl scan-positions x --from 0mm --to 10mm --steps 21 --repeat 5 --both-ways --csv scan.csv --resume
  tmclctl scan-positions x --from 0mm --to 10mm --steps 3 --at ./measure.sh
)";

}  // namespace

void add_scan_positions(Grammar& grammar) {
  auto scan = grammar.verb<verb::ScanPositions>(
      "scan-positions", access::acts, "Visit positions, and say how well they were reached",
      scan_positions_help, run);
  scan.axis(scan->axis);
  auto& values = *scan.operator->();
  scan.required_option("--from", "POSITION", "The first position", text(values.from));
  scan.required_option("--to", "POSITION", "The last one", text(values.to));
  scan.required_option("--steps", "N", "How many positions, both ends included",
                       number(values.steps, 2, most_steps));
  scan.option("--dwell", "TIME", "Stand so long at each, such as 0.2s or 200ms",
              [&values](const std::string& text) {
                return read_time(text, 0, longest_dwell_s, values.dwell_s);
              });
  scan.option("--repeat", "N", "Go through them so many times",
              number(values.repeat, 1, most_passes));
  scan.flag("--both-ways", "Go back from the last to the first as well", values.both_ways);
  scan.option("--at", "COMMAND", "Run this at each position", text(values.command));
  scan.option("--csv", "FILE", "Write a row for each; '-': to standard output", text(values.csv));
  scan.flag("--resume", "Go on with the scan that the file is of", values.resume);
  scan.flag("--encoder", "The axis has an encoder that the configuration does not name",
            values.encoder);
  scan.internal(values.internal);
  scan.object([](const verb::ScanPositions& said, bool json) {
    if (said.resume && (said.csv.empty() || said.csv == "-")) return "--resume needs --csv FILE";
    const auto all = static_cast<std::size_t>(said.steps) * static_cast<std::size_t>(said.repeat);
    if (all > most_visits) return "that is more than a million positions";
    return json && said.csv == "-" ? "--json and '--csv -' both want standard output" : "";
  });
}

}  // namespace tmclctl
