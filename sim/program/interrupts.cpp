#include "sim/program/interrupts.hpp"

#include <algorithm>

#include "sim/module/due.hpp"

namespace tmcl::sim {
namespace {

using std::chrono::milliseconds;

constexpr std::uint8_t timers = 3;
constexpr std::uint8_t edge_rising = 1;
constexpr std::uint8_t edge_falling = 2;

}  // namespace

std::optional<Interrupts::Place> Interrupts::place_of(std::uint8_t number) const {
  const auto within = [number](std::uint8_t first, std::size_t count) {
    return number >= first && number < first + count;
  };
  const auto motors = host_->motors();
  const auto at = [number](Kind kind, std::uint8_t first) {
    return Place{kind, static_cast<std::size_t>(number - first)};
  };
  if (within(interrupt::timer, timers)) return at(Kind::timer, interrupt::timer);
  if (within(interrupt::target_reached, motors))
    return at(Kind::target_reached, interrupt::target_reached);
  if (within(interrupt::stall, motors)) return at(Kind::stall, interrupt::stall);
  if (within(interrupt::deviation, motors)) return at(Kind::deviation, interrupt::deviation);
  if (within(interrupt::stop_left, 2 * motors)) {
    const auto offset = static_cast<std::size_t>(number - interrupt::stop_left);
    return Place{offset % 2 == 0 ? Kind::left : Kind::right, offset / 2};
  }
  if (within(interrupt::input, host_->inputs())) return at(Kind::input, interrupt::input);
  return std::nullopt;
}

bool Interrupts::level_of(Place place) const {
  switch (place.kind) {
    case Kind::timer: return false;
    case Kind::target_reached: return host_->motor(place.index).at_target;
    case Kind::stall: return host_->motor(place.index).stalled;
    case Kind::deviation: return host_->motor(place.index).deviated;
    case Kind::left: return host_->motor(place.index).left_switch;
    case Kind::right: return host_->motor(place.index).right_switch;
    case Kind::input: return host_->input(place.index);
  }
  return false;
}

bool Interrupts::exists(std::uint8_t number) const { return place_of(number).has_value(); }

void Interrupts::enable(std::uint8_t number, TimePoint now) {
  if (number == interrupt::global_enable) {
    enabled_ = true;
    return;
  }
  auto& source = sources_[number];
  if (source.enabled) return;
  source.enabled = true;
  source.pending = false;
  source.level = level_of(*place_of(number));
  source.begun = now;
}

void Interrupts::disable(std::uint8_t number) {
  if (number == interrupt::global_enable) {
    enabled_ = false;
    return;
  }
  sources_[number].enabled = false;
}

void Interrupts::observe(TimePoint now) {
  for (auto& [number, source] : sources_) {
    if (source.enabled) observe(number, source, now);
  }
}

void Interrupts::observe(std::uint8_t number, Source& source, TimePoint now) const {
  const auto place = *place_of(number);
  if (place.kind == Kind::timer) return observe_timer(number, source, now);
  const auto level = level_of(place);
  if (level == source.level) return;
  source.level = level;
  if (is_edge(place.kind, number, level)) source.pending = true;
}

bool Interrupts::is_edge(Kind kind, std::uint8_t number, bool level) const {
  const bool configured = kind == Kind::left || kind == Kind::right || kind == Kind::input;
  if (!configured) return level;
  return (host_->interrupt_setting(number) & (level ? edge_rising : edge_falling)) != 0;
}

// A timer whose period is 0 is off; its next period begins when it gets one.
void Interrupts::observe_timer(std::uint8_t number, Source& source, TimePoint now) const {
  const auto length = period(number);
  if (length == Duration::zero()) {
    source.begun = now;
    return;
  }
  const auto passed = (now - source.begun) / length;
  if (passed == 0) return;
  source.begun += passed * length;
  source.pending = true;
}

Duration Interrupts::period(std::uint8_t timer) const {
  return milliseconds(std::max(0, host_->interrupt_setting(timer)));
}

std::optional<std::uint16_t> Interrupts::take() {
  if (!enabled_) return std::nullopt;
  for (auto& [number, source] : sources_) {
    if (!source.enabled || !source.pending || !source.vector) continue;
    source.pending = false;
    return source.vector;
  }
  return std::nullopt;
}

bool Interrupts::listening() const {
  return std::ranges::any_of(sources_, [](const auto& entry) {
    return entry.second.enabled && entry.first >= interrupt::timer + timers;
  });
}

TimePoint Interrupts::next_due() const {
  auto due = never;
  for (const auto& [number, source] : sources_) {
    if (number >= interrupt::timer + timers) break;
    const auto length = period(number);
    if (source.enabled && length != Duration::zero()) due = std::min(due, source.begun + length);
  }
  return due;
}

}  // namespace tmcl::sim
