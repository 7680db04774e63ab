// Paths that are passed: held, slowed down, sped up, stopped, and told about.
#include <algorithm>
#include <utility>

#include "api/handlers.hpp"
#include "api/journey.hpp"
#include "api/lookup.hpp"
#include "api/number_within.hpp"
#include "async/rest.hpp"
#include "gateway/journey/path_run.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;

constexpr tmcl::Duration look_interval = std::chrono::milliseconds(10);

using PathRuns = std::vector<std::shared_ptr<PathRun>>;

/// The paths of the axes that are named; all of them if none is.
Result<PathRuns> runs_of(const Call& call, const path::OnPaths& params) {
  const auto axes = axes_of(call, params.axes);
  if (!axes) return tl::unexpected(axes.error());
  PathRuns runs;
  for (const auto& axis : *axes) {
    const auto path = std::dynamic_pointer_cast<PathRun>(axis->journey());
    if (!path && params.axes) {
      return tl::unexpected(
          param_error("no_path", "axes", "axis '" + axis->name() + "' is on no path"));
    }
    if (path && std::ranges::find(runs, path) == runs.end()) runs.push_back(path);
  }
  return runs;
}

path::PathAxes axes_on(const PathRuns& runs) {
  path::PathAxes all;
  for (const auto& run : runs) {
    for (const auto& name : run->axis_names()) all.axes.push_back(name);
  }
  return all;
}

std::optional<Error> failure_to_stop(const PathRuns& runs) {
  std::string text;
  std::vector<std::string> unstopped;
  for (const auto& run : runs) {
    for (auto& axis : run->unstopped()) {
      text += (text.empty() ? "" : "; ") + not_stopped(axis);
      unstopped.push_back(std::move(axis));
    }
  }
  if (unstopped.empty()) return std::nullopt;
  auto error = failed("not_stopped", std::move(text), stop_them);
  add_outcome(error, unstopped);
  return error;
}

/// How long the rest takes: dwells take their time at any rate.
std::optional<double> time_left(const PathRun& run) {
  const auto feed = run.feed();
  if (feed.held) return std::nullopt;
  const double resting = run.course().resting_after(run.passed());
  const double moving = run.duration() - run.passed() - resting;
  return std::max(0.0, moving) / std::min(feed.asked, 1.0) + resting;
}

path::RunningPath view_of_run(const PathRun& run) {
  const auto feed = run.feed();
  const auto& course = run.course();
  const double passed = run.passed();
  path::RunningPath view;
  view.axes = run.axis_names();
  if (!run.name().empty()) view.name = run.name();
  view.mode = name_of(run.mode());
  view.phase = name_of(run.phase());
  view.passed_s = passed;
  view.duration_s = run.duration();
  view.done = run.duration() > 0 ? passed / run.duration() : 1;
  view.left_s = time_left(run);
  view.line = course.line_at(passed);
  view.held = feed.held;
  view.factor = feed.asked;
  view.factor_now = feed.now;
  view.planned_feed = course.speed_at(passed);
  view.feed = feed.now * view.planned_feed;
  view.off_path = run.report().largest_off;
  view.off_path_at_s = run.report().largest_off_at_s;
  view.lag_s = run.report().largest_lag_s;
  if (const auto* halt = run.waits_at()) view.waits_at_line = halt->line;
  return view;
}

path::RunningPaths views_of(const PathRuns& runs) {
  path::RunningPaths views;
  for (const auto& run : runs) views.paths.push_back(view_of_run(*run));
  return views;
}

/// Slower is like a stop: it needs no lease. What makes an axis faster is for its holder.
std::optional<Error> objection_to_faster(const Call& call, const PathRuns& runs) {
  for (const auto& axis : call.gateway->axes()) {
    const auto path = std::dynamic_pointer_cast<PathRun>(axis->journey());
    const auto* lease = call.gateway->leases()->of(*axis);
    const bool is_concerned = path && std::ranges::find(runs, path) != runs.end();
    if (!is_concerned || lease == nullptr || lease->holder.number == call.permit.client) continue;
    return not_now(
        name_of(tmcl::Errc::leased),
        "axis '" + axis->name() + "' is leased to " + lease->holder.name,
        "that client may speed its path up, and let it go on; any may slow it down, hold "
        "it and stop it");
  }
  return std::nullopt;
}

std::optional<Error> objection_to_feed(const PathRuns& runs) {
  for (const auto& run : runs) {
    if (plan::takes_feed(run->mode())) continue;
    return not_now(
        "wrong_mode",
        "the path of axis '" + run->axis_names().front() +
            "' is passed in position mode, in which its speeds are sent ahead",
        "it can be held where it stands itself; the modes velocity and segments take any "
        "override");
  }
  return std::nullopt;
}

bool is_faster(const PathRuns& runs, const path::Feed& params) {
  return std::ranges::any_of(runs, [&](const auto& run) {
    const auto feed = run->feed();
    const bool goes_on = feed.held && params.hold == false;
    return goes_on || (params.factor && *params.factor > feed.asked);
  });
}

Task<path::PathAxes> pause_all(Call& call, const path::OnPaths& params, bool on) {
  const auto runs = co_await must(runs_of(call, params));
  if (!on) co_await must_not(objection_to_faster(call, runs));
  for (const auto& run : runs) run->pause(on);
  co_return axes_on(runs);
}

}  // namespace

Answer<path::Pause> pause_path(Call& call, const path::Pause& params) {
  return pause_all(call, params, true);
}
Answer<path::Resume> resume_path(Call& call, const path::Resume& params) {
  return pause_all(call, params, false);
}

Answer<path::Status> status_of_paths(Call& call, const path::Status& params) {
  const auto runs = co_await must(runs_of(call, params));
  co_return views_of(runs);
}

Answer<path::Feed> feed_path(Call& call, const path::Feed& params) {
  if (!params.factor && !params.hold)
    co_return param_error<&path::Feed::factor>("bad_argument", "give 'factor', 'hold', or both");
  if (params.factor) {
    co_await must(number_within("factor", *params.factor, plan::least_feed, plan::most_feed));
  }
  const auto runs = co_await must(runs_of(call, params));
  if (params.factor) co_await must_not(objection_to_feed(runs));
  if (is_faster(runs, params)) co_await must_not(objection_to_faster(call, runs));
  for (const auto& run : runs) {
    if (params.factor) run->set_feed(*params.factor);
    if (params.hold) run->pause(*params.hold);
  }
  co_return views_of(runs);
}

Answer<path::Stop> stop_path(Call& call, const path::Stop& params) {
  const auto runs = co_await must(runs_of(call, params));
  for (const auto& run : runs)
    run->end({plan::DriveFault::Kind::asked, {}, "a client has stopped the path"});
  for (const auto& run : runs) {
    while (!run->has_ended()) co_await rest(look_interval);
  }
  co_await must_not(failure_to_stop(runs));
  co_return axes_on(runs);
}

}  // namespace tmcld::handlers
