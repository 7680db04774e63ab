#include "motion/drive/drive_runner.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "motion/twin/divisors.hpp"
#include "tmcl/plan/ramp_choice.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr int stop_attempts = 3;
constexpr Duration longest_braking = std::chrono::seconds(10);

}  // namespace

// ---- settings ----

void KeptSettings::know(Setting setting) {
  before_[setting.parameter] = setting.value;
  now_[setting.parameter] = setting.value;
}

std::optional<std::int32_t> KeptSettings::now(std::uint8_t parameter) const {
  const auto found = now_.find(parameter);
  return found == now_.end() ? std::nullopt : std::optional(found->second);
}

void KeptSettings::begin_write(std::uint8_t parameter) {
  now_.erase(parameter);
  if (std::ranges::find(written_, parameter) == written_.end()) written_.push_back(parameter);
}

std::vector<Setting> KeptSettings::to_restore() const {
  std::vector<Setting> settings;
  for (auto parameter = written_.rbegin(); parameter != written_.rend(); ++parameter) {
    const auto before = before_.at(*parameter);
    if (now(*parameter) != before) settings.push_back({*parameter, before});
  }
  return in_safe_order(std::move(settings));
}

std::vector<Setting> KeptSettings::in_safe_order(std::vector<Setting> settings) const {
  const auto known = now(pulse_divisor);
  return known ? plan::in_safe_order(std::move(settings), *known) : settings;
}

// ---- the script and its commands ----

DriveStep DriveRunner::next(TimePoint now) {
  now_ = now;
  if (!script_) {
    script_.emplace(whole());
    proceed(script_->start(now));
  } else if (!ended_ && awaited_ == 0 && (now >= until_ || (heeds_stop_ && stop_asked_))) {
    proceed(script_->resume({}, now));
  }
  if (ended_) return DriveEnd{};
  if (awaited_ == 0) return DriveWait{until_};
  if (to_send_.empty()) return DriveWait{TimePoint::max()};
  for (const auto& command : to_send_) under_way_[command.axis]->exchange.asked = now;
  return std::exchange(to_send_, {});
}

void DriveRunner::answered(TimePoint now, std::size_t axis, Result<std::int32_t> answer) {
  now_ = now;
  auto [exchange, lane] = std::move(*under_way_[axis]);
  under_way_[axis].reset();
  --awaited_;
  exchange.ended = now;
  exchange.answer = std::move(answer);
  on_answered(now - exchange.asked);
  if (all_or_none_ && (!exchange.answer || stop_asked_)) lanes_.clear();
  done_.push_back(std::move(exchange));
  if (lane < lanes_.size()) send_next(lane);
  if (awaited_ > 0) return;
  answer_ = done_.back().answer;
  asked_at_ = done_.back().asked;
  proceed(script_->resume({}, now));
}

void DriveRunner::proceed(const std::optional<Step>& step) { ended_ = !step; }

void DriveRunner::send_next(std::size_t lane) {
  if (lanes_[lane].empty()) return;
  const auto command = lanes_[lane].back();
  lanes_[lane].pop_back();
  to_send_.push_back(command);
  under_way_[command.axis] = UnderWay{{command, {}, {}, 0}, lane};
  ++awaited_;
}

DriveRunner::Awaiter DriveRunner::command(DriveCommand command) {
  command.may_wait = command.may_wait || (stopping_ && command.kind == Kind::get);
  return side_by_side(std::vector(1, DriveCommands(1, command)), false);
}

DriveRunner::Awaiter DriveRunner::until(TimePoint time) {
  until_ = time;
  return {false};
}

DriveRunner::Awaiter DriveRunner::side_by_side(std::vector<DriveCommands>&& lanes,
                                               bool all_or_none) {
  lanes_ = std::move(lanes);
  all_or_none_ = all_or_none;
  done_.clear();
  for (auto& lane : lanes_) std::ranges::reverse(lane);
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) send_next(lane);
  return {awaited_ == 0};
}

// ---- what all drives do ----

DriveRunner::Fault DriveRunner::fault(DriveFault::Kind kind, std::optional<std::size_t> axis,
                                      std::string message) const {
  if (has_other_reason()) return stop_asked_;
  return DriveFault{kind, axis, std::move(message), {}, {}};
}

DriveRunner::Fault DriveRunner::refusal(std::size_t axis, const Error& error) const {
  if (has_other_reason()) return stop_asked_;
  return DriveFault{DriveFault::Kind::refused, axis, {}, error, {}};
}

Script<DriveRunner::Fault> DriveRunner::know(std::size_t axis, std::uint8_t parameter) {
  if (settings_[axis].is_known(parameter)) co_return std::nullopt;
  co_await command({Kind::get, axis, parameter, 0});
  if (!answer_) co_return refusal(axis);
  settings_[axis].know({parameter, *answer_});
  co_return std::nullopt;
}

Script<DriveRunner::Fault> DriveRunner::set(std::size_t axis, Setting setting) {
  auto wrong = co_await know(axis, setting.parameter);
  if (wrong) co_return wrong;
  if (settings_[axis].now(setting.parameter) == setting.value) co_return std::nullopt;
  // Whether or not an answer comes: it may be carried out.
  settings_[axis].begin_write(setting.parameter);
  const auto before = settings_[axis].before(setting.parameter);
  co_await command({Kind::set, axis, setting.parameter, setting.value, false, before});
  if (!answer_) co_return refusal(axis);
  settings_[axis].wrote(setting);
  on_written(axis, setting);
  co_return std::nullopt;
}

Script<DriveRunner::Fault> DriveRunner::stop_all(DriveReport& report, int attempts) {
  stopping_ = true;
  heeds_stop_ = false;
  std::vector<DriveCommands> lanes;
  for (std::size_t axis = 0; axis < axes(); ++axis)
    lanes.push_back({{Kind::stop, axis, 0, 0, true}});
  DriveCommands words;
  for (const auto word : take_words_at_stop())
    words.push_back({Kind::carry_out, axes(), 0, word, true});
  if (!words.empty()) lanes.push_back(std::move(words));
  for (; attempts > 0 && !lanes.empty(); --attempts) {
    co_await side_by_side(std::move(lanes), false);
    lanes.clear();
    note_stops(report);
    for (const auto& unstopped : report.unstopped)
      lanes.push_back({{Kind::stop, unstopped.axis, 0, 0, true}});
  }
  co_return std::nullopt;
}

// What was to be switched is not tried again: it may have been switched.
void DriveRunner::note_stops(DriveReport& report) {
  report.unstopped.clear();
  std::ranges::sort(done_, {}, [](const Exchange& done) { return done.command.axis; });
  for (auto& [given, asked, ended, answer] : done_) {
    if (answer) continue;
    if (given.kind == Kind::carry_out) {
      report.unswitched.push_back(
          {static_cast<std::uint8_t>(given.value), std::move(answer.error())});
    } else {
      report.unstopped.push_back({given.axis, std::move(answer.error())});
    }
  }
}

Script<DriveRunner::Fault> DriveRunner::stop_and_rest(DriveReport& report) {
  co_await stop_all(report, stop_attempts);
  auto restless = co_await see_all_stand(report, now_ + longest_braking);
  co_return restless;
}

Script<DriveRunner::Fault> DriveRunner::come_to_rest(std::size_t axis, TimePoint limit) {
  while (true) {
    co_await command({Kind::get, axis, ap::actual_velocity, 0});
    if (!answer_) co_return refusal(axis);
    if (*answer_ == 0) co_return std::nullopt;
    if (now_ > limit) co_return fault(DriveFault::Kind::no_end, axis, "did not come to rest");
    co_await until(now_ + drive_look_interval);
  }
}

Script<DriveRunner::Fault> DriveRunner::see_all_stand(DriveReport& report, TimePoint limit) {
  Fault first;
  for (std::size_t axis = 0; axis < axes(); ++axis) {
    if (std::ranges::count(report.unstopped, axis, &Unstopped::axis) != 0) continue;
    auto restless = co_await come_to_rest(axis, limit);
    if (!restless) continue;
    Error why;
    why.message = restless->message;
    report.unstopped.push_back({axis, restless->error.value_or(why)});
    if (!first) first = std::move(restless);
  }
  co_return first;
}

Script<DriveRunner::Fault> DriveRunner::restore(DriveReport& report, bool unstopped_ones) {
  for (std::size_t axis = 0; axis < axes(); ++axis) {
    const auto moving = std::ranges::find(report.unstopped, axis, &Unstopped::axis);
    for (const auto setting : settings_[axis].to_restore()) {
      if (!unstopped_ones && moving != report.unstopped.end()) {
        report.unrestored.push_back({axis, setting, moving->why});
        continue;
      }
      co_await command({Kind::set, axis, setting.parameter, setting.value, true});
      if (!answer_) report.unrestored.push_back({axis, setting, answer_.error()});
    }
  }
  co_return std::nullopt;
}

Script<DriveRunner::Fault> DriveRunner::arrive(std::vector<Goal> goals, TimePoint begin,
                                               TimePoint limit) {
  std::vector<Watched> all;
  for (const auto& goal : goals)
    all.push_back({goal, Arrival(goal.target, begin, {most_standing, {}, time_to_begin})});
  while (std::ranges::any_of(all, [](const auto& one) { return one.arrival.has_value(); })) {
    co_await until(now_ + drive_look_interval);
    for (auto& watched : all) {
      if (!watched.arrival) continue;
      if (stop_asked_) co_return stop_asked_;
      auto wrong = co_await look(watched, std::max(limit, begin + time_to_begin));
      if (wrong) co_return wrong;
    }
  }
  co_return std::nullopt;
}

// The position last: of an axis that had stopped, it is the place where it stands.
Script<DriveRunner::Fault> DriveRunner::look(Watched& watched, TimePoint limit) {
  const auto& goal = watched.goal;
  std::array<std::int32_t, 3> read{};
  constexpr std::array read_parameters{ap::actual_velocity, ap::target_position,
                                       ap::actual_position};
  for (std::size_t i = 0; i < read.size(); ++i) {
    co_await command({Kind::get, goal.axis, read_parameters[i], 0});
    if (!answer_) co_return refusal(goal.axis);
    read[i] = *answer_;
  }
  const auto [velocity, target, position] = read;
  switch (watched.arrival->judge({now_, {position}, {target}, velocity == 0, position == target})) {
    case Arrival::Verdict::under_way: break;
    case Arrival::Verdict::arrived: watched.arrival.reset(); co_return std::nullopt;
    case Arrival::Verdict::stands_elsewhere: co_return short_of(goal, {position});
    case Arrival::Verdict::sent_elsewhere:
      co_return fault(DriveFault::Kind::foreign, goal.axis, "was sent elsewhere");
  }
  if (now_ <= limit) co_return std::nullopt;
  co_return fault(DriveFault::Kind::no_end, goal.axis, "has not arrived when it should have");
}

DriveRunner::Fault DriveRunner::short_of(const Goal& goal, Microsteps position) const {
  auto short_of_it =
      fault(DriveFault::Kind::no_end, goal.axis,
            fmt::format("stands at {}, short of its target {}", position.value, goal.target.value));
  if (!has_other_reason()) short_of_it->stands_at = position;
  return short_of_it;
}

// ---- the public face ----

Drive::Drive(std::unique_ptr<DriveRunner> runner) : runner_(std::move(runner)) {}
Drive::~Drive() = default;
Drive::Drive(Drive&&) noexcept = default;
Drive& Drive::operator=(Drive&&) noexcept = default;

DriveStep Drive::next(TimePoint now) { return runner_->next(now); }
void Drive::answered(TimePoint now, std::size_t axis, Result<std::int32_t> answer) {
  runner_->answered(now, axis, std::move(answer));
}
void Drive::stop(DriveFault why) { runner_->stop(std::move(why)); }

}  // namespace tmcl::plan
