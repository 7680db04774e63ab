#include "sim/stage/stage.hpp"

#include <algorithm>
#include <cmath>

namespace tmcl::sim {
namespace {

constexpr Place microsteps_per_full_step = 256;
// Farther than any motor gets, and far from what does not fit.
constexpr Place far = Place{1} << 60;

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  const auto quotient = a / b;
  return a % b != 0 && (a < 0) != (b < 0) ? quotient - 1 : quotient;
}

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return -floor_div(-a, b); }

Interval wider(Interval interval, Place by) { return {interval.from - by, interval.to + by}; }

bool contains(Interval interval, Place place) {
  return interval.from <= place && place <= interval.to;
}

}  // namespace

Stage::Stage(const StageSettings& settings)
    : settings_(settings), position_(settings.position), load_(settings.position) {
  if (settings.resonance) swing_.emplace(*settings.resonance);
  settle(true);
}

bool Stage::is_bare() const {
  return !settings_.left_switch && !settings_.right_switch && !settings_.home &&
         !settings_.left_stop && !settings_.right_stop && !settings_.encoder;
}

void Stage::move(Place way) {
  if (settings_.load >= full_load) return;
  const auto least = settings_.left_stop.value_or(-far);
  const auto most = settings_.right_stop.value_or(far);
  position_ = std::clamp(position_ + way, std::min(least, position_), std::max(most, position_));
  load_ = std::clamp(load_, position_ - settings_.backlash, position_);
  settle(false);
}

bool Stage::holds(int direction) const {
  if (settings_.load >= full_load) return true;
  if (direction < 0) return settings_.left_stop && position_ <= *settings_.left_stop;
  return direction > 0 && settings_.right_stop && position_ >= *settings_.right_stop;
}

// ---- Switches

std::optional<Interval> Stage::left() const {
  if (!settings_.left_switch) return std::nullopt;
  return Interval{-far, *settings_.left_switch};
}

std::optional<Interval> Stage::right() const {
  if (!settings_.right_switch) return std::nullopt;
  return Interval{*settings_.right_switch, far};
}

void Stage::settle(bool anew) {
  settle(left_, left(), anew);
  settle(right_, right(), anew);
  settle(home_, settings_.home, anew);
}

void Stage::settle(Contact& contact, const std::optional<Interval>& place, bool anew) const {
  if (!place) return;
  const bool stays = contact.closed && !anew;
  contact.closed = contains(stays ? wider(*place, settings_.switch_tolerance) : *place, position_);
}

void Stage::press(StageSwitch which, bool pressed) {
  switch (which) {
    case StageSwitch::left: left_.pressed = pressed; break;
    case StageSwitch::right: right_.pressed = pressed; break;
    case StageSwitch::home: home_.pressed = pressed; break;
  }
}

StageInputs Stage::inputs() const {
  return {left_.is_closed() != settings_.limits_normally_closed,
          right_.is_closed() != settings_.limits_normally_closed,
          home_.is_closed() != settings_.home_normally_closed};
}

void Stage::limit(Reach& reach, const Contact& contact,
                  const std::optional<Interval>& place) const {
  if (!place) return;
  if (contact.closed) {
    const auto hold = wider(*place, settings_.switch_tolerance);
    reach.limit_back(position_ - hold.from);
    reach.limit_ahead(hold.to - position_);
  } else if (position_ > place->to) {
    reach.limit_back(position_ - place->to - 1);
  } else {
    reach.limit_ahead(place->from - position_ - 1);
  }
}

Reach Stage::reach() const {
  Reach reach;
  limit(reach, left_, left());
  limit(reach, right_, right());
  limit(reach, home_, settings_.home);
  if (settings_.left_stop && !holds(-1)) reach.limit_back(position_ - *settings_.left_stop - 1);
  if (settings_.right_stop && !holds(1)) reach.limit_ahead(*settings_.right_stop - position_ - 1);
  return reach;
}

// ---- Encoder

std::int64_t Stage::counts_at(Place position) const {
  const auto& encoder = *settings_.encoder;
  const auto turn = microsteps_per_full_step * settings_.full_steps_per_turn;
  const auto counts = encoder.backwards ? -encoder.counts_per_turn : encoder.counts_per_turn;
  // In two parts, so that no product is too great.
  const auto turns = floor_div(position, turn);
  return turns * counts + floor_div((position - turns * turn) * counts, turn);
}

Place Stage::load_position() const {
  return swing_ ? load_ + std::llround(swing_->offset()) : load_;
}

std::int64_t Stage::encoder_counts() const {
  if (!settings_.encoder) return 0;
  return counts_at(load_position()) - counts_at(settings_.position) + slip_;
}

std::int32_t Stage::encoder_angle() const {
  if (!settings_.encoder) return 0;
  const auto turn = std::int64_t{settings_.encoder->counts_per_turn};
  const auto counts = encoder_counts();
  return static_cast<std::int32_t>(counts - floor_div(counts, turn) * turn);
}

Reach Stage::encoder_reach() const {
  if (!settings_.encoder) return {};
  auto reach = reach_of_count();
  // What the motor makes up for before the load moves.
  reach.back += position_ - load_;
  reach.ahead += settings_.backlash - (position_ - load_);
  return reach;
}

/// How far the load can go.
Reach Stage::reach_of_count() const {
  const auto turn = microsteps_per_full_step * settings_.full_steps_per_turn;
  const auto counts = std::int64_t{settings_.encoder->counts_per_turn};
  const auto turns = floor_div(load_, turn);
  const auto rest = load_ - turns * turn;
  const bool backwards = settings_.encoder->backwards;
  // The places within this turn at which the same count begins and ends.
  const auto count = backwards ? ceil_div(rest * counts, turn) - 1 : floor_div(rest * counts, turn);
  const auto first =
      backwards ? floor_div(count * turn, counts) + 1 : ceil_div(count * turn, counts);
  const auto last =
      backwards ? floor_div((count + 1) * turn, counts) : ceil_div((count + 1) * turn, counts) - 1;
  return {rest - first, last - rest};
}

}  // namespace tmcl::sim
