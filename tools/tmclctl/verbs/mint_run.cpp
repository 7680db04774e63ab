// mint run.
#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "following.hpp"
#include "json_read.hpp"
#include "path/path_source.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/plan/mint.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

/// "0=x"
Result<void> add_choice(const std::string& choice, json::array& axes, json::array& numbers) {
  const auto equals = choice.find('=');
  unsigned number = 0;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + equals, number);
  if (error != std::errc{} || end != choice.data() + equals ||
      number >= tmcl::plan::mint::most_axes) {
    return tl::unexpected(
        usage_error("unknown_axis", fmt::format("--axis {}: Mint's axes are 0 to {}", choice,
                                                tmcl::plan::mint::most_axes - 1)));
  }
  axes.emplace_back(choice.substr(equals + 1));
  numbers.emplace_back(number);
  return {};
}

// Axis 0 is the first that there is, unless somebody says which is which.
Result<json::object> params_of(const verb::RunMint& verb, Target& target) {
  json::array axes;
  json::array numbers;
  for (const auto& choice : verb.axes) {
    if (const auto added = add_choice(choice, axes, numbers); !added)
      return tl::unexpected(added.error());
  }
  if (!verb.axes.empty()) return json::object{{"axes", axes}, {"numbers", numbers}};
  return target.axes().map([&](const std::vector<AxisRow>& rows) {
    for (const auto& row : rows)
      if (axes.size() < tmcl::plan::mint::most_axes) axes.emplace_back(row.name);
    return json::object{{"axes", axes}};
  });
}

/// Follows a program by what the gateway tells of it.
class Audience {
 public:
  Audience(json::array axes, bool names_axes, Context& context)
      : axes_(std::move(axes)), names_axes_(names_axes), context_(context), line_(context.output) {}

  void hear(const json::object& news) {
    const auto phase = text_at(news, "phase");
    if (phase == "checked") {
      tell_axes(news);
      path::warn(news, context_.output);
    } else if (phase == "stands") {
      tell_group(integer_at<std::size_t>(news, "line"), number_at(news, "passed_s").value_or(0),
                 number_at(news, "duration_s").value_or(0));
    } else {
      go_ = integer_at<std::size_t>(news, "line");
      show(number_at(news, "passed_s").value_or(0), number_at(news, "duration_s").value_or(0));
    }
  }
  /// A signal stops all axes, which ends the program.
  void look() {
    if (signal_ == 0) signal_ = context_.host.take_signal();
    if (signal_ == 0 || has_stopped_) return;
    has_stopped_ = true;
    for (const auto& axis : axes_) {
      const auto stopped = context_.target.stop(std::string(axis.as_string()));
      if (stopped) continue;
      context_.output.err << "tmclctl: " << std::string_view(axis.as_string())
                          << " NOT stopped: " << error_text(stopped.error()) << '\n';
    }
  }
  /// Those of the groups that were not heard of.
  void tell_rest(const json::object& report) {
    const auto& groups = array_at(report, "groups");
    for (auto i = told_; i < groups.size(); ++i) {
      const auto& group = groups[i].as_object();
      tell_group(integer_at<std::size_t>(group, "line"), number_at(group, "took_s").value_or(0),
                 number_at(group, "planned_s").value_or(0));
    }
    line_.clear();
    path::warn(report, context_.output);
  }
  int signal() const { return signal_; }
  std::size_t go() const { return go_; }

 private:
  void tell_axes(const json::object& news) {
    if (!names_axes_ || context_.output.json) return;
    for (const auto& value : array_at(news, "axes")) {
      const auto& row = value.as_object();
      context_.output.out << fmt::format("axis {} is {}\n", integer_at<unsigned>(row, "number"),
                                         text_at(row, "axis"));
    }
  }
  void tell_group(std::size_t line, double took_s, double planned_s) {
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

  json::array axes_;
  bool names_axes_;
  Context& context_;
  ProgressLine line_;
  std::size_t told_ = 0;
  std::size_t go_ = 0;  // the line of the GO that is under way
  bool has_stopped_ = false;
  int signal_ = 0;
};

}  // namespace

VerbResult run(const verb::RunMint& verb, Context& context) {
  const auto text = path::text_of(verb.file, path::most_mint_bytes);
  if (!text) return tl::unexpected(text.error());
  auto params = params_of(verb, context.target);
  if (!params) return tl::unexpected(params.error());
  if (verb.counts_encoder) (*params)["counts"] = "encoder";
  Audience audience(params->at("axes").as_array(), verb.axes.empty(), context);
  auto result = context.target.perform_watched(
      "mint.run", std::move(*params), &*text,
      {[&](const json::object& news) { audience.hear(news); }, [&] { audience.look(); }});
  if (!result) {
    audience.tell_rest(object_at(result.error().subject, "run"));
    auto failure = path::explained(std::move(result.error()), verb.file, context.output);
    if (audience.signal() == 0) return tl::unexpected(std::move(failure));
    const auto where = fmt::format("stopped at the GO of line {}", audience.go());
    return tl::unexpected(interrupted_error(
        audience.signal(), audience.go() > 0 ? where : "stopped before anything moved", "",
        std::move(failure.subject)));
  }
  audience.tell_rest(*result);
  if (context.output.json)
    print_json({{"file", verb.file}, {"groups", array_at(*result, "groups")}}, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl
