#include "sim/module/homing.hpp"

namespace tmcl::sim {
namespace {

using Target = SearchMode::Target;

constexpr std::int32_t swap_sides = 64;
constexpr std::int32_t invert_home = 128;

std::optional<SearchMode> end_search(std::int32_t number, bool swapped) {
  SearchMode mode;
  mode.target = swapped ? Target::right : Target::left;
  mode.direction = swapped ? 1 : -1;
  mode.other_end_first = number == 2 || number == 3;
  mode.from_both_sides = number == 3 || number == 4;
  return mode;
}

std::optional<SearchMode> home_search(std::int32_t number, bool inverted) {
  SearchMode mode;
  mode.target = Target::home;
  mode.direction = number == 6 || number == 7 ? 1 : -1;
  mode.turns_at_end = number <= 6;
  mode.ignores_ends = number >= 7;
  mode.home_inverted = inverted;
  return mode;
}

std::optional<SearchMode> old_search(std::int32_t value) {
  if (value < 1 || value > 3) return std::nullopt;
  SearchMode mode;
  mode.other_end_first = value >= 2;
  if (value == 3) mode.target = Target::home;
  return mode;
}

}  // namespace

std::optional<SearchMode> SearchMode::of(Family family, std::int32_t value) {
  if (family == Family::tmc457) return old_search(value);
  if (value >= 1 && value <= 4) return end_search(value, false);
  if (value >= 1 + swap_sides && value <= 4 + swap_sides) {
    return end_search(value - swap_sides, true);
  }
  if (value >= 5 && value <= 8) return home_search(value, false);
  if (value >= 5 + invert_home && value <= 8 + invert_home) {
    return home_search(value - invert_home, true);
  }
  return std::nullopt;
}

Homing::Order Homing::start(const SearchMode& mode, const Switches& switches,
                            std::int32_t position) {
  mode_ = mode;
  other_end_.reset();
  const auto first = mode.other_end_first
                         ? enter(Step::other_end, Order::Kind::search, -mode.direction)
                         : enter(Step::searching, Order::Kind::search, mode.direction);
  const auto next = see(switches, position);
  return next.kind == Order::Kind::go_on ? first : next;
}

// A switch may be active already when its step begins.
Homing::Order Homing::see(const Switches& switches, std::int32_t position) {
  Order last;
  for (auto order = step_on(switches, position); order.kind != Order::Kind::go_on;
       order = step_on(switches, position)) {
    last = order;
  }
  return last;
}

Homing::Order Homing::step_on(const Switches& switches, std::int32_t position) {
  const int direction = mode_.direction;
  switch (step_) {
    case Step::other_end:
      if (!end_active(switches, -direction)) return {};
      other_end_ = position;
      return enter(Step::searching, Order::Kind::search, direction);
    case Step::searching:
      if (target_active(switches)) {
        return enter(Step::backing_off, Order::Kind::switching, -direction);
      }
      if (!mode_.turns_at_end || !end_active(switches, direction)) return {};
      return enter(Step::turned, Order::Kind::search, -direction);
    case Step::turned:
      if (!target_active(switches)) return {};
      return enter(Step::backing_off, Order::Kind::switching, -direction);
    case Step::backing_off:
      if (target_active(switches)) return {};
      opened_ = position;
      return enter(Step::approaching, Order::Kind::switching, direction);
    case Step::approaching:
      if (!target_active(switches)) return {};
      reference_ = mode_.from_both_sides ? position + (opened_ - position) / 2 : position;
      step_ = Step::returning;
      return {Order::Kind::drive_to, 0, reference_};
    case Step::idle:
    case Step::returning: return {};
  }
  return {};
}

Homing::Order Homing::arrived() {
  step_ = Step::idle;
  return {Order::Kind::finish, 0, reference_};
}

Homing::Order Homing::enter(Step step, Order::Kind kind, int direction) {
  step_ = step;
  return {kind, direction, 0};
}

bool Homing::target_active(const Switches& switches) const {
  switch (mode_.target) {
    case Target::left: return switches.left;
    case Target::right: return switches.right;
    case Target::home: return switches.home != mode_.home_inverted;
  }
  return false;
}

}  // namespace tmcl::sim
