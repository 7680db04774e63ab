/// A course, carried out on the axes of modules: what to tell which axis when, without I/O.
///
/// Its runner does what Drive says.
///
/// First it measures how long a command takes, and that the axes stand where the course starts.
///
/// StreamMode::velocity streams velocities to any module. Each update brings the axis to where the
/// course will be one update later; what the readings of its position differ from that is corrected
/// slowly. Each command may be the last one: the axis is sent to the end of the stretch on which
/// the course goes one way, and the velocities are parameter 4, the greatest speed on the way
/// there; 0 where it stands. Where a ramp generator may not take that at once (families
/// tmc4361 and firmware) they are ROR and ROL. The acceleration parameters are raised while it runs
/// where they have to be. It ends with a move to the exact end.
///
/// StreamMode::segments tells an axis what changes only where the speed of the course bends: the
/// speed that it is to have from then on, and the acceleration that leads there (AN-035: at t1 and
/// at t3). An axis that is seen off the course is brought back within some updates. Where the speed
/// does not jump, it takes no more than the axis' own acceleration and a tenth.
///
/// StreamMode::position loads the legs of the course one after the other into ramp generators with
/// stop speeds (family sixpoint): the next one when the axes are at the joint by their twins. One
/// that goes on there is sent beyond it, by its way to rest: if the next leg is late, it brakes by
/// its ramp. Targets are written as parameter 0, which does not start a motor that was stopped.
///
/// At a halt of the course the axes stand; then its word is carried out, or the stream waits. If it
/// ends early, M5 and M9 are carried out beside the stops, for what may have been switched on.
///
/// Before an axis is told anything new, it is asked what it does (parameter 2, or its ramp mode).
/// If that is not what it was sent, another client stopped or turned it, and all axes are stopped.
/// That is the case, too, when a command fails, when updates come too late, and when a reading is
/// off the course by too much.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/drive.hpp"

namespace tmcl::plan {

/// So many updates may be missing before a stream has starved.
constexpr int most_late_updates = 10;
/// What part of a difference between course and axis one update makes up for.
constexpr double position_gain = 0.5;
/// What part of the axis' greatest velocity on the course that may take at most.
constexpr double most_correction = 0.5;
/// What part of a difference between reading and expectation is believed, where the time between
/// question and answer may explain it; what that does not explain is believed at once.
constexpr double observer_gain = 0.2;
/// How much of the bus a stream leaves to others, and to chance.
constexpr double spare_part_of_bus = 0.25;
constexpr Duration shortest_stream_period = std::chrono::milliseconds(5);

enum class StreamMode : std::uint8_t { velocity, segments, position };
/// "segments"; part of the stable interface.
std::string_view name_of(StreamMode mode);
std::optional<StreamMode> stream_mode_named(std::string_view name);

/// What tells where the motor of an axis is, whatever its generator says.
struct StreamEncoder {
  std::uint8_t parameter = 0;  ///< That has what it counts, 32 bits.
  double counts_per_unit = 1;  ///< Of the course; negative where it counts the other way.
};

/// An axis of the course, and how its module counts.
struct StreamAxis {
  double microsteps_per_unit = 1;  ///< Negative where the axis counts the other way.
  ModuleUnits units{};
  std::int32_t greatest_velocity = 0;       ///< That it is told, in the module's unit.
  std::int32_t greatest_acceleration = 0;   ///< That parameter 5 takes.
  std::int32_t greatest_stop_velocity = 0;  ///< That parameter 20 takes; position mode only.
  std::optional<AxisTwin> twin{};           ///< Set as the axis is; position mode only.
  Family family = Family::firmware;         ///< Velocity mode, and by segments.
  /// Only reported on: read where an update leaves time to, and in place of some positions. Where
  /// the course starts it counts as being where the axis is.
  std::optional<StreamEncoder> encoder{};
};

struct StreamOptions {
  StreamMode mode = StreamMode::velocity;
  /// How far a reading of an axis may be off the course, in its units.
  double most_deviation = 1;
  /// No updates more often than this, in velocity mode and by segments.
  Duration period_min = shortest_stream_period;
  /// Position mode: a leg on which a constant speed stays so close to the course is passed with it,
  /// and takes fewer commands. By segments: an axis that is farther off is brought back.
  double even_within = 0.005;
  /// Brings the axes to the start of the course first; otherwise they must stand there.
  bool to_start = false;
  /// Of the places where the axes are seen so many are kept. Of more, every second is left out,
  /// over the whole course.
  std::size_t most_seen = 0;
  /// Whether it waits at halts that say so until pause(false); it goes on by itself otherwise.
  bool waits = true;
};

struct AxisTracking {
  std::size_t readings = 0;
  double largest = 0;  ///< The largest difference between reading and course, in units.
  double squares = 0;
  double rms() const;
};

struct SeenPlace {
  double at_s = 0;  ///< In seconds of the course.
  AxisValues place{};
  AxisValues on_path{};  ///< The point of the path that is nearest.
};

/// How near to their course axes were seen.
struct CourseSight {
  std::vector<AxisTracking> axes;
  double largest_off = 0;       ///< Across the path, as far as readings tell; in units.
  double largest_off_at_s = 0;  ///< When that was, in seconds of the course.
  AxisValues largest_off_at{};  ///< Where the axes were then.
  double largest_lag_s = 0;     ///< Along it: how late the axes were at most.
  std::vector<SeenPlace> seen;  ///< In the order of time.
};

/// By the positions of the axes.
struct StreamReport : DriveReport, CourseSight {
  Duration round_trip{};        ///< Mean of a command's.
  Duration worst_round_trip{};  ///< Before anything moved.
  Duration period{};            ///< Of updates; position mode: the least time for a leg.
  Duration worst_delay{};       ///< Of an update, or of a leg's load.
  std::size_t updates = 0;      ///< Velocity mode: of all axes; segments; position mode: legs.
  std::size_t commands = 0;     ///< While the course was passed.
  double passed_s = 0;          ///< How long that took.
  double busy_s = 0;            ///< How much of that commands took.
  /// By the encoders of those that have one, and the positions of the others; nothing without any.
  std::optional<CourseSight> motors;
};

/// What part of the planned speed a course may be passed with, if another one is asked for.
constexpr double least_feed = 0.1;
constexpr double most_feed = 2;
/// In position mode the legs are with the modules already.
constexpr bool takes_feed(StreamMode mode) { return mode != StreamMode::position; }

struct StreamFeed {
  double asked = 1;   ///< Parts of the planned speed.
  double now = 0;     ///< What there is of it: less where a limit of an axis does not allow more.
  bool held = false;  ///< A pause was asked for, or it waits at a halt.
};

class StreamRunner;

class PathStream final : public Drive {
 public:
  enum class Phase : std::uint8_t { approaching, before, running, pausing, waiting, after, ended };

  /// `course` must outlive it; one StreamAxis for each of its axes.
  PathStream(const Course& course, std::vector<StreamAxis> axes, StreamOptions options);
  ~PathStream() override;
  PathStream(PathStream&&) noexcept;
  PathStream& operator=(PathStream&&) noexcept;

  /// The course is left at no point: time on it goes slower until it stands. In position mode it
  /// stands where the course itself does next. `on` false: what waits at a halt goes on, too.
  void pause(bool on);

  /// From now on this part of the planned speed, least_feed..most_feed; takes_feed() says in which
  /// modes. No axis exceeds the limits of the course: more than 1 where those leave room.
  void set_feed(double factor);
  StreamFeed feed() const;

  Phase phase() const;
  /// The halt of the course at which it waits; null if it does not.
  const CourseHalt* waits_at() const;
  /// How much of the course has been passed, in its seconds.
  double passed() const;
  const StreamReport& report() const;

 private:
  StreamRunner& runner() const;
};

}  // namespace tmcl::plan
