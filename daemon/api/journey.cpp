#include "api/journey.hpp"

#include <boost/json/array.hpp>

#include "api/staging.hpp"
#include "tmcl/drive_report.hpp"

namespace tmcld {

namespace json = boost::json;
namespace plan = tmcl::plan;

Result<std::string> text_of(const Call& call, const std::optional<std::string>& text,
                            std::optional<std::uint32_t> bytes) {
  if (text.has_value() == bytes.has_value()) {
    return tl::unexpected(
        param_error("bad_argument", "text", "give one of 'text' and 'bytes', and not both"));
  }
  if (text) return *text;
  return take_staged(call, staged_path, *bytes).map([](const std::vector<std::uint8_t>& staged) {
    return std::string(reinterpret_cast<const char*>(staged.data()), staged.size());
  });
}

Result<PlanningBudget::Place> place_to_plan(const Call& call, std::size_t text_bytes) {
  return place_for(call, PlanningBudget::bytes_for(text_bytes));
}

Result<PlanningBudget::Place> place_for(const Call& call, std::size_t bytes) {
  const auto client = call.peer->client();
  auto place = call.gateway->planning.take(client.number, client.name, bytes);
  if (!place) return tl::unexpected(call_error(place.error()));
  return std::move(*place);
}

void add_problems(Error& error, const tmcl::TextProblems& problems) {
  json::array all;
  for (const auto& problem : problems) {
    all.push_back(json::object{
        {"line", problem.line}, {"column", problem.column}, {"message", problem.message}});
  }
  error.subject["problems"] = std::move(all);
}

Error error_of(const plan::PathObjection& objection, std::string_view param) {
  if (!objection.param.empty()) param = objection.param;
  auto error = param_error(objection.name, param, objection.message, objection.hint);
  if (!objection.file_axis.empty()) error.subject["file_axis"] = objection.file_axis;
  if (objection.problems.empty()) return error;
  const auto& first = objection.problems.front();
  error.message += ": line " + std::to_string(first.line) + ": " + first.message;
  add_problems(error, objection.problems);
  return error;
}

std::optional<Error> refusal_to_begin(const Call& call) {
  if (!call.gateway->is_closing()) return std::nullopt;
  return failed("daemon_ending", "the daemon is ending");
}

void add_outcome(Error& error, const std::vector<std::string>& unstopped) {
  error.outcome = unstopped.empty() ? tmcl::Outcome::done : tmcl::Outcome::unknown;
  if (!unstopped.empty())
    error.subject["unstopped"] = json::array(unstopped.begin(), unstopped.end());
}

Error error_of(const AwaitedRun& run, json::object report) {
  const auto& fault = *run.report().fault;
  const auto unstopped = run.unstopped();
  const bool moved = !is_before_motion(fault.kind);
  const bool starved = fault.kind == tmcl::plan::DriveFault::Kind::starved;
  const auto* hint = !unstopped.empty() ? stop_them
                     : starved ? "all its axes were stopped; this computer was busy: a longer "
                                 "period, or mode 'segments' where the model has it, needs "
                                 "fewer updates"
                               : "all its axes were stopped";
  auto error = failed(name_of(fault), run.text_of(fault), moved ? hint : "");
  if (moved) add_outcome(error, unstopped);
  error.subject["axis"] = run.axis_names()[fault.axis.value_or(0)];
  error.subject["run"] = std::move(report);
  return error;
}

std::vector<std::string> remarks_of(const AwaitedRun& run) {
  return tmcl::remarks_of(run.report(), run.axis_names());
}

}  // namespace tmcld
