// verify: a module held against its twin.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "output_file.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/verify.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

std::string where_to(const verb::Verify& verb) {
  if (verb.travel_from.empty()) return "within its soft limits";
  return fmt::format("between {} and {} from where it stands", verb.travel_from, verb.travel_to);
}

/// Nobody is there to ask: that is an error.
Result<bool> is_wanted(const verb::Verify& verb, Context& context) {
  if (verb.yes) return true;
  const auto question = fmt::format("{} will move, {}. Nothing may be in its way. Go on? [y/N] ",
                                    verb.axis, where_to(verb));
  const auto said = context.host.confirm(question);
  if (said) return *said;
  return tl::unexpected(usage_error("bad_argument",
                                    "the axis would move, and nobody is there to be asked",
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

json::object params_of(const verb::Verify& verb) {
  json::object params{{"axis", verb.axis}};
  if (verb.travel_from.empty()) return params;
  put(params, "from", "from_microsteps", {verb.travel_from, verb.internal});
  put(params, "to", "to_microsteps", {verb.travel_to, verb.internal});
  return params;
}

}  // namespace

VerbResult run(const verb::Verify& verb, Context& context) {
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
  const auto result =
      context.target.perform("axis.verify", params_of(verb), [&](const json::object& news) {
        const auto progress = api::from_json<api::axis::VerifyProgress>(news);
        line.show(fmt::format("{}: {}", verb.axis, progress.text));
        return context.host.signal() == 0;
      });
  line.clear();
  if (!result) return tl::unexpected(result.error());
  const auto found = api::from_json<api::axis::Verified>(*result);
  if (auto written = file.write(found.report); !written) return tl::unexpected(written.error());
  if (to_output) {
    context.output.out << found.report;
  } else if (context.output.json) {
    print_json(*result, context.output);
  } else {
    print(found, context.output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl
