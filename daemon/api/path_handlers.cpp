// Paths through several axes, passed by the daemon.
#include <algorithm>
#include <cctype>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/this_coro.hpp>

#include "api/audit.hpp"
#include "api/course_view.hpp"
#include "api/handlers.hpp"
#include "api/journey.hpp"
#include "api/path_rehearsal.hpp"
#include "api/path_request.hpp"
#include "api/resonance_request.hpp"
#include "api/staging.hpp"
#include "async/rest.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/journey/path_run.hpp"
#include "gateway/journey/planned_path.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;
namespace ap = tmcl::axis_parameter;
using boost::asio::awaitable;

// ---- the axes ----

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;
using path::OfPath;

/// Those of "axes"; none if it is absent.
Result<Axes> named_axes(const Call& call, const OfPath& params) {
  if (!params.axes) return Axes{};
  auto axes = axes_of(call, params.axes);
  if (!axes) return axes;
  const auto named = params.axes->size();
  const auto letters = params.file_axes ? params.file_axes->size() : 0;
  if (axes->size() == named && (letters == 0 || letters == named)) return axes;
  return tl::unexpected(param_error("bad_argument", letters == named ? "axes" : "file_axes",
                                    "there must be one of 'axes' for each of 'file_axes', and "
                                    "each axis once"));
}

/// Which axis of the file each of them is; without "file_axes" they come in the file's order.
std::vector<plan::PathChoice> choices_of(const OfPath& params, const plan::PathSource& source,
                                         const Axes& axes) {
  const auto& letters = params.file_axes ? *params.file_axes : source.path.axes;
  std::vector<plan::PathChoice> choices;
  for (std::size_t i = 0; i < std::min(letters.size(), axes.size()); ++i)
    choices.push_back({letters[i], axes[i]->name()});
  return choices;
}

/// X is the axis X or x, unless something else was said.
void add_namesakes(const Gateway& gateway, const plan::PathSource& source, Axes& axes,
                   std::vector<plan::PathChoice>& choices) {
  for (const auto& of_file : source.path.axes) {
    if (std::ranges::find(choices, of_file, &plan::PathChoice::of_file) != choices.end()) continue;
    auto small = of_file;
    std::ranges::transform(small, small.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    auto axis = gateway.find_axis(of_file);
    if (!axis) axis = gateway.find_axis(small);
    if (!axis) continue;
    choices.push_back({of_file, axis->name()});
    axes.push_back(std::move(axis));
  }
}

/// In the order of the file's axes.
Result<Axes> axes_for(const Call& call, const OfPath& params, const plan::PathSource& source,
                      bool with_namesakes) {
  auto axes = named_axes(call, params);
  if (!axes) return axes;
  auto choices = choices_of(params, source, *axes);
  if (choices.size() < axes->size()) {
    return tl::unexpected(param_error("bad_argument", "axes",
                                      "the file has " + std::to_string(choices.size()) +
                                          " axes, and not " + std::to_string(axes->size())));
  }
  if (with_namesakes) add_namesakes(*call.gateway, source, *axes, choices);
  const auto order = in_order(source, choices);
  if (!order) return tl::unexpected(error_of(order.error(), "file_axes"));
  Axes in_file_order;
  for (const auto& choice : *order)
    in_file_order.push_back(*std::ranges::find(*axes, choice.axis, &GatewayAxis::name));
  return in_file_order;
}

struct ReadForPath {
  std::vector<plan::Setting> ramp;
  tmcl::Microsteps position;
  bool moving = false;
  tmcl::Duration command{};  ///< How long one took.
};

/// What limits its ramps, how fast it is, and where: all proven, as the path is computed from it.
tmcl::Script<tmcl::Result<ReadForPath>> read_for_path(tmcl::AxisAddress axis,
                                                      const tmcl::Model& model) {
  ReadForPath read;
  const auto begin = co_await tmcl::current_time();
  auto parameters = plan::ramp_limit_parameters(model);
  parameters.push_back(ap::actual_velocity);
  const auto values = co_await tmcl::must(tmcl::verbs::get_all(axis, parameters, {}));
  read.command = (co_await tmcl::current_time() - begin) / std::ssize(parameters);
  for (std::size_t i = 0; i < parameters.size(); ++i)
    read.ramp.push_back({parameters[i], values.at(i)});
  read.moving = values.back() != 0;
  tmcl::CallOptions twice;
  twice.proof = tmcl::Proof::twice;
  const auto position = co_await tmcl::must(tmcl::verbs::command(
      {axis.module, tmcl::Command::GAP, ap::actual_position, axis.motor, 0}, std::move(twice)));
  read.position = {position.reply.value};
  co_return read;
}

awaitable<tmcl::Result<plan::PathAxisFacts>> facts_of(GatewayAxis& axis, std::string of_file) {
  plan::PathAxisFacts facts;
  facts.choice = {std::move(of_file), axis.name()};
  auto ready = co_await axis.be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  facts.model = axis.module().model();
  auto units = co_await axis.module_units();
  if (!units) co_return tl::unexpected(std::move(units.error()));
  facts.units = *units;
  auto scale = co_await axis.scale();
  if (!scale) co_return tl::unexpected(std::move(scale.error()));
  facts.scale = std::move(*scale);
  facts.limits = axis.soft_limits();
  if (const auto jump = axis.corner_jump()) facts.corner_jump = *jump;
  facts.encoder_counts_per_unit = axis.encoder_counts_per_unit();
  if (facts.model == nullptr) co_return facts;
  const auto read = co_await axis.perform(read_for_path(axis.address(), *facts.model), {});
  if (!read) co_return tl::unexpected(read.error());
  facts.ramp = plan::ramp_limits(*facts.model, read->ramp);
  facts.moving = read->moving;
  facts.position = read->position;
  facts.command = read->command;
  co_return facts;
}

/// What makes up for deviations stays within the limits of the axis, too.
awaitable<tmcl::Result<void>> keep_limits(GatewayAxis& axis, Permit permit,
                                          plan::StreamAxis& stream) {
  const auto limits = axis.motion_limits();
  if (!limits || permit.exceeds_limits) co_return tmcl::Result<void>{};
  const auto greatest = co_await axis.perform(limits->greatest(), {});
  if (!greatest) co_return tl::unexpected(greatest.error());
  const auto keep = [](std::int32_t& most, std::optional<std::int32_t> limit) {
    if (limit) most = std::min(most, *limit);
  };
  keep(stream.greatest_velocity, greatest->velocity);
  keep(stream.greatest_acceleration, greatest->acceleration);
  co_return tmcl::Result<void>{};
}

Task<std::vector<plan::PathAxis>> path_axes(const plan::PathSource& source, const Axes& chosen,
                                            const plan::PathRequest& request, Permit permit) {
  std::vector<plan::PathAxis> axes;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    auto& axis = *chosen[i];
    const auto facts = co_await must(facts_of(axis, source.path.axes[i]), axis);
    // It does not move by itself, and will not soon be free.
    if (facts.moving && axis.claim_kind() != ClaimKind::none)
      co_return call_error(axis.claimed(), axis.name());
    auto made = plan::path_axis(source, facts, request);
    if (!made) {
      auto error = error_of(made.error(), "axes");
      error.subject["axis"] = axis.name();
      co_return tl::unexpected(std::move(error));
    }
    co_await must(keep_limits(axis, permit, made->stream), axis);
    if (request.mode == plan::StreamMode::position) {
      auto twin = co_await must(axis.twin({}), axis);
      made->stream.twin = std::move(twin);
    }
    axes.push_back(std::move(*made));
  }
  co_return axes;
}

// ---- the course ----

/// A course, and what it was made of.
struct Made {
  const plan::Course& course;
  const std::vector<std::string>& axes;  ///< Of the file.
  const Cast& cast;
  const plan::PathRequest& request;
  std::function<plan::PathResult<plan::Course>()> without_jerk;  ///< Makes the same without one.
};
/// Done with a course where it is made: that may take long, too.
using Look = std::function<void(const Made&)>;

/// As the configuration is now.
std::shared_ptr<const plan::path_file::GcodeSetup> setup_for(const Call& call,
                                                             const OfPath& params) {
  auto setup = setup_of(call.gateway->path());
  if (params.lenient.value_or(false)) setup.unknowns = plan::path_file::Unknowns::skipped;
  return std::make_shared<const plan::path_file::GcodeSetup>(std::move(setup));
}

/// `with_namesakes`: axes of the file that are not named are those of the same name.
Task<PlannedPath> plan_for(const Call& call, const OfPath& params, bool with_namesakes, Look look) {
  auto request = co_await must(request_of(params));
  request.shaping = co_await must(shaping_of(params));
  request.resonance = co_await must(resonance_of(params.resonance_hz, params.damping));
  // Before the text is read, which may take a while.
  if (!with_namesakes && !params.axes) {
    co_return param_error("bad_argument", "axes",
                          "path.run needs the parameter 'axes', or a 'plan'");
  }
  co_await must(named_axes(call, params));
  auto given = co_await must(text_of(call, params));
  const auto place = co_await must(place_to_plan(call, given.size()));
  const auto format = co_await must(format_in(params));
  auto& planner = call.gateway->planner;
  const auto turn = co_await planner.take_turn(call.peer->client().number);
  const PathWords words(*call.gateway);
  request.setup = setup_for(call, params);

  // It may have some megabytes, and what is read of it some more: nothing of it is copied here.
  const auto text = std::make_shared<const std::string>(std::move(given));
  auto read = [text, format, tolerance = request.tolerance, setup = request.setup] {
    return plan::read_path(*text, format.value_or(plan::format_of("", *text)), tolerance, *setup);
  };
  auto source = co_await planner.plan(std::move(read));
  if (!source) co_return error_of(source.error(), "text");
  auto axes = co_await must(axes_for(call, params, *source, with_namesakes));
  auto known = co_await must(path_axes(*source, axes, request, call.permit));

  auto cast = co_await must(cast_of(axes, known));

  const auto feed = feed_of(known);
  if (!feed) co_return error_of(feed.error(), "feed");
  plan::PathSource names{source->format, {source->path.axes, {}}};
  names.path.remarks = source->path.remarks;
  auto plan_it = [source = std::move(*source), text, known, feed = *feed, request,
                  cast = std::move(cast), look = std::move(look)]() mutable {
    const auto letters = source.path.axes;
    auto limits = limits_of(source, known);
    const auto counted =
        from_where_axes_stand(std::move(source), *text, known, request)
            .and_then([&](auto from_there) { return by_steps(std::move(from_there), known); });
    const auto pass = [&](const plan::PathSource& path) {
      return course_of(path, limits, feed, request.tolerance, request.shaping);
    };
    auto course = counted.and_then(pass);
    if (!course) return course;
    limits.jerk = std::numeric_limits<double>::infinity();
    const auto without_jerk = [&] { return counted.and_then(pass); };
    look({*course, letters, cast, request, without_jerk});
    return course;
  };
  auto course = co_await planner.plan(std::move(plan_it));
  if (!course) co_return error_of(course.error(), "text");
  if (const auto objection = objection_to_reach(*course, known))
    co_return error_of(*objection, "text");
  PlannedPath planned{0,
                      request,
                      names,
                      std::move(axes),
                      std::move(known),
                      std::move(*course),
                      words,
                      params.name.value_or("")};
  co_return planned;
}

/// The parameter "plan". What has changed since then is found out, and where the axes are now.
Task<PlannedPath> planned_before(const Call& call, const path::Run& params) {
  std::string_view other;
  if (params.bytes) other = api::name_of<&OfPath::bytes>();
  if (params.text) other = api::name_of<&OfPath::text>();
  if (params.axes) other = api::name_of<&OfPath::axes>();
  if (!other.empty()) {
    co_return param_error("bad_argument", other,
                          "give 'plan' alone; it has all that the path was planned with");
  }
  auto& kept = call.gateway->planned_path;
  if (!kept || kept->number != *params.plan) {
    co_return param_error("no_plan", "plan", "there is no such plan any more",
                          "plan the path again: the daemon keeps one, and runs it "
                          "once");
  }
  auto planned = std::move(*std::exchange(kept, nullptr));
  auto known = co_await must(path_axes(planned.source, planned.axes, planned.request, call.permit));
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (moves_alike(known[i], planned.known[i])) continue;
    co_return param_error(
        "no_plan", "plan",
        "settings of " + planned.axes[i]->name() + " have changed since the path was planned",
        "plan it again");
  }
  planned.known = std::move(known);
  co_return planned;
}

/// It could not be run, and may be later.
void keep_again(const Call& call, PlannedPath planned) {
  auto& kept = call.gateway->planned_path;
  if (!kept) kept = std::make_shared<PlannedPath>(std::move(planned));
}

/// Of what the file asks for and is not carried out; of the settings with which each axis moves to
/// the start, and is stopped.
awaitable<std::vector<std::string>> warnings_of(const PlannedPath& planned) {
  auto all = plan::warnings_of(planned.source);
  for (const auto& axis : planned.axes) {
    const auto warnings = co_await axis->warnings();
    if (!warnings) continue;  // The path itself tells of what cannot be read.
    for (const auto& text : *warnings) all.push_back(axis->name() + ": " + text);
  }
  co_return all;
}

// ---- how it goes ----

PathRun::OnProgress path_progress_to(const Call& call) {
  return [tell = call.progress_reporter()](const PathRun& run) {
    tell(PathProgress{std::string(name_of(run.phase())), run.passed(), run.duration()});
  };
}

path::Curve curve_of_seen(const std::vector<plan::SeenPlace>& seen, std::size_t axes,
                          plan::AxisValues plan::SeenPlace::*place) {
  path::Curve curve;
  for (const auto& one : seen) {
    curve.times_s.push_back(one.at_s);
    curve.positions.push_back(to_list(one.*place, axes));
  }
  return curve;
}

/// What is told alike of a Passage and a MotorPassage. `all`: also of axes that were not looked at.
template <class Passed>
void tell(const plan::CourseSight& sight, const std::vector<std::string>& names, double tolerance,
          bool all, Passed& passed) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& axis = sight.axes[i];
    if (all || axis.readings > 0)
      passed.tracking_error.push_back({axis.largest, axis.rms(), axis.readings, names[i]});
  }
  passed.off_path = sight.largest_off;
  passed.off_path_at_s = sight.largest_off_at_s;
  passed.off_path_at = to_list(sight.largest_off_at, names.size());
  passed.lag_s = sight.largest_lag_s;
  if (sight.largest_off > tolerance) passed.tolerance_exceeded_by = sight.largest_off - tolerance;
  if (sight.seen.empty()) return;
  passed.seen = curve_of_seen(sight.seen, names.size(), &plan::SeenPlace::place);
  passed.on_path = curve_of_seen(sight.seen, names.size(), &plan::SeenPlace::on_path);
}

std::optional<path::MotorPassage> motors_of(const plan::StreamReport& report,
                                            const std::vector<std::string>& names,
                                            double tolerance) {
  if (!report.motors) return std::nullopt;
  path::MotorPassage motors;
  tell(*report.motors, names, tolerance, false, motors);
  if (motors.tracking_error.empty()) return std::nullopt;
  return motors;
}

path::Passage passage_of(const PathRun& run, double tolerance) {
  const auto& report = run.report();
  const auto a_second = [&](double count) {
    return report.passed_s > 0 ? count / report.passed_s : 0;
  };
  path::Passage passage;
  passage.passed_s = report.passed_s;
  passage.updates = report.updates;
  passage.period_ms = 1e3 * tmcl::seconds(report.period);
  passage.worst_delay_ms = 1e3 * tmcl::seconds(report.worst_delay);
  passage.commands = report.commands;
  passage.commands_per_s = a_second(static_cast<double>(report.commands));
  passage.bus_load = a_second(report.busy_s);
  passage.round_trip_us = 1e6 * tmcl::seconds(report.round_trip);
  const auto names = run.axis_names();
  tell(report, names, tolerance, true, passage);
  passage.remarks = remarks_of(run);
  passage.motors = motors_of(report, names, tolerance);
  return passage;
}

std::string tolerance_warning(double tolerance, double by, double at_s) {
  return fmt::format(
      "the tolerance of {} was exceeded by at least {}, where positions were read, at {} s; a "
      "lower velocity or acceleration, or another mode, keeps nearer to the path",
      tmcl::plain_number(tolerance, 6), tmcl::plain_number(by, 3), tmcl::plain_number(at_s, 4));
}

std::string motors_warning(double tolerance, const path::MotorPassage& motors) {
  return fmt::format(
      "by their encoders the motors exceeded the tolerance of {} by at least {}, at {} s",
      tmcl::plain_number(tolerance, 6), tmcl::plain_number(*motors.tolerance_exceeded_by, 3),
      tmcl::plain_number(motors.off_path_at_s, 4));
}

}  // namespace

Answer<path::Stage> stage_path(Call& call, const path::Stage& params) {
  co_return stage_part(call, {params.offset, params.data}, staged_path);
}

Answer<path::Plan> plan_path(Call& call, const path::Plan& params) {
  const auto result = std::make_shared<path::Planned>();
  auto look = [result, points = params.points.value_or(0)](const Made& made) {
    const auto& [course, axes, cast, request, without_jerk] = made;
    result->expected = expected_of(course, cast, request);
    result->course = view_of(course, axes);
    result->shaping = view_of(course, request.shaping, axes);
    if (request.jerk) {
      const auto unlimited = without_jerk();
      if (unlimited) result->jerk = view_of_jerk(course, *unlimited, request.resonance, axes);
    }
    if (points > 0) result->curve = curve_of(course, points);
  };
  auto planned = co_await must(plan_for(call, params, true, std::move(look)));
  planned.number = call.gateway->next_path_number();
  result->plan = planned.number;
  for (const auto& axis : planned.axes) result->axes.push_back(axis->name());
  for (auto& word : result->course.words) word.switches = planned.words.what_switches(word.number);
  result->warnings = co_await warnings_of(planned);
  if (auto warning = warning_of(result->expected, planned.request.tolerance); !warning.empty())
    result->warnings.push_back(std::move(warning));
  call.gateway->planned_path = std::make_shared<PlannedPath>(std::move(planned));
  co_return std::move(*result);
}

Answer<path::Run> run_path(Call& call, const path::Run& params) {
  const auto expected = std::make_shared<std::vector<path::Expected>>();
  auto look = [expected](const Made& made) {
    *expected = expected_of(made.course, made.cast, made.request);
  };
  auto planning =
      params.plan ? planned_before(call, params) : plan_for(call, params, false, std::move(look));
  auto planned = co_await must(std::move(planning));
  const auto most_seen = static_cast<std::size_t>(params.points.value_or(0));
  // By positions, and by encoders.
  const auto place =
      place_for(call, planned.course.bytes() + 2 * most_seen * sizeof(plan::SeenPlace));
  if (!place) {
    if (params.plan) keep_again(call, std::move(planned));
    co_return tl::unexpected(place.error());
  }
  auto warnings = co_await warnings_of(planned);
  if (auto warning = warning_of(*expected, planned.request.tolerance); !warning.empty())
    warnings.push_back(std::move(warning));
  co_await must_not(refusal_to_begin(call));
  begin_journey(call);
  std::vector<DriveMember> members;
  for (const auto& axis : planned.axes)
    members.push_back({axis, axis->begin_movement(call.permit, {})});
  auto options = options_of(planned.request);
  options.to_start = params.to_start.value_or(false);
  options.most_seen = most_seen;

  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run = std::make_shared<PathRun>(
      executor, std::move(planned.course), std::move(members), streamed(planned.known), options,
      std::move(planned.words), std::move(planned.name), path_progress_to(call));
  const auto failure = co_await PathRun::pass(run);
  co_await must_not(failure);
  if (!run->journal_failure().empty()) warnings.push_back(journal_warning(run->journal_failure()));
  auto passage = passage_of(*run, planned.request.tolerance);
  if (run->report().fault) co_return error_of(*run, api::to_json(passage));
  if (const auto by = passage.tolerance_exceeded_by)
    warnings.push_back(tolerance_warning(planned.request.tolerance, *by, passage.off_path_at_s));
  if (passage.motors && passage.motors->tolerance_exceeded_by)
    warnings.push_back(motors_warning(planned.request.tolerance, *passage.motors));
  co_return path::Passed{std::move(passage), std::move(warnings), std::move(*expected)};
}

}  // namespace tmcld::handlers
