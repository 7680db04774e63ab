#include "motion/path/smooth_speed.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include "motion/solve/arithmetic.hpp"

namespace tmcl::plan {
namespace {

// An acceleration takes so long at least, in seconds: less is lost in the rounding of times.
constexpr double shortest_mean = 1e-4;
// Phases that are shorter than this part of the mean's time are rounding.
constexpr double no_time = 1e-9;
// How often a better acceleration is sought: by halves first, then in between.
constexpr int most_halvings = 40;
constexpr int narrowings = 5;
// Where there are more limits, which takes its time, not in between.
constexpr std::size_t most_narrowed = 20'000;
constexpr double golden_part = 0.381966;

/// Of a path, where a speed is the most.
struct Zone {
  double begin;
  double end;
  double speed;
};

std::vector<Zone> zones_of(std::span<const SpeedLimit> limits, double mean_time) {
  std::vector<Zone> zones;
  double way = 0;
  const auto add = [&](double begin, double end, double speed) {
    const double more = speed * mean_time / 2;
    zones.push_back({begin - more, end + more, speed});
  };
  for (const auto& limit : limits) {
    if (std::isfinite(limit.corner) && way > 0) add(way, way, limit.corner);
    add(way, way + limit.length, limit.speed);
    way += limit.length;
  }
  std::ranges::sort(zones, {}, &Zone::begin);
  return zones;
}

/// One length after the other, each with one limit.
std::vector<SpeedLimit> without_overlaps(const std::vector<Zone>& zones, double length) {
  const auto is_faster = [](const Zone& one, const Zone& other) { return one.speed > other.speed; };
  std::priority_queue<Zone, std::vector<Zone>, decltype(is_faster)> here(is_faster);
  std::vector<SpeedLimit> parts;
  auto next = zones.begin();
  for (double way = 0; way < length;) {
    for (; next != zones.end() && next->begin <= way; ++next) here.push(*next);
    while (here.top().end <= way && here.size() > 1) here.pop();
    double end = std::min(here.top().end, length);
    if (next != zones.end()) end = std::min(end, next->begin);
    // What rounding leaves between two zones belongs to the first one.
    if (end <= way) end = next != zones.end() ? std::min(next->begin, length) : length;
    const double speed = here.top().speed;
    const bool is_same = !parts.empty() && parts.back().speed == speed;
    if (!is_same) parts.push_back({0, speed});
    parts.back().length += end - way;
    way = end;
  }
  return parts;
}

/// A way on which the square of the speed changes evenly.
struct Slope {
  double way;
  double from;
  double to;
  bool rises() const { return to > from; }
  bool is_even() const { return to == from; }
};

/// Puts slopes together, and cuts off tops that are passed too soon.
class Slopes {
 public:
  Slopes(double acceleration, double mean_time)
      : acceleration_(acceleration), mean_time_(mean_time) {}

  void rise(double from, double to) {
    if (to <= from) return;
    if (!slopes_.empty() && slopes_.back().rises()) {
      slopes_.back().way += way_between(from, to);
      slopes_.back().to = to;
    } else {
      slopes_.push_back({way_between(from, to), from, to});
    }
  }
  void keep(double way, double square_of_speed) {
    if (way <= 0) return;
    if (!slopes_.empty() && slopes_.back().is_even()) {
      slopes_.back().way += way;
    } else {
      slopes_.push_back({way, square_of_speed, square_of_speed});
    }
  }
  void fall(double from, double to) {
    while (to < from) {
      const double top = take_even_way();
      const bool is_top = !slopes_.empty() && slopes_.back().rises();
      const double level = is_top ? level_for(top, from) : from;
      if (level >= from) {
        keep(top, from);
        slopes_.push_back({way_between(to, from), from, to});
        return;
      }
      auto& rise = slopes_.back();
      const double cut = std::max({level, rise.from, to});
      const double wider = top + 2 * way_between(cut, from);
      rise.to = from = cut;
      rise.way = way_between(rise.from, cut);
      if (!rise.rises()) slopes_.pop_back();
      keep(wider, cut);
    }
  }
  const std::vector<Slope>& all() const { return slopes_; }

 private:
  double way_between(double low, double high) const { return (high - low) / (2 * acceleration_); }
  double take_even_way() {
    if (slopes_.empty() || !slopes_.back().is_even()) return 0;
    const double way = slopes_.back().way;
    slopes_.pop_back();
    return way;
  }
  /// Of a top that is so long, and gets longer where it is cut: where it takes the mean's time.
  double level_for(double way, double square_of_speed) const {
    if (way >= std::sqrt(square_of_speed) * mean_time_) return square_of_speed;
    const double gained = acceleration_ * mean_time_;
    const double whole = square_of_speed + acceleration_ * way;
    return square(2 * whole / (gained + std::sqrt(square(gained) + 4 * whole)));
  }

  double acceleration_;
  double mean_time_;
  std::vector<Slope> slopes_;
};

Slopes ramps_of(std::span<const SpeedLimit> parts, double acceleration, double mean_time) {
  // The squares of the speeds between the parts.
  std::vector<double> squares(parts.size() + 1);
  const auto reachable = [&](double from, std::size_t part) {
    return from + 2 * acceleration * parts[part].length;
  };
  for (std::size_t i = 1; i < parts.size(); ++i)
    squares[i] = std::min(
        {square(parts[i - 1].speed), square(parts[i].speed), reachable(squares[i - 1], i - 1)});
  for (std::size_t i = parts.size(); i-- > 1;)
    squares[i] = std::min(squares[i], reachable(squares[i + 1], i));
  Slopes slopes(acceleration, mean_time);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double from = squares[i], to = squares[i + 1];
    const double reached = (from + to) / 2 + acceleration * parts[i].length;
    const double top = std::max({from, to, std::min(reached, square(parts[i].speed))});
    slopes.rise(from, top);
    if (reached > top) slopes.keep((reached - top) / acceleration, top);
    slopes.fall(top, to);
  }
  return slopes;
}

double time_of(const Slope& slope, double acceleration) {
  if (slope.is_even()) return slope.way / std::sqrt(slope.from);
  return std::abs(std::sqrt(slope.to) - std::sqrt(slope.from)) / acceleration;
}

/// Time, way and speed where a slope of the ramps begins.
struct RampPoint {
  double time;
  double way;
  double speed;
  double acceleration;
};

std::vector<RampPoint> points_of(const std::vector<Slope>& slopes, double acceleration) {
  std::vector<RampPoint> points;
  double time = 0, way = 0;
  for (const auto& slope : slopes) {
    const double changes = slope.is_even() ? 0 : slope.rises() ? acceleration : -acceleration;
    points.push_back({time, way, std::sqrt(slope.from), changes});
    time += time_of(slope, acceleration);
    way += slope.way;
  }
  points.push_back({time, way, 0, 0});
  return points;
}

/// Ascending times only.
class RampReader {
 public:
  explicit RampReader(const std::vector<RampPoint>& points) : points_(points) {}
  RampPoint at(double time) {
    while (next_ < points_.size() && points_[next_].time <= time) ++next_;
    if (next_ == 0) return {time, 0, 0, 0};
    const auto& point = points_[next_ - 1];
    const double after = time - point.time;
    return {time, point.way + after * (point.speed + after * point.acceleration / 2),
            point.speed + after * point.acceleration, point.acceleration};
  }

 private:
  const std::vector<RampPoint>& points_;
  std::size_t next_ = 0;
};

/// The times at which the mean bends.
std::vector<double> bends_of(const std::vector<RampPoint>& points, double mean_time) {
  std::vector<double> later, all;
  for (const auto& point : points) {
    all.push_back(point.time);
    later.push_back(point.time + mean_time);
  }
  const auto middle = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), later.begin(), later.end());
  std::inplace_merge(all.begin(), all.begin() + middle, all.end());
  const auto near = [&](double one, double other) { return other - one <= no_time * mean_time; };
  const double end = all.back();
  all.erase(std::unique(all.begin(), all.end(), near), all.end());
  all.back() = end;
  return all;
}

std::vector<SpeedPhase> mean_of(const std::vector<RampPoint>& points, double mean_time) {
  std::vector<SpeedPhase> phases;
  RampReader first(points), last(points);
  for (const double bend : bends_of(points, mean_time)) {
    const auto from = first.at(bend - mean_time), to = last.at(bend);
    phases.push_back(
        {bend, 0, (to.way - from.way) / mean_time, (to.speed - from.speed) / mean_time, 0});
  }
  for (std::size_t i = 0; i + 1 < phases.size(); ++i) {
    auto& [begin, way, speed, acceleration, jerk] = phases[i];
    auto& next = phases[i + 1];
    const double time = next.begin - begin;
    jerk = (next.acceleration - acceleration) / time;
    next.way = way + time * ((speed + next.speed) / 2 - time * time * jerk / 12);
  }
  return phases;
}

class Search {
 public:
  Search(std::span<const SpeedLimit> limits, double jerk) : limits_(limits), jerk_(jerk) {
    for (const auto& limit : limits) length_ += limit.length;
  }

  std::vector<RampPoint> ramps(double acceleration) const {
    const double mean_time = mean_time_for(acceleration);
    const auto parts = without_overlaps(zones_of(limits_, mean_time), length_);
    return points_of(ramps_of(parts, acceleration, mean_time).all(), acceleration);
  }
  double duration(double acceleration) const {
    return ramps(acceleration).back().time + mean_time_for(acceleration);
  }
  double mean_time_for(double acceleration) const {
    return std::max(acceleration / jerk_, shortest_mean);
  }
  double best(double most) const {
    double here = most, time = duration(here);
    for (int i = 0; i < most_halvings; ++i) {
      const double half = duration(here / 2);
      if (half >= time) break;
      here /= 2;
      time = half;
    }
    if (limits_.size() > most_narrowed) return here;
    return narrowed(here / 2, std::min(2 * here, most), here, time);
  }

 private:
  double narrowed(double low, double high, double here, double time) const {
    for (int i = 0; i < narrowings; ++i) {
      const bool above = high - here > here - low;
      const double tried = here + golden_part * (above ? high - here : low - here);
      const double takes = duration(tried);
      if (takes < time) {
        (above ? low : high) = here;
        here = tried;
        time = takes;
      } else {
        (above ? high : low) = tried;
      }
    }
    return here;
  }

  std::span<const SpeedLimit> limits_;
  double jerk_;
  double length_ = 0;
};

}  // namespace

std::vector<SpeedPhase> smooth_speed(std::span<const SpeedLimit> limits, double acceleration,
                                     double jerk) {
  const Search search(limits, jerk);
  const double best = search.best(acceleration);
  return mean_of(search.ramps(best), search.mean_time_for(best));
}

}  // namespace tmcl::plan
