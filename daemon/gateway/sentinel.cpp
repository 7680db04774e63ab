#include "gateway/sentinel.hpp"

#include <limits>

#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using tmcl::Duration;

constexpr Duration reading_error = 20ms;
constexpr int clock_error = 100;  // one part of so many
constexpr std::int64_t timer_modulus = std::int64_t{1} << 31;

std::int64_t milliseconds(Duration duration) {
  return std::chrono::floor<std::chrono::milliseconds>(duration).count();
}

/// -half..half of the modulus.
std::int64_t wrapped(std::int64_t difference) {
  constexpr auto half = timer_modulus / 2;
  const auto rest = ((difference + half) % timer_modulus + timer_modulus) % timer_modulus;
  return rest - half;
}

}  // namespace

std::string Sentinel::name() const {
  if (!watches()) return "none";
  return is_variable() ? "variable:" + std::to_string(config_.variable) : "tick";
}

tmcl::Request Sentinel::question(tmcl::ModuleAddress module) const {
  const auto bank =
      is_variable() ? tmcl::global_bank::user_variables : tmcl::global_bank::parameters;
  const auto number = is_variable() ? config_.variable : tmcl::global_parameter::tick_timer;
  return {module, tmcl::Command::GGP, number, bank, 0};
}

Sentinel::Verdict Sentinel::take(const Reading& reading) {
  const auto verdict = judge(reading);
  const bool moves = last_ && reading.value != last_->value;
  may_stand_ = verdict != Verdict::same && !is_variable() && !has_run_ && !moves;
  if (verdict != Verdict::same || was_seen_since(reading.asked)) return verdict;
  has_run_ = has_run_ || moves;
  last_ = reading;
  return verdict;
}

void Sentinel::forget() {
  last_.reset();
  has_run_ = false;
  may_stand_ = false;
  is_given_up_ = false;
}

Sentinel::Verdict Sentinel::judge(const Reading& reading) const {
  if (!last_) return Verdict::same;
  if (is_variable()) return reading.value == last_->value ? Verdict::same : Verdict::restarted;
  const auto most = reading.answered - last_->asked;
  const auto least = reading.asked - last_->answered;
  const auto error = reading_error + most / clock_error;
  const auto ahead = [&](Duration passed) {
    return wrapped(std::int64_t{reading.value} - last_->value - milliseconds(passed));
  };
  const bool fits = ahead(least) >= -milliseconds(error) && ahead(most) <= milliseconds(error);
  if (fits) return Verdict::same;
  const auto expected = (last_->value + milliseconds(least)) % timer_modulus;
  return (reading.value & std::numeric_limits<std::int32_t>::max()) < expected ? Verdict::restarted
                                                                               : Verdict::ahead;
}

}  // namespace tmcld
