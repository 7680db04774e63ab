/// The sixPoint ramp generator written down as plainly as possible, one tick at a time. What jumps
/// is compared with it, so it shares nothing with it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace tmcl::test {

struct PlainSixPoint {
  // The registers, as written.
  std::int64_t vstart = 0, a1 = 0, v1 = 0, amax = 0, vmax = 0, dmax = 0, d1 = 0, vstop = 10;
  std::int64_t tzerowait = 0, xtarget = 0, rampmode = 0;
  bool stop_l_enable = false, stop_r_enable = false, soft = false;
  bool latch_l_active = false, latch_l_inactive = false;
  bool latch_r_active = false, latch_r_inactive = false;
  bool left = false, right = false;

  std::uint64_t n = 0;
  std::int64_t x = 0;  // 2^-23 microsteps
  std::int64_t v = 0;  // 2^-23 microsteps a tick
  std::int64_t wait = 0;
  bool latched = false;
  std::string_view phase = "rest";
  std::int64_t acceleration = 0;
  bool pos_reached_event = false, second_move = false, latched_l = false, latched_r = false;
  std::int64_t xlatch = 0;

  static constexpr std::int64_t microstep = 1 << 23;

  static std::int64_t wrap55(std::int64_t way) {
    const auto top = static_cast<std::uint64_t>(way) << 9;
    return static_cast<std::int64_t>(top) / 512;
  }
  std::int64_t xactual() const { return wrap55(x + microstep / 2) >> 23; }
  std::int64_t distance() const { return wrap55(xtarget * microstep - x); }

  std::int64_t wanted() const {
    if (rampmode == 0) return distance();
    if (rampmode == 3) return 0;
    return rampmode == 1 ? vmax : -vmax;
  }
  std::int64_t direction() const { return v != 0 ? v : wanted(); }
  bool event_stop_l() const { return direction() < 0 && left && stop_l_enable; }
  bool event_stop_r() const { return direction() > 0 && right && stop_r_enable; }

  void set_switches(bool now_left, bool now_right) {
    const bool take_l =
        (now_left && !left && latch_l_active) || (left && !now_left && latch_l_inactive);
    const bool take_r =
        (now_right && !right && latch_r_active) || (right && !now_right && latch_r_inactive);
    if (take_l || take_r) xlatch = xactual();
    latched_l |= take_l;
    latched_r |= take_r;
    left = now_left;
    right = now_right;
  }

  std::int64_t decelerated(std::int64_t speed) const {
    if (speed > 256 * v1) return std::max({speed - dmax, 256 * v1, 256 * vstop});
    return std::max(speed - d1, 256 * vstop);
  }

  // The sum of decelerated(speed), decelerated() of that, and so on until it is VSTOP.
  std::int64_t brake(std::int64_t speed) const {
    std::int64_t sum = 0;
    for (const auto& [floor, d] : {std::pair{std::max(v1, vstop), dmax}, std::pair{vstop, d1}}) {
      if (speed <= 256 * floor) continue;
      if (d == 0) return INT64_MAX / 4;
      const auto ticks = (speed - 256 * floor + d - 1) / d;
      // All but the last make a series, whose mean is that of its ends.
      sum += (ticks - 1) * (2 * speed - ticks * d) / 2 + 256 * floor;
      speed = 256 * floor;
    }
    return sum;
  }

  std::int64_t towards_vmax(std::int64_t speed) const {
    if (speed > 256 * vmax) {
      if (speed > 256 * v1) return std::max({speed - amax, 256 * v1, 256 * vmax});
      return std::max(speed - a1, 256 * vmax);
    }
    const auto faster = speed < 256 * v1 ? std::min(speed + a1, 256 * v1) : speed + amax;
    return std::min(std::max(faster, 256 * vstart), 256 * vmax);
  }

  void tick() {
    ++n;
    const auto before = xactual();
    const auto v_before = v;
    acceleration = 0;
    move();
    if (v == 0) {
      phase = "rest";
      acceleration = 0;
      latched = false;
    }
    if (v == 0 && (v_before != 0 || xactual() != before)) {
      x = xactual() * microstep;
      wait = tzerowait;
    } else if (wait > 0) {
      --wait;
    }
    if (v == 0 && wait > 0) phase = "TZEROWAIT";
    count_from(before);
  }

  // XACTUAL counts one by one from `before` to where it is now.
  void count_from(std::int64_t before) {
    const auto steps = wrap55((xactual() - before) * microstep) / microstep;
    for (std::int64_t i = 1; i <= std::abs(steps); ++i) {
      const auto at = before + (steps < 0 ? -i : i);
      if (wrap55(at * microstep) == xtarget * microstep) pos_reached_event = true;
    }
  }

  void move() {
    if (wait > 0) return;
    const std::int64_t way = v != 0 ? v : wanted();
    const bool right_stops = way > 0 && right && stop_r_enable;
    const bool left_stops = way < 0 && left && stop_l_enable;
    if (right_stops || left_stops) {
      latched = false;
      return stop(soft ? std::abs(v) : 0);
    }
    if (rampmode == 0) return position_mode();
    if (rampmode == 3) {
      phase = "hold";
      x += v;
      return;
    }
    velocity_mode(rampmode == 1 ? 256 * vmax : -256 * vmax);
  }

  void velocity_mode(std::int64_t goal) {
    const auto old = v;
    v = goal > v ? std::min(v + amax, goal) : std::max(v - amax, goal);
    if ((old > 0 && v < 0) || (old < 0 && v > 0)) v = 0;
    phase = old == goal ? "VMAX" : "AMAX";
    acceleration = v == old ? 0 : v > old ? amax : -amax;
    x += v;
  }

  // From this speed, with DMAX and D1.
  void stop(std::int64_t speed) {
    if (speed <= 256 * vstop) {
      v = 0;
      return;
    }
    run(v < 0 ? -1 : 1, decelerated(speed), speed > 256 * v1 ? "DMAX" : "D1");
  }

  void run(std::int64_t sign, std::int64_t speed, std::string_view name) {
    const auto change = sign * speed - v;
    const auto with = name == "A1"     ? a1
                      : name == "AMAX" ? amax
                      : name == "DMAX" ? dmax
                      : name == "D1"   ? d1
                                       : 0;
    acceleration = change > 0 ? with : change < 0 ? -with : 0;
    phase = name;
    v = sign * speed;
    x += v;
  }

  void position_mode() {
    const auto d = distance();
    const auto speed = std::abs(v);
    if (v == 0 && d == 0) return;
    if ((v > 0 && d < 0) || (v < 0 && d > 0)) {
      stop(speed);
      second_move = second_move || v == 0;
      return;
    }
    const std::int64_t sign = v != 0 ? (v < 0 ? -1 : 1) : d < 0 ? -1 : 1;
    const auto left_over = std::abs(d);
    const auto stops_at = [&](std::int64_t next) {
      return next <= 256 * vstop && left_over <= next + microstep / 2;
    };
    const auto fits = [&](std::int64_t next) {
      return !stops_at(next) && next + brake(next) <= left_over;
    };
    const auto faster = towards_vmax(speed);
    const bool below_vstop = speed < 256 * vstop;
    const auto same = below_vstop ? std::min(faster, 256 * vstop) : speed;

    if ((!latched || below_vstop) && fits(faster)) {
      const bool first = speed < 256 * vmax ? speed < 256 * v1 : speed <= 256 * v1;
      return run(sign, faster, speed == 256 * vmax ? "VMAX" : first ? "A1" : "AMAX");
    }
    latched = true;
    const std::string_view slower = speed > 256 * v1 ? "DMAX" : "D1";
    if (fits(same)) return run(sign, same, same > 256 * vstop ? slower : "VSTOP");
    const auto next = speed > 256 * vstop ? decelerated(speed) : same;
    if (!stops_at(next)) return run(sign, next, slower);
    x = xtarget * microstep;
    v = 0;
  }
};

}  // namespace tmcl::test
