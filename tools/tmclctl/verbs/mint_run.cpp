// mint run.
#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "path/path_source.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/plan/mint.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

// Checking a long program takes a while.
constexpr auto longest_mint_silence = std::chrono::seconds(120);

/// "0=x"
Result<void> add_choice(const std::string& choice, api::mint::Run& run) {
  const auto equals = choice.find('=');
  std::uint8_t number = 0;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + equals, number);
  if (error != std::errc{} || end != choice.data() + equals ||
      number >= tmcl::plan::mint::most_axes) {
    return tl::unexpected(
        usage_error("unknown_axis", fmt::format("--axis {}: Mint's axes are 0 to {}", choice,
                                                tmcl::plan::mint::most_axes - 1)));
  }
  run.axes.push_back(choice.substr(equals + 1));
  if (!run.numbers) run.numbers.emplace();
  run.numbers->push_back(number);
  return {};
}

// Axis 0 is the first that there is, unless the command line says which is which.
Result<api::mint::Run> params_of(const verb::RunMint& verb, Context& context) {
  api::mint::Run run;
  if (verb.counts_encoder) run.counts = "encoder";
  for (const auto& choice : verb.axes) {
    if (const auto added = add_choice(choice, run); !added) return tl::unexpected(added.error());
  }
  if (!verb.axes.empty()) return run;
  return axes_of(context).map([&](const std::vector<AxisRow>& rows) {
    for (const auto& row : rows)
      if (run.axes.size() < tmcl::plan::mint::most_axes) run.axes.push_back(row.name);
    return run;
  });
}

/// What is told while a program runs: every member of the kinds of news that there are.
struct MintNews : api::MintProgress {
  TMCL_STRUCT(MintNews, api::MintProgress);
  TMCL_FIELD(std::vector<api::MintAxis>, axes, "once checked");
  TMCL_FIELD(std::vector<std::string>, remarks, "once checked");
};

/// Follows a program by what the gateway tells of it.
class Audience {
 public:
  Audience(std::vector<std::string> axes, bool names_axes, Context& context)
      : axes_(std::move(axes)), names_axes_(names_axes), context_(context), line_(context.output) {}

  void hear(const MintNews& news) {
    if (news.phase == "checked") {
      tell_axes(news.axes);
      warn(news.remarks, context_.output);
    } else if (news.phase == "stands") {
      tell_group(news.line, news.passed_s, news.duration_s);
    } else {
      go_ = news.line;
      show(news.passed_s, news.duration_s);
    }
  }
  /// A signal stops all axes, which ends the program.
  void look() {
    if (signal_ == 0) signal_ = context_.host.take_signal();
    if (signal_ == 0 || has_stopped_) return;
    has_stopped_ = true;
    for (const auto& axis : axes_) {
      const auto stopped = context_.call(api::axis::Stop{axis});
      if (stopped) continue;
      context_.output.err << "tmclctl: " << axis << " NOT stopped: "
                          << error_text(stopped.error(), context_.output.gateway) << '\n';
    }
  }
  /// Those of the groups that were not heard of.
  void tell_rest(const api::mint::Ran& report) {
    for (auto i = told_; i < report.groups.size(); ++i) {
      const auto& group = report.groups[i];
      tell_group(static_cast<std::uint64_t>(group.line), group.took_s, group.planned_s);
    }
    line_.clear();
    warn(report.remarks, context_.output);
  }
  int signal() const { return signal_; }
  std::uint64_t go() const { return go_; }

 private:
  void tell_axes(const std::vector<api::MintAxis>& axes) {
    if (!names_axes_ || context_.output.json) return;
    for (const auto& axis : axes)
      context_.output.out << fmt::format("axis {} is {}\n", axis.number, axis.axis);
  }
  void tell_group(std::uint64_t line, double took_s, double planned_s) {
    ++told_;
    if (context_.output.json) return;
    line_.clear();
    context_.output.out << fmt::format("GO of line {}: {:.3f} s, planned {:.3f} s", line, took_s,
                                       planned_s)
                        << std::endl;
  }
  void show(double passed_s, double planned_s) {
    const double done = planned_s > 0 ? std::clamp(passed_s / planned_s, 0.0, 1.0) : 1;
    line_.show(fmt::format("at the GO of line {}: {} {:.1f} of {:.1f} s", go_,
                           bar(done, usual_bar_width, line_.screen().utf8), passed_s, planned_s));
  }

  std::vector<std::string> axes_;
  bool names_axes_;
  Context& context_;
  ProgressLine line_;
  std::size_t told_ = 0;
  std::uint64_t go_ = 0;  // the line of the GO that is under way
  bool has_stopped_ = false;
  int signal_ = 0;
};

Result<api::mint::Ran> run_followed(const std::string& text, api::mint::Run run, Audience& audience,
                                    Context& context) {
  const tmcl::client::CallOptions options{longest_mint_silence, [&] { audience.look(); }};
  const auto staged = path::hand_over(text, run, context, options);
  if (!staged) return tl::unexpected(staged.error());
  const tmcl::client::Hearing<MintNews> hearing(context.gateway.caller, api::progress_notification,
                                                [&](const MintNews& news) { audience.hear(news); });
  return context.call(run, options);
}

Result<ExitCode> run(const verb::RunMint& verb, Context& context) {
  const auto text = path::text_of(verb.file, path::most_mint_bytes);
  if (!text) return tl::unexpected(text.error());
  const auto params = params_of(verb, context);
  if (!params) return tl::unexpected(params.error());
  Audience audience(params->axes, verb.axes.empty(), context);
  auto result = run_followed(*text, *params, audience, context);
  if (!result) {
    audience.tell_rest(path::part_done<api::mint::Ran>(result.error()));
    auto failure = path::explained(std::move(result.error()), verb.file, context.output);
    if (audience.signal() == 0) return tl::unexpected(std::move(failure));
    const auto where = fmt::format("stopped at the GO of line {}", audience.go());
    return tl::unexpected(interrupted_error(
        audience.signal(), audience.go() > 0 ? where : "stopped before anything moved", "",
        std::move(failure.subject)));
  }
  audience.tell_rest(*result);
  if (context.output.json)
    print_json({{"file", verb.file}, {"groups", api::write_value(result->groups)}}, context.output);
  return ExitCode::done;
}

constexpr const char* mint_run_help = R"(
Runs a program as 'tmclctl mint check' reads it. Positions are counts: SCALE microsteps are a user unit,
or, with --counts encoder, SCALE counts of the axis' encoder, which the configuration must know.
Each GO sets the ramps of its axes to SPEED, ACCEL and DECEL, starts them together, and waits until all
stand. Axis 0 is the first that 'tmclctl axes' lists, unless --axis says which is which. Nothing moves
unless every axis is there, stands, and can go everywhere the program sends it. Ctrl-C stops all axes.
The ramps' parameters are set back at the end.

  tmclctl mint run exercise.mint
  tmclctl mint run two.mint --axis 0=x --axis 1=y
  tmclctl mint run exercise.mint --axis 0=z --counts encoder
)";

}  // namespace

void add_mint_run(Grammar& grammar, const Form& group) {
  auto form = grammar.verb<verb::RunMint>(group, "run", access::tells,
                                          "Move axes as a Mint program says", mint_run_help, run);
  form.word("FILE", "The program", text(form->file));
  auto& said = *form.operator->();
  form.repeated_option("--axis", "NUMBER=AXIS", "Which axis the program's axis of this number is",
                       named_axes(said.axes));
  form.option("--counts", "WHAT", "What SCALE counts: microsteps (default), or encoder",
              [&said](const std::string& text) -> Reading {
                said.counts_encoder = text == "encoder";
                if (said.counts_encoder || text == "microsteps") return {};
                return tl::unexpected(fmt::format("'{}' is neither microsteps nor encoder", text));
              });
}

}  // namespace tmclctl
