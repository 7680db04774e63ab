#include "tmcl/plan/course.hpp"
#include "tmcl/plain_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "motion/solve/arithmetic.hpp"

namespace tmcl::plan {
namespace {

using path_file::Dwell;
using path_file::LineTo;

// Speeds that differ by less are the same.
constexpr double rounding = 1e-9;

// The velocity at a row between two slopes that keeps the cubics on either side monotone.
double slope_between(double before, double after, double time_before, double time_after) {
  if (before * after <= 0) return 0;
  const double total = 3 * (time_before + time_after);
  return total / ((2 * time_after + time_before) / before + (time_after + 2 * time_before) / after);
}

}  // namespace

/// Puts a course together, element by element.
class Course::Maker {
 public:
  Maker(const path_file::Path& path, const PathLimits& limits, double feed, double longer_rests)
      : path_(path), limits_(limits), feed_(feed), longer_rests_(longer_rests), here_(path.start) {
    limits_.axes = path.axes.size();
    course_.axes_ = limits_.axes;
    course_.limits_ = limits_;
    course_.least_ = course_.greatest_ = here_;
  }

  tl::expected<Course, std::string> make() {
    for (const auto& element : path_.elements) {
      if (const auto* line = std::get_if<LineTo>(&element)) take(*line);
      if (const auto* dwell = std::get_if<Dwell>(&element)) rest(*dwell);
      if (!fault_.empty()) return tl::unexpected(fault_);
    }
    close();
    if (!fault_.empty()) return tl::unexpected(fault_);
    for (std::size_t axis = 0; axis < course_.axes_; ++axis)
      course_.turns_[axis].push_back({course_.duration(), here_[axis]});
    return std::move(course_);
  }

 private:
  void take(const LineTo& line) {
    const double way = distance_between(here_, line.target, course_.axes_);
    const double counted =
        distance_between(here_, line.target, std::min(course_.axes_, path_.length_axes));
    // A feed is about the counted axes, a plan about the way of all.
    const double stretch = counted > 0 ? way / counted : 1;
    if (line.duration) {
      if (rows_.empty()) rows_.push_back({0, here_, {}});
      rows_.push_back({rows_.back().time + *line.duration, line.target, {}});
      course_.timed_ = true;
    } else {
      legs_.push_back({line.target, std::min(feed_, line.feed.value_or(feed_)) * stretch});
    }
    lines_.push_back(line.line);
    stretches_.push_back(stretch);
    course_.length_ += counted;
    here_ = line.target;
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      course_.least_[axis] = std::min(course_.least_[axis], here_[axis]);
      course_.greatest_[axis] = std::max(course_.greatest_[axis], here_[axis]);
    }
  }

  void rest(const Dwell& dwell) {
    close();
    add(Rest{here_, dwell.duration + longer_rests_});
    // When what comes before it has come to rest.
    const double stands = course_.pieces_.back().begin + longer_rests_;
    if (dwell.word) course_.halts_.push_back({stands, dwell.line, *dwell.word});
  }

  // What was collected since the last rest becomes a piece.
  void close() {
    if (!legs_.empty()) plan_legs();
    if (!rows_.empty()) plan_rows();
    legs_.clear();
    rows_.clear();
    lines_.clear();
    stretches_.clear();
    piece_start_ = here_;
  }

  void plan_legs() {
    auto plan = plan_path(piece_start_, legs_, limits_);
    if (!plan) {
      const auto& fault = plan.error();
      using Kind = PathFault::Kind;
      const bool of_leg = fault.kind == Kind::target || fault.kind == Kind::feed;
      fault_ = (of_leg ? fmt::format("line {}: ", lines_[fault.leg]) : "") + describe(fault);
      return;
    }
    for (std::size_t leg = 0; leg < plan->legs().size(); ++leg) {
      note_way(course_.duration() + plan->legs()[leg].begin, legs_[leg].target);
      if (plan->legs()[leg].length == 0) continue;
      course_.legs_.push_back({course_.pieces_.size(), leg, lines_[leg], stretches_[leg]});
      for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
        course_.top_speed_[axis] = std::max(course_.top_speed_[axis], plan->ramp(leg, axis).vmax);
      }
    }
    add(std::move(*plan));
  }

  void plan_rows() {
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      for (std::size_t i = 1; i + 1 < rows_.size(); ++i) {
        rows_[i].velocity[axis] = slope_between(slope_after(i - 1, axis), slope_after(i, axis),
                                                time_after(i - 1), time_after(i));
      }
    }
    for (std::size_t i = 0; i + 1 < rows_.size() && fault_.empty(); ++i) {
      check_limits(i);
      note_way(course_.duration() + rows_[i].time, rows_[i + 1].position);
    }
    add(std::move(rows_));
  }

  // From the corner before, where it is at `time`.
  void note_way(double time, const AxisValues& target) {
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      const double way = target[axis] - corner_[axis];
      if (way * heading_[axis] < 0) course_.turns_[axis].push_back({time, corner_[axis]});
      if (way != 0) heading_[axis] = way;
    }
    corner_ = target;
  }

  double time_after(std::size_t row) const { return rows_[row + 1].time - rows_[row].time; }
  double slope_after(std::size_t row, std::size_t axis) const {
    return (rows_[row + 1].position[axis] - rows_[row].position[axis]) / time_after(row);
  }

  // A cubic is fastest at an end or where its acceleration is 0, and accelerates most at an end.
  void check_limits(std::size_t row) {
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      const double time = time_after(row);
      const double slope = slope_after(row, axis);
      const double v0 = rows_[row].velocity[axis];
      const double v1 = rows_[row + 1].velocity[axis];
      const double a0 = (6 * slope - 4 * v0 - 2 * v1) / time;
      const double a1 = (2 * v0 + 4 * v1 - 6 * slope) / time;
      double speed = std::max(std::abs(v0), std::abs(v1));
      if (a0 * a1 < 0) speed = std::max(speed, std::abs(v0 + a0 * time * a0 / (a0 - a1) / 2));
      course_.top_speed_[axis] = std::max(course_.top_speed_[axis], speed);
      complain(row, axis, "fast", speed, limits_.axis[axis].velocity, "/s");
      complain(row, axis, "steep", std::max(std::abs(a0), std::abs(a1)),
               limits_.axis[axis].acceleration, "/s^2");
    }
  }

  void complain(std::size_t row, std::size_t axis, std::string_view how, double value, double limit,
                std::string_view unit) {
    if (value <= limit * (1 + timetable_slack) || !fault_.empty()) return;
    fault_ =
        fmt::format("line {}: too {} for axis {}: {}{}, where {} is the most", lines_[row], how,
                    path_.axes[axis], plain_number(value, 6), unit, plain_number(limit, 6));
  }

  void add(std::variant<PathPlan, Rest, Timetable> what) {
    Piece piece{course_.duration(), rested_, std::move(what)};
    if (const auto* rest = std::get_if<Rest>(&piece.what))
      rested_ += rest->duration - longer_rests_;
    course_.pieces_.push_back(std::move(piece));
  }

  const path_file::Path& path_;
  PathLimits limits_;
  double feed_;
  double longer_rests_;  // what comes before may end so much later
  AxisValues here_;
  AxisValues piece_start_ = here_;
  AxisValues corner_ = here_;
  AxisValues heading_{};  // the last way that each axis went
  std::vector<Leg> legs_;
  Timetable rows_;
  std::vector<std::size_t> lines_;
  std::vector<double> stretches_;
  std::string fault_;
  double rested_ = 0;
  Course course_;
};

tl::expected<Course, std::string> Course::of(const path_file::Path& path, const PathLimits& limits,
                                             double feed, const std::optional<Shaping>& shaping) {
  const double longer = shaping ? longest_delay(impulses_of(*shaping)) : 0;
  auto course = Maker(path, limits, feed, longer).make();
  if (course && course->timed_ && std::isfinite(limits.jerk))
    return tl::unexpected<std::string>("a table with times is passed as it says, with any jerk");
  if (course && shaping) course->shape(*shaping);
  return course;
}

double Course::duration_of(const Piece& piece) {
  if (const auto* plan = std::get_if<PathPlan>(&piece.what)) return plan->duration();
  if (const auto* rest = std::get_if<Rest>(&piece.what)) return rest->duration;
  return std::get<Timetable>(piece.what).back().time;
}

double Course::plain_duration() const {
  return pieces_.empty() ? 0 : pieces_.back().begin + duration_of(pieces_.back());
}

double Course::duration() const { return plain_duration() + longest_delay(impulses_); }

std::size_t Course::bytes() const {
  auto bytes = sizeof *this + pieces_.capacity() * sizeof(Piece) +
               legs_.capacity() * sizeof(LegPlace) + halts_.capacity() * sizeof(CourseHalt);
  for (const auto& turns : turns_) bytes += turns.capacity() * sizeof(Turn);
  for (const auto& piece : pieces_) {
    if (const auto* plan = std::get_if<PathPlan>(&piece.what)) bytes += plan->bytes();
    if (const auto* rows = std::get_if<Timetable>(&piece.what))
      bytes += rows->capacity() * sizeof(Row);
  }
  return bytes;
}

PathMotion Course::motion_at(const Timetable& rows, double t) {
  PathMotion state;
  const auto later = std::ranges::upper_bound(rows, t, {}, &Row::time);
  if (later == rows.begin() || later == rows.end()) {
    state.position = later == rows.begin() ? rows.front().position : rows.back().position;
    return state;
  }
  const auto& from = *std::prev(later);
  const double time = later->time - from.time;
  const double u = (t - from.time) / time;
  for (std::size_t axis = 0; axis < most_path_axes; ++axis) {
    const double way = later->position[axis] - from.position[axis];
    const double v0 = from.velocity[axis] * time;
    const double v1 = later->velocity[axis] * time;
    const double c2 = 3 * way - 2 * v0 - v1;
    const double c3 = v0 + v1 - 2 * way;
    state.position[axis] = from.position[axis] + u * (v0 + u * (c2 + u * c3));
    state.velocity[axis] = (v0 + u * (2 * c2 + u * 3 * c3)) / time;
    state.acceleration[axis] = (2 * c2 + u * 6 * c3) / (time * time);
    state.jerk[axis] = 6 * c3 / (time * time * time);
  }
  return state;
}

const Course::Piece& Course::piece_at(double t) const {
  const auto later = std::ranges::upper_bound(pieces_, std::max(t, 0.0), {}, &Piece::begin);
  return *std::prev(later);
}

PathState Course::plain_at(double t) const {
  if (pieces_.empty()) return {least_, {}};
  const auto& piece = piece_at(t);
  const double after = std::max(t, 0.0) - piece.begin;
  if (const auto* plan = std::get_if<PathPlan>(&piece.what)) return plan->at(after);
  if (const auto* rest = std::get_if<Rest>(&piece.what)) return {rest->position, {}};
  return motion_at(std::get<Timetable>(piece.what), after);
}

PathMotion Course::plain_motion_at(double t) const {
  if (pieces_.empty()) return {{least_, {}}, {}, {}};
  const auto& piece = piece_at(t);
  const double after = t - piece.begin;
  if (const auto* plan = std::get_if<PathPlan>(&piece.what)) return plan->motion_at(after);
  if (const auto* rest = std::get_if<Rest>(&piece.what)) return {{rest->position, {}}, {}, {}};
  return motion_at(std::get<Timetable>(piece.what), after);
}

double Course::plain_bend_not_before(double t) const {
  if (pieces_.empty()) return std::numeric_limits<double>::infinity();
  for (const auto* piece = &piece_at(t); piece != pieces_.data() + pieces_.size(); ++piece) {
    const auto* plan = std::get_if<PathPlan>(&piece->what);
    if (plan == nullptr) continue;
    const double bend = plan->bend_not_before(t - piece->begin);
    if (std::isfinite(bend)) return piece->begin + bend;
  }
  return std::numeric_limits<double>::infinity();
}

CourseLeg Course::leg(std::size_t index) const {
  const auto& place = legs_[index];
  const auto& piece = pieces_[place.piece];
  const auto& plan = std::get<PathPlan>(piece.what);
  const auto& leg = plan.legs()[place.leg];
  CourseLeg made{piece.begin + leg.begin,
                 piece.begin + leg.end(),
                 leg.up,
                 leg.down,
                 place.line,
                 leg.peak_speed - leg.start_speed > rounding * leg.peak_speed,
                 leg.peak_speed - leg.end_speed > rounding * leg.peak_speed,
                 leg.start_speed,
                 leg.peak_speed,
                 leg.end_speed,
                 leg.length / leg.duration(),
                 leg.acceleration,
                 {}};
  for (std::size_t axis = 0; axis < axes_; ++axis) made.axis[axis] = plan.ramp(place.leg, axis);
  return made;
}

double Course::begin_of(const LegPlace& place) const {
  const auto& piece = pieces_[place.piece];
  return piece.begin + std::get<PathPlan>(piece.what).legs()[place.leg].begin;
}

std::optional<std::size_t> Course::leg_at(double t) const {
  const auto begin = [this](const LegPlace& place) { return begin_of(place); };
  const auto later = std::ranges::upper_bound(legs_, t - mean_delay(impulses_), {}, begin);
  if (later == legs_.begin()) return std::nullopt;
  return static_cast<std::size_t>(std::distance(legs_.begin(), later)) - 1;
}

std::optional<std::size_t> Course::line_at(double t) const {
  const auto leg = leg_at(std::max(t, mean_delay(impulses_)));
  return leg ? std::optional(legs_[*leg].line) : std::nullopt;
}

double Course::speed_at(double t) const {
  const auto velocity = at(t).velocity;
  double speed = 0;
  for (std::size_t axis = 0; axis < axes_; ++axis) speed = std::hypot(speed, velocity[axis]);
  const auto leg = leg_at(t);
  return leg ? speed / legs_[*leg].stretch : speed;
}

std::optional<CourseRest> Course::rest_after(double t) const {
  if (pieces_.empty()) return std::nullopt;
  // What comes before it may end so much later, and then it stands.
  const double late = longest_delay(impulses_);
  for (const auto* piece = &piece_at(t); piece != pieces_.data() + pieces_.size(); ++piece) {
    const double end = piece->begin + duration_of(*piece);
    if (std::holds_alternative<Rest>(piece->what) && end > t)
      return CourseRest{piece->begin + late, end};
  }
  return std::nullopt;
}

double Course::resting_after(double t) const {
  if (pieces_.empty()) return 0;
  const auto& last = pieces_.back();
  const double late = longest_delay(impulses_);
  const auto rest_of = [late](const Piece& piece) {
    return std::holds_alternative<Rest>(piece.what) ? duration_of(piece) - late : 0;
  };
  const auto& here = piece_at(t);
  const double rested = here.rested + std::clamp(t - here.begin - late, 0.0, rest_of(here));
  return last.rested + rest_of(last) - rested;
}

std::vector<Corner> Course::slowest_corners(std::size_t most) const {
  std::vector<Corner> corners;
  // Where the path is passed at its full speed, nothing is slow.
  double top = 0;
  for (std::size_t i = 0; i < legs_.size(); ++i) top = std::max(top, leg(i).peak_speed);
  for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
    const auto ended = leg(i);
    if (ended.end_speed >= top) continue;
    corners.push_back({ended.end + mean_delay(impulses_), ended.end_speed / legs_[i].stretch,
                       ended.line, plain_at(ended.end).position});
  }
  const auto count = std::min(most, corners.size());
  std::ranges::partial_sort(corners, corners.begin() + static_cast<std::ptrdiff_t>(count), {},
                            &Corner::speed);
  corners.resize(count);
  return corners;
}

}  // namespace tmcl::plan
