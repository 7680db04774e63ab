// path feed, path status.
#include <fmt/format.h>

#include "output/print.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/stream.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using tmcl::plain_number;

constexpr int digits_of_speed = 4;

std::string in_percent(double part) { return plain_number(100 * part, 3) + " %"; }

/// "left, front: override 50 %, 83 % now"
std::string feed_text(const api::path::RunningPath& path) {
  auto text = fmt::format("{}: ", joined(path.axes));
  if (path.waits_at_line) {
    text += fmt::format("waiting at M0, line {}; ", *path.waits_at_line);
  } else if (path.held) {
    text += "held on the path; ";
  }
  return text +
         fmt::format("override {}, {} now", in_percent(path.factor), in_percent(path.factor_now));
}

void tell_none(Context& context) {
  context.output.out << "No axis is on a path that tmcld passes\n";
}

Result<ExitCode> run(const verb::FeedPath& verb, Context& context) {
  api::path::Feed params;
  params.axes = {verb.axis};
  params.factor = verb.factor;
  params.hold = verb.hold;
  const auto result = context.call(params);
  if (!result) return tl::unexpected(result.error());
  if (context.output.json) return print_json(api::to_json(*result), context.output), ExitCode::done;
  for (const auto& path : result->paths) context.output.out << feed_text(path) << '\n';
  return ExitCode::done;
}

void print(const api::path::RunningPath& path, std::ostream& out) {
  const auto left = path.left_s ? fmt::format("{:.1f} s left", *path.left_s) : "held";
  out << fmt::format("{}: {}, {} mode, {}\n", joined(path.axes), path.name.value_or("a path"),
                     path.mode, path.phase);
  out << fmt::format("  done      {:.0f} %: {:.1f} of {:.1f} s, {}\n", 100 * path.done,
                     path.passed_s, path.duration_s, left);
  if (path.line) out << fmt::format("  line      {} of the file\n", *path.line);
  if (path.waits_at_line)
    out << fmt::format("  waiting at M0, line {}: 'tmclctl path resume' lets it go on\n",
                       *path.waits_at_line);
  out << fmt::format("  override  {}{}, {} now\n", in_percent(path.factor),
                     path.held ? ", and held" : "", in_percent(path.factor_now));
  out << fmt::format("  feed      {} a second, planned {}\n",
                     plain_number(path.feed, digits_of_speed),
                     plain_number(path.planned_feed, digits_of_speed));
  out << fmt::format("  off path  {:.4f} at most so far, at {:.3f} s, and {:.1f} ms late on it\n",
                     path.off_path, path.off_path_at_s, 1e3 * path.lag_s);
}

Result<ExitCode> run(const verb::PathStatus& verb, Context& context) {
  api::path::Status params;
  if (!verb.axes.empty()) params.axes = verb.axes;
  const auto result = context.call(params);
  if (!result) return tl::unexpected(result.error());
  if (context.output.json) return print_json(api::to_json(*result), context.output), ExitCode::done;
  for (const auto& path : result->paths) print(path, context.output.out);
  if (result->paths.empty()) tell_none(context);
  return ExitCode::done;
}

/// "50%", "hold" or "resume".
Reading read_feed(const std::string& text, verb::FeedPath& into) {
  if (text == "hold" || text == "resume") {
    into.hold = text == "hold";
    return {};
  }
  constexpr double least = 100 * tmcl::plan::least_feed, most = 100 * tmcl::plan::most_feed;
  const auto number = std::string_view(text).substr(0, text.find('%'));
  const bool is_percent = !text.empty() && number.size() == text.size() - 1;
  const auto value = parse_number<double>(number, least, most);
  if (!is_percent || !value) {
    return tl::unexpected(
        fmt::format("'{}' is none of hold, resume and {}% to {}%", text, least, most));
  }
  into.factor = *value / 100;
  return {};
}

constexpr const char* only_tmcld =
    "with --direct it is the program that began a path that leads it";

constexpr const char* path_feed_help = R"(
Passes a path that is under way slower or faster than it was planned, holds it, and lets it go on. The axes
stay on the path: its time goes slower, or stands. Above 100 % it is faster only where the limits of all
its axes leave room; 'tmclctl path status' says what there is of it. Dwells take their time all the same.
To slow a path down and to hold it needs no lease; what makes it faster is for the holder, if there is one.
In position mode a path is held where it stands itself, and takes no other feed.

  tmclctl path feed left 50%
  tmclctl path feed left hold
  tmclctl path feed left resume
  tmclctl path status
)";

constexpr const char* path_status_help = R"(
How far the paths are that tmcld passes, how fast, and how far off them their axes were seen.

  tmclctl path status
  tmclctl --json path status left
)";

}  // namespace

void add_path_feed(Grammar& grammar, const Form& group) {
  auto feed =
      grammar.verb<verb::FeedPath>(group, "feed", access::tmcld_only(VerbEffect::acts, only_tmcld),
                                   "Slow a path down, speed it up, hold it", path_feed_help, run);
  feed.axis(feed->axis);
  auto& said = *feed.operator->();
  feed.word("FEED", "Of what was planned, 10% to 200%; or hold, or resume",
            [&said](const std::string& text) { return read_feed(text, said); });
  auto status = grammar.verb<verb::PathStatus>(
      group, "status", access::tmcld_only(VerbEffect::reads, only_tmcld),
      "How far paths are, and how fast", path_status_help, run);
  status.words("AXIS", "One of each path; without any, all paths", texts(status->axes));
}

}  // namespace tmclctl
