/// A stream of positions: legs, loaded into ramp generators one after the other.
#pragma once

#include <string>

#include "motion/drive/ramp_legs.hpp"

namespace tmcl::plan {

inline constexpr auto vstop = number_of("stop_velocity");
inline constexpr Duration look_interval = std::chrono::milliseconds(10);
/// What part of the speed it was told for a joint an axis may lack when its ramp is loaded.
inline constexpr double near_speed = 1. / 32;

class PositionRunner final : public StreamRunner {
 public:
  using StreamRunner::StreamRunner;

 private:
  using Drive = Passage::Drive;
  /// How an axis comes to a leg, and so what of it may be written when.
  enum class Way : std::uint8_t {
    goes_on,       ///< At its speed: the next one is what it changes at the joint.
    goes_on_late,  ///< Its speed still changes when the load begins.
    brakes,        ///< Until its target is replaced.
    from_rest,     ///< Its target sets it off.
    turns,         ///< It is sent back when it stands at the joint.
  };
  struct Load {
    std::size_t axis;
    Way way;
    std::int32_t amax, dmax, vstop, target;
  };
  struct TwinState {
    Duration begin{};  ///< What the twin counted at twin_start_.
    double ahead = 0;  ///< The axis of its twin, in microsteps.
  };

  Script<Fault> prepare() override;
  Script<Fault> pass_course() override;
  void on_pause(bool on) override { pause_asked_ = on; }
  bool is_held() const override { return pause_asked_; }
  bool rests_at_end() const override { return true; }
  double planned_position(std::size_t axis) const override;
  void on_written(std::size_t axis, Setting setting) override;

  Fault fault_of_axes() const;
  Script<Fault> set_joint_accelerations();
  Script<Fault> fit_legs_to_bus();
  std::string too_short(std::size_t index) const;
  Script<Fault> start_ramps();
  Script<Fault> pause_between(const CourseLeg& next);
  Script<Fault> pass_halts(double until_time);
  Script<Fault> watch_until(TimePoint due);
  Script<Fault> begin_from_rest(const Passage& passage);
  Script<Fault> begin_on_the_way(const Passage& passage);
  TimePoint time_at_joint(const Passage& passage);
  Script<Fault> see_standing(const Passage& passage);
  Script<Fault> see_standing(std::size_t axis);
  Script<Fault> see_joint_speeds(const Passage& passage);
  TimePoint time_of(double course_time);
  double expected_of_twin(std::size_t axis) const;
  void correct_twin(std::size_t axis);
  void let_twin_run(std::size_t axis, TimePoint to);

  // stream_loads.cpp
  Script<Fault> prepare_loads(const Passage& passage);
  Script<Fault> write_before(const Passage& passage, const Load& load);
  Script<Fault> begin_leg(const Passage& passage);
  Script<Fault> load_ramps(const Passage& passage);
  Script<Fault> set_start_speed(const Passage& passage, std::size_t axis);
  Script<Fault> set_velocity(const Passage& passage, double speed, std::size_t axis);
  Script<Fault> set_target(const Load& load);
  std::int32_t deceleration_of(const Passage& passage, const Load& load) const;
  bool is_too_gentle(const Passage& passage, const Load& load) const;
  Script<Fault> set_deceleration(const Passage& passage, const Load& load);
  Script<Fault> set_braking(const Passage& passage, const Load& load);
  Way way_to(const Passage& passage, std::size_t axis) const;
  Load load_for(const Passage& passage, std::size_t axis);
  void aim(const Passage& passage, Load& load) const;
  double pace(const Passage& passage, double speed, std::size_t axis);
  std::int32_t velocity_in(const Passage& passage, double speed, std::size_t axis);
  bool has_slowed_down(std::size_t axis) const;
  std::int32_t own_acceleration(std::size_t axis) const;

  RampLegs legs_{course_, axes_, options_.even_within, report_};
  std::vector<TwinState> twins_ = std::vector<TwinState>(axes());
  TimePoint twin_start_{};
  std::vector<Load> loads_;            // of the leg that begins
  std::optional<CourseLeg> even_leg_;  // the one that is passed evenly
  bool pause_asked_ = false;
};

}  // namespace tmcl::plan
