// top
#include <algorithm>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "axis/axis_rows.hpp"
#include "connection/reconnecting_watch.hpp"
#include "output/full_screen.hpp"
#include "tmcl/api/axis.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

// What axis.list knows costs no exchange.
constexpr auto list_interval = std::chrono::seconds(1);

/// All axes on the screen, until q is pressed.
class Top {
 public:
  Top(const verb::Top& verb, const std::vector<AxisRow>& rows, FullScreen& screen, Context& context)
      : verb_(verb), screen_(screen), context_(context) {
    for (const auto& row : rows) {
      axes_.push_back({row.name, row.state});
      names_.push_back(row.name);
    }
  }

  Result<void> run() {
    const AxesWatcher watcher{
        .on_reading = [this](const auto& axis, const auto& reading) { note(axis, reading); },
        .on_error = {},
        .on_event = {},
        .wanted = [this] { return go_on(); }};
    return keep_watching(
        {names_, verb_.interval}, watcher,
        [this](const Error* why) { away_ = why != nullptr ? why->message : std::string(); },
        context_);
  }

 private:
  void note(const std::string& axis, const AxisReading& reading) {
    const auto line = std::ranges::find(axes_, axis, &AxisLine::name);
    if (line != axes_.end()) line->reading = reading;
  }

  bool go_on() {
    for (auto key = screen_.take_key(); key; key = screen_.take_key()) {
      if (key->letter == 'q') wanted_ = false;
    }
    const auto now = context_.host.now();
    if (away_.empty() && now - listed_at_ >= list_interval) {
      listed_at_ = now;
      look_at_modules();
    }
    if (now - drawn_at_ >= verb_.interval) {
      drawn_at_ = now;
      draw();
    }
    return wanted_ && context_.host.signal() == 0;
  }

  /// An error is left to the watching, which notices it as well.
  void look_at_modules() {
    const auto listed = context_.call(api::axis::List{true});
    if (!listed) return;
    for (const auto& found : listed->axes) {
      const auto line = std::ranges::find(axes_, found.name, &AxisLine::name);
      if (line == axes_.end()) continue;
      line->state = found.state;
      if (!line->limits && found.state == "ready" && !asked_.contains(found.name)) {
        asked_.insert(found.name);
        if (const auto units = units_of(found.name, context_)) line->limits = units->limits;
      }
    }
  }

  void draw() {
    const auto moving = std::ranges::count_if(
        axes_, [](const AxisLine& axis) { return axis.reading && axis.reading->moving; });
    std::vector<std::string> lines{
        away_.empty()
            ? fmt::format("{} axes, {} moving; q ends this, the axes go on", axes_.size(), moving)
            : fmt::format("AWAY: {}", away_),
        ""};
    auto shown = axes_;
    if (!away_.empty()) {
      for (auto& axis : shown) axis.state.clear();
    }
    std::ranges::move(lines_of(shown, screen_.width(), verb_.internal), std::back_inserter(lines));
    screen_.show(lines);
  }

  const verb::Top& verb_;
  FullScreen& screen_;
  Context& context_;
  std::vector<AxisLine> axes_;
  std::vector<std::string> names_;
  std::set<std::string> asked_;  ///< For their limits.
  std::string away_;             ///< Why tmcld is; empty while it is there.
  bool wanted_ = true;
  tmcl::TimePoint listed_at_{};
  tmcl::TimePoint drawn_at_{};
};

Result<ExitCode> run(const verb::Top& verb, Context& context) {
  // Before anything is looked for, which may take a while.
  const auto found = FullScreen::look_for(context.output.out_screen);
  if (!found) return tl::unexpected(found.error());
  const auto rows = axes_of(context);
  if (!rows) return tl::unexpected(rows.error());
  if (rows->empty()) return tl::unexpected(usage_error("no_axes", "there are no axes to watch"));
  const auto screen = FullScreen::open(context.output.out_screen);
  if (!screen) return tl::unexpected(screen.error());
  Top top(verb, *rows, **screen, context);
  return top.run().map([] { return ExitCode::done; });
}

constexpr const char* top_help = R"(
One row for each axis: whether its module answers, its position, a bar from its lower soft limit to the
upper one, its velocity, and what else is to be known: latched, referenced, leased, unattended, why it
stands short of its target. It stays while modules do not answer or tmcld starts again. q or Ctrl-C ends
it; the axes go on. It needs a terminal: 'watch --all' writes lines.

  tmclctl top
)";

}  // namespace

void add_top(Grammar& grammar) {
  auto top = grammar.verb<verb::Top>("top", access::reads, "Show all axes on the whole terminal",
                                     top_help, run);
  auto& top_interval = top->interval;
  top.option("--interval", "MS", "Draw at most once in so many milliseconds (default 200)",
             milliseconds(top_interval));
  top.internal(top->internal);
}

}  // namespace tmclctl
