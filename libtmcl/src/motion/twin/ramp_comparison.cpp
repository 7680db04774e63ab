#include "tmcl/plan/ramp_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "tmcl/conversion.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_registers.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;
using ramp::Tick;

constexpr auto ramp_type = number_of("ramp_type");

template <ramp::Generator G>
class Follower {
 public:
  /// `velocity_unit`: of the chip, in microsteps per second.
  Follower(G chip, double velocity_unit) : chip_(std::move(chip)), unit_(velocity_unit) {}

  FollowedMove follow() {
    for (auto left = most_changes; left != 0; --left) {
      const auto change = chip_.next_change();
      if (chip_.arrived() || chip_.settled() || change == ramp::forever) break;
      pass(change);
    }
    if (chip_.arrived()) move_.seconds = seconds(chip_.tick());
    end_phase();
    return std::move(move_);
  }

 private:
  static constexpr double clock_hz = 16e6;  // of all modules
  // A move has some dozens of them; what has more goes to and fro.
  static constexpr std::size_t most_changes = 2'000;
  // The ramp of a TMC429 is a staircase, whose steps need not be of equal height.
  static constexpr Tick parts = std::is_same_v<G, ramp::Tmc429> ? 16 : 1;

  static double seconds(Tick ticks) {
    return static_cast<double>(ticks) / G::ticks_per_second(clock_hz);
  }
  double velocity_at(Tick tick) {
    chip_.advance_to(tick);
    const double velocity = static_cast<double>(chip_.motion().velocity) * unit_;
    move_.top_speed = std::max(move_.top_speed, std::abs(velocity));
    return velocity;
  }

  /// To the next change. What a generator takes at once, as VSTART, it takes in its first tick or
  /// in its last one.
  void pass(Tick to) {
    const double before = velocity_;
    const auto from = chip_.tick();
    stretch(from + 1);
    const auto begin = chip_.tick();
    if (to > begin + 1) {
      for (Tick part = 1; part <= parts; ++part)
        curve(begin + (to - 1 - begin) / parts * part + (to - 1 - begin) % parts * part / parts);
    }
    stretch(to);
    note_phase(from, before);
  }

  void stretch(Tick to) {
    const auto from = chip_.tick();
    if (to <= from) return;
    const double velocity = velocity_at(to);
    add({seconds(to - from), (velocity - velocity_) / seconds(to - from), 0});
    velocity_ = velocity;
  }
  /// The velocity is a parabola through three of its points.
  void curve(Tick to) {
    const auto from = chip_.tick();
    if (to < from + 2) return stretch(to);
    const auto middle = from + (to - from) / 2;
    const double first = seconds(middle - from);
    const double all = seconds(to - from);
    const double to_middle = (velocity_at(middle) - velocity_) / first;
    phase_ahead_ = chip_.phase();
    const double velocity = velocity_at(to);
    const double to_end = (velocity - velocity_) / all;
    const double half_jerk = (to_end - to_middle) / (all - first);
    add({all, to_middle - half_jerk * first, 2 * half_jerk});
    velocity_ = velocity;
  }
  void add(MotionStretch stretch) {
    auto& all = move_.stretches;
    const bool goes_on = !all.empty() && all.back().acceleration == 0 && all.back().jerk == 0 &&
                         stretch.acceleration == 0 && stretch.jerk == 0;
    if (goes_on) {
      all.back().seconds += stretch.seconds;
    } else {
      all.push_back(stretch);
    }
  }

  void note_phase(Tick from, double before) {
    const bool changes = velocity_ != before;
    if (!changes || phase_ahead_ != phase_) end_phase();
    if (!changes) return;
    if (phase_.empty()) phase_began_ = from;
    phase_ = phase_ahead_;
    phase_ended_ = chip_.tick();
  }
  void end_phase() {
    if (!phase_.empty())
      move_.longest_phase_s = std::max(move_.longest_phase_s, seconds(phase_ended_ - phase_began_));
    phase_ = {};
  }

  G chip_;
  double unit_;
  double velocity_ = 0;
  std::string_view phase_ahead_;
  std::string_view phase_;
  Tick phase_began_ = 0;
  Tick phase_ended_ = 0;
  FollowedMove move_;
};

template <ramp::Generator G>
std::optional<FollowedMove> follow_on(const RampRegisters& registers, const Model& model,
                                      std::span<const RegisterWrite> writes) {
  G chip;
  for (const auto& write : writes)
    if (!chip.write(static_cast<typename G::Register>(write.index), write.value))
      return std::nullopt;
  ModuleUnits units{};
  if constexpr (requires { chip.dividers(); }) units = module_units(chip.dividers());
  const auto& row = *find_parameter(axis_parameters(model), ap::max_velocity);
  return Follower<G>(chip, registers.in_microsteps(row, 1, units)).follow();
}

std::int32_t value_of(std::span<const Setting> settings, std::uint8_t parameter) {
  const auto last = std::find_if(settings.rbegin(), settings.rend(), [&](const Setting& setting) {
    return setting.parameter == parameter;
  });
  return last == settings.rend() ? 0 : last->value;
}

using Variants = std::vector<std::vector<Setting>>;

Variants bows_of_tmc457() {
  constexpr auto max_bow = number_of("max_bow");
  Variants variants;
  for (std::int32_t bow = 0; bow <= greatest_bow; ++bow) variants.push_back({{max_bow, bow}});
  return variants;
}

/// Gentler at low speed than above V1.
Variants points_of_sixpoint(std::span<const Setting> settings) {
  constexpr auto a1 = number_of("acceleration_a1");
  constexpr auto v1 = number_of("velocity_v1");
  constexpr auto d1 = number_of("deceleration_d1");
  constexpr std::array parts{0.25, 0.5, 0.75};
  constexpr std::array parts_or_all{0.25, 0.5, 1.0};
  const auto part_of = [&](std::uint8_t parameter, double part) {
    return std::max(1, static_cast<std::int32_t>(part * value_of(settings, parameter)));
  };
  Variants variants{{{v1, 0}}};
  for (const double speed : parts) {
    for (const double up : parts_or_all) {
      for (const double down : parts_or_all) {
        if (up == 1 && down == 1) continue;
        variants.push_back({{v1, part_of(ap::max_velocity, speed)},
                            {a1, part_of(ap::max_acceleration, up)},
                            {d1, part_of(number_of("max_deceleration"), down)}});
      }
    }
  }
  return variants;
}

/// Without its trapezoid, which another generator stands in for.
Variants bows_of_tmc4361() {
  constexpr std::array bows{number_of("bow1"), number_of("bow2"), number_of("bow3"),
                            number_of("bow4")};
  constexpr int least_bits = 12;
  constexpr int most_bits = 23;
  Variants variants;
  for (int bits = least_bits; bits <= most_bits; ++bits) {
    std::vector<Setting> settings{{ramp_type, 1}};
    for (const auto bow : bows) settings.push_back({bow, 1 << bits});
    variants.push_back(std::move(settings));
  }
  return variants;
}

}  // namespace

std::optional<FollowedMove> follow_move(const Model& model, std::span<const Setting> settings,
                                        Microsteps distance) {
  auto registers = RampRegisters::of(model);
  if (!registers) return std::nullopt;
  auto writes = registers->initial_writes();
  bool taken = true;
  const auto write = [&](Setting setting) {
    const auto* row = find_parameter(axis_parameters(model), setting.parameter);
    if (row == nullptr || !registers->unit_mode().accepts(*row, setting.value)) return false;
    const auto more = registers->writes_of(*row, setting.value);
    writes.insert(writes.end(), more.begin(), more.end());
    // What chooses S-shaped ramps is no register of a generator that has no others.
    return !more.empty() || (model.family == Family::tmc4361 && row->number == ramp_type);
  };
  for (const auto& setting : settings) {
    if (setting.parameter == ap::unit_mode) {
      registers->count_in_pps(setting.value == 1);
    } else {
      taken = write(setting) && taken;
    }
  }
  if (!write({ap::target_position, distance.value}) || !taken) return std::nullopt;
  switch (model.family) {
    case Family::tmc429: return follow_on<ramp::Tmc429>(*registers, model, writes);
    case Family::tmc457: return follow_on<ramp::Tmc457>(*registers, model, writes);
    case Family::sixpoint: return follow_on<ramp::SixPoint>(*registers, model, writes);
    case Family::tmc4361: return follow_on<ramp::Tmc4361>(*registers, model, writes);
    case Family::firmware: break;
  }
  return std::nullopt;
}

std::vector<std::vector<Setting>> ramp_variants(const Model& model,
                                                std::span<const Setting> settings) {
  switch (model.family) {
    case Family::tmc457: return bows_of_tmc457();
    case Family::sixpoint: return points_of_sixpoint(settings);
    case Family::tmc4361: return bows_of_tmc4361();
    case Family::tmc429:
    case Family::firmware: break;
  }
  return {{}};
}

RampVerdict judge(const FollowedMove& move, const std::optional<LoadWish>& load) {
  RampVerdict verdict{move.seconds, move.longest_phase_s, {}, {}};
  if (!load || !move.seconds) return verdict;
  ramp::ResonantLoad swinging(load->resonance);
  for (const auto& [seconds, acceleration, jerk] : move.stretches)
    swinging.advance(seconds, acceleration, jerk);
  verdict.swing = swinging.swing();
  if (const auto wait = swinging.time_to_settle(load->tolerance))
    verdict.settled_s = *move.seconds + *wait;
  return verdict;
}

std::optional<RampVerdict> judge_variant(const Model& model, std::vector<Setting> settings,
                                         std::span<const Setting> variant, Microsteps distance,
                                         const std::optional<LoadWish>& load) {
  settings.insert(settings.end(), variant.begin(), variant.end());
  const auto move = follow_move(model, settings, distance);
  return move ? std::optional(judge(*move, load)) : std::nullopt;
}

std::optional<std::size_t> first_settled(std::span<const RampVerdict> verdicts) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    const auto& settled = verdicts[i].settled_s;
    if (settled && (!first || *settled < *verdicts[*first].settled_s)) first = i;
  }
  return first;
}

}  // namespace tmcl::plan
