#include "verify/watched_axis.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "motion/twin/divisors.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/seconds.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;
using namespace std::chrono_literals;

/// After this a motor whose speed reads 0 has none; the slowest experiment needs 130 ms for that.
constexpr Duration time_to_settle = 200ms;
/// To come back with the settings that it had, or with slow ones.
constexpr Duration longest_way_home = 30s;
constexpr int tries = 3;
constexpr std::size_t most_exchanges_noted = 256;

constexpr auto minimum_velocity = number_of("minimum_velocity");
constexpr auto ramp_divisor = number_of("ramp_divisor");

}  // namespace

Script<Result<Answer>> WatchedAxis::exchange_once(Command command, std::uint8_t type,
                                                  std::int32_t value) {
  const auto answer =
      co_await must(tmcl::exchange({axis_.module, command, type, axis_.motor, value}));
  if (exchanges_.size() < most_exchanges_noted) exchanges_.push_back(answer.received - answer.sent);
  co_return answer;
}

Script<Result<std::int32_t>> WatchedAxis::ask(Command command, std::uint8_t type,
                                              std::int32_t value) {
  const auto answer = co_await must(exchange_once(command, type, value));
  co_return answer.reply.value;
}

Duration WatchedAxis::usual_exchange() const {
  auto sorted = exchanges_;
  if (sorted.empty()) return {};
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  return *middle;
}

Duration WatchedAxis::quickest_exchange() const {
  return exchanges_.empty() ? Duration{} : std::ranges::min(exchanges_);
}

Script<Result<void>> WatchedAxis::begin() {
  for (const auto& setting : settings_) held_[setting.parameter] = setting.value;
  const auto velocity = co_await must(get(ap::actual_velocity));
  if (velocity != 0) co_return tl::unexpected(bad_argument("the axis moves", "stop it first"));
  const Request where{axis_.module, Command::GAP, ap::actual_position, axis_.motor, 0};
  home_ = co_await must(verbs::ask(where, with_proof(Proof::twice)));
  here_ = home_;
  co_return Result<void>{};
}

Script<Result<void>> WatchedAxis::set(plan::Setting setting) {
  const auto held = held_.find(setting.parameter);
  if (held != held_.end() && held->second == setting.value) co_return Result<void>{};
  forget(setting.parameter);
  co_await must(verbs::set(axis_, setting.parameter, setting.value));
  held_[setting.parameter] = setting.value;
  co_return Result<void>{};
}

Script<Result<void>> WatchedAxis::set_all(std::vector<plan::Setting> settings) {
  Result<void> result;
  for (const auto& setting : settings) {
    auto done = co_await set(setting);
    for (auto left = tries - 1; !done && left > 0; --left) done = co_await set(setting);
    if (!done) result = std::move(done);
  }
  co_return result;
}

// With the least speed and acceleration while the dividers say what those mean.
Script<Result<void>> WatchedAxis::set(const plan::Experiment& experiment) {
  const std::vector<plan::Setting> settings{{ap::max_velocity, 1},
                                            {ap::max_acceleration, 1},
                                            {minimum_velocity, 1},
                                            {plan::pulse_divisor, experiment.dividers.pulse},
                                            {ramp_divisor, experiment.dividers.ramp},
                                            {ap::max_acceleration, experiment.acceleration},
                                            {minimum_velocity, experiment.minimum_velocity},
                                            {ap::max_velocity, experiment.velocity}};
  for (const auto& setting : settings) co_await must(set(setting));
  co_return Result<void>{};
}

Script<Result<void>> WatchedAxis::put_back() {
  std::vector<plan::Setting> settings;
  const auto has_dividers = std::ranges::find(settings_, plan::pulse_divisor,
                                              &plan::Setting::parameter) != settings_.end();
  if (has_dividers) settings = {{ap::max_velocity, 1}, {ap::max_acceleration, 1}};
  // Speeds last: dividers say what they mean.
  for (const auto& setting : settings_) {
    const bool is_scaled =
        setting.parameter == ap::max_velocity || setting.parameter == ap::max_acceleration;
    if (!is_scaled) settings.push_back(setting);
  }
  for (const auto& setting : settings_) {
    if (setting.parameter == ap::max_acceleration) settings.push_back(setting);
  }
  for (const auto& setting : settings_) {
    if (setting.parameter == ap::max_velocity) settings.push_back(setting);
  }
  return set_all(std::move(settings));
}

Script<Result<void>> WatchedAxis::stop() {
  auto done = co_await verbs::stop(axis_);
  for (auto left = tries - 1; !done && left > 0; --left) done = co_await verbs::stop(axis_);
  co_return done;
}

Script<Result<void>> WatchedAxis::end(Result<void> done) {
  if (!done) co_await stop();
  auto back = co_await put_back();
  if (done) co_return back;
  if (!back) {
    done.error().message += "; and not all of its settings could be given back";
    done.error().outcome = Outcome::unknown;
  }
  co_return done;
}

Error WatchedAxis::interrupted(std::int32_t target, std::int32_t here) const {
  Error error;
  error.code = Errc::move_interrupted;
  error.outcome = Outcome::unknown;
  error.message = fmt::format(
      "the axis was sent from {} to {}, and is at {} when it should be there", here_, target, here);
  error.hint = "see its switches, its supply, and whether something else moves it";
  return error;
}

Script<Result<plan::WatchedMove>> WatchedAxis::move_to(std::int32_t target, Duration limit) {
  plan::WatchedMove move{target - here_, {}, {}};
  const auto sign = move.distance < 0 ? -1 : 1;
  const auto told = co_await must(exchange_once(Command::MVP, move_type::absolute, target));
  move.told = {told.sent, told.received};
  auto here = here_;
  do {
    const auto seen = co_await must(exchange_once(Command::GAP, ap::actual_position, 0));
    here = seen.reply.value;
    auto& all = move.sightings;
    const auto steps = sign * (here - here_);
    // Of those in one place the first and the last say everything.
    const auto size = all.size();
    const bool is_third = size > 1 && all[size - 1].steps == steps && all[size - 2].steps == steps;
    if (is_third) all.pop_back();
    all.push_back({{seen.sent, seen.received}, steps});
    if (here != target && seen.sent > told.received + limit)
      co_return tl::unexpected(interrupted(target, here));
  } while (here != target);
  co_await must(stand(target, move.told.received + limit));
  co_return move;
}

/// It may come to its target faster than it can stop there.
Script<Result<void>> WatchedAxis::stand(std::int32_t target, TimePoint limit) {
  while (true) {
    const auto velocity = co_await must(get(ap::actual_velocity));
    const auto seen = co_await must(exchange_once(Command::GAP, ap::actual_position, 0));
    const bool is_there = velocity == 0 && seen.reply.value == target;
    if (is_there) break;
    if (seen.sent > limit) co_return tl::unexpected(interrupted(target, seen.reply.value));
  }
  co_await pause(time_to_settle);
  here_ = co_await must(get(ap::actual_position));
  if (here_ != target) co_return tl::unexpected(interrupted(target, here_));
  co_return Result<void>{};
}

Script<Result<void>> WatchedAxis::return_home() {
  here_ = co_await must(get(ap::actual_position));
  co_await must(move_to(home_, longest_way_home));
  co_return Result<void>{};
}

Script<Result<void>> WatchedAxis::go_home() {
  if (here_ != home_) co_await must(move_to(home_, longest_way_home));
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
