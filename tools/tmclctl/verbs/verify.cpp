// verify: a module held against its twin.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "measured_travel.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/api/verify.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

std::string found_text(const api::axis::VerifiedTrait& trait) {
  if (!trait.measured) return "not measured";
  return trait.fits.empty() ? "like none known" : fmt::format("{}", fmt::join(trait.fits, " or "));
}

/// Of the traits that were measured.
struct Verdicts {
  std::size_t measured = 0;
  std::size_t others = 0;     ///< What was foreseen does not fit.
  std::size_t undecided = 0;  ///< It fits, and so does another variant.

  void add(const api::axis::VerifiedTrait& trait) {
    if (!trait.measured) return;
    ++measured;
    const bool fits = std::ranges::find(trait.fits, trait.foreseen) != trait.fits.end();
    if (!fits) ++others;
    if (fits && trait.fits.size() > 1) ++undecided;
  }
  std::string text() const {
    auto text = others == 0 ? std::string("the module is as its twin")
                            : fmt::format("{} not as foreseen", others);
    return undecided == 0 ? text : fmt::format("{}; {} not decided", text, undecided);
  }
};

void print(const api::axis::Verified& found, Output& output) {
  output.out << fmt::format("{}, firmware {}", found.model, found.firmware);
  if (found.answer_us)
    output.out << fmt::format(", answers within {:.2f} ms",
                              static_cast<double>(*found.answer_us) / 1000);
  output.out << '\n';
  Table table({"TRAIT", "TWIN", "MODULE", ""});
  Verdicts verdicts;
  for (const auto& trait : found.traits) {
    table.add({trait.trait, trait.foreseen, found_text(trait), trait.text});
    verdicts.add(trait);
  }
  table.print(output);
  output.out << fmt::format("{} of {} traits measured; {}\n", verdicts.measured,
                            found.traits.size(), verdicts.text());
}

api::axis::Verify params_of(const verb::Verify& verb) {
  const Typed from{verb.travel.from, verb.internal};
  const Typed to{verb.travel.to, verb.internal};
  return {verb.axis, from.counted(), from.amount(), to.counted(), to.amount()};
}

Result<ExitCode> run(const verb::Verify& verb, Context& context) {
  const auto wanted = may_be_measured(verb.axis, verb.travel, verb.yes, context);
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

constexpr const char* verify_module_help = R"(
What a move will do is foreseen by a twin of the module's ramp generator, and some of what chips and
firmware do is in no document. This finds it out: small, slow moves, up to a hundred microsteps, and some
questions. Each move is watched, and every known variant that could not have moved like this is out. The
table says for each trait what the twin has, what the module was found to be, and how that is known, or
why it is not: a trait whose variants differ by milliseconds does not show on a line of 9600 baud.

The axis ends where it began, and has the settings that it had. Currents are never touched. A value out of
range is sent that a module without a check cuts to what it has, and one question to an address that no
module here has. No other client can move or set the axis meanwhile; a stop, or Ctrl-C, ends it: the axis stands
then, and gets its settings back. It takes a minute or less.

--report writes a file that says all this, for a person and for programs: 'tmclsim --module MODEL --as FILE'
makes a simulated module like it, and 'as' in a [[module]] of tmcld.toml a twin.

  tmclctl verify x --travel -2mm..2mm
  tmclctl verify x --yes --report x.toml
  tmclctl verify 1/0 --travel -100..100 --yes --report -
)";

}  // namespace

void add_verify(Grammar& grammar) {
  auto verify = grammar.verb<verb::Verify>("verify", access::acts,
                                           "Find out in what a module is not like its twin",
                                           verify_module_help, run);
  verify.axis(verify->axis);
  auto& values = *verify.operator->();
  verify.option("--travel", "FROM..TO",
                "How far it may go from where it stands; without it, to its soft limits",
                [&values](const std::string& said) { return read_travel(said, values.travel); });
  verify.option("--report", "FILE", "Write what was found; '-': to standard output",
                text(verify->report));
  verify.flag("--yes", "Do not ask whether the axis may move", verify->yes);
  verify.internal(verify->internal);
  verify.object([](const verb::Verify& said, bool json) {
    return json && said.report == "-" ? "--json and '--report -' both want standard output" : "";
  });
}

}  // namespace tmclctl
