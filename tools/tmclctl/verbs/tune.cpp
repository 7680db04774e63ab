// tune: what an axis bears, found by trials.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "measured_travel.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/api/tune.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using api::axis::Tuned;
using api::axis::TunedValue;
using api::axis::TuneTrial;

constexpr double greatest_margin_percent = 1000;
constexpr std::int32_t most_current = 255;

std::string pulses(double value) { return tmcl::plain_number(value, 6); }

// ---- the picture ------------------------------------------------------------------------------

/// Trials for one of the values on a line, from the least to the greatest, an equal way for each
/// doubling.
struct Strip {
  std::string_view sought;
  double (*value)(const TuneTrial& trial);
};
constexpr std::size_t strip_width = 50;

std::string drawn(const Strip& strip, const std::vector<TuneTrial>& trials) {
  std::vector<const TuneTrial*> shown;
  for (const auto& trial : trials)
    if (trial.sought == strip.sought && strip.value(trial) > 0) shown.push_back(&trial);
  if (shown.empty()) return {};
  const auto value = [&](const TuneTrial* trial) { return strip.value(*trial); };
  const auto [least, most] = std::ranges::minmax(shown, {}, value);
  const double low = value(least);
  const double span = std::max(std::log(value(most) / low), 1e-9);
  std::string line(strip_width, ' ');
  for (const auto* trial : shown) {
    const auto part = std::log(value(trial) / low) / span;
    auto& place = line[static_cast<std::size_t>(std::lround(part * (strip_width - 1)))];
    // What was lost is seen, wherever others held.
    if (place != 'x') place = trial->held ? 'o' : 'x';
  }
  return fmt::format("{:<13}|{}| {} to {}\n", strip.sought, line, pulses(low), pulses(value(most)));
}

std::string picture(const Tuned& tuned) {
  const Strip strips[] = {
      {"velocity", [](const TuneTrial& trial) { return trial.velocity_pps; }},
      {"acceleration", [](const TuneTrial& trial) { return trial.acceleration_pps2; }},
      {"current", [](const TuneTrial& trial) { return static_cast<double>(trial.current); }},
      {"hold", [](const TuneTrial& trial) { return static_cast<double>(trial.current); }}};
  std::string text;
  for (const auto& strip : strips) text += drawn(strip, tuned.trials);
  return text;
}

// ---- what was found ---------------------------------------------------------------------------

std::string why_no_more(const TunedValue& value) {
  if (value.limited_by == "travel") return "the travel is too short for more";
  if (value.limited_by == "bounds") return "no more was tried";
  return "beyond that it lost steps";
}

std::string why_this_bow(const api::axis::TunedBow& bow) {
  if (!bow.resonance_hz) return "no swing was found: as it was";
  return fmt::format("the load swings at {} Hz, at rest by {} microsteps, before by {}",
                     tmcl::plain_number(*bow.resonance_hz, 4), tmcl::plain_number(bow.swing, 3),
                     tmcl::plain_number(bow.swing_before, 3));
}

/// What to type to have it.
std::vector<std::string> next_words(const verb::Tune& verb, const Tuned& tuned) {
  std::vector<std::string> lines;
  for (const auto& setting : tuned.settings) {
    if (setting.value == setting.before) continue;
    const auto name = setting.name.empty() ? std::to_string(setting.parameter) : setting.name;
    lines.push_back(fmt::format("tmclctl set {} {} {}", verb.axis, name, setting.value));
  }
  return lines;
}

void print(const verb::Tune& verb, const Tuned& tuned, Output& output) {
  Table table({"", "LIMIT", "PROPOSED", ""});
  const auto row = [&](const char* name, const TunedValue& value, const char* unit,
                       const std::string& why) {
    table.add({name, pulses(value.limit) + unit, pulses(value.proposed) + unit, why});
  };
  row("velocity", tuned.velocity, "pps", why_no_more(tuned.velocity));
  row("acceleration", tuned.acceleration, "pps/s", why_no_more(tuned.acceleration));
  const bool is_least = tuned.current.limited_by == "motor";
  row("current", tuned.current, "", is_least ? "below that it lost steps" : "no less was tried");
  if (tuned.hold_current) {
    const bool was_seen = tuned.hold_current->limited_by == "motor";
    row("hold current", *tuned.hold_current, "",
        was_seen ? "below that it slid at rest" : "nothing moved it at rest: as it was");
  }
  if (tuned.threshold)
    table.add({"threshold", "", std::to_string(*tuned.threshold), "the load value keeps off 0"});
  if (tuned.bow) table.add({"bow", "", std::to_string(tuned.bow->value), why_this_bow(*tuned.bow)});
  table.print(output);
  output.out << picture(tuned);
  const auto held = std::ranges::count(tuned.trials, true, &TuneTrial::held);
  output.out << fmt::format("{} trials, {} of them held (o); backlash {} microsteps\n",
                            tuned.trials.size(), held, pulses(tuned.backlash));
  if (tuned.stored) {
    output.out << "this is set and stored\n";
    return;
  }
  for (const auto& line : next_words(verb, tuned)) output.out << line << '\n';
}

api::axis::Tune method_of(const verb::Tune& verb) {
  const Typed from{verb.travel.from, verb.internal};
  const Typed to{verb.travel.to, verb.internal};
  api::axis::Tune method;
  method.axis = verb.axis;
  method.max_current = verb.max_current;
  method.from_microsteps = from.counted();
  method.from = from.amount();
  method.to_microsteps = to.counted();
  method.to = to.amount();
  constexpr double percent = 100;
  if (verb.margin_percent) method.margin = *verb.margin_percent / percent;
  if (verb.store) method.store = true;
  if (!verb.by_switch.empty()) method.by_switch = verb.by_switch;
  return method;
}

/// tmcld tells of each trial, and one may go slowly through all of the travel.
constexpr auto longest_trial = std::chrono::minutes(10);

Result<ExitCode> run(const verb::Tune& verb, Context& context) {
  const auto wanted = may_be_measured(verb.axis, verb.travel, verb.yes, context);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!*wanted) {
    context.output.err << "Nothing was moved\n";
    return ExitCode::refused;
  }
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::axis::TuneProgress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::axis::TuneProgress& progress) {
        line.show(fmt::format("{}: {}", verb.axis, progress.text));
      });
  const auto tuned = context.call(method_of(verb), {.timeout = longest_trial, .meanwhile = {}});
  line.clear();
  if (!tuned) return tl::unexpected(tuned.error());
  warn(tuned->warnings, context.output);
  if (context.output.json) {
    print_json(api::to_json(*tuned), context.output);
  } else {
    print(verb, *tuned, context.output);
  }
  return ExitCode::done;
}

constexpr const char* tune_help = R"(
Finds what the axis bears, by moves there and back within its travel, whose steps its encoder counts:
the greatest velocity with the acceleration that the axis has, then the greatest acceleration at the
velocity that is proposed, then the least current for both, where the module has stallGuard2 the least
threshold with which its load value keeps off 0, the least standby current with which the axis stands, and
on a TMC457 the bow with which a load that swings stands first. Proposed is less than the limit by
--margin, of currents more. In the end all of it is made twice on all of the travel.

An axis without an encoder needs --switch left or right: after each trial it goes slowly to that limit
switch, which must stop it within the travel, and steps that were lost are seen only then. With an encoder
a trial ends at the first sign of
trouble: the encoder is four full steps from where it should be, or half a full step when the axis
stands. The motor is stopped, the position is set again as the encoder has it, and less is tried; so an
axis that has lost steps has lost its reference, and is to search it again.

The axis moves at the edge of what it can do, again and again: nothing may be in its way, and no hand
near it. A load that hangs falls where steps are lost, until the motor stands, and slides a little where
the standby current is too small. With soft limits it must have searched its reference. No other client can move or set it
meanwhile. It ends where it began with the settings that it had, unless --store says to keep what is
proposed; a stop, or Ctrl-C, ends it, and it gets its settings back. --max-current is never exceeded.

Not found: the bows of other modules ('tmclctl resonance' measures the load for 'tmclctl ramp --compare'),
and what changes with temperature, wear, and supply. docs/TUNING.md says more.

  tmclctl tune x --max-current 200 --travel -50mm..50mm
  tmclctl tune x --max-current 200 --margin 50 --store --yes
  tmclctl tune z --max-current 150 --switch left --travel -60mm..0mm
)";

}  // namespace

void add_tune(Grammar& grammar) {
  auto tune = grammar.verb<verb::Tune>("tune", access::acts,
                                       "Find the velocity, acceleration and current of an axis",
                                       tune_help, run);
  tune.axis(tune->axis);
  auto& values = *tune.operator->();
  tune.required_option("--max-current", "VALUE",
                       "The greatest current that may flow, as parameter max_current counts it",
                       number(values.max_current, 1, most_current));
  tune.option("--travel", "FROM..TO",
              "How far it may go from where it stands; without it, to its soft limits",
              [&values](const std::string& said) { return read_travel(said, values.travel); });
  tune.option("--switch", "left|right",
              "The limit switch that tells lost steps; without it, the encoder",
              text(values.by_switch));
  tune.option("--margin", "PERCENT", "How much more than what is proposed held (default: 20)",
              number(values.margin_percent, 0, greatest_margin_percent));
  tune.flag("--store", "Set what is proposed, and keep it in the EEPROM", tune->store);
  tune.flag("--yes", "Do not ask whether the axis may move", tune->yes);
  tune.internal(tune->internal);
}

}  // namespace tmclctl
