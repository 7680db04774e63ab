/// What is behind a PathStream: what its modes share. Each mode is a class of its own.
#pragma once

#include <algorithm>
#include <memory>

#include "motion/drive/course_clock.hpp"
#include "motion/drive/course_watch.hpp"
#include "motion/drive/drive_runner.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/stream.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {

/// The axis parameter of the chips that slow down by another acceleration than they speed up by.
inline constexpr auto dmax = number_of("max_deceleration");

inline Duration duration(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// On a leg, and between its loads, an axis is looked at so often.
constexpr Duration watch_interval = std::chrono::milliseconds(20);

/// A long course is not looked at all at once, which would take seconds: the stream's runner is
/// waited for after so many legs, or points.
constexpr std::size_t looks_per_slice = 1000;
constexpr bool yields_at(std::size_t look) { return look % looks_per_slice == looks_per_slice - 1; }

/// How long a bus is taken by so many commands, with what a stream leaves to others.
double time_to_send(Duration round_trip, std::size_t commands);

/// Why it ended early, if it did.
using StreamScript = Script<std::optional<DriveFault>>;

class StreamRunner : public DriveRunner {
 public:
  using Phase = PathStream::Phase;

  StreamRunner(const Course& course, std::vector<StreamAxis> axes, StreamOptions options);

  void pause(bool on) {
    on_pause(on);
    if (phase_ == Phase::running && on) phase_ = Phase::pausing;
    if (phase_ == Phase::pausing && !on) phase_ = Phase::running;
    if (waits_ && !on) may_go_on_ = true;
  }
  void set_feed(double factor) {
    asked_feed_ = factor;
    on_feed();
  }
  StreamFeed feed() const {
    const bool runs = phase_ == Phase::running || phase_ == Phase::pausing;
    const bool stands = clock_.halt() != nullptr;
    return {asked_feed_, runs && !stands ? clock_.rate() : 0, is_held() || is_waiting()};
  }
  Phase phase() const { return is_waiting() && phase_ == Phase::running ? Phase::waiting : phase_; }
  const CourseHalt* waits_at() const { return is_waiting() ? clock_.next_halt() : nullptr; }
  double passed() const { return std::min(clock_.passed(), course_.duration()); }
  const StreamReport& report() const { return report_; }

 protected:
  /// Before anything moves: whether the mode can do it, and what it has to know and to set.
  virtual Script<Fault> prepare() = 0;
  virtual Script<Fault> pass_course() = 0;
  virtual void on_pause(bool on) { clock_.pause(on); }
  virtual void on_feed() { clock_.set_factor(asked_feed_); }
  virtual bool is_held() const { return clock_.paused(); }
  /// At the end of the course the axes come to rest by themselves; otherwise they are stopped.
  virtual bool rests_at_end() const { return false; }
  /// Of an axis, now.
  virtual double planned_position(std::size_t axis) const {
    return course_.at(clock_.passed()).position[axis];
  }

  /// The course is at a halt, and no axis has been told to move: does what is to be done there, and
  /// lets the course go on after `lead`. Leaves it there while it waits.
  Script<Fault> pass_halt(Duration lead);
  std::int32_t microsteps(std::size_t axis, double position) const;
  Script<Fault> check(std::size_t axis);
  Script<Fault> read_position(std::size_t axis);
  /// Of the next axis that has one, if that is over by then.
  Script<Fault> look_at_encoder(TimePoint limit = TimePoint::max());
  /// Whether this reading is of an encoder, and not of a position: each fourth, as short segments
  /// and legs leave no time for both.
  bool reads_encoder(std::size_t reading) const { return motor_watch_ && reading % 4 == 3; }
  /// The axis whose position is read next, in turn.
  std::size_t next_to_read() { return positions_read_++ % axes(); }
  Fault note_delay(Duration late, Duration period);

  const Course& course_;
  const StreamOptions options_;
  std::vector<StreamAxis> axes_;
  /// What a parameter of an axis reads unless another client stops or turns it.
  std::vector<std::optional<Setting>> told_;
  StreamReport report_;
  CourseClock clock_;
  double asked_feed_ = 1;    ///< Part of the planned speed.
  bool waits_ = false;       ///< At the halt of its clock, until it may go on.
  std::size_t watched_ = 0;  ///< The axis that is looked at next.

 private:
  bool is_waiting() const { return waits_ && !may_go_on_; }
  Script<Fault> whole() override;
  void on_answered(Duration took) override;
  Script<Fault> measure();
  Script<Fault> arrive_at_end();
  Script<Fault> go_to(AxisValues position, TimePoint limit);
  Script<Fault> check_all();
  Script<Fault> start_encoders();
  Fault take_reading(std::size_t axis);
  void take_count(std::size_t axis);
  AxisValues planned_positions() const;
  Script<Fault> come_to_halt();
  Script<Fault> carry_out(const CourseHalt& halt);
  Fault not_carried_out(const CourseHalt& halt, const Error& error) const;
  std::vector<std::uint8_t> take_words_at_stop() override;

  CourseWatch watch_;
  std::optional<CourseWatch> motor_watch_;
  std::vector<std::int32_t> start_counts_;  // of the encoders, where the path starts
  std::size_t positions_read_ = 0;
  std::size_t encoder_ = 0;  // the axis whose encoder was looked at last
  Phase phase_ = Phase::before;
  bool may_go_on_ = false;
  // What may have been switched on, by the word that switches it off.
  std::vector<std::uint8_t> off_words_;
};

using StreamAxes = std::vector<StreamAxis>;
std::unique_ptr<StreamRunner> velocity_runner(const Course&, StreamAxes, StreamOptions);
std::unique_ptr<StreamRunner> segment_runner(const Course&, StreamAxes, StreamOptions);
std::unique_ptr<StreamRunner> position_runner(const Course&, StreamAxes, StreamOptions);

}  // namespace tmcl::plan
