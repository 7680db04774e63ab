#include "sim/module/target_events.hpp"

#include <algorithm>
#include <bit>

namespace tmcl::sim {

void TargetEvents::arm_once(std::uint32_t motors, EventSink& sink) {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if ((motors >> i & 1U) == 0) continue;
    watches_[i].armed = &sink;
    watches_[i].always = false;
  }
}

void TargetEvents::arm_always(std::uint32_t motors, EventSink& sink) {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    watches_[i].armed = (motors >> i & 1U) != 0 ? &sink : nullptr;
    watches_[i].always = true;
  }
}

void TargetEvents::forget(const EventSink& sink) {
  for (auto& watch : watches_) {
    if (watch.armed == &sink) watch.armed = nullptr;
    if (watch.pending == &sink) watch.pending = nullptr;
  }
}

void TargetEvents::move_begun(std::size_t motor) {
  auto& watch = watches_[motor];
  if (watch.armed != nullptr) watch.pending = watch.armed;
  if (!watch.always) watch.armed = nullptr;
}

TimePoint TargetEvents::next_due(const std::deque<Axis>& axes) const {
  auto due = never;
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if (watches_[i].pending != nullptr) due = std::min(due, axes[i].outlook().arrival);
  }
  return due;
}

void TargetEvents::run_due(TimePoint now, const std::deque<Axis>& axes, const Module& module) {
  std::uint32_t motors = 0;
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    if (watches_[i].pending == nullptr || axes[i].outlook().arrival > now) continue;
    motors |= 1U << i;
  }
  report(motors, module);
}

void TargetEvents::report(std::uint32_t motors, const Module& module) {
  while (motors != 0) {
    auto* sink = watches_[static_cast<std::size_t>(std::countr_zero(motors))].pending;
    std::uint32_t together = 0;
    for (std::size_t i = 0; i < watches_.size(); ++i) {
      if ((motors >> i & 1U) == 0 || watches_[i].pending != sink) continue;
      together |= 1U << i;
      watches_[i].pending = nullptr;
    }
    motors &= ~together;
    sink->target_reached(module, static_cast<std::int32_t>(together));
  }
}

}  // namespace tmcl::sim
