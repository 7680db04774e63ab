/// The TMC429 written down as plainly as possible: one base tick after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "tmcl/ramp/tmc429.hpp"

namespace tmcl::test {

struct PlainTmc429 {
  using Chip = ramp::Tmc429;

  std::uint64_t n = 0;
  std::int32_t xt = 0, x = 0, v_min = 0, v_max = 0, vt = 0, v = 0, a_max = 0;
  std::int32_t accumulator = 0;
  int pd = 0, rd = 0;
  std::int64_t p = 128, pdiv = 13;
  Chip::Mode mode = Chip::Mode::ramp;
  Chip::LastStep last_step = Chip::LastStep::r3;
  Chip::Order order = Chip::Order::ramp_first;
  bool keep_accumulator = false;
  bool stop_left = false, stop_right = false, soft_stop = false;

  static std::int32_t wrap(std::int64_t position) {
    position &= 0xFFFFFF;
    return static_cast<std::int32_t>(position >= 0x800000 ? position - 0x1000000 : position);
  }

  std::int32_t speed_at(std::int64_t distance) const {
    const auto d = std::min<std::int64_t>(distance, 1 << 19);
    const double factor = static_cast<double>(p) / std::exp2(3 + pdiv);
    double w = std::sqrt(2048 * factor * static_cast<double>(d - 1));
    if (last_step == Chip::LastStep::r1)
      w = std::sqrt(2048 * std::floor(factor * static_cast<double>(d)));
    if (last_step == Chip::LastStep::r2) w = std::sqrt(2048 * factor * static_cast<double>(d));
    if (mode == Chip::Mode::soft) w = factor * static_cast<double>(d);
    const auto whole = static_cast<std::int32_t>(std::min(w, 2047.0));
    return std::min(std::max(whole, v_min), v_max);
  }

  std::int32_t asked() const {
    const auto dx = wrap(std::int64_t{xt} - x);
    return dx == 0 ? 0 : dx > 0 ? speed_at(dx) : -speed_at(-std::int64_t{dx});
  }

  bool blocked(std::int32_t velocity) const {
    return (velocity < 0 && stop_left) || (velocity > 0 && stop_right);
  }

  void slew_to(std::int32_t goal) {
    if (blocked(goal)) goal = 0;
    v += std::clamp(goal - v, -a_max, a_max);
  }

  void ramp_tick() {
    if (blocked(v) && !soft_stop) {
      v = 0;
    } else if (mode == Chip::Mode::hold) {
      slew_to(v);
    } else if (mode == Chip::Mode::velocity) {
      slew_to(256 * std::clamp(vt, -v_max, v_max));
    } else if (x == xt && std::abs(v) / 256 <= v_min) {
      v = 0;
      if (!keep_accumulator) accumulator = 0;
    } else {
      slew_to(256 * asked());
    }
  }

  void pulse_tick() {
    accumulator += std::abs(v) / 256;
    if (accumulator < 2048) return;
    accumulator -= 2048;
    x = wrap(std::int64_t{x} + (v < 0 ? -1 : 1));
  }

  void advance_to(std::uint64_t until) {
    while (n < until) {
      ++n;
      const bool pulse = n % (1ULL << pd) == 0;
      if (pulse && order == Chip::Order::pulse_first) pulse_tick();
      if (n % (1ULL << rd) == 0) ramp_tick();
      if (pulse && order == Chip::Order::ramp_first) pulse_tick();
    }
  }

  void set_mode(Chip::Mode to) {
    if (mode == Chip::Mode::ramp || mode == Chip::Mode::soft) vt = asked();
    mode = to;
  }

  /// As the data sheet's example does it, in floating point: `share` of the ideal factor.
  void update_factor(double share = 0.99) {
    const double ideal = share * a_max / (128 * std::exp2(rd - pd));
    p = 128;
    pdiv = 13;
    if (ideal * 8 >= 256) {
      p = 255;
      pdiv = 0;
    }
    for (int div = 0; div <= 13; ++div) {
      const auto product = static_cast<std::int64_t>(std::floor(ideal * 8 * std::exp2(div) + 1e-9));
      if (product < 128 || product > 255) continue;
      p = product;
      pdiv = div;
    }
  }
};

}  // namespace tmcl::test
