#include "tune/encoded_axis.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;
using namespace std::chrono_literals;

/// A rotor that is further behind its field than this has lost it.
constexpr double full_steps_on_the_way = 4;
/// What is lost is lost in full steps; the rest is the encoder's.
constexpr double full_steps_at_rest = 0.5;
constexpr double counts_at_rest = 2.5;
/// An encoder shows a way at least so well; modules may count in microsteps what it does not see.
constexpr double full_steps_of_grain = 0.3;
constexpr double counts_of_grain = 1.5;
/// It is measured again by one that is so many times as long.
constexpr double longer = 1.2;
/// Of that; it would add up from trial to trial.
constexpr double drift_part = 0.4;
/// An encoder counts more than this, or there is none.
constexpr double least_counts = 20;

// It is quiet when so many readings are alike, this long after each other.
constexpr std::size_t quiet_readings = 5;
constexpr double full_steps_alike = 0.1;
constexpr Duration between_readings = 10ms;
constexpr Duration longest_unrest = 3s;

/// What swings at 1 to 80 Hz is in these readings; more would take longer to be looked through than
/// anything else may wait.
constexpr Duration listening = 1s;
constexpr std::size_t most_listened = 200;

}  // namespace

// ---- what it counts ---------------------------------------------------------------------------

double EncodedAxis::place_of(std::int32_t counted) const {
  return anchor_ + (counted - anchor_count_) / ratio_;
}

double EncodedAxis::grain() const {
  return std::max(full_steps_of_grain * full_step_, counts_of_grain / std::abs(ratio_));
}

double EncodedAxis::uncertainty(double place) const {
  return grain() * std::abs(place - anchor_) / measured_way_;
}

void EncodedAxis::measure_again(std::int32_t counted, std::int32_t target) {
  const auto way = target - anchor_;
  if (way < longer * measured_way_) return;
  ratio_ = (counted - anchor_count_) / way;
  measured_way_ = way;
}

double EncodedAxis::tolerance_at_rest() const {
  return std::max(full_steps_at_rest * full_step_, counts_at_rest / std::abs(ratio_));
}

Script<Result<std::int32_t>> EncodedAxis::quiet() {
  std::deque<std::int32_t> readings;
  const auto begin = co_await current_time();
  while (true) {
    readings.push_back(co_await must(watched_->get(encoder_)));
    if (readings.size() > quiet_readings) readings.pop_front();
    const auto [least, most] = std::ranges::minmax(readings);
    const auto alike = std::max(1.0, full_steps_alike * full_step_ * std::abs(ratio_));
    const bool is_quiet = readings.size() == quiet_readings && most - least <= alike;
    if (is_quiet || co_await current_time() - begin > longest_unrest)
      co_return static_cast<std::int32_t>((std::int64_t{least} + most) / 2);
    co_await pause(between_readings);
  }
}

Script<Result<std::int32_t>> EncodedAxis::counted_at(std::int32_t target, Duration limit) {
  co_await must(watched_->move_to(target, limit));
  const auto counted = co_await must(quiet());
  co_return counted;
}

Error EncodedAxis::cannot_follow(const std::string& what) const {
  Error error;
  error.code = Errc::move_interrupted;
  error.outcome = Outcome::unknown;
  error.message = what;
  error.hint = "see the encoder and its cable, the current, and whether something holds the axis";
  return error;
}

Script<Result<void>> EncodedAxis::calibrate(ValueRange range, Duration limit) {
  const auto middle = range.least + (range.greatest - range.least) / 2;
  co_await must(counted_at(range.greatest, limit));
  co_await must(counted_at(range.least, limit));
  const double middle_up = co_await must(counted_at(middle, limit));
  const double top = co_await must(counted_at(range.greatest, limit));
  const double middle_down = co_await must(counted_at(middle, limit));
  const double bottom = co_await must(counted_at(range.least, limit));
  const double up = (top - middle_up) / (range.greatest - middle);
  const double down = (middle_down - bottom) / (middle - range.least);
  const double way = range.greatest - middle;
  if (std::abs(up) * way < least_counts)
    co_return tl::unexpected(cannot_follow(fmt::format(
        "the encoder has counted {} while the motor went {} microsteps", top - middle_up, way)));
  ratio_ = (up + down) / 2;
  const bool is_even = std::abs((up - down) / ratio_) * way <= tolerance_at_rest();
  backlash_ = (middle_down - middle_up) / ratio_;
  anchor_ = range.least;
  anchor_count_ = middle_up - ratio_ * (middle - range.least);
  measured_way_ = way;
  if (is_even && backlash_ > -tolerance_at_rest() && backlash_ < way / 2) {
    backlash_ = std::max(backlash_, 0.0);
    co_return Result<void>{};
  }
  co_return tl::unexpected(cannot_follow(
      fmt::format("the motor goes {} microsteps slowly there and back, and its encoder counts {} "
                  "and {}",
                  way, top - middle_up, middle_down - bottom)));
}

// ---- whether its motor follows ----------------------------------------------------------------

Script<Result<EncodedAxis::Sight>> EncodedAxis::look() {
  Sight sight;
  sight.before = co_await must(watched_->get(ap::actual_position));
  sight.counted = co_await must(watched_->get(encoder_));
  sight.after = co_await must(watched_->get(ap::actual_position));
  co_return sight;
}

double EncodedAxis::deviation(const Sight& sight) const {
  const auto place = place_of(sight.counted);
  const auto [least, most] = std::minmax(sight.before, sight.after);
  return std::max({0.0, least - place, place - backlash_ - most});
}

// After a short move nothing tells on which side its backlash is.
double EncodedAxis::off_at_rest(double place, std::int32_t from, std::int32_t target) const {
  const auto way = std::abs(static_cast<double>(target) - from);
  const bool is_short = way <= backlash_ + full_step_;
  const double least = target < from && !is_short ? target + backlash_ : target;
  const double most = target > from && !is_short ? target : target + backlash_;
  return std::max({0.0, least - place, place - most});
}

std::string EncodedAxis::stray_text(double deviation) const {
  return fmt::format("the encoder was {:.1f} full steps from where it should be",
                     deviation / full_step_);
}

Script<Result<std::vector<ReadingAt>>> EncodedAxis::listen() {
  RestReadings wanted;
  wanted.parameter = encoder_;
  wanted.span = listening;
  wanted.most = most_listened;
  return read_at_rest(axis_, wanted);
}

double EncodedAxis::swing_of(const std::vector<ReadingAt>& readings) const {
  if (readings.empty()) return 0;
  const auto [least, most] = std::ranges::minmax(readings, {}, &ReadingAt::value);
  return (static_cast<double>(most.value) - least.value) / 2 / std::abs(ratio_);
}

Script<Result<Passage>> EncodedAxis::pass_to(std::int32_t target, Lookout lookout) {
  Passage passage;
  const auto begin = co_await current_time();
  const auto first = co_await must(watched_->get(ap::actual_position));
  const auto here = [](const Sight& sight) { return sight.after; };
  co_await must(watched_->ask(Command::MVP, move_type::absolute, target));
  while (true) {
    const auto sight = co_await must(look());
    passage.deviation = std::max(passage.deviation, deviation(sight));
    const auto most = full_steps_on_the_way * full_step_ + uncertainty(sight.after);
    if (passage.deviation > most) {
      passage.trouble = stray_text(passage.deviation);
      break;
    }
    if (here(sight) == target && co_await must(watched_->get(ap::actual_velocity)) == 0) break;
    if (co_await current_time() - begin > lookout.limit) {
      passage.trouble =
          fmt::format("it was sent from {} to {}, and was at {} when it should have been there",
                      first, target, here(sight));
      break;
    }
    if (lookout.load_value_from)
      co_await must(look_at_load(*watched_, passage, *lookout.load_value_from));
  }
  if (!passage.held()) {
    co_await must(watched_->stop());
    co_return passage;
  }
  if (lookout.listens) passage.at_rest = co_await must(listen());
  const auto counted = co_await must(quiet());
  const auto off = off_at_rest(place_of(counted), first, target);
  passage.deviation = std::max(passage.deviation, off);
  passage.drifted = off > drift_part * tolerance_at_rest();
  if (off > tolerance_at_rest() + uncertainty(target)) passage.trouble = stray_text(off);
  // A rotor may stand a part of a step behind: what its ratio cannot explain is no measure of that.
  const bool is_of_ratio = off <= uncertainty(target);
  if (is_of_ratio && target - first > backlash_ + full_step_) measure_again(counted, target);
  co_return passage;
}

Script<Result<double>> EncodedAxis::slides_with(plan::Setting setting, Duration span) {
  const double first = co_await must(quiet());
  co_await must(watched_->set(setting));
  const auto begin = co_await current_time();
  double slid = 0;
  while (slid <= tolerance_at_rest() && co_await current_time() - begin < span) {
    const auto counted = co_await must(watched_->get(encoder_));
    slid = std::max(slid, std::abs((counted - first) / ratio_));
  }
  co_return slid;
}

Script<Result<void>> EncodedAxis::correct(bool up, Duration limit) {
  co_await must(watched_->stop());
  // What a module counts is set only while its motor stands.
  const auto begin = co_await current_time();
  while (co_await must(watched_->get(ap::actual_velocity)) != 0) {
    if (co_await current_time() - begin > limit)
      co_return tl::unexpected(cannot_follow("the axis was stopped, and turns on"));
  }
  const auto counted = co_await must(quiet());
  const auto place = place_of(counted) - (up ? 0 : backlash_);
  const auto position = static_cast<std::int32_t>(std::lround(place));
  co_await must(verbs::set(axis_, ap::actual_position, position));
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
