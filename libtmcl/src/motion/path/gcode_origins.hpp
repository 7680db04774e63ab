/// Where a program of G-code counts from.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {

/// The coordinate systems G54 to G59, what G92 shifts all of them by, and lengths of tools, in mm
/// and degrees from the zero of the axes.
class Origins {
 public:
  static constexpr std::size_t systems = GcodeSetup::systems;

  /// As they were stored.
  explicit Origins(const std::array<std::optional<Point>, systems>& stored) {
    for (std::size_t i = 0; i < systems; ++i) {
      set_[i] = stored[i].has_value();
      systems_[i] = stored[i].value_or(Point{});
    }
  }

  double of(std::size_t axis) const {
    return systems_[selected_][axis] + shift_[axis] + tool_[axis];
  }
  std::size_t selected() const { return selected_; }
  void select(std::size_t system) { selected_ = system; }
  bool is_set(std::size_t system) const { return set_[system]; }

  /// G10 L2.
  void set(std::size_t system, std::size_t axis, double origin) {
    systems_[system][axis] = origin;
    set_[system] = true;
  }
  /// G10 L20: what stands at `place` has this position there.
  void set_by_place(std::size_t system, std::size_t axis, double place, double position) {
    set(system, axis, place - shift_[axis] - tool_[axis] - position);
  }
  /// G52.
  void shift(std::size_t axis, double by) { kept_[axis] = shift_[axis] = by; }
  /// G92: what stands at `place` has this position.
  void shift_by_place(std::size_t axis, double place, double position) {
    shift(axis, place - systems_[selected_][axis] - tool_[axis] - position);
  }
  /// G43.1; of G43, which forgets the others, along Z.
  void lengthen_tool(std::size_t axis, double length) { tool_[axis] = length; }
  /// G49.
  void forget_tool() { tool_ = {}; }
  /// G92.1.
  void forget_shift() { shift_ = kept_ = {}; }
  /// G92.2.
  void suspend_shift() { shift_ = {}; }
  /// G92.3.
  void restore_shift() { shift_ = kept_; }

 private:
  std::array<Point, systems> systems_{};
  std::array<bool, systems> set_{};
  Point shift_{};
  Point kept_{};
  Point tool_{};
  std::size_t selected_ = 0;
};

}  // namespace tmcl::plan::path_file::gcode
