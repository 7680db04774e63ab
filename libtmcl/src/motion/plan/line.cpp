#include "tmcl/plan/line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "motion/twin/divisors.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// Register values that come about as near to a time as the ramp generator's ticks allow.
constexpr Duration near_enough = std::chrono::microseconds(50);
// What a candidate is worth is only known once a twin has tried it; so many are tried.
constexpr std::size_t tried_first = 8;
constexpr std::size_t tried_then = 24;
// A ramp that is less steep or steeper than the line wants by more than this leaves the line too
// far.
constexpr double most_acceleration_change = 0.15;
// Unless the ramp is such a small part of the time that it does not take it off.
constexpr double short_ramp = 0.005;
constexpr std::int32_t least_speeds_tried = 3;  // to either side
constexpr std::int32_t speeds_tried_part = 60;
constexpr double most_time_change = 0.005;  // less than 1 / speeds_tried_part
constexpr int deviation_samples = 200;
constexpr std::uint8_t greatest_divider = 13;
constexpr std::int32_t greatest_register = 2047;
// So that it can be chosen to 1 %.
constexpr std::int32_t fine_acceleration = 64;
constexpr std::size_t dividers_tried = 2;
// They cost four commands more.
constexpr Duration not_worth_other_dividers = std::chrono::microseconds(500);

std::int64_t way_of(const LineAxis& axis) {
  return std::int64_t{axis.target.value} - axis.twin.motion().position.value;
}

/// Values of parameters.
struct Registers {
  std::int32_t velocity;      // max_velocity
  std::int32_t acceleration;  // max_acceleration
  std::int32_t minimum = 0;   // minimum_velocity of a TMC429; 0: the one that does not creep
};

// Of a trapezoid or a triangle.
double time_of(double way, double velocity, double acceleration) {
  if (velocity * velocity > way * acceleration) return 2 * std::sqrt(way / acceleration);
  return way / velocity + velocity / acceleration;
}

// With which a trapezoid takes so long, but no more than the greatest.
double velocity_for(double way, double time_s, double greatest, double acceleration) {
  const double ramps = acceleration * time_s;
  const double below_root = ramps * ramps - 4 * acceleration * way;
  if (below_root <= 0) return greatest;
  return std::min(greatest, (ramps - std::sqrt(below_root)) / 2);
}

/// What makes a plain trapezoid, with everything else that makes a difference to it: the other
/// accelerations, bow, minimum velocity.
std::vector<Setting> trapezoid_settings(const AxisTwin& twin, InternalVelocity velocity,
                                        InternalAcceleration acceleration) {
  const auto v = velocity.value;
  const auto a = acceleration.value;
  if (const auto* chip = twin.tmc429()) {
    return {{ap::max_velocity, v},
            {ap::max_acceleration, a},
            {number_of("minimum_velocity"),
             std::min(speed_within_a_microstep(chip->dividers(), acceleration).value, v)}};
  }
  constexpr auto deceleration = number_of("max_deceleration");
  if (twin.model().family == Family::tmc457) {
    return {{ap::max_velocity, v},
            {number_of("acceleration"), a},
            {deceleration, a},
            {number_of("max_bow"), 0}};
  }
  return {{ap::max_velocity, v},
          {ap::max_acceleration, a},
          {number_of("velocity_v1"), 0},
          {deceleration, a},
          {number_of("deceleration_d1"), a}};
}

/// The smallest ramp divider with which the acceleration is fine: arrivals are on the grid of the
/// ramp's ticks.
std::optional<Tmc429Dividers> least_ramp_divider(std::uint8_t pulse,
                                                 PulsesPerSecond2 acceleration) {
  for (std::uint8_t ramp = 0; ramp <= greatest_divider; ++ramp) {
    const Tmc429Dividers dividers{pulse, ramp};
    const auto value = acceleration.value / module_units(dividers).acceleration.value;
    const auto valid = tmc429_acceleration_range(dividers);
    if (value >= std::max(valid.least, fine_acceleration) && value <= valid.greatest)
      return dividers;
  }
  return std::nullopt;
}

/// Those with which a TMC429's registers can say the speed of a slow axis, the finest first.
std::vector<Tmc429Dividers> finer_dividers(Tmc429Dividers present, PulsesPerSecond velocity,
                                           PulsesPerSecond2 acceleration) {
  std::vector<Tmc429Dividers> all;
  for (auto pulse = greatest_divider; pulse >= present.pulse; --pulse) {
    const auto unit = module_units(Tmc429Dividers{pulse, 0}).velocity.value;
    if (velocity.value / unit > greatest_register) continue;
    const auto dividers = least_ramp_divider(pulse, acceleration);
    if (dividers && *dividers != present) all.push_back(*dividers);
    if (all.size() == dividers_tried || pulse == 0) break;
  }
  return all;
}

AxisTwin with_dividers(AxisTwin twin, std::optional<Tmc429Dividers> dividers) {
  if (!dividers) return twin;
  twin.set({pulse_divisor, dividers->pulse});
  twin.set({ramp_divisor, dividers->ramp});
  return twin;
}

/// Less is nothing to the generator, which would not even stop then. A TMC429 has a range of its
/// own.
std::int32_t least_acceleration(const AxisTwin& twin) {
  const bool is_tmc457 = twin.model().family == Family::tmc457;
  const auto unit = is_tmc457 ? tmc457_acceleration_unit : sixpoint_acceleration_unit;
  if (twin.tmc429() != nullptr) return 1;
  const auto pps2 = static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
  return static_cast<std::int32_t>(std::ceil(pps2 / twin.to_pps2(InternalAcceleration{1}).value));
}

/// One axis on its line.
class Runner {
 public:
  /// With the dividers that its module has, or with others.
  Runner(const LineAxis& axis, double part_of_longest,
         std::optional<Tmc429Dividers> dividers = std::nullopt)
      : axis_(&axis),
        dividers_(dividers),
        standing_(with_dividers(axis.twin, dividers)),
        way_(static_cast<double>(std::abs(way_of(axis)))),
        part_(part_of_longest),
        v_unit_(standing_.to_pps(InternalVelocity{1}).value),
        a_unit_(standing_.to_pps2(InternalAcceleration{1}).value),
        v_range_(range(ap::max_velocity, axis.velocity.value / v_unit_)),
        a_range_(range(ap::max_acceleration, axis.acceleration.value / a_unit_)) {
    a_range_.least = std::max(a_range_.least, least_acceleration(standing_));
    const auto* chip = standing_.tmc429();
    if (chip == nullptr) return;
    const auto valid = tmc429_acceleration_range(chip->dividers());
    a_range_.least = std::max(a_range_.least, valid.least);
    a_range_.greatest = std::min(a_range_.greatest, valid.greatest);
  }

  /// Its part of the common speed and acceleration. False if its registers cannot say that.
  bool choose(double velocity, double acceleration) {
    v_ideal_ = velocity * part_ / v_unit_;
    a_ideal_ = acceleration * part_ / a_unit_;
    const auto v = std::round(std::min<double>(v_ideal_, v_range_.greatest));
    const auto a = std::round(std::min<double>(a_ideal_, a_range_.greatest));
    if (v < v_range_.least || a < a_range_.least) return false;
    return take({static_cast<std::int32_t>(v), static_cast<std::int32_t>(a)});
  }

  /// The registers with which it takes nearest to this time.
  void fit(Duration wanted) {
    if (try_out(chosen_, wanted)) return;
    for (const auto count : {tried_first, tried_then}) {
      const double bias = seconds(arrival_) - formula(chosen_);
      for (const auto& candidate : candidates(seconds(wanted) - bias, count)) {
        if (try_out(candidate, wanted)) return;
      }
    }
  }

  /// It takes so much more or less than its part should that the others could not follow it.
  bool is_coarse() const {
    const double ideal = time_of(way_, v_ideal_ * v_unit_, a_ideal_ * a_unit_);
    return std::abs(formula(chosen_) / ideal - 1) > most_time_change;
  }

  Duration arrival() const { return arrival_; }
  AxisOfLine result(Duration start) const {
    return {settings_to_write(), run(chosen_), start, start + arrival_};
  }

 private:
  ValueRange range(std::uint8_t parameter, double limit) const {
    const auto& row = *find_parameter(axis_parameters(axis_->twin.model()), parameter);
    return {1, static_cast<std::int32_t>(
                   std::min<double>(row.maximum, std::floor(limit * (1 + 1e-9))))};
  }

  std::vector<Setting> settings_to_write() const {
    auto settings = settings_of(chosen_);
    if (!dividers_) return settings;
    settings.insert(settings.begin(),
                    {{pulse_divisor, dividers_->pulse}, {ramp_divisor, dividers_->ramp}});
    return in_safe_order(std::move(settings), axis_->twin.tmc429()->dividers().pulse);
  }

  std::vector<Setting> settings_of(Registers registers) const {
    auto settings = trapezoid_settings(standing_, {registers.velocity}, {registers.acceleration});
    if (registers.minimum != 0) settings.back().value = registers.minimum;
    return settings;
  }

  AxisTwin run(Registers registers) const {
    auto twin = standing_;
    twin.set(settings_of(registers));
    twin.move_to(axis_->target);
    return twin;
  }

  bool take(Registers registers) {
    const auto arrival = run(registers).time_to_arrival();
    if (!arrival) return false;
    chosen_ = registers;
    arrival_ = *arrival;
    return true;
  }

  // True if that is near enough.
  bool try_out(Registers registers, Duration wanted) {
    const auto arrival = run(registers).time_to_arrival();
    if (!arrival) return false;
    keep_if_nearer(registers, *arrival, wanted);
    if (*arrival < wanted) creep_at_the_end(registers, wanted);
    return std::chrono::abs(arrival_ - wanted) <= near_enough;
  }

  void keep_if_nearer(Registers registers, Duration arrival, Duration wanted) {
    if (std::chrono::abs(arrival - wanted) >= std::chrono::abs(arrival_ - wanted)) return;
    chosen_ = registers;
    arrival_ = arrival;
  }

  // What is missing to the time is spent on the last microsteps, where it takes no axis off the
  // line: the lower a TMC429's minimum velocity, the later it arrives.
  void creep_at_the_end(Registers registers, Duration wanted) {
    if (axis_->twin.tmc429() == nullptr) return;
    std::int32_t late = 0;
    auto early = settings_of(registers).back().value;
    while (early - late > 1) {
      registers.minimum = (early + late) / 2;
      const auto arrival = run(registers).time_to_arrival();
      if (!arrival) return;
      keep_if_nearer(registers, *arrival, wanted);
      (*arrival < wanted ? early : late) = registers.minimum;
    }
  }

  double formula(Registers registers) const {
    return time_of(way_, registers.velocity * v_unit_, registers.acceleration * a_unit_);
  }

  // The best first.
  std::vector<Registers> candidates(double time_s, std::size_t count) const {
    std::vector<std::pair<double, Registers>> ranked;
    const auto consider = [&](double velocity, double acceleration) {
      for (const double a : {std::floor(acceleration), std::ceil(acceleration)}) {
        if (!(a >= a_range_.least && a <= a_range_.greatest)) continue;
        const double ramp_s = velocity * v_unit_ / (a * a_unit_);
        const bool is_near =
            std::abs(a / a_ideal_ - 1) <= most_acceleration_change || ramp_s <= short_ramp * time_s;
        if (!is_near && a != chosen_.acceleration) continue;
        const Registers registers{static_cast<std::int32_t>(velocity),
                                  static_cast<std::int32_t>(a)};
        ranked.emplace_back(std::abs(formula(registers) - time_s), registers);
      }
    };
    const auto middle = static_cast<std::int32_t>(std::lround(v_ideal_));
    const auto reach = std::max(least_speeds_tried, middle / speeds_tried_part);
    const auto last = std::min(middle + reach, v_range_.greatest);
    const auto step = std::max(1, reach / 50);
    for (auto v = std::max(middle - reach, v_range_.least); v <= last; v += step) {
      const double velocity = v * v_unit_;
      const double ramp_s = time_s - way_ / velocity;
      const double triangle = 4 * way_ / (time_s * time_s);
      const bool is_triangle = velocity * velocity > way_ * triangle;
      if (!is_triangle && ramp_s <= 0) continue;
      consider(v, (is_triangle ? triangle : velocity / ramp_s) / a_unit_);
    }
    const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(std::min(count, ranked.size()));
    std::partial_sort(ranked.begin(), end, ranked.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Registers> best;
    for (auto it = ranked.begin(); it != end; ++it) best.push_back(it->second);
    return best;
  }

  const LineAxis* axis_;
  std::optional<Tmc429Dividers> dividers_;
  AxisTwin standing_;
  double way_;
  double part_;
  double v_unit_;
  double a_unit_;
  ValueRange v_range_;
  ValueRange a_range_;
  double v_ideal_ = 0;
  double a_ideal_ = 0;
  Registers chosen_{};
  Duration arrival_{};
};

std::optional<LineError> fault_of(std::span<const LineAxis> axes) {
  if (axes.empty() || axes.size() > most_line_axes)
    return LineError{0,
                     fmt::format("a line has 1 to {} axes, not {}", most_line_axes, axes.size())};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(axes[i].velocity.value > 0 && std::isfinite(axes[i].velocity.value)))
      return LineError{i, "its greatest velocity must be greater than 0"};
    if (!(axes[i].acceleration.value > 0 && std::isfinite(axes[i].acceleration.value)))
      return LineError{i, "its greatest acceleration must be greater than 0"};
    if (axes[i].twin.motion().velocity.value != 0)
      return LineError{i, "it moves; a line begins at standstill"};
  }
  return std::nullopt;
}

/// How far off the line it gets when all go their own ways in time.
double deviation_of(const Line& line, std::span<const LineAxis> axes, std::size_t longest) {
  const double longest_way = static_cast<double>(std::abs(way_of(axes[longest])));
  std::vector<AxisTwin> twins;
  for (const auto& axis : line.axes) twins.push_back(axis.twin);
  std::vector<double> done(axes.size());
  double worst = 0;
  const auto step = line.duration / deviation_samples;
  for (int sample = 0; sample <= deviation_samples; ++sample) {
    const auto now = step * sample;
    for (const auto i : line.order) {
      const auto since_start = now - line.axes[i].start;
      const auto past = twins[i].elapsed() - line.axes[i].twin.elapsed();
      if (since_start > past) twins[i].advance(since_start - past);
      const auto gone = twins[i].motion().position.value - axes[i].twin.motion().position.value;
      done[i] = gone / static_cast<double>(way_of(axes[i]));
    }
    for (const auto i : line.order) {
      const double way = static_cast<double>(std::abs(way_of(axes[i])));
      worst = std::max(worst, std::abs(done[i] - done[longest]) * way / longest_way);
    }
  }
  return worst;
}

}  // namespace

SharedRamp share_ramp(std::span<const Way> ways) {
  SharedRamp ramp;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (std::abs(ways[i].distance) > std::abs(ways[ramp.longest].distance)) ramp.longest = i;
  }
  const double longest_way = std::abs(ways[ramp.longest].distance);
  for (const auto& way : ways) {
    const double part = std::abs(way.distance) / longest_way;
    if (!(part > 0)) continue;
    ramp.velocity = std::min(ramp.velocity, way.velocity / part);
    ramp.acceleration = std::min(ramp.acceleration, way.acceleration / part);
  }
  return ramp;
}

namespace {

/// A line in the making.
class Planner {
 public:
  Planner(std::span<const LineAxis> axes, const ExchangeTimes& exchanges)
      : axes_(axes), exchanges_(exchanges) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      ways_.push_back({static_cast<double>(way_of(axes[i])), axes[i].velocity.value,
                       axes[i].acceleration.value});
      line_.axes.push_back({{}, axes[i].twin, {}, {}});
      if (way_of(axes[i]) != 0) line_.order.push_back(i);
    }
    ramp_ = share_ramp(ways_);
  }

  /// Greater than what the line takes at least.
  void stretch_to(Duration duration) {
    if (line_.order.empty()) return;
    duration_ = duration;
    const double way = std::abs(ways_[ramp_.longest].distance);
    ramp_.velocity = velocity_for(way, seconds(duration), ramp_.velocity, ramp_.acceleration);
  }

  tl::expected<Line, LineError> plan() {
    if (line_.order.empty()) return std::move(line_);
    if (auto fault = choose_registers()) return tl::unexpected(std::move(*fault));
    // The slowest goes first, so that a late start costs nothing.
    std::ranges::stable_sort(line_.order, std::greater{},
                             [&](std::size_t i) { return runners_[i].arrival(); });
    fit_to_the_last();
    line_.deviation = deviation_of(line_, axes_, ramp_.longest);
    return std::move(line_);
  }

 private:
  double part_of(std::size_t i) const {
    return std::abs(ways_[i].distance) / std::abs(ways_[ramp_.longest].distance);
  }

  std::optional<LineError> choose_registers() {
    for (std::size_t i = 0; i < axes_.size(); ++i) runners_.emplace_back(axes_[i], part_of(i));
    for (const auto i : line_.order) {
      const bool possible = runners_[i].choose(ramp_.velocity, ramp_.acceleration);
      if (possible && !runners_[i].is_coarse()) continue;
      if (auto finer = finer_runners(i); !finer.empty()) {
        runners_[i] = std::move(finer.front());
        continue;
      }
      if (possible) continue;
      return LineError{
          i,
          fmt::format("its part of the line, {} of the longest way, is too slow for its registers",
                      plain_number(part_of(i), 3)),
          Pace{{ramp_.velocity * part_of(i)}, {ramp_.acceleration * part_of(i)}}};
    }
    return std::nullopt;
  }

  /// The same axis with other dividers.
  std::vector<Runner> finer_runners(std::size_t i) const {
    std::vector<Runner> runners;
    const auto* chip = axes_[i].twin.tmc429();
    if (chip == nullptr) return runners;
    const double velocity = ramp_.velocity * part_of(i);
    // A short ramp may be longer, if that lets the speed be finer.
    const double gentle = velocity * velocity / (std::abs(ways_[i].distance) * short_ramp);
    const double acceleration = std::min(ramp_.acceleration * part_of(i), gentle);
    for (const auto dividers : finer_dividers(chip->dividers(), {velocity}, {acceleration})) {
      Runner runner(axes_[i], part_of(i), dividers);
      if (runner.choose(ramp_.velocity, ramp_.acceleration)) runners.push_back(std::move(runner));
    }
    return runners;
  }

  void fit(std::size_t i, Duration wanted) {
    runners_[i].fit(wanted);
    for (auto& finer : finer_runners(i)) {
      if (is_near_enough(runners_[i], wanted)) return;
      finer.fit(wanted);
      if (std::chrono::abs(finer.arrival() - wanted) <
          std::chrono::abs(runners_[i].arrival() - wanted))
        runners_[i] = std::move(finer);
    }
  }

  static bool is_near_enough(const Runner& runner, Duration wanted) {
    return std::chrono::abs(runner.arrival() - wanted) <= not_worth_other_dividers;
  }

  void fit_to_the_last() {
    std::vector<std::size_t> buses;
    for (const auto i : line_.order) buses.push_back(axes_[i].bus);
    const auto starts = start_times(buses, exchanges_);
    Duration end = duration_;
    for (std::size_t place = 0; place < line_.order.size(); ++place)
      end = std::max(end, starts[place] + runners_[line_.order[place]].arrival());
    auto earliest = end;
    for (std::size_t place = 0; place < line_.order.size(); ++place) {
      const auto i = line_.order[place];
      fit(i, end - starts[place]);
      line_.axes[i] = runners_[i].result(starts[place]);
      earliest = std::min(earliest, line_.axes[i].arrival);
      line_.duration = std::max(line_.duration, line_.axes[i].arrival);
    }
    line_.spread = line_.duration - earliest;
  }

  std::span<const LineAxis> axes_;
  const ExchangeTimes& exchanges_;
  std::vector<Way> ways_;
  SharedRamp ramp_;
  Duration duration_{};  // 0: as short as possible
  std::vector<Runner> runners_;
  Line line_;
};

}  // namespace

std::vector<Duration> start_times(std::span<const std::size_t> buses,
                                  const ExchangeTimes& exchanges) {
  std::vector<Duration> times;
  std::array<Duration, most_line_axes> asked{};
  for (const auto bus : buses) {
    const auto exchange = bus < exchanges.size() ? exchanges[bus] : Duration{};
    times.push_back(asked.at(bus) + exchange / 2);
    asked.at(bus) += exchange;
  }
  const auto first = times.empty() ? Duration{} : *std::ranges::min_element(times);
  for (auto& time : times) time -= first;
  return times;
}

tl::expected<Line, LineError> plan_line(std::span<const LineAxis> axes,
                                        const ExchangeTimes& exchanges,
                                        std::optional<Duration> duration) {
  if (auto fault = fault_of(axes)) return tl::unexpected(std::move(*fault));
  auto shortest = Planner(axes, exchanges).plan();
  if (!duration || !shortest || shortest->order.empty()) return shortest;
  if (*duration < shortest->duration) {
    return tl::unexpected(
        LineError{shortest->order.front(),
                  fmt::format("it cannot be there after {} s; the shortest time possible is {} s",
                              plain_number(seconds(*duration), 6),
                              plain_number(seconds(shortest->duration), 6))});
  }
  Planner planner(axes, exchanges);
  planner.stretch_to(*duration);
  return planner.plan();
}

}  // namespace tmcl::plan
