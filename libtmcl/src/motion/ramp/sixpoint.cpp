#include "tmcl/ramp/sixpoint.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "motion/ramp/mentions.hpp"
#include "motion/ramp/register_rows.hpp"
#include "motion/ramp/sixpoint_ways.hpp"

namespace tmcl::ramp {
namespace {

constexpr std::string_view modes[] = {"position", "velocity_positive", "velocity_negative", "hold"};
// Addresses from the vendor's register headers, bits from the data sheets.
// clang-format off
constexpr auto table = std::to_array<RegisterInfo>({
    {"vstart", 0, (1 << 18) - 1, "start velocity, f/2^24 Hz", {0x23, 0, 18}},
    {"a1", 0, (1 << 16) - 1, "acceleration up to V1, f^2/2^41 Hz/s", {0x24, 0, 16}},
    {"v1", 0, (1 << 20) - 1, "velocity at which A1 and D1 end, f/2^24 Hz; 0 turns them off", {0x25, 0, 20}},
    {"amax", 0, (1 << 16) - 1, "acceleration above V1 and in velocity mode, f^2/2^41 Hz/s", {0x26, 0, 16}},
    {"vmax", 0, (1 << 23) - 512, "target velocity, f/2^24 Hz", {0x27, 0, 23}},
    {"dmax", 0, (1 << 16) - 1, "deceleration down to V1, f^2/2^41 Hz/s", {0x28, 0, 16}},
    {"d1", 0, (1 << 16) - 1, "deceleration below V1, f^2/2^41 Hz/s", {0x2A, 0, 16}},
    {"vstop", 0, (1 << 18) - 1, "stop velocity, f/2^24 Hz", {0x2B, 0, 18}},
    {"tzerowait", 0, (1 << 16) - 1, "standstill after a stop, 512/f s", {0x2C, 0, 16}},
    {"xtarget", INT32_MIN, INT32_MAX, "target position, microsteps", {0x2D, 0, 32}},
    {"rampmode", 0, 3, "how it drives", {0x20, 0, 2}, modes},
    {"xactual", INT32_MIN, INT32_MAX, "actual position, microsteps", {0x21, 0, 32}},
    {"sw_mode", 0, (1 << 12) - 1, "what the stop switches do, bits", {0x34, 0, 12}},
});
// clang-format on

}  // namespace

std::span<const RegisterInfo> SixPoint::registers() { return table; }

SixPoint::SixPoint() { registers_[static_cast<std::size_t>(Register::vstop)] = 10; }

// ---- Registers

Written SixPoint::write(Register name, std::int64_t value) {
  const auto& info = table[static_cast<std::size_t>(name)];
  if (!info.takes(value)) return out_of_range(info, value);
  const bool was_reached = position_reached();
  if (name == Register::xactual) {
    position_ = static_cast<std::uint64_t>(value) << 32;
  } else {
    registers_[static_cast<std::size_t>(name)] = static_cast<std::int32_t>(value);
  }
  if (name == Register::xactual || name == Register::xtarget || name == Register::rampmode) {
    braking_ = false;
  }
  if (!was_reached && position_reached()) pos_reached_event_ = true;
  run_.end = tick_;
  return {};
}

std::int64_t SixPoint::read(Register name) const {
  return name == Register::xactual ? xactual() : value(name);
}

std::vector<Finding> SixPoint::findings() const {
  using R = Register;
  std::vector<Finding> found;
  const auto holds = [this](R name) { return held(*this, name); };
  const auto add = [&](bool wrong, std::string_view text, std::vector<Finding::Mention> mentions) {
    if (wrong) found.push_back({text, std::move(mentions)});
  };
  const auto is_zero = [this](R name) { return value(name) == 0; };
  constexpr std::int32_t least_vstop = 10;

  const bool positioning = mode() == Mode::position;
  if (mode() == Mode::hold) return found;
  if (positioning) {
    add(value(R::vstop) < value(R::vstart), "{} is below {}, so a short way may not allow to stop",
        {holds(R::vstop), holds(R::vstart)});
    add(value(R::vstop) < least_vstop, "{} is below {}, the least for positioning",
        {holds(R::vstop), mention(R::vstop, least_vstop, Finding::Form::value)});
  }
  add(is_zero(R::vmax), "{}: the motor does not move", {holds(R::vmax)});
  if (is_zero(R::vmax)) return found;
  add(is_zero(R::amax), "{} cannot change the velocity", {holds(R::amax)});
  if (!positioning) return found;

  add(value(R::vmax) < value(R::vstart), "{} is below {}", {holds(R::vmax), holds(R::vstart)});
  add(is_zero(R::dmax), "{} cannot brake", {holds(R::dmax)});
  if (is_zero(R::v1)) {
    add(is_zero(R::d1), "{} is not to be set for positioning, not even while {} is 0",
        {holds(R::d1), mention(R::v1, 0, Finding::Form::name)});
    return found;
  }
  add(is_zero(R::a1), "{} cannot come up to {}", {holds(R::a1), holds(R::v1)});
  add(is_zero(R::d1), "{} cannot brake below {}", {holds(R::d1), holds(R::v1)});
  return found;
}

// ---- What can be seen

SixPoint::Exact SixPoint::exact() const {
  return {static_cast<std::int64_t>(position_) >> position_shift, velocity_};
}

std::string_view SixPoint::phase() const {
  switch (phase_) {
    case Phase::a1: return "A1";
    case Phase::amax: return "AMAX";
    case Phase::vmax: return "VMAX";
    case Phase::dmax: return "DMAX";
    case Phase::d1: return "D1";
    case Phase::vstop: return "VSTOP";
    case Phase::hold: return "hold";
    case Phase::rest: break;
  }
  return tick_ < stands_until_ ? "TZEROWAIT" : "rest";
}

bool SixPoint::arrived() const {
  return mode() == Mode::position && velocity_ == 0 && position_reached();
}

bool SixPoint::settled() const {
  const auto run = tick_ < run_.end ? run_ : next_run();
  return tick_ >= stands_until_ && run.ticks == forever && run.phase == phase_ &&
         acceleration_ == 0;
}

SixPoint::Status SixPoint::status() const {
  const int direction = velocity_ != 0 ? sign(velocity_) : wanted_direction();
  return {
      .status_stop_l = left_,
      .status_stop_r = right_,
      .status_latch_l = latch_l_event_,
      .status_latch_r = latch_r_event_,
      .event_stop_l = direction < 0 && blocked(direction),
      .event_stop_r = direction > 0 && blocked(direction),
      .event_pos_reached = pos_reached_event_,
      .velocity_reached = speed() == speed_in(Register::vmax),
      .position_reached = position_reached(),
      .vzero = velocity_ == 0,
      .t_zerowait_active = tick_ < stands_until_,
      .second_move = second_move_event_,
  };
}

SixPoint::Status SixPoint::take_events() {
  const auto taken = status();
  latch_l_event_ = latch_r_event_ = pos_reached_event_ = second_move_event_ = false;
  if (taken.event_pos_reached) run_.end = tick_;  // it has yet to look for the next passing
  return taken;
}

// ---- Switches

void SixPoint::set_switches(bool left, bool right) {
  latch(left_, left, latch_l_active, latch_l_inactive, latch_l_event_);
  latch(right_, right, latch_r_active, latch_r_inactive, latch_r_event_);
  left_ = left;
  right_ = right;
  run_.end = tick_;
}

void SixPoint::latch(bool before, bool now, std::int32_t on_active, std::int32_t on_inactive,
                     bool& event) {
  if (before == now) return;
  if ((value(Register::sw_mode) & (now ? on_active : on_inactive)) == 0) return;
  xlatch_ = xactual();
  event = true;
}

void SixPoint::halt() {
  if (velocity_ == 0) return;
  velocity_ = 0;
  run_ = {.end = tick_};
  come_to_rest();
}

// ---- Time

void SixPoint::advance_to(Tick tick) {
  tick = std::min(tick, last_tick);
  while (tick_ < tick) {
    if (run_.end <= tick_) plan();
    take(std::min(tick, run_.end) - tick_);
  }
}

void SixPoint::plan() {
  run_ = next_run();
  run_.end = run_.ticks == forever ? forever : tick_ + run_.ticks;
  run_.reach = forever;
  if (run_.arrives) {
    if (!position_reached()) run_.reach = tick_ + 1;
  } else if (run_heading() != 0) {
    const auto edge = std::int64_t{value(Register::xtarget)} + (run_heading() < 0 ? 1 : 0);
    run_.reach = tick_after(way_to(edge));
  }
}

void SixPoint::take(Tick ticks) {
  position_ += static_cast<std::uint64_t>(way_of(ticks, velocity_, run_.change)) << position_shift;
  const auto before = velocity_;
  velocity_ += static_cast<std::int64_t>(ticks * static_cast<std::uint64_t>(run_.change));
  tick_ += ticks;
  phase_ = run_.phase;
  acceleration_ = run_.acceleration;
  braking_ = run_.brakes;
  if (tick_ >= run_.reach) pos_reached_event_ = true;
  if (velocity_ == 0 && (before != 0 || run_.arrives)) come_to_rest();
}

void SixPoint::come_to_rest() {
  const auto microsteps = static_cast<std::uint64_t>(static_cast<std::uint32_t>(xactual()));
  position_ = run_.arrives ? target() : microsteps << 32;
  stands_until_ = tick_ + static_cast<Tick>(value(Register::tzerowait));
  phase_ = Phase::rest;
  acceleration_ = 0;
  braking_ = false;
  if (run_.turns) second_move_event_ = true;
}

// ---- Looking ahead within the run

int SixPoint::run_heading() const { return velocity_ != 0 ? sign(velocity_) : sign(run_.change); }

// The way until XACTUAL crosses the lower edge of this microstep, 1..2^55.
Tick SixPoint::way_to(std::int64_t number) const {
  const auto edge = (static_cast<std::uint64_t>(number) << 32) - (std::uint64_t{1} << 31);
  // Upwards the edge itself belongs to the other side already, downwards it does not.
  const auto whole = run_heading() > 0 ? edge - position_ - 1 : position_ - edge;
  return (whole >> position_shift) + 1;
}

// The tick of the run that completes such a way; `forever` if none does.
Tick SixPoint::tick_after(Tick way) const {
  const auto ticks = run_.end - tick_;
  const int heading = run_heading();
  const auto v = heading * velocity_;
  const auto change = heading * run_.change;
  const auto fastest = static_cast<Tick>(
      std::max(v, v + static_cast<std::int64_t>(ticks * static_cast<Tick>(change))));
  if (fastest == 0 || (way - 1) / fastest >= ticks) return forever;
  if (change == 0) return tick_ + (way - 1) / fastest + 1;
  const auto n =
      first_tick(ticks, [&](Tick k) { return static_cast<Tick>(way_of(k, v, change)) >= way; });
  return n <= ticks ? tick_ + n : forever;
}

// The tick of the run at which the speed comes to this one, or leaves it.
Tick SixPoint::tick_at_speed(std::int64_t speed) const {
  if (run_.change == 0) return forever;
  const auto off = run_heading() * speed - velocity_;
  if (off == 0) return tick_ + 1;
  const auto n = off / run_.change;
  if (n < 1 || n * run_.change != off || static_cast<Tick>(n) > run_.end - tick_) return forever;
  return tick_ + static_cast<Tick>(n);
}

Tick SixPoint::next_change() {
  if (run_.end <= tick_) plan();
  if (tick_ < stands_until_) return stands_until_;
  if (run_.phase != phase_ || run_.acceleration != acceleration_) return tick_ + 1;
  auto change = std::min({run_.end == forever ? forever : run_.end + 1, tick_at_speed(0),
                          tick_at_speed(speed_in(Register::vmax))});
  if (run_.reach > tick_) change = std::min(change, run_.reach);
  if (run_heading() != 0 && position_reached()) {
    const auto edge = std::int64_t{value(Register::xtarget)} + (run_heading() > 0 ? 1 : 0);
    change = std::min(change, tick_after(way_to(edge)));
  }
  return change;
}

}  // namespace tmcl::ramp
