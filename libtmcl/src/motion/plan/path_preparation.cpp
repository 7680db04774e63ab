#include "tmcl/plan/path_preparation.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/path_correction.hpp"
#include "tmcl/scale_factor.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

PathObjection wrong(std::string name, std::string message) {
  return {std::move(name), std::move(message), {}, {}};
}

// A table begins with the names of its columns, G-code with a word, a comment or a line of %.
bool looks_like_gcode(std::string_view text) {
  while (!text.empty()) {
    const auto line = text.substr(0, text.find('\n'));
    const auto first = line.find_first_not_of(" \t\r");
    if (first != std::string_view::npos && line[first] != '#')
      return line[first] == '(' || line[first] == ';' || line.find(',') == std::string_view::npos;
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return false;
}

// G-code counts in mm, and turns in degrees; the axes of a table are in their own units.
std::optional<PathObjection> objection_to_unit(const PathSource& source,
                                               const PathAxisFacts& facts) {
  if (source.format != PathFormat::gcode || !facts.scale || facts.scale->unit.empty())
    return std::nullopt;
  const auto& [of_file, axis] = facts.choice;
  const std::string needed = of_file < "X" ? "deg" : "mm";
  if (facts.scale->unit == needed) return std::nullopt;
  return wrong("wrong_unit", fmt::format("axis {} of G-code is in {}, and {} in {}", of_file,
                                         needed, axis, facts.scale->unit));
}

std::optional<StreamEncoder> encoder_of(const PathAxisFacts& facts) {
  const auto table = axis_parameters(*facts.model);
  const auto row = std::ranges::find(table, "encoder_position", &ParameterInfo::name);
  if (!facts.encoder_counts_per_unit || facts.scale->unit.empty() || row == table.end())
    return std::nullopt;
  const double direction = facts.scale->reverse ? -1 : 1;
  return StreamEncoder{row->number, direction * *facts.encoder_counts_per_unit};
}

PathResult<double> microsteps_of_unit(const PathAxisFacts& facts, std::optional<double> per_turn) {
  const auto& name = facts.choice.axis;
  if (!facts.scale) {
    return tl::unexpected(wrong(
        "unknown_units", fmt::format("how many microsteps a turn of {} has is not known", name)));
  }
  const double turn = facts.scale->steps.per_revolution();
  if (!facts.scale->unit.empty()) {
    const double direction = facts.scale->reverse ? -1 : 1;
    return direction * tmcl::microsteps_per_unit(*facts.scale);
  }
  if (per_turn) return turn / *per_turn;
  return tl::unexpected(wrong("unknown_unit", fmt::format("{} has no unit", name)));
}

ValueRange range_of(const Model& model, const ModuleUnits& units, std::uint8_t parameter) {
  const auto* row = find_parameter(axis_parameters(model), parameter);
  if (row == nullptr) return {0, 0};
  return tmcl::range_of(*row, initial_units(model), units);
}

Microsteps microsteps(const PathAxis& axis, double position) {
  return {static_cast<std::int32_t>(std::lround(position * axis.stream.microsteps_per_unit))};
}

std::optional<PathObjection> objection_to(double counted, const PathAxis& axis) {
  const auto& [of_file, name] = axis.choice;
  const double there = counted * axis.stream.microsteps_per_unit;
  const auto& correction = axis.scale.correction;
  const double position = correction ? correction->actual(counted) : counted;
  if (there < axis.range.least || there > axis.range.greatest) {
    return wrong(
        "out_of_range",
        fmt::format("the path goes to {} {}: {:.0f} microsteps, and {} can go to {} to {}", of_file,
                    plain_number(position, 6), there, name, axis.range.least, axis.range.greatest));
  }
  const auto limit =
      axis.limits ? beyond(*axis.limits, microsteps(axis, counted), axis.scale) : std::nullopt;
  if (!limit) return std::nullopt;
  return wrong("beyond_soft_limit", fmt::format("the path goes to {} {}: {} of {}", of_file,
                                                plain_number(position, 6), describe(*limit), name));
}

PathResult<PathSource> flattened(const tl::expected<path_file::Path, TextProblems>& path,
                                 PathFormat format, double tolerance) {
  if (!path) {
    auto objection = wrong("bad_path", "the path cannot be read");
    objection.problems = path.error();
    return tl::unexpected(std::move(objection));
  }
  auto flat = path_file::flatten(*path, tolerance * chords_part);
  if (!flat) return tl::unexpected(wrong("bad_path", flat.error()));
  if (flat->elements.empty()) return tl::unexpected(wrong("bad_path", "it moves nothing"));
  return PathSource{format, std::move(*flat)};
}

}  // namespace

// ---- the file ----

std::string_view name_of(PathFormat format) {
  return format == PathFormat::gcode ? "gcode" : "csv";
}

PathFormat format_of(std::string file_name, std::string_view text) {
  std::ranges::transform(file_name, file_name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (file_name.ends_with(".csv")) return PathFormat::csv;
  constexpr std::array<std::string_view, 5> endings{".ngc", ".nc", ".gcode", ".gco", ".tap"};
  const bool named =
      std::ranges::any_of(endings, [&](auto ending) { return file_name.ends_with(ending); });
  return named || looks_like_gcode(text) ? PathFormat::gcode : PathFormat::csv;
}

PathResult<PathSource> read_path(std::string_view text, PathFormat format, double tolerance,
                                 const path_file::GcodeSetup& setup) {
  if (format == PathFormat::csv) return flattened(path_file::read_csv(text), format, tolerance);
  return flattened(path_file::read_gcode(text, {}, setup), format, tolerance);
}

std::vector<std::string> warnings_of(const PathSource& source) {
  std::vector<std::string> all;
  for (const auto& remark : source.path.remarks)
    all.push_back(fmt::format("line {}: {}", remark.line, remark.message));
  return all;
}

StreamOptions options_of(const PathRequest& request) {
  return {request.mode, request.deviation.value_or(deviation_in_tolerances * request.tolerance),
          request.period, even_part * request.tolerance};
}

// ---- the axes ----

PathResult<std::vector<PathChoice>> in_order(const PathSource& source,
                                             const std::vector<PathChoice>& choices) {
  const auto& known = source.path.axes;
  for (const auto& choice : choices) {
    if (std::ranges::find(known, choice.of_file) != known.end()) continue;
    return tl::unexpected(wrong(
        "unknown_axis",
        fmt::format("the file has no axis {}; it has {}", choice.of_file, fmt::join(known, ", "))));
  }
  std::vector<PathChoice> ordered;
  for (const auto& of_file : known) {
    const auto found = std::ranges::find(choices, of_file, &PathChoice::of_file);
    if (found == choices.end()) {
      auto objection =
          wrong("missing_axis", fmt::format("the file moves {}: which axis is that?", of_file));
      objection.file_axis = of_file;
      return tl::unexpected(std::move(objection));
    }
    if (std::ranges::find(ordered, found->axis, &PathChoice::axis) != ordered.end())
      return tl::unexpected(wrong("named_twice", fmt::format("{} is named twice", found->axis)));
    ordered.push_back(*found);
  }
  return ordered;
}

namespace {

/// Lowers `limit`, in the file's units, to the quantity `said` of the request, which is called
/// `param` there. `convert`: into microsteps.
template <class InMicrosteps>
std::optional<PathObjection> lower(double& limit, const char* param,
                                   const std::optional<tmcl::Quantity>& said,
                                   const AxisUnits& units, double microsteps_per_unit,
                                   Result<InMicrosteps> (*convert)(const tmcl::Quantity&,
                                                                   const AxisUnits&)) {
  if (!said) return std::nullopt;
  double in_file_units = said->number;
  if (!said->unit.empty()) {
    const auto converted = convert(*said, units.undirected());
    if (!converted) {
      const auto& error = converted.error();
      return PathObjection{
          std::string(name_of(error.code)), error.message, {}, {}, param, error.hint};
    }
    in_file_units = converted->value / std::abs(microsteps_per_unit);
  }
  limit = std::min(limit, in_file_units);
  if (in_file_units >= least_of_path && in_file_units <= most_of_path) return std::nullopt;
  return PathObjection{
      "out_of_range", fmt::format("'{}' is outside 1e-9..1e9", param), {}, {}, param, {}};
}

bool has_times(const path_file::Path& path) {
  return std::ranges::any_of(path.elements, [](const auto& element) {
    const auto* line = std::get_if<path_file::LineTo>(&element);
    return line != nullptr && line->duration.has_value();
  });
}

/// Whether an axis of the file is one that a feed is about.
bool makes_length(const path_file::Path& path, const std::string& of_file) {
  const auto place = std::ranges::find(path.axes, of_file) - path.axes.begin();
  return static_cast<std::size_t>(place) < path.length_axes;
}

/// Lowers what the axis can do to what was asked for.
std::optional<PathObjection> heed(const PathSource& source, const PathRequest& request,
                                  const PathAxisFacts& facts, PathAxis& axis) {
  const AxisUnits units{facts.choice.axis, facts.model, facts.units, facts.scale};
  const double scale = axis.stream.microsteps_per_unit;
  axis.feed = axis.jerk = std::numeric_limits<double>::infinity();
  auto objection = lower(axis.velocity, "velocity", request.velocity, units, scale, to_pps);
  if (!objection) {
    objection =
        lower(axis.acceleration, "acceleration", request.acceleration, units, scale, to_pps2);
  }
  if (!objection && makes_length(source.path, facts.choice.of_file))
    objection = lower(axis.feed, "feed", request.feed, units, scale, to_pps);
  if (!objection) {
    objection = lower(axis.corner_jump, "corner_jump", request.corner_jump, units, scale, to_pps);
  }
  if (!objection) objection = lower(axis.jerk, "jerk", request.jerk, units, scale, to_pps3);
  return objection;
}

}  // namespace

PathResult<PathAxis> path_axis(const PathSource& source, const PathAxisFacts& facts,
                               const PathRequest& request) {
  const auto& name = facts.choice.axis;
  if (facts.model == nullptr || !facts.units) {
    return tl::unexpected(
        wrong("unknown_units", fmt::format("what the module of {} counts in is not known", name)));
  }
  if (auto objection = objection_to_unit(source, facts))
    return tl::unexpected(std::move(*objection));
  const auto scale = microsteps_of_unit(facts, request.per_turn);
  if (!scale) return tl::unexpected(scale.error());
  if (facts.moving) return tl::unexpected(wrong("moving", fmt::format("{} is moving", name)));
  const auto greatest = [&](std::uint8_t parameter) {
    return range_of(*facts.model, *facts.units, parameter).greatest;
  };
  PathAxis axis;
  axis.choice = facts.choice;
  axis.stream = {*scale,
                 *facts.units,
                 std::min(facts.ramp.velocity, greatest(ap::target_velocity)),
                 greatest(ap::max_acceleration),
                 greatest(number_of("stop_velocity")),
                 {},
                 facts.model->family,
                 encoder_of(facts)};
  axis.limits = facts.limits;
  axis.scale = facts.scale->unit.empty() ? microsteps_scale() : *facts.scale;
  axis.stands_at = facts.position.value / *scale;
  if (axis.scale.correction) axis.stands_at = axis.scale.correction->actual(axis.stands_at);
  axis.command = facts.command;
  axis.range = range_of(*facts.model, *facts.units, ap::target_position);
  axis.velocity = facts.ramp.velocity * facts.units->velocity.value / std::abs(*scale);
  axis.acceleration = facts.ramp.acceleration * facts.units->acceleration.value / std::abs(*scale);
  axis.corner_jump = facts.corner_jump;
  if (facts.scale->unit.empty()) axis.corner_jump /= std::abs(*scale);
  if (!(axis.velocity > 0 && axis.acceleration > 0)) {
    return tl::unexpected(wrong(
        "no_limits",
        fmt::format("{} has max_velocity {} and {} as its smallest acceleration: it cannot move",
                    name, facts.ramp.velocity, facts.ramp.acceleration)));
  }
  if (auto objection = heed(source, request, facts, axis))
    return tl::unexpected(std::move(*objection));
  axis.stream.greatest_velocity = fastest_within(axis.velocity, axis.stream);
  return axis;
}

std::int32_t fastest_within(double velocity, const StreamAxis& axis) {
  constexpr double rounding = 1e-6;
  const double most = velocity * std::abs(axis.microsteps_per_unit) / axis.units.velocity.value;
  const double told = std::max(std::floor(most + rounding), 1.0);
  return static_cast<std::int32_t>(std::min<double>(told, axis.greatest_velocity));
}

// A unit of speed may be greater than the spare part of a low limit.
double planned_within(double velocity, const StreamAxis& axis) {
  const double told = fastest_within(velocity, axis) * axis.units.velocity.value /
                      std::abs(axis.microsteps_per_unit);
  return (1 - spare_velocity) * std::min(velocity, told);
}

bool moves_alike(const PathAxis& one, const PathAxis& other) {
  return one.stream.microsteps_per_unit == other.stream.microsteps_per_unit &&
         one.stream.units == other.stream.units && one.velocity == other.velocity &&
         one.acceleration == other.acceleration && one.corner_jump == other.corner_jump &&
         one.jerk == other.jerk && one.scale.correction == other.scale.correction;
}

std::vector<StreamAxis> streamed(const std::vector<PathAxis>& axes) {
  std::vector<StreamAxis> all;
  for (const auto& axis : axes) all.push_back(axis.stream);
  return all;
}

// ---- the course ----

PathResult<PathSource> from_where_axes_stand(PathSource source, std::string_view text,
                                             const std::vector<PathAxis>& axes,
                                             const PathRequest& request) {
  if (source.format != PathFormat::gcode) return source;
  path_file::Point start{};
  for (const auto& axis : axes)
    start[path_file::gcode_axes.find(axis.choice.of_file)] = axis.stands_at;
  const auto& setup = request.setup ? *request.setup : path_file::GcodeSetup();
  return flattened(path_file::read_gcode(text, start, setup), source.format, request.tolerance);
}

PathResult<PathSource> by_steps(PathSource source, const std::vector<PathAxis>& axes) {
  std::vector<std::shared_ptr<const Correction>> corrections;
  for (const auto& axis : axes) corrections.push_back(axis.scale.correction);
  auto counted = as_counted(std::move(source.path), corrections);
  if (!counted) return tl::unexpected(wrong("bad_path", counted.error()));
  return PathSource{source.format, *std::move(counted)};
}

PathLimits limits_of(const PathSource& source, const std::vector<PathAxis>& axes) {
  const bool timed = has_times(source.path);
  PathLimits limits;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto& axis = axes[i];
    const double velocity = timed ? axis.velocity : planned_within(axis.velocity, axis.stream);
    limits.axis[i] = {velocity, axis.acceleration, axis.corner_jump};
    limits.jerk = std::min(limits.jerk, axis.jerk);
  }
  return limits;
}

PathResult<double> feed_of(const std::vector<PathAxis>& axes) {
  constexpr double rounding = 1e-9;
  auto bounded = axes;
  std::erase_if(bounded, [](const PathAxis& axis) { return std::isinf(axis.feed); });
  if (bounded.empty()) return std::numeric_limits<double>::infinity();
  const auto [least, greatest] = std::ranges::minmax_element(bounded, {}, &PathAxis::feed);
  if (least->feed == greatest->feed || greatest->feed - least->feed <= rounding * least->feed)
    return least->feed;
  return tl::unexpected(
      PathObjection{"wrong_unit",
                    fmt::format("'feed' is {} a second in the unit of {}, and {} in that of {}",
                                plain_number(least->feed, 6), least->choice.axis,
                                plain_number(greatest->feed, 6), greatest->choice.axis),
                    {},
                    {},
                    "feed",
                    "give a number, in units of the file per second"});
}

PathResult<Course> course_of(const PathSource& source, PathLimits limits, double feed,
                             double tolerance, const std::optional<Shaping>& shaping) {
  limits.axes = source.path.axes.size();
  limits.corner_tolerance = tolerance * corners_part;
  return Course::of(source.path, limits, feed, shaping).map_error([](const std::string& why) {
    return wrong("bad_path", why);
  });
}

std::optional<PathObjection> objection_to_reach(const Course& course,
                                                const std::vector<PathAxis>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (const double position : {course.least()[i], course.greatest()[i]}) {
      if (auto objection = objection_to(position, axes[i])) return objection;
    }
  }
  return std::nullopt;
}

// ---- how it went ----

std::string_view name_of(const DriveFault& fault) {
  switch (fault.kind) {
    case DriveFault::Kind::asked: return "stopped";
    case DriveFault::Kind::refused: return "command_failed";
    case DriveFault::Kind::foreign: {
      const bool is_stop = !fault.error || fault.error->code == Errc::superseded_by_stop;
      return is_stop ? "stopped_by_other" : name_of(fault.error->code);
    }
    case DriveFault::Kind::starved: return "starved";
    case DriveFault::Kind::off_course: return "off_path";
    case DriveFault::Kind::not_at_start: return "not_at_start";
    case DriveFault::Kind::unsuited: return "unsuited";
    case DriveFault::Kind::slow_bus: return "slow_bus";
    case DriveFault::Kind::no_end: return "not_at_end";
  }
  return {};
}

std::string_view name_of(PathStream::Phase phase) {
  switch (phase) {
    case PathStream::Phase::approaching: return "approaching";
    case PathStream::Phase::before: return "measuring";
    case PathStream::Phase::running: return "running";
    case PathStream::Phase::pausing: return "pausing";
    case PathStream::Phase::waiting: return "waiting";
    case PathStream::Phase::after:
    case PathStream::Phase::ended: return "ending";
  }
  return {};
}

bool is_before_motion(DriveFault::Kind kind) {
  return kind == DriveFault::Kind::not_at_start || kind == DriveFault::Kind::unsuited ||
         kind == DriveFault::Kind::slow_bus;
}

}  // namespace tmcl::plan
