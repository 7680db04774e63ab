/// What keys mean that are held down to jog axes. No I/O, no clock.
///
/// A terminal reports that a key is pressed, and again and again while it is held down. Few report
/// that it is released. So a press holds as long as a keyboard takes until it repeats the key, and
/// each repeat until the next one; a release that is reported ends both.
#pragma once

#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "output/key.hpp"
#include "tmcl/clock.hpp"

namespace tmclctl {

class JogKeys {
 public:
  static constexpr tmcl::Duration press_holds = std::chrono::milliseconds(600);
  static constexpr tmcl::Duration repeat_holds = std::chrono::milliseconds(150);
  /// Arrows that may have been pressed so long ago, while nothing was read, move nothing.
  static constexpr tmcl::Duration stale_after = repeat_holds;
  static constexpr std::size_t most_axes = 3;

  explicit JogKeys(std::size_t axes) : axes_(axes) {}

  /// All keys since the last look.
  void look(const std::vector<Key>& keys, tmcl::TimePoint now);

  /// An axis is to go on.
  struct Going {
    std::size_t axis = 0;
    int direction = 1;  ///< 1 or -1.
    int percent = 100;  ///< Of its speed.
    std::chrono::milliseconds hold{};
    bool operator==(const Going&) const = default;
  };
  /// What is to be told now; each is given once.
  std::vector<Going> take_going(tmcl::TimePoint now);
  /// An axis is to make a step.
  struct Step {
    std::size_t axis = 0;
    int direction = 1;
    bool operator==(const Step&) const = default;
  };
  std::vector<Step> take_steps() { return std::exchange(steps_, {}); }
  /// Axes whose key was released while they went on: to be stopped at once. Each is given once.
  std::vector<std::size_t> take_released() { return std::exchange(released_, {}); }
  /// All axes are to be stopped at once; given once.
  bool take_stop() { return std::exchange(stops_, false); }
  bool has_ended() const { return ended_; }

  int percent() const { return percent_; }
  bool makes_steps() const { return makes_steps_; }
  /// A step is ten to this power, of what the axis is measured in.
  int step_power() const { return step_power_; }

 private:
  struct Axis {
    int direction = 0;  ///< 0: no key of it is held.
    tmcl::TimePoint held_until{};
    int told_direction = 0;
    int told_percent = 0;
    tmcl::TimePoint told_until{};
  };

  void press(Key key, tmcl::TimePoint now);
  void press_letter(char letter);
  void hold(Step arrow, tmcl::TimePoint now);
  void release(Step arrow);
  void stop();

  std::vector<Axis> axes_;
  std::vector<Step> steps_;
  std::vector<std::size_t> released_;
  std::optional<tmcl::TimePoint> looked_at_;
  int percent_ = 100;
  int step_power_ = 0;
  bool makes_steps_ = false;
  bool stops_ = false;
  bool ended_ = false;
};

}  // namespace tmclctl
