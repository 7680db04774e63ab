// path check.
#include <limits>

#include "api/course_view.hpp"
#include "path/leg_table.hpp"
#include "path/path_source.hpp"
#include "print.hpp"
#include "text_problems.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace plan = tmcl::plan;

Error failure_of(const verb::CheckPath& verb, const plan::PathObjection& objection,
                 Output& output) {
  if (!objection.problems.empty())
    return error_from(verb.file, objection.problems, tmcl::plan::most_text_problems, output);
  auto failure = usage_error(objection.name, verb.file + ": " + objection.message);
  failure.kind = tmcl::client::kind_of_objection(objection.name);
  return failure;
}

}  // namespace

Result<ExitCode> run(const verb::CheckPath& verb, Output& output) {
  const auto text = path::text_of(verb.file, path::most_path_bytes);
  if (!text) return tl::unexpected(text.error());
  const auto source = plan::read_path(*text, plan::format_of(verb.file, *text), verb.tolerance);
  if (!source) return tl::unexpected(failure_of(verb, source.error(), output));
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  plan::PathLimits limits;
  limits.axis.fill({verb.velocity, verb.acceleration, verb.corner_jump.value_or(unlimited)});
  const double feed = verb.feed.value_or(unlimited);
  const auto planned = plan::course_of(*source, limits, feed, verb.tolerance);
  if (!planned) return tl::unexpected(failure_of(verb, planned.error(), output));
  const auto course = tmcld::view_of(*planned, source->path.axes);
  if (!verb.svg.empty()) {
    const auto curve = tmcld::curve_of(*planned, tmcl::api::path::most_curve_points);
    if (const auto drawn = path::draw(verb.svg, verb.file, course, curve); !drawn)
      return tl::unexpected(drawn.error());
  }
  boost::json::array legs;
  if (verb.legs) legs = path::leg_table(*planned, source->path.axes, verb.microsteps_per_unit);
  if (output.json) {
    auto document = tmcl::api::to_json(course);
    if (verb.legs) document["leg_table"] = std::move(legs);
    document["file"] = verb.file;
    print_json(document, output);
  } else {
    path::print(verb.file, course, output);
    if (verb.legs) path::print_legs(legs, output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl
