/// What is behind a PathStream: a script whose steps are commands to axes, and pauses.
#pragma once

#include <map>

#include "tmcl/plan/stream.hpp"
#include "tmcl/script.hpp"

namespace tmcl::plan {

inline double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }
inline Duration duration(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// How much of the course has been passed; may go slower than time, down to a standstill and up
/// again.
class CourseClock {
 public:
  void start(TimePoint now, bool stands);
  void set_ramp(double seconds) { ramp_s_ = seconds; }
  void pause(bool on) { paused_ = on; }
  bool paused() const { return paused_; }
  void advance(TimePoint now);
  double passed() const { return passed_; }
  /// So much later than the last advance().
  double passed_in(Duration ahead) const;

 private:
  double passed_after(double time, double& rate) const;

  TimePoint at_{};
  double passed_ = 0;
  double rate_ = 1;
  double ramp_s_ = 0;
  bool paused_ = false;
};

class PathStream::Runner {
 public:
  Runner(const Course& course, std::vector<StreamAxis> axes, StreamOptions options);

  StreamStep next(TimePoint now);
  void answered(TimePoint now, StreamAnswer answer);
  void stop() { stop_asked_ = true; }
  void pause(bool on) {
    pause_asked_ = on;
    if (options_.mode == StreamMode::velocity) clock_.pause(on);
    if (phase_ == Phase::running && on) phase_ = Phase::pausing;
    if (phase_ == Phase::pausing && !on) phase_ = Phase::running;
  }
  Phase phase() const { return phase_; }
  double passed() const { return std::min(clock_.passed(), course_.duration()); }
  const StreamReport& report() const { return report_; }

 private:
  using Fault = std::optional<StreamFault>;

  struct Axis {
    StreamAxis info;
    std::map<std::uint8_t, std::int32_t> before;      // parameters, as they were
    std::map<std::uint8_t, std::int32_t> parameters;  // as they are
    std::optional<std::int32_t> velocity;             // what parameter 2 is to read
    // Velocity mode: where it should be by what it was told, in microsteps, and when that was.
    // Position mode: how far it is ahead of its twin.
    double position = 0;
    double pps = 0;
    TimePoint at{};
    TimePoint due{};
    Duration twin_begin{};  // what its twin counted at twin_start_
  };

  struct Awaiter {
    StreamStep step;
    Runner* runner;
    bool await_ready() const noexcept { return false; }
    template <class Promise>
    void await_suspend(std::coroutine_handle<Promise> script) {
      runner->step_ = step;
      script.promise().state->step = tmcl::step::Pause{};
    }
    void await_resume() const noexcept {}
  };
  Awaiter command(StreamCommand command) { return {command, this}; }
  Awaiter until(TimePoint time) { return {StreamWait{time}, this}; }

  bool wait_is_over() const;
  void proceed(const std::optional<Step>& step);
  TimePoint middle() const;
  static Fault fault(StreamFault::Kind kind, std::size_t axis, std::string message);
  Fault refusal(std::size_t axis) const;
  Fault asked_to_stop() const;
  std::int32_t microsteps(std::size_t axis, double position) const;

  Script<Fault> whole();
  Script<Fault> measure();
  Script<Fault> stop_all();
  Script<Fault> come_to_rest(std::vector<bool> which);
  Script<Fault> restore();
  Script<Fault> arrive();
  Script<Fault> know(std::size_t axis, std::uint8_t parameter);
  Script<Fault> set(std::size_t axis, std::uint8_t parameter, std::int32_t value);
  Script<Fault> check(std::size_t axis);
  Script<Fault> read_position(std::size_t axis);
  Fault take_reading(std::size_t axis);
  Fault note_delay(Duration late, Duration period);

  // Velocity mode.
  Script<Fault> prepare_velocities();
  Script<Fault> by_velocity();
  Script<Fault> update(std::size_t axis);
  std::int32_t velocity_for(std::size_t axis) const;
  double expected(std::size_t axis, TimePoint at) const;
  void note_velocity(std::size_t axis, std::int32_t velocity);
  void correct(std::size_t axis);
  double steepest(std::size_t axis) const;
  void set_pause_ramp();

  // Position mode.
  struct Load {
    std::int32_t vmax = 0, amax = 0, dmax = 0, vstop = 0, target = 0;
  };
  Script<Fault> prepare_legs();
  Script<Fault> by_position();
  Script<Fault> start_ramps();
  Script<Fault> pause_between(const CourseLeg& next);
  Script<Fault> load(const CourseLeg& leg);
  Script<Fault> load_axis(const CourseLeg& leg, std::size_t axis);
  CourseLeg leg_at(std::size_t index) const;
  Fault fault_of_legs();
  std::size_t commands_of(std::size_t leg) const;
  Load load_for(const CourseLeg& leg, std::size_t axis);
  Duration lead_of(std::size_t leg) const;
  Duration ahead_of(std::size_t leg) const;
  double expected_of_twin(std::size_t axis) const;
  void correct_twin(std::size_t axis);
  void let_twin_run(std::size_t axis, TimePoint to);

  const Course& course_;
  StreamOptions options_;
  std::vector<Axis> axes_;
  StreamReport report_;
  std::optional<Script<Fault>> script_;
  StreamStep step_ = StreamEnd{};
  StreamAnswer answer_ = 0;
  TimePoint now_{};
  TimePoint asked_at_{};
  TimePoint twin_start_{};
  CourseClock clock_;
  bool stop_asked_ = false;
  bool pause_asked_ = false;
  Phase phase_ = Phase::before;
};

}  // namespace tmcl::plan
