#include "tmcl/plan/line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "motion/plan/line_runner.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

constexpr int deviation_samples = 200;
// They cost four commands more.
constexpr Duration not_worth_other_dividers = std::chrono::microseconds(500);

// With which a trapezoid takes so long, but no more than the greatest.
double velocity_for(double way, double time_s, double greatest, double acceleration) {
  const double ramps = acceleration * time_s;
  const double below_root = ramps * ramps - 4 * acceleration * way;
  if (below_root <= 0) return greatest;
  return std::min(greatest, (ramps - std::sqrt(below_root)) / 2);
}

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
  std::vector<LineRunner> finer_runners(std::size_t i) const {
    return LineRunner::finer(axes_[i], part_of(i), ramp_);
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

  static bool is_near_enough(const LineRunner& runner, Duration wanted) {
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
  std::vector<LineRunner> runners_;
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
