#include "tmcl/plan/stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "motion/drive/stream_runner.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {

using namespace std::string_view_literals;

namespace {

constexpr std::array mode_names{std::pair(StreamMode::velocity, "velocity"sv),
                                std::pair(StreamMode::segments, "segments"sv),
                                std::pair(StreamMode::position, "position"sv)};

}  // namespace

std::string_view name_of(StreamMode mode) {
  return std::ranges::find(mode_names, mode, &decltype(mode_names)::value_type::first)->second;
}

std::optional<StreamMode> stream_mode_named(std::string_view name) {
  const auto found = std::ranges::find(mode_names, name, &decltype(mode_names)::value_type::second);
  return found == mode_names.end() ? std::nullopt : std::optional(found->first);
}

double AxisTracking::rms() const {
  return readings == 0 ? 0 : std::sqrt(squares / static_cast<double>(readings));
}

// ---- what all modes share ----

namespace {

namespace ap = axis_parameter;

constexpr int measuring_rounds = 4;
constexpr Duration longest_way_to_rest = std::chrono::seconds(30);
constexpr Duration longest_way_to_halt = std::chrono::seconds(2);

/// Which M word switches off what this one switches on.
std::optional<std::uint8_t> off_word_for(std::uint8_t word) {
  if (word == 3 || word == 4) return 5;
  if (word == 7 || word == 8) return 9;
  return std::nullopt;
}

}  // namespace

StreamRunner::StreamRunner(const Course& course, std::vector<StreamAxis> axes,
                           StreamOptions options)
    : DriveRunner(axes.size()),
      course_(course),
      options_(options),
      axes_(std::move(axes)),
      told_(axes_.size()),
      clock_(course_),
      watch_(course_, report_, axes_.size(), options_.most_seen),
      start_counts_(axes_.size()) {
  const auto has_encoder = [](const StreamAxis& axis) { return axis.encoder.has_value(); };
  if (!std::ranges::any_of(axes_, has_encoder)) return;
  motor_watch_.emplace(course_, report_.motors.emplace(), axes_.size(), options_.most_seen);
}

void StreamRunner::on_answered(Duration took) {
  if (phase_ != Phase::running && phase_ != Phase::pausing) return;
  ++report_.commands;
  report_.busy_s += seconds(took);
}

std::int32_t StreamRunner::microsteps(std::size_t axis, double position) const {
  return static_cast<std::int32_t>(std::lround(position * axes_[axis].microsteps_per_unit));
}

StreamScript StreamRunner::measure() {
  const auto begin = course_.at(0).position;
  Duration total{};
  int count = 0;
  for (int round = 0; round < measuring_rounds; ++round) {
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      if (auto asked = asked_to_stop()) co_return asked;
      const bool looks_at_speed = round == 0;
      co_await command(
          {Kind::get, axis, looks_at_speed ? ap::actual_velocity : ap::actual_position, 0});
      if (!answer_) co_return refusal(axis);
      const auto wanted = looks_at_speed ? 0 : microsteps(axis, begin[axis]);
      if (*answer_ != wanted) {
        co_return fault(
            DriveFault::Kind::not_at_start, axis,
            looks_at_speed
                ? "is moving"
                : fmt::format("is at {} and not at {}, where the path starts", *answer_, wanted));
      }
      total += now_ - asked_at_;
      report_.worst_round_trip = std::max(report_.worst_round_trip, now_ - asked_at_);
      ++count;
    }
  }
  report_.round_trip = total / count;
  auto unknown = co_await start_encoders();
  co_return unknown;
}

StreamScript StreamRunner::start_encoders() {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (!axes_[axis].encoder) continue;
    co_await command({Kind::get, axis, axes_[axis].encoder->parameter, 0});
    if (!answer_) co_return refusal(axis);
    start_counts_[axis] = *answer_;
  }
  co_return std::nullopt;
}

StreamScript StreamRunner::whole() {
  Fault result;
  if (options_.to_start) {
    phase_ = Phase::approaching;
    result = co_await go_to(course_.at(0).position, TimePoint::max());
    if (result) co_await stop_and_rest(report_);
  }
  phase_ = Phase::before;
  if (!result) result = co_await measure();
  if (!result) result = co_await prepare();
  if (!result) {
    const auto begin = now_;
    phase_ = Phase::running;
    result = co_await pass_course();
    phase_ = Phase::after;
    heeds_stop_ = false;
    report_.passed_s = seconds(now_ - begin);
    const auto limit = now_ + longest_way_to_rest;
    for (std::size_t axis = 0; axis < axes_.size() && !result && rests_at_end(); ++axis)
      result = co_await come_to_rest(axis, limit);
    // The last time that a stop by another client can be told from one's own.
    if (!result) result = co_await check_all();
    if (result || !rests_at_end()) {
      auto stopped = co_await stop_and_rest(report_);
      if (!result) result = stopped;
    }
  }
  phase_ = Phase::after;
  heeds_stop_ = false;
  // An axis that may still move to a target would become as fast as it was.
  co_await restore(report_, false);
  if (!result) result = co_await arrive_at_end();
  report_.fault = result;
  phase_ = Phase::ended;
  co_return result;
}

// ---- halts ----

StreamScript StreamRunner::pass_halt(Duration lead) {
  const auto halt = *clock_.halt();
  if (!waits_) {
    auto wrong = co_await come_to_halt();
    if (wrong) co_return wrong;
    waits_ = halt.waits() && options_.waits;
  }
  if (waits_ && !may_go_on_) co_return asked_to_stop();
  waits_ = may_go_on_ = false;
  Fault wrong;
  if (!halt.waits()) wrong = co_await carry_out(halt);
  if (!wrong) wrong = asked_to_stop();
  clock_.leave_halt(now_ + lead);
  co_return wrong;
}

StreamScript StreamRunner::come_to_halt() {
  const auto limit = now_ + longest_way_to_halt;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto wrong = co_await come_to_rest(axis, limit);
    if (!wrong) wrong = asked_to_stop();
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

StreamScript StreamRunner::carry_out(const CourseHalt& halt) {
  const auto off = off_word_for(halt.word);
  if (off && std::ranges::find(off_words_, *off) == off_words_.end()) off_words_.push_back(*off);
  co_await command({Kind::carry_out, axes_.size(), 0, halt.word});
  if (!answer_) co_return not_carried_out(halt, answer_.error());
  std::erase(off_words_, halt.word);
  co_return std::nullopt;
}

DriveRunner::Fault StreamRunner::not_carried_out(const CourseHalt& halt, const Error& error) const {
  if (auto asked = asked_to_stop()) return asked;
  auto message =
      fmt::format("line {}: M{} was not carried out: {}", halt.line, halt.word, error.message);
  return DriveFault{DriveFault::Kind::refused, {}, std::move(message), error, {}};
}

std::vector<std::uint8_t> StreamRunner::take_words_at_stop() {
  return std::exchange(off_words_, {});
}

// ---- the end ----

StreamScript StreamRunner::arrive_at_end() {
  const auto end = course_.at(course_.duration()).position;
  auto wrong = co_await go_to(end, now_ + longest_way_to_rest);
  if (wrong) {
    co_await stop_and_rest(report_);
  } else {
    report_.unstopped.clear();
  }
  co_return wrong;
}

StreamScript StreamRunner::go_to(AxisValues position, TimePoint limit) {
  const auto begin = now_;
  std::vector<Goal> goals;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (auto asked = asked_to_stop()) co_return asked;
    goals.push_back({axis, {microsteps(axis, position[axis])}});
    co_await command({Kind::move_to, axis, 0, goals.back().target.value});
    if (!answer_) co_return refusal(axis);
  }
  auto wrong = co_await arrive(std::move(goals), begin, limit);
  co_return wrong;
}

// A position is read somewhere between question and answer.
DriveRunner::Fault StreamRunner::take_reading(std::size_t axis) {
  clock_.advance(middle());
  const auto planned = planned_position(axis);
  const double position = *answer_ / axes_[axis].microsteps_per_unit;
  const double off = position - planned;
  watch_.note(axis, off);
  watch_.look(clock_.passed(), planned_positions());
  if (motor_watch_ && !axes_[axis].encoder) motor_watch_->assume(axis, off);
  if (std::abs(off) <= options_.most_deviation) return std::nullopt;
  return fault(
      DriveFault::Kind::off_course, axis,
      fmt::format("is {} off the path, at {}; {} are allowed", plain_number(std::abs(off), 6),
                  plain_number(position, 6), plain_number(options_.most_deviation, 6)));
}

AxisValues StreamRunner::planned_positions() const {
  AxisValues planned{};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) planned[axis] = planned_position(axis);
  return planned;
}

// Counted from where it stood: the counter may have run over meanwhile.
void StreamRunner::take_count(std::size_t axis) {
  clock_.advance(middle());
  const auto counted = static_cast<std::int32_t>(static_cast<std::uint32_t>(*answer_) -
                                                 static_cast<std::uint32_t>(start_counts_[axis]));
  const double position =
      course_.at(0).position[axis] + counted / axes_[axis].encoder->counts_per_unit;
  motor_watch_->note(axis, position - planned_position(axis));
  motor_watch_->look(clock_.passed(), planned_positions());
}

StreamScript StreamRunner::look_at_encoder(TimePoint limit) {
  if (!motor_watch_ || now_ + report_.worst_round_trip > limit) co_return std::nullopt;
  do {
    encoder_ = (encoder_ + 1) % axes_.size();
  } while (!axes_[encoder_].encoder);
  co_await command({Kind::get, encoder_, axes_[encoder_].encoder->parameter, 0});
  if (!answer_) co_return refusal(encoder_);
  take_count(encoder_);
  co_return std::nullopt;
}

// Whether it does what it was told last.
StreamScript StreamRunner::check(std::size_t axis) {
  const auto told = told_[axis];
  const auto parameter = told ? told->parameter : ap::target_velocity;
  co_await command({Kind::get, axis, parameter, 0});
  if (!answer_) co_return refusal(axis);
  if (!told || *answer_ == told->value) co_return std::nullopt;
  const bool is_velocity = parameter == ap::target_velocity;
  const auto* what = !is_velocity    ? "stopped or turned"
                     : *answer_ == 0 ? "stopped"
                                     : "told another velocity";
  co_return fault(DriveFault::Kind::foreign, axis, fmt::format("was {} by another client", what));
}

StreamScript StreamRunner::check_all() {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto wrong = co_await check(axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

StreamScript StreamRunner::read_position(std::size_t axis) {
  co_await command({Kind::get, axis, ap::actual_position, 0});
  if (!answer_) co_return refusal(axis);
  co_return take_reading(axis);
}

DriveRunner::Fault StreamRunner::note_delay(Duration late, Duration period) {
  report_.worst_delay = std::max(report_.worst_delay, late);
  if (late <= most_late_updates * period) return std::nullopt;
  return fault(DriveFault::Kind::starved, {},
               fmt::format("an update came {:.1f} ms late; {:.1f} ms are allowed",
                           seconds(late) * 1e3, seconds(period) * 1e3 * most_late_updates));
}

double time_to_send(Duration round_trip, std::size_t commands) {
  return seconds(round_trip) * static_cast<double>(commands) / (1 - spare_part_of_bus);
}

// ---- the public face ----

namespace {

std::unique_ptr<DriveRunner> runner_for(const Course& course, std::vector<StreamAxis> axes,
                                        StreamOptions options) {
  switch (options.mode) {
    case StreamMode::velocity: return velocity_runner(course, std::move(axes), options);
    case StreamMode::segments: return segment_runner(course, std::move(axes), options);
    case StreamMode::position: break;
  }
  return position_runner(course, std::move(axes), options);
}

}  // namespace

PathStream::PathStream(const Course& course, std::vector<StreamAxis> axes, StreamOptions options)
    : Drive(runner_for(course, std::move(axes), options)) {}
PathStream::~PathStream() = default;
PathStream::PathStream(PathStream&&) noexcept = default;
PathStream& PathStream::operator=(PathStream&&) noexcept = default;

StreamRunner& PathStream::runner() const { return static_cast<StreamRunner&>(*runner_); }
void PathStream::pause(bool on) { runner().pause(on); }
void PathStream::set_feed(double factor) { runner().set_feed(factor); }
StreamFeed PathStream::feed() const { return runner().feed(); }
PathStream::Phase PathStream::phase() const { return runner().phase(); }
double PathStream::passed() const { return runner().passed(); }
const CourseHalt* PathStream::waits_at() const { return runner().waits_at(); }
const StreamReport& PathStream::report() const { return runner().report(); }

}  // namespace tmcl::plan
