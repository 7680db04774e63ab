#include "jog_keys.hpp"

#include <algorithm>
#include <utility>

namespace tmclctl {
namespace {

/// What a call has to add to be worth the exchanges.
constexpr tmcl::Duration least_gain = std::chrono::milliseconds(40);
/// That of axis.jog.
constexpr std::chrono::milliseconds shortest_hold{100};
constexpr int finest_step = -4;
constexpr int coarsest_step = 4;

/// Which axis a key is for, and which way; nothing for one that is none of them.
std::optional<JogKeys::Step> arrow_of(Key key) {
  switch (key.kind) {
    case Key::Kind::left: return JogKeys::Step{0, -1};
    case Key::Kind::right: return JogKeys::Step{0, 1};
    case Key::Kind::down: return JogKeys::Step{1, -1};
    case Key::Kind::up: return JogKeys::Step{1, 1};
    case Key::Kind::page_down: return JogKeys::Step{2, -1};
    case Key::Kind::page_up: return JogKeys::Step{2, 1};
    case Key::Kind::letter:
    case Key::Kind::other: break;
  }
  return std::nullopt;
}

}  // namespace

void JogKeys::look(const std::vector<Key>& keys, tmcl::TimePoint now) {
  const bool is_stale = looked_at_ && now - *looked_at_ > stale_after;
  looked_at_ = now;
  for (const auto key : keys)
    if (!is_stale || key.is_release || !arrow_of(key)) press(key, now);
}

void JogKeys::press(Key key, tmcl::TimePoint now) {
  const auto arrow = arrow_of(key);
  const bool is_of_axis = arrow && arrow->axis < axes_.size();
  if (is_of_axis && key.is_release) return release(*arrow);
  if (key.is_release) return;
  if (is_of_axis) return hold(*arrow, now);
  if (key.kind == Key::Kind::letter) return press_letter(key.letter);
  stop();
}

void JogKeys::press_letter(char letter) {
  if (letter >= '0' && letter <= '9') {
    percent_ = letter == '0' ? 100 : 10 * (letter - '0');
  } else if (letter == '+') {
    step_power_ = std::min(step_power_ + 1, coarsest_step);
  } else if (letter == '-') {
    step_power_ = std::max(step_power_ - 1, finest_step);
  } else {
    stop();
    if (letter == '\t') makes_steps_ = !makes_steps_;
    if (letter == 'q') ended_ = true;
  }
}

void JogKeys::hold(Step arrow, tmcl::TimePoint now) {
  auto& axis = axes_[arrow.axis];
  const bool repeats = axis.direction == arrow.direction && now < axis.held_until;
  axis.direction = arrow.direction;
  axis.held_until = repeats ? std::max(axis.held_until, now + repeat_holds) : now + press_holds;
  // A key that is held down makes one step.
  if (makes_steps_ && !repeats) steps_.push_back(arrow);
}

/// The other key of the axis may be held by now.
void JogKeys::release(Step arrow) {
  auto& axis = axes_[arrow.axis];
  if (axis.direction != arrow.direction) return;
  if (axis.told_direction == arrow.direction) released_.push_back(arrow.axis);
  axis = Axis{};
}

void JogKeys::stop() {
  std::ranges::fill(axes_, Axis{});
  steps_.clear();
  released_.clear();
  stops_ = true;
}

std::vector<JogKeys::Going> JogKeys::take_going(tmcl::TimePoint now) {
  std::vector<Going> going;
  for (std::size_t i = 0; i < axes_.size() && !makes_steps_; ++i) {
    auto& axis = axes_[i];
    if (axis.direction == 0 || now >= axis.held_until) continue;
    const bool is_told = axis.told_direction == axis.direction && axis.told_percent == percent_;
    if (is_told && axis.held_until - axis.told_until < least_gain) continue;
    axis.told_direction = axis.direction;
    axis.told_percent = percent_;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(axis.held_until - now);
    const auto hold = std::max(left, shortest_hold);
    axis.told_until = std::max(axis.held_until, now + hold);
    going.push_back({i, axis.direction, percent_, hold});
  }
  return going;
}

}  // namespace tmclctl
