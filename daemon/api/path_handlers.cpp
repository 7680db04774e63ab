// Paths through several axes, passed by the daemon.
#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/staging.hpp"
#include "async/rest.hpp"
#include "gateway/path_run.hpp"
#include "tmcl/drive_report.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;
namespace ap = tmcl::axis_parameter;
using boost::asio::awaitable;

constexpr tmcl::Duration look_interval = std::chrono::milliseconds(10);

// ---- what is asked for ----

Lookup<plan::StreamMode> mode_of(const Call& call) {
  const auto mode = call.params.text_or("mode", "velocity");
  if (mode == "velocity") return plan::StreamMode::velocity;
  if (mode == "position") return plan::StreamMode::position;
  return tl::unexpected(
      param_error("bad_argument", "mode", "'mode' must be 'velocity' or 'position'"));
}

Lookup<plan::PathRequest> request_of(const Call& call) {
  plan::PathRequest request;
  const auto mode = mode_of(call);
  if (!mode) return tl::unexpected(mode.error());
  request.mode = *mode;
  std::optional<double> tolerance;
  const std::pair<const char*, std::optional<double>*> numbers[] = {
      {"tolerance", &tolerance},
      {"velocity", &request.velocity},
      {"acceleration", &request.acceleration},
      {"feed", &request.feed},
      {"per_turn", &request.per_turn},
      {"deviation", &request.deviation}};
  for (const auto& [name, into] : numbers) {
    if (!call.params.has(name)) continue;
    const double value = call.params.number(name);
    if (!(value >= plan::least_of_path && value <= plan::most_of_path)) {
      return tl::unexpected(
          param_error("out_of_range", name, "'" + std::string(name) + "' is outside 1e-9..1e9"));
    }
    *into = value;
  }
  request.tolerance = tolerance.value_or(request.tolerance);
  if (call.params.has("period_ms"))
    request.period = std::chrono::milliseconds(call.params.integer("period_ms"));
  return request;
}

Lookup<std::string> text_of(const Call& call) {
  const bool in_line = call.params.has("text");
  if (in_line == call.params.has("bytes")) {
    return tl::unexpected(
        param_error("bad_argument", "text", "give one of 'text' and 'bytes', and not both"));
  }
  if (in_line) return call.params.text("text");
  return take_staged(call, staged_path).map([](const std::vector<std::uint8_t>& bytes) {
    return std::string(bytes.begin(), bytes.end());
  });
}

Lookup<plan::PathFormat> format_of(const Call& call, const std::string& text) {
  if (!call.params.has("format")) return plan::format_of("", text);
  const auto said = call.params.text("format");
  for (const auto format : {plan::PathFormat::csv, plan::PathFormat::gcode}) {
    if (said == name_of(format)) return format;
  }
  return tl::unexpected(param_error("bad_argument", "format", "'format' must be 'csv' or 'gcode'"));
}

RpcError error_of(const plan::PathObjection& objection, std::string_view param) {
  auto error = param_error(objection.name, param, objection.message);
  if (objection.problems.empty()) return error;
  json::array problems;
  for (const auto& problem : objection.problems) {
    problems.push_back(json::object{
        {"line", problem.line}, {"column", problem.column}, {"message", problem.message}});
  }
  const auto& first = objection.problems.front();
  error.message += ": line " + std::to_string(first.line) + ": " + first.message;
  error.data["problems"] = std::move(problems);
  return error;
}

// ---- the axes ----

Lookup<std::vector<PathMember>> members_of(const Call& call) {
  const auto axes = axes_of(call);
  if (!axes) return tl::unexpected(axes.error());
  const auto named = call.params.texts("axes").size();
  const auto letters = call.params.texts("file_axes").size();
  if (axes->size() != named || (letters != 0 && letters != named)) {
    return tl::unexpected(param_error("bad_argument", letters == named ? "axes" : "file_axes",
                                      "there must be one of 'axes' for each of 'file_axes', and "
                                      "each axis once"));
  }
  std::vector<PathMember> members;
  for (const auto& axis : *axes) members.push_back({axis, axis->begin_movement(call.permit, {})});
  return members;
}

/// Which axis of the file each of them is; without "file_axes" they come in the file's order.
std::vector<plan::PathChoice> choices_of(const Call& call, const plan::PathSource& source,
                                         const std::vector<PathMember>& members) {
  const auto letters =
      call.params.has("file_axes") ? call.params.texts("file_axes") : source.path.axes;
  std::vector<plan::PathChoice> choices;
  for (std::size_t i = 0; i < std::min(letters.size(), members.size()); ++i)
    choices.push_back({letters[i], members[i].axis->name()});
  return choices;
}

Lookup<std::vector<PathMember>> ordered(const Call& call, const plan::PathSource& source,
                                        std::vector<PathMember> members) {
  const auto choices = choices_of(call, source, members);
  if (choices.size() < members.size()) {
    return tl::unexpected(param_error("bad_argument", "axes",
                                      "the file has " + std::to_string(choices.size()) +
                                          " axes, and not " + std::to_string(members.size())));
  }
  const auto order = in_order(source, choices);
  if (!order) return tl::unexpected(error_of(order.error(), "file_axes"));
  std::vector<PathMember> in_file_order;
  for (const auto& choice : *order) {
    in_file_order.push_back(*std::ranges::find_if(
        members, [&](const PathMember& member) { return member.axis->name() == choice.axis; }));
  }
  return in_file_order;
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
  const std::pair<std::uint8_t, std::int32_t*> settings[] = {
      {ap::max_velocity, &facts.max_velocity}, {ap::max_acceleration, &facts.max_acceleration}};
  for (const auto& [parameter, into] : settings) {
    const auto value = co_await axis.get(parameter, {});
    if (!value) co_return tl::unexpected(value.error());
    *into = *value;
  }
  const auto velocity = co_await axis.get(ap::actual_velocity, {});
  if (!velocity) co_return tl::unexpected(velocity.error());
  facts.moving = *velocity != 0;
  const auto position = co_await axis.get(ap::actual_position, {});
  if (!position) co_return tl::unexpected(position.error());
  facts.position = {*position};
  co_return facts;
}

awaitable<Lookup<std::vector<plan::PathAxis>>> path_axes(const plan::PathSource& source,
                                                         const std::vector<PathMember>& members,
                                                         const plan::PathRequest& request) {
  std::vector<plan::PathAxis> axes;
  for (std::size_t i = 0; i < members.size(); ++i) {
    auto& axis = *members[i].axis;
    const auto facts = co_await facts_of(axis, source.path.axes[i]);
    if (!facts) co_return tl::unexpected(call_error(facts.error(), axis.name()));
    // It does not move by itself, and will not soon be free.
    if (facts->moving && axis.mover() != Mover::nobody)
      co_return tl::unexpected(call_error(axis.claimed(), axis.name()));
    auto made = plan::path_axis(source, *facts, request);
    if (!made) {
      auto error = error_of(made.error(), "axes");
      error.data["axis"] = axis.name();
      co_return tl::unexpected(std::move(error));
    }
    if (request.mode == plan::StreamMode::position) {
      auto twin = co_await axis.twin(members[i].movement);
      if (!twin) co_return tl::unexpected(call_error(twin.error(), axis.name()));
      made->stream.twin = std::move(*twin);
    }
    axes.push_back(std::move(*made));
  }
  co_return axes;
}

// ---- how it goes ----

PathRun::OnProgress progress_to(const Call& call) {
  return [peer = call.peer, id = call.id](const PathRun& run) {
    peer->notify("notify_progress", json::object{{"id", id},
                                                 {"phase", name_of(run.phase())},
                                                 {"passed_s", run.passed()},
                                                 {"duration_s", run.duration()}});
  };
}

json::object to_json(const std::vector<plan::Figure>& figures) {
  json::object out;
  for (const auto& figure : figures)
    std::visit([&](const auto value) { out[figure.first] = value; }, figure.second);
  return out;
}

json::object to_json(const plan::StreamReport& report, const PathRun& run) {
  const auto names = run.axis_names();
  json::array tracking;
  for (std::size_t i = 0; i < names.size(); ++i) {
    auto row = to_json(figures_of(report.axes[i]));
    row["axis"] = names[i];
    tracking.push_back(std::move(row));
  }
  const auto remarks = tmcl::remarks_of(report, names);
  auto out = to_json(figures_of(report));
  out["tracking_error"] = std::move(tracking);
  out["remarks"] = json::array(remarks.begin(), remarks.end());
  return out;
}

constexpr const char* stop_them =
    "stop them as soon as their bus can be reached, or by other means";

/// Of axes that were to be stopped.
void add_outcome(RpcError& error, const std::vector<std::string>& unstopped) {
  error.data["outcome"] = name_of(unstopped.empty() ? tmcl::Outcome::done : tmcl::Outcome::unknown);
  if (!unstopped.empty()) error.data["unstopped"] = json::array(unstopped.begin(), unstopped.end());
}

RpcError error_of(const plan::StreamReport& report, const PathRun& run) {
  const auto& fault = *report.fault;
  const auto unstopped = run.unstopped();
  const bool moved = !is_before_motion(fault.kind);
  const auto* hint = unstopped.empty() ? "all axes of the path were stopped" : stop_them;
  auto error =
      rpc_error(rpc_code::call_failed, name_of(fault.kind), run.text_of(fault), moved ? hint : "");
  if (moved) add_outcome(error, unstopped);
  error.data["axis"] = run.axis_names()[fault.axis.value_or(0)];
  error.data["run"] = to_json(report, run);
  return error;
}

/// The paths of the axes that are named; all of them if none is.
Lookup<std::vector<std::shared_ptr<PathRun>>> runs_of(const Call& call) {
  const auto axes = axes_of(call);
  if (!axes) return tl::unexpected(axes.error());
  std::vector<std::shared_ptr<PathRun>> runs;
  for (const auto& axis : *axes) {
    const auto path = axis->path();
    if (!path && call.params.has("axes")) {
      return tl::unexpected(
          param_error("no_path", "axes", "axis '" + axis->name() + "' is on no path"));
    }
    if (path && std::ranges::find(runs, path) == runs.end()) runs.push_back(path);
  }
  return runs;
}

json::object to_json(const std::vector<std::shared_ptr<PathRun>>& runs) {
  json::array axes;
  for (const auto& run : runs) {
    for (const auto& name : run->axis_names()) axes.emplace_back(name);
  }
  return {{"axes", std::move(axes)}};
}

std::optional<RpcError> failure_to_stop(const std::vector<std::shared_ptr<PathRun>>& runs) {
  std::string text;
  std::vector<std::string> unstopped;
  for (const auto& run : runs) {
    for (auto& axis : run->unstopped()) {
      text += (text.empty() ? "" : "; ") + not_stopped(axis);
      unstopped.push_back(std::move(axis));
    }
  }
  if (unstopped.empty()) return std::nullopt;
  auto error = rpc_error(rpc_code::call_failed, "not_stopped", std::move(text), stop_them);
  add_outcome(error, unstopped);
  return error;
}

Answer pause_all(Call& call, bool on) {
  const auto runs = runs_of(call);
  if (!runs) co_return tl::unexpected(runs.error());
  for (const auto& run : *runs) run->pause(on);
  co_return to_json(*runs);
}

}  // namespace

Answer stage_path(Call& call) { co_return stage_part(call, staged_path); }

Answer run_path(Call& call) {
  const auto request = request_of(call);
  if (!request) co_return tl::unexpected(request.error());
  auto named = members_of(call);
  if (!named) co_return tl::unexpected(named.error());
  auto given = text_of(call);
  if (!given) co_return tl::unexpected(given.error());
  const auto format = format_of(call, *given);
  if (!format) co_return tl::unexpected(format.error());
  auto& planner = call.gateway->planner;

  // It may have some megabytes, and what is read of it some more: nothing of it is copied here.
  const auto text = std::make_shared<const std::string>(std::move(*given));
  auto read = [text, format = *format, tolerance = request->tolerance] {
    return plan::read_path(*text, format, tolerance);
  };
  auto source = co_await elsewhere(planner, std::move(read));
  if (!source) co_return tl::unexpected(error_of(source.error(), "text"));
  auto members = ordered(call, *source, std::move(*named));
  if (!members) co_return tl::unexpected(members.error());
  const auto axes = co_await path_axes(*source, *members, *request);
  if (!axes) co_return tl::unexpected(axes.error());

  auto plan_it = [source = std::move(*source), text, axes = *axes, request = *request]() mutable {
    return from_where_axes_stand(std::move(source), *text, axes, request)
        .and_then([&](const auto& from_there) {
          return course_of(from_there, limits_of(axes, request), request);
        });
  };
  auto course = co_await elsewhere(planner, std::move(plan_it));
  if (!course) co_return tl::unexpected(error_of(course.error(), "text"));
  if (const auto objection = objection_to_reach(*course, *axes))
    co_return tl::unexpected(error_of(*objection, "text"));
  if (call.gateway->is_closing()) {
    co_return tl::unexpected(
        rpc_error(rpc_code::daemon_ending, "daemon_ending", "the daemon is ending"));
  }

  const auto executor = co_await boost::asio::this_coro::executor;
  const auto run =
      std::make_shared<PathRun>(executor, std::move(*course), std::move(*members), streamed(*axes),
                                options_of(*request), progress_to(call));
  const auto report = co_await PathRun::pass(run);
  if (!report) co_return tl::unexpected(call_error(report.error().error, report.error().axis));
  if (report->fault) co_return tl::unexpected(error_of(*report, *run));
  co_return to_json(*report, *run);
}

Answer pause_path(Call& call) { return pause_all(call, true); }
Answer resume_path(Call& call) { return pause_all(call, false); }

Answer stop_path(Call& call) {
  const auto runs = runs_of(call);
  if (!runs) co_return tl::unexpected(runs.error());
  for (const auto& run : *runs)
    run->end({plan::DriveFault::Kind::asked, {}, "a client has stopped the path"});
  for (const auto& run : *runs) {
    while (!run->has_ended()) co_await rest(look_interval);
  }
  if (auto failed = failure_to_stop(*runs)) co_return tl::unexpected(std::move(*failed));
  co_return to_json(*runs);
}

}  // namespace tmcld::handlers
