// scan-positions.
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "axis/position_visits.hpp"
#include "axis/recording_csv.hpp"
#include "output/print.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/quantity.hpp"
#include "verbs.hpp"
#include "verbs/position_scan.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

constexpr std::int32_t most_steps = 10'000;
constexpr std::int32_t most_passes = 1'000;
constexpr std::size_t most_visits = 1'000'000;
constexpr double longest_dwell_s = 3600;

// ---- Where the axis is to go

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

// ---- The axis

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
  const auto read = context.call(api::parameter::Get{{verb.axis, encoder_of_scan}});
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
        fmt::format("{} is beyond the soft limits of {}", text_of_target(end), axis.recording.axis),
        fmt::format("{} to {}", tmcl::plain_number(limits->least.value, digits_of_targets),
                    tmcl::plain_number(limits->greatest.value, digits_of_targets))));
  }
  return {};
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
