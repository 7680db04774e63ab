#include "gateway/module/deadman.hpp"

#include <algorithm>
#include <utility>

#include "config/feeding.hpp"
#include "gateway/bus.hpp"
#include "gateway/module/deadman_memory.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using tmcl::Outcome;
using tmcl::Script;
namespace gp = tmcl::global_parameter;
constexpr auto bank = tmcl::global_bank::parameters;

bool is_line_fault(const tmcl::Error& error) {
  return error.outcome != Outcome::refused && error.code != tmcl::Errc::bad_argument &&
         error.code != tmcl::Errc::unexpected_value;
}

/// Of two that it may be set to, the one that it is to be fed by: 0 is none.
std::int32_t shorter(std::int32_t one, std::int32_t other) {
  return one == 0 || other == 0 ? std::max(one, other) : std::min(one, other);
}

}  // namespace

std::uint8_t Deadman::parameter() const {
  return bus_.is_can() ? gp::can_heartbeat : gp::serial_heartbeat;
}

// ---- what it is set to --------------------------------------------------------------------------

Script<tmcl::Result<void>> Deadman::adopt(tmcl::FoundModule found) {
  version_ = found.version;
  const bool is_wanted = wanted_ms_.has_value() || known() != nullptr;
  if (is_adopted_ || !is_wanted) co_return tmcl::Result<void>{};
  const auto held = co_await must(read());
  is_adopted_ = true;
  if (held == wanted_ms_.value_or(held)) co_return tmcl::Result<void>{};
  if (is_missing_) {
    say("has no deadman: its motors go on when tmcld does not");
    co_return tmcl::Result<void>{};
  }
  if (written_to_ == found.version) {
    say("has a deadman of " + std::to_string(held) + " ms, and not of " +
        std::to_string(*wanted_ms_) + " ms as configured: that is written to it only once");
    co_return tmcl::Result<void>{};
  }
  written_to_ = found.version;
  auto set = co_await set_as_configured();
  // It may have been set without an answer: then it is read again.
  is_adopted_ = set.has_value();
  if (!set && set.error().outcome == Outcome::not_sent) written_to_.reset();
  co_return set;
}

Script<tmcl::Result<void>> Deadman::set_as_configured() {
  const auto before = set_ms_.value_or(0);
  auto written = co_await write(*wanted_ms_);
  const auto what = "deadman of module " + std::to_string(number(address_)) + " from " +
                    std::to_string(before) + " to " + std::to_string(*wanted_ms_) + " ms";
  bus_.audit(what +
             (written ? " outcome=done" : " error=" + std::string(name_of(written.error().code))));
  if (written) bus_.log(LogLevel::info, bus_.name() + ": " + what);
  if (written) co_return written;
  // What the module does not want it does not get, and works as before.
  if (is_line_fault(written.error())) co_return written;
  say("keeps its deadman of " + std::to_string(before) + " ms: " + written.error().message);
  co_return tmcl::Result<void>{};
}

Script<tmcl::Result<std::int32_t>> Deadman::read() {
  auto value = co_await tmcl::verbs::get_global(address_, bank, parameter());
  if (!value && value.error().outcome != Outcome::refused) co_return value;
  is_missing_ = !value;
  note_set(value.value_or(0));
  co_return *set_ms_;
}

Script<tmcl::Result<bool>> Deadman::starts_program() {
  const auto mode = co_await tmcl::verbs::get_global(address_, bank, gp::auto_start_mode);
  if (mode) co_return *mode != 0;
  // One that does not know of programs starts none.
  if (mode.error().outcome == Outcome::refused) co_return false;
  co_return tl::unexpected(mode.error());
}

Script<tmcl::Result<void>> Deadman::change(std::int32_t ms) {
  const auto held = co_await must(read());
  if (held == ms) co_return tmcl::Result<void>{};
  if (is_missing_) {
    co_return tl::unexpected(
        tmcl::bad_argument("the module has no deadman: it does not know global parameter " +
                               std::to_string(parameter()),
                           "what stops its motors then is in docs/SAFETY.md"));
  }
  auto written = co_await write(ms);
  co_return written;
}

Script<tmcl::Result<void>> Deadman::write(std::int32_t ms) {
  const auto held_before = set_ms_.value_or(0);
  auto starts = co_await starts_program();
  if (!starts) {
    starts.error().outcome = Outcome::not_sent;
    co_return tl::unexpected(std::move(starts.error()));
  }
  if (*starts) {
    co_return tl::unexpected(tmcl::bad_argument(
        "the module starts a program by itself (global parameter 77), which a deadman would stop",
        "disable that first: set global parameter 77 to 0"));
  }
  auto written = co_await tmcl::verbs::set_global(address_, bank, parameter(), ms);
  if (!written && written.error().outcome == Outcome::unknown) note_set(shorter(held_before, ms));
  if (!written) co_return written;
  const auto held = co_await must(read());
  if (held == ms) co_return tmcl::Result<void>{};
  // The module has said that it took it; a late answer to another question may say otherwise.
  note_set(shorter(held, ms));
  tmcl::Error error;
  error.code = tmcl::Errc::unexpected_value;
  error.outcome = Outcome::unknown;
  error.message = "the module has taken " + std::to_string(ms) + " ms for its deadman, and has " +
                  std::to_string(held);
  co_return tl::unexpected(std::move(error));
}

const KnownDeadman* Deadman::known() const {
  return bus_.deadmen() ? bus_.deadmen()->find(bus_.name(), address_, version_) : nullptr;
}

std::optional<std::int32_t> Deadman::stops_after_ms() const {
  const auto* known = this->known();
  return known != nullptr && known->set_ms == set_ms_ ? known->stops_after_ms : std::nullopt;
}

void Deadman::remember(std::optional<std::int32_t> stops_after_ms) {
  if (bus_.deadmen())
    bus_.deadmen()->note({bus_.name(), address_, version_, set_ms_.value_or(0), stops_after_ms});
}

void Deadman::note_set(std::int32_t ms) {
  set_ms_ = ms;
  bus_.look_at_feeding();
}

void Deadman::say(const std::string& what) {
  if (std::exchange(said_, what) == what) return;
  bus_.log(LogLevel::warning,
           bus_.name() + ": module " + std::to_string(number(address_)) + " " + what);
}

// ---- feeding ------------------------------------------------------------------------------------

tmcl::TimePoint Deadman::due() const {
  if (!is_set() || is_feeding_) return tmcl::TimePoint::max();
  return std::max(heard_, fed_) + feeding_interval(*set_ms_);
}

tmcl::TimePoint Deadman::begin_to_feed(tmcl::TimePoint now) {
  is_feeding_ = true;
  fed_ = now;
  return now + feeding_interval(*set_ms_);
}

Script<tmcl::Result<void>> Deadman::ask() {
  co_await must(tmcl::verbs::get({address_, 0}, tmcl::axis_parameter::actual_position));
  co_return tmcl::Result<void>{};
}

void Deadman::note_answer(const tmcl::Answer& answer) {
  const bool had_too_long =
      is_set() && answer.received - heard_ > std::chrono::milliseconds(*set_ms_);
  if (had_too_long) last_gap_ = answer.received;
  heard_ = std::max(heard_, answer.sent);
}

}  // namespace tmcld
