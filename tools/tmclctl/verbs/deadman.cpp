// deadman set, deadman off, deadman test.
#include <fmt/format.h>

#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/deadman.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

std::string text_of(const api::axis::TestedDeadman& tested) {
  const auto* found = std::get_if<api::axis::Deadman>(&tested.deadman.said);
  if (found == nullptr) return "no deadman: " + tested.reason.value_or("its module has none");
  return fmt::format("its module stops it {} ms after the last command (set to {} ms)",
                     found->measured, found->ms);
}

}  // namespace

Result<ExitCode> run(const verb::SetDeadman& verb, Context& context) {
  const api::axis::SetDeadman params{.axis = verb.axis, .ms = verb.ms};
  const auto result = context.call(params);
  if (!result) return tl::unexpected(result.error());
  if (context.output.json) {
    print_json(api::to_json(*result), context.output);
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
    print_json(api::to_json(tested), context.output);
  } else {
    context.output.out << fmt::format("{}: {}; it has gone {} microsteps\n", verb.axis,
                                      text_of(tested), tested.way_microsteps);
  }
  // Who tests it wants to know that it works.
  const bool works = std::holds_alternative<api::axis::Deadman>(tested.deadman.said);
  return works ? ExitCode::done : ExitCode::not_reached;
}

}  // namespace tmclctl
