/// The reference search (RFS) as a state machine: told which switches are active and where the
/// motor is, it says where to drive next.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/model.hpp"

namespace tmcl::sim {

/// The active switches, as the module sees them.
struct Switches {
  bool left = false;
  bool right = false;
  bool home = false;
  bool operator==(const Switches&) const = default;
};

/// What a value of axis parameter 193 asks for.
struct SearchMode {
  enum class Target : std::uint8_t { left, right, home };
  Target target = Target::left;
  int direction = -1;  ///< In which it looks for the target.
  bool other_end_first = false;
  bool from_both_sides = false;  ///< The reference is half way between closing and opening.
  bool turns_at_end = false;     ///< At the end switch in its direction, to look the other way.
  bool ignores_ends = false;
  bool home_inverted = false;

  /// 1 left switch · 2 right, then left switch · 3 as 2, but the left one from both sides · 4 left
  /// switch from both sides · 5 home switch in negative direction, reversing at the left switch ·
  /// 6 the other way round · 7 home switch in positive direction, ignoring end switches · 8 in
  /// negative direction. 1 to 4 + 64: sides swapped. 5 to 8 + 128: home switch inverted. Modules
  /// with a TMC457 only have 1, 2, and 3, where the home switch comes after the right one (manual
  /// of the TMCM-142, page 39). Nothing for any other value.
  static std::optional<SearchMode> of(Family family, std::int32_t value);
};

/// The manuals name the modes and not what is between; what a user sees of it here is this. The
/// switch is looked for with the speed of parameter 194. Once it is active the motor backs off with
/// that of parameter 195 until it is not, and returns as slowly: where the switch then closes is
/// the reference. At last the motor drives onto it. A switch that never comes is looked for for
/// ever.
class Homing {
 public:
  struct Order {
    enum class Kind : std::uint8_t {
      go_on,      ///< As before.
      search,     ///< Turn with the speed of parameter 194 ...
      switching,  ///< ... or 195, in this direction.
      drive_to,   ///< Position to `position`.
      finish,     ///< `position` is to be called 0.
    };
    Kind kind = Kind::go_on;
    int direction = 0;
    std::int32_t position = 0;
  };

  Order start(const SearchMode& mode, const Switches& switches, std::int32_t position);
  /// The switches have changed, or the motor has.
  Order see(const Switches& switches, std::int32_t position);
  /// The motor stands where drive_to sent it.
  Order arrived();
  void abort() { step_ = Step::idle; }

  bool active() const { return step_ != Step::idle; }
  bool returns() const { return step_ == Step::returning; }
  bool ignores_ends() const { return active() && mode_.ignores_ends; }
  /// What RFS STATUS answers: 0 when nothing is searched, otherwise the step.
  std::int32_t step() const { return static_cast<std::int32_t>(step_); }

  /// Where the other end switch of the last search was, as the position was counted then. Nothing
  /// if its mode does not look for it.
  std::optional<std::int32_t> other_end() const { return other_end_; }

 private:
  enum class Step : std::uint8_t {
    idle,
    other_end,
    searching,
    turned,
    backing_off,
    approaching,
    returning,
  };

  Order step_on(const Switches& switches, std::int32_t position);
  Order enter(Step step, Order::Kind kind, int direction);
  bool target_active(const Switches& switches) const;
  static bool end_active(const Switches& switches, int direction) {
    return direction < 0 ? switches.left : switches.right;
  }

  Step step_ = Step::idle;
  SearchMode mode_;
  std::optional<std::int32_t> other_end_;
  std::int32_t opened_ = 0;
  std::int32_t reference_ = 0;
};

}  // namespace tmcl::sim
