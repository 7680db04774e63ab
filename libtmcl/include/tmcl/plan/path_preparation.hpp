/// From the text of a path file and what is known of some axes to a course that they can pass:
/// everything that is to be found out, and found wrong, before anything moves.
///
///     auto source = read_path(text, PathFormat::gcode, request.tolerance);
///     for (const auto& choice : *in_order(*source, choices)) axes.push_back(*path_axis(...));
///     source = from_where_axes_stand(std::move(*source), text, axes, request);
///     source = by_steps(std::move(*source), axes);
///     auto limits = limits_of(*source, axes);
///     auto course = course_of(*source, limits, *feed_of(axes), request.tolerance);
///     auto wrong = objection_to_reach(*course, axes);
///     PathStream stream(*course, streamed(axes), options_of(request));
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/mechanics.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/path_file.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/plan/stream.hpp"
#include "tmcl/quantity.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::plan {

constexpr double default_path_tolerance = 0.05;
/// What part of a tolerance chords may use up, what part corners, and what part legs that are
/// passed at an even speed; the rest is for the axes.
constexpr double chords_part = 0.25;
constexpr double corners_part = 0.5;
constexpr double even_part = 0.1;
/// How far off its plan an axis may be seen, unless the request says otherwise.
constexpr double deviation_in_tolerances = 20;
/// Between these are all numbers of a request.
constexpr double least_of_path = 1e-9;
constexpr double most_of_path = 1e9;
/// What part of a velocity legs leave to an axis that is behind: it catches up within its limit.
constexpr double spare_velocity = 0.02;
constexpr Duration longest_stream_period = std::chrono::seconds(1);

/// Why a path is not run; nothing has moved.
struct PathObjection {
  std::string name;         ///< snake_case; part of the stable interface.
  std::string message;      ///< One sentence without a full stop.
  TextProblems problems{};  ///< What is wrong with the text, if that is it.
  std::string file_axis{};  ///< Of the text, if it is for the user to name one; else empty.
  std::string param{};      ///< Of the request, if that is what is wrong.
  std::string hint{};       ///< What to try; may be empty.
};
template <class T>
using PathResult = tl::expected<T, PathObjection>;

enum class PathFormat : std::uint8_t { csv, gcode };
std::string_view name_of(PathFormat format);

/// By the file's name (.csv; .ngc, .nc, .gcode, .gco, .tap), otherwise by the first line that says
/// something.
PathFormat format_of(std::string file_name, std::string_view text);

struct PathSource {
  PathFormat format = PathFormat::csv;
  path_file::Path path;  ///< Without arcs.
};
/// G-code as if all axes stood at zero.
PathResult<PathSource> read_path(std::string_view text, PathFormat format, double tolerance,
                                 const path_file::GcodeSetup& setup = {});
/// What of the text is not carried out; a sentence for each, without a full stop.
std::vector<std::string> warnings_of(const PathSource& source);

/// What a user asks for; lengths, and quantities without a unit, in the file's units.
struct PathRequest {
  StreamMode mode = StreamMode::velocity;
  double tolerance = default_path_tolerance;
  std::optional<tmcl::Quantity> velocity{}, acceleration{};  ///< Of each axis.
  std::optional<tmcl::Quantity> feed{};                      ///< Along the path.
  std::optional<tmcl::Quantity> corner_jump{};               ///< Of each axis, in a corner.
  std::optional<double> per_turn{};   ///< What a turn of the motor is, for axes without a unit.
  std::optional<double> deviation{};  ///< How far off its plan an axis may be seen.
  Duration period = shortest_stream_period;
  std::shared_ptr<const path_file::GcodeSetup> setup{};  ///< Null: nothing is said of the machine.
  std::optional<Shaping> shaping{};
  std::optional<tmcl::Quantity> jerk{};        ///< Along the path.
  std::optional<ramp::Resonance> resonance{};  ///< What is told of it counts for such loads.
};
StreamOptions options_of(const PathRequest& request);

/// "X=left": which axis of the file is which axis.
struct PathChoice {
  std::string of_file;
  std::string axis;
};
/// In the order of the file's axes. Objections: unknown_axis, missing_axis, named_twice.
PathResult<std::vector<PathChoice>> in_order(const PathSource& source,
                                             const std::vector<PathChoice>& choices);

/// What is known of an axis, however it is reached.
struct PathAxisFacts {
  PathChoice choice;
  const Model* model = nullptr;        ///< Null for one that is not known.
  std::optional<ModuleUnits> units{};  ///< Nothing where they are not known.
  std::optional<UserScale> scale{};    ///< Its unit is empty if the axis has none.
  std::optional<SoftLimits> limits{};  ///< In its unit; without one in microsteps.
  RampLimits ramp{};                   ///< As its parameters have them.
  /// By which its velocity may change at once; in its unit a second, without one in microsteps.
  double corner_jump = std::numeric_limits<double>::infinity();
  Microsteps position{};
  bool moving = false;
  Duration command{};  ///< How long a command to it takes.
  /// Of its unit, if an encoder tells where its motor is.
  std::optional<double> encoder_counts_per_unit{};
};

struct PathAxis {
  PathChoice choice;
  StreamAxis stream;  ///< Without a twin, which position mode needs.
  std::optional<SoftLimits> limits;
  UserScale scale;          ///< What the limits are in.
  ValueRange range;         ///< Of positions, in microsteps.
  double velocity = 0;      ///< What its parameters and the request allow, in the file's units.
  double acceleration = 0;  ///< What these allow of acceleration.
  double corner_jump = 0;   ///< What the configuration and the request allow; may be infinite.
  /// What the request allows along the path; infinite if nothing, or for an axis that goes along.
  double feed = 0;
  double stands_at = 0;  ///< In the file's units, corrected.
  Duration command{};    ///< How long a command to it takes.
  double jerk = 0;       ///< What the request allows along the path; may be infinite.
};
/// Objections: what is not known of an axis; one whose unit is not the file's, or that moves, or
/// cannot; a quantity that it cannot be measured in, by the name of the Errc.
PathResult<PathAxis> path_axis(const PathSource& source, const PathAxisFacts& facts,
                               const PathRequest& request);
/// The greatest speed in its module's unit that is not beyond `velocity`, in units of the course,
/// nor beyond its greatest; 1 at least, without which it would not move.
std::int32_t fastest_within(double velocity, const StreamAxis& axis);
/// With which legs are planned, in units of the course: what that speed leaves without its spare
/// part.
double planned_within(double velocity, const StreamAxis& axis);
/// Whether a course that was planned for the one suits the other, wherever they stand.
bool moves_alike(const PathAxis& one, const PathAxis& other);
std::vector<StreamAxis> streamed(const std::vector<PathAxis>& axes);

/// The same G-code from where its axes stand; a table says itself where it begins.
PathResult<PathSource> from_where_axes_stand(PathSource source, std::string_view text,
                                             const std::vector<PathAxis>& axes,
                                             const PathRequest& request);

/// The same path by the steps of its axes, which their tables correct: what course_of() is about.
PathResult<PathSource> by_steps(PathSource source, const std::vector<PathAxis>& axes);

/// Legs leave a spare part of the velocity; a table with times says itself how fast it is.
PathLimits limits_of(const PathSource& source, const std::vector<PathAxis>& axes);
/// In the file's units. Objection: wrong_unit, if it is another in the units of each axis.
PathResult<double> feed_of(const std::vector<PathAxis>& axes);
/// For axes that can do what `limits` says; `limits` without a tolerance of corners. `feed` may be
/// infinite.
PathResult<Course> course_of(const PathSource& source, PathLimits limits, double feed,
                             double tolerance, const std::optional<Shaping>& shaping = {});
/// Whether a point is where the axes cannot or may not go.
std::optional<PathObjection> objection_to_reach(const Course& course,
                                                const std::vector<PathAxis>& axes);

// ---- how it went ----

/// snake_case; part of the stable interface. What has taken the right to move an axis away has a
/// name of its own, unless it was a stop.
std::string_view name_of(const DriveFault& fault);
/// Such as "running".
std::string_view name_of(PathStream::Phase phase);
/// Whether nothing has moved.
bool is_before_motion(DriveFault::Kind kind);

}  // namespace tmcl::plan
