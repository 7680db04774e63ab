#include "gateway/module/sentinel.hpp"

#include <algorithm>
#include <limits>

#include "gateway/authority/motors.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using tmcl::Duration;

constexpr Duration reading_error = 20ms;
constexpr int clock_error = 100;  // one part of so many
constexpr std::int64_t timer_modulus = std::int64_t{1} << 31;

std::int64_t whole_milliseconds(Duration duration) {
  return std::chrono::floor<std::chrono::milliseconds>(duration).count();
}

/// -half..half of the modulus.
std::int64_t wrapped(std::int64_t difference) {
  constexpr auto half = timer_modulus / 2;
  const auto rest = ((difference + half) % timer_modulus + timer_modulus) % timer_modulus;
  return rest - half;
}

/// What a request that can move a motor makes of its target.
enum class Aim : std::uint8_t { kept, away, unknown };

Aim aim_of(const tmcl::Request& request) {
  const auto intent = intent_of(request);
  if (intent.is_unseen) return Aim::unknown;
  if (intent.sets == tmcl::Setpoint::velocity) return Aim::kept;
  return intent.sets == tmcl::Setpoint::position && request.value != 0 ? Aim::away : Aim::unknown;
}

bool may_set_any_target(const tmcl::Intent& intent) {
  return is_unpredictable(intent.motion) || intent.subject == tmcl::Subject::chip;
}

}  // namespace

std::string Sentinel::name() const {
  if (!watches()) return "none";
  if (is_by_settings()) return "settings";
  return is_variable() ? "variable:" + std::to_string(config_.variable) : "tick";
}

tmcl::Request Sentinel::question(tmcl::ModuleAddress module) const {
  if (is_by_settings()) {
    return {module, tmcl::Command::GAP, tmcl::axis_parameter::target_position,
            certainly_away().value_or(0), 0};
  }
  const auto bank =
      is_variable() ? tmcl::global_bank::user_variables : tmcl::global_bank::parameters;
  const auto number = is_variable() ? config_.variable : tmcl::global_parameter::tick_timer;
  return {module, tmcl::Command::GGP, number, bank, 0};
}

std::optional<std::uint8_t> Sentinel::certainly_away() const {
  const auto found =
      std::ranges::find_if(away_, [&](auto motor) { return !unsure_.contains(motor); });
  return found == away_.end() ? std::nullopt : std::optional(*found);
}

Sentinel::Verdict Sentinel::take(const Reading& reading) {
  const auto verdict = judge(reading);
  const bool moves = last_ && reading.value != last_->value;
  may_stand_ = verdict != Verdict::same && kind() == Kind::tick && !has_run_ && !moves;
  if (verdict != Verdict::same || was_seen_since(reading.asked)) return verdict;
  has_run_ = has_run_ || moves;
  last_ = reading;
  return verdict;
}

bool Sentinel::answers(const tmcl::Request& question) const {
  const auto own = this->question(question.address);
  const bool is_alike = question.command == own.command && question.type == own.type;
  return is_alike && (is_by_settings() || question.motor == own.motor);
}

void Sentinel::overhear(const tmcl::Request& question, const tmcl::Answer& answer) {
  if (!watches() || !answers(question)) return;
  if (judge(Reading::of(question, answer)) != Verdict::same) doubt();
}

void Sentinel::forget() {
  last_.reset();
  in_doubt_ = false;
  has_run_ = false;
  may_stand_ = false;
  is_given_up_ = false;
  starts_program_.reset();
  away_.clear();
}

void Sentinel::note_sending(const tmcl::Request& request) {
  if (may_set_any_target(intent_of(request))) ++setting_any_;
  if (aim_of(request) != Aim::unknown) return;
  for (const auto& axis : motors_of(request)) unsure_.insert(axis.motor);
}

void Sentinel::note_sent(const tmcl::Request& request, tmcl::Outcome outcome) {
  using tmcl::Outcome;
  const bool done = outcome == Outcome::done;
  const bool may_be_done = done || outcome == Outcome::unknown;
  if (may_set_any_target(intent_of(request))) {
    --setting_any_;
    if (may_be_done) starts_program_ = true;
  }
  const auto aim = aim_of(request);
  for (const auto& axis : motors_of(request)) {
    const auto unsure = unsure_.find(axis.motor);
    if (aim == Aim::away && done && unsure == unsure_.end()) away_.insert(axis.motor);
    if (aim != Aim::unknown) continue;
    if (unsure != unsure_.end()) unsure_.erase(unsure);
    if (may_be_done) away_.erase(axis.motor);
  }
}

Sentinel::Verdict Sentinel::judge(const Reading& reading) const {
  if (is_by_settings()) {
    const bool was_away = away_.contains(reading.motor) && !unsure_.contains(reading.motor);
    return was_away && reading.value == 0 ? Verdict::restarted : Verdict::same;
  }
  if (!last_) return Verdict::same;
  if (is_variable()) return reading.value == last_->value ? Verdict::same : Verdict::restarted;
  const auto most = reading.answered - last_->asked;
  const auto least = reading.asked - last_->answered;
  const auto error = reading_error + most / clock_error;
  const auto ahead = [&](Duration passed) {
    return wrapped(std::int64_t{reading.value} - last_->value - whole_milliseconds(passed));
  };
  const bool fits =
      ahead(least) >= -whole_milliseconds(error) && ahead(most) <= whole_milliseconds(error);
  if (fits) return Verdict::same;
  const auto expected = (last_->value + whole_milliseconds(least)) % timer_modulus;
  return (reading.value & std::numeric_limits<std::int32_t>::max()) < expected ? Verdict::restarted
                                                                               : Verdict::ahead;
}

}  // namespace tmcld
