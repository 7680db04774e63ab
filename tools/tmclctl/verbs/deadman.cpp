// deadman set, deadman off, deadman test.
#include <fmt/format.h>

#include "config/feeding.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/deadman.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

/// The same, saying which axis it is about.
boost::json::object about(const std::string& axis, boost::json::object document) {
  document["axis"] = axis;
  return document;
}

namespace api = tmcl::api;

std::string text_of(const api::axis::TestedDeadman& tested) {
  const auto* found = std::get_if<api::axis::Deadman>(&tested.deadman.said);
  if (found == nullptr) return "no deadman: " + tested.reason.value_or("its module has none");
  return fmt::format("its module stops it {} ms after the last command (set to {} ms)",
                     found->measured, found->ms);
}

Result<ExitCode> run(const verb::SetDeadman& verb, Context& context) {
  const api::axis::SetDeadman params{.axis = verb.axis, .ms = verb.ms};
  const auto result = context.call(params);
  if (!result) return tl::unexpected(result.error());
  if (context.output.json) {
    print_json(about(verb.axis, api::to_json(*result)), context.output);
  } else if (verb.ms == 0) {
    context.output.out << verb.axis << ": the deadman of its module is off\n";
  } else {
    context.output.out << fmt::format(
        "{0}: its module is set to stop its motors {1} ms after the last command; "
        "'tmclctl deadman test {0}' sees whether it does\n",
        verb.axis, verb.ms);
  }
  return ExitCode::done;
}

Result<ExitCode> run(const verb::TestDeadman& verb, Context& context) {
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::DeadmanProgress> hearing(
      context.gateway.caller, api::progress_notification, [&](const api::DeadmanProgress& plan) {
        line.show(fmt::format("{} goes {} microsteps at most; its module is sent nothing for {} s",
                              verb.axis, plan.way_microsteps,
                              static_cast<double>(plan.silence_ms) / 1000));
      });
  const auto result = context.call(api::axis::TestDeadman{verb.axis});
  line.clear();
  if (!result) return tl::unexpected(result.error());
  const auto& tested = *result;
  if (context.output.json) {
    print_json(about(verb.axis, api::to_json(tested)), context.output);
  } else {
    context.output.out << fmt::format("{}: {}; it has gone {} microsteps\n", verb.axis,
                                      text_of(tested), tested.way_microsteps);
  }
  // Who tests it wants to know that it works.
  const bool works = std::holds_alternative<api::axis::Deadman>(tested.deadman.said);
  return works ? ExitCode::done : ExitCode::not_reached;
}

constexpr const char* deadman_help = R"(
A module can stop its motors by itself when no host has sent it anything for a time: when this computer
has failed, tmcld hangs, or the cable is cut. The time is kept in the module's EEPROM, and holds for every
other host, too, and for programs in the module: one that starts a program by itself is not set. tmcld
sends something to a module that it has set in every third of the time; 'deadman_ms' in its configuration
sets it for good. With --direct it holds from the moment on at which tmclctl ends.

That a module keeps the time does not prove that it heeds it. 'test' turns the axis for some tenths of a
turn within its soft limits, not faster than its max_velocity, sends its module nothing for four times the
time, and tells when it has stopped. All its other motors must stand. Other calls to the module wait until
then; a stop, or Ctrl-C, ends the test. tmcld remembers what was found: 'tmclctl --json modules' shows it.

  exit 0   'test': the module has stopped its motor
       5   'test': it has not, or its deadman is off

  tmclctl deadman set x 1000
  tmclctl deadman test x
  tmclctl deadman off x
)";

}  // namespace

void add_deadman(Grammar& grammar) {
  const auto group = grammar.group(
      "deadman", "Modules that stop their motors when no host is there", deadman_help);
  auto set = grammar.verb<verb::SetDeadman>(
      group, "set", access::acts, "Switch it on, in the module's EEPROM", deadman_help, run);
  set.axis(set->axis);
  set.word("MS", "How long after the last command it stops them, 100 to 65535",
           number(set->ms, tmcld::shortest_deadman_ms, tmcld::longest_deadman_ms));
  auto off = grammar.verb<verb::SetDeadman>(
      group, "off", access::acts, "Switch it off, in the module's EEPROM", deadman_help, run);
  off.axis(off->axis);
  auto test = grammar.verb<verb::TestDeadman>(
      group, "test", access::acts,
      "Move the axis slowly, send its module nothing, and see when it stops", deadman_help, run);
  test.axis(test->axis);
}

}  // namespace tmclctl
