// verify: a module held against its twin.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "output_file.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/api/verify.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

std::string where_to(const verb::Verify& verb) {
  if (verb.travel_from.empty()) return "within its soft limits";
  return fmt::format("between {} and {} from where it stands", verb.travel_from, verb.travel_to);
}

/// Without a person to ask: that is an error.
Result<bool> is_wanted(const verb::Verify& verb, Context& context) {
  if (verb.yes) return true;
  const auto question = fmt::format("{} will move, {}. Nothing may be in its way. Go on? [y/N] ",
                                    verb.axis, where_to(verb));
  const auto said = context.host.confirm(question);
  if (said) return *said;
  return tl::unexpected(
      usage_error("bad_argument", "the axis would move, and there is no terminal to confirm it at",
                  "--yes says that it may"));
}

std::string found_text(const api::axis::VerifiedTrait& trait) {
  if (!trait.measured) return "not measured";
  return trait.fits.empty() ? "like none known" : fmt::format("{}", fmt::join(trait.fits, " or "));
}

bool is_as_foreseen(const api::axis::VerifiedTrait& trait) {
  return trait.fits.size() == 1 && trait.fits.front() == trait.foreseen;
}

void print(const api::axis::Verified& found, Output& output) {
  output.out << fmt::format("{}, firmware {}", found.model, found.firmware);
  if (found.answer_us)
    output.out << fmt::format(", answers within {:.2f} ms",
                              static_cast<double>(*found.answer_us) / 1000);
  output.out << '\n';
  Table table({"TRAIT", "TWIN", "MODULE", ""});
  std::size_t measured = 0;
  std::size_t others = 0;
  for (const auto& trait : found.traits) {
    table.add({trait.trait, trait.foreseen, found_text(trait), trait.text});
    if (trait.measured) ++measured;
    if (trait.measured && !is_as_foreseen(trait)) ++others;
  }
  table.print(output.out);
  output.out << fmt::format(
      "{} of {} traits measured; {}\n", measured, found.traits.size(),
      others == 0 ? "the module is as its twin" : fmt::format("{} not as foreseen", others));
}

api::axis::Verify params_of(const verb::Verify& verb) {
  const Typed from{verb.travel_from, verb.internal};
  const Typed to{verb.travel_to, verb.internal};
  return {verb.axis, from.counted(), from.amount(), to.counted(), to.amount()};
}

}  // namespace

Result<ExitCode> run(const verb::Verify& verb, Context& context) {
  const auto wanted = is_wanted(verb, context);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!*wanted) {
    context.output.err << "Nothing was moved\n";
    return ExitCode::refused;
  }
  OutputFile file;
  const bool to_output = verb.report == "-";
  if (auto opened = file.open(to_output ? "" : verb.report); !opened)
    return tl::unexpected(opened.error());
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::axis::VerifyProgress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::axis::VerifyProgress& progress) {
        line.show(fmt::format("{}: {}", verb.axis, progress.text));
      });
  const auto result = context.call(params_of(verb));
  line.clear();
  if (!result) return tl::unexpected(result.error());
  const auto& found = *result;
  if (auto written = file.write(found.report); !written) return tl::unexpected(written.error());
  if (to_output) {
    context.output.out << found.report;
  } else if (context.output.json) {
    print_json(api::to_json(found), context.output);
  } else {
    print(found, context.output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl
