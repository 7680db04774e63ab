#include "gateway/module/module.hpp"

#include <limits>
#include <random>
#include <utility>

#include "gateway/bus.hpp"

namespace tmcld {
namespace {

using tmcl::Script;

/// Longer than the timer of any module takes to go on.
constexpr tmcl::Duration time_to_tick = std::chrono::milliseconds(50);

std::string name_of(const tmcl::FoundModule& found) {
  const auto& version = found.version;
  auto name = found.model.empty() ? "unknown model " + std::to_string(version.model)
                                  : std::string(found.model);
  return std::move(name) + (version.bootloader ? ", bootloader " : ", firmware ") +
         to_string(version);
}

std::int32_t random_mark() {
  std::random_device device;
  return std::uniform_int_distribution<std::int32_t>(
      1, std::numeric_limits<std::int32_t>::max())(device);
}

}  // namespace

std::string_view name_of(GatewayModule::State state) {
  switch (state) {
    case GatewayModule::State::unknown: return "unknown";
    case GatewayModule::State::ready: return "ready";
    case GatewayModule::State::silent: return "silent";
    case GatewayModule::State::in_bootloader: return "in_bootloader";
  }
  return {};
}

const tmcl::Model* GatewayModule::model() const {
  return identity_ ? tmcl::find_model(identity_->version.model) : nullptr;
}

tmcl::ModuleTraits GatewayModule::traits() const {
  return as_.model != nullptr && as_.model == model() ? as_.traits : tmcl::ModuleTraits{};
}

boost::asio::awaitable<tmcl::Result<void>> GatewayModule::be_ready() {
  if (state_ == State::ready) co_return tmcl::Result<void>{};
  auto met = co_await meetings_.join([this] { return bus_.run(meet(), {}); });
  if (met) {
    if (state_ == State::ready) co_return met;
    auto error = tmcl::no_firmware(address_);
    error.bus = bus_.name();
    co_return tl::unexpected(std::move(error));
  }
  note(met.error());
  auto error = std::move(met.error());
  error.outcome = tmcl::Outcome::not_sent;
  co_return tl::unexpected(std::move(error));
}

// ---- whether it is what it was -----------------------------------------------------------------

Script<tmcl::Result<void>> GatewayModule::watch(tmcl::Duration max_age) {
  const auto now = co_await tmcl::current_time();
  // It may fall silent while a verb that found it ready is on its way.
  const bool is_silent = state_ == State::silent;
  const bool is_due = is_silent || sentinel_.counts_until(max_age) <= now;
  if (!is_watched() || !is_due) co_return tmcl::Result<void>{};
  auto look = is_silent ? meet() : look_after();
  auto met = co_await std::move(look);
  if (met) co_return met;
  note(met.error());
  met.error().outcome = tmcl::Outcome::not_sent;
  co_return met;
}

Script<tmcl::Result<void>> GatewayModule::look_after() {
  const auto seen = co_await must(look_at_sentinel());
  if (seen != Sentinel::Verdict::same) co_await must(meet());
  co_return tmcl::Result<void>{};
}

Script<tmcl::Result<void>> GatewayModule::meet() {
  const auto found = co_await must(tmcl::verbs::identify(address_));
  const bool runs = !found.version.bootloader;
  const bool ran = identity_ && !identity_->version.bootloader;
  if (runs && ran && identity_->version != found.version) {
    const auto before = name_of(*identity_);
    identity_ = found;
    sentinel_.forget();
    latch(GatewayEvent::Kind::module_replaced,
          "is another one than before: " + name_of(found) + ", and before that " + before);
  }
  if (runs) {
    const auto seen = co_await must(look_at_sentinel());
    // At once: other calls meanwhile find nothing new.
    if (seen != Sentinel::Verdict::same) sentinel_.forget();
    if (seen == Sentinel::Verdict::restarted)
      latch(GatewayEvent::Kind::module_reset, "has started again");
    if (seen != Sentinel::Verdict::same) co_await must(look_at_sentinel());
    co_await must(mark());
    co_await must(deadman_.adopt(found));
  }
  adopt(found);
  co_return tmcl::Result<void>{};
}

Script<tmcl::Result<Sentinel::Verdict>> GatewayModule::look_at_sentinel() {
  if (!sentinel_.in_doubt()) {
    const auto first = co_await must(judge_sentinel(tmcl::Proof::none));
    if (first == Sentinel::Verdict::same) co_return first;
    // It could have been the answer to something else. Should nothing more be answered, that stays.
    sentinel_.doubt();
  }
  auto seen = co_await must(judge_sentinel(tmcl::Proof::followed));
  if (seen == Sentinel::Verdict::missing) {
    auto left = co_await give_up_sentinel("it has no " + sentinel_.name());
    co_return left;
  }
  if (seen != Sentinel::Verdict::same && sentinel_.may_stand()) {
    co_await tmcl::pause(time_to_tick);
    seen = co_await must(judge_sentinel(tmcl::Proof::followed));
    if (seen != Sentinel::Verdict::same && sentinel_.may_stand()) {
      auto left = co_await give_up_sentinel("its tick timer stands");
      co_return left;
    }
  }
  if (seen != Sentinel::Verdict::same) co_return seen;
  // One that fits may be late, from before a restart: only the next one says that it is not.
  seen = co_await must(judge_sentinel(tmcl::Proof::followed));
  if (seen == Sentinel::Verdict::same) sentinel_.end_doubt();
  co_return seen;
}

Script<tmcl::Result<Sentinel::Verdict>> GatewayModule::judge_sentinel(tmcl::Proof proof) {
  if (sentinel_.wants_to_know_programs()) {
    const bool starts = co_await must(deadman_.starts_program());
    sentinel_.note_programs(starts);
  }
  if (!sentinel_.watches()) co_return Sentinel::Verdict::same;
  tmcl::CallOptions options;
  options.proof = sentinel_.is_unmistakable() ? proof : tmcl::Proof::followed;
  const auto question = sentinel_.question(address_);
  const auto answer = co_await tmcl::exchange(question, options);
  if (answer) deadman_.note_answer(*answer);
  if (answer) co_return sentinel_.take(Sentinel::Reading::of(question, *answer));
  if (answer.error().outcome != tmcl::Outcome::refused) co_return tl::unexpected(answer.error());
  co_return Sentinel::Verdict::missing;
}

void GatewayModule::note_sentinel(const tmcl::Request& question,
                                  const tmcl::Result<tmcl::Answer>& answer) {
  if (answer && state_ == State::ready) sentinel_.take(Sentinel::Reading::of(question, *answer));
}

void GatewayModule::note_answer(const tmcl::Request& request, const tmcl::Answer& answer) {
  deadman_.note_answer(answer);
  sentinel_.overhear(request, answer);
  duplicate_suspected_ = answer.duplicate_suspected;
}

void GatewayModule::note_sent(const tmcl::Request& request) {
  const auto sentinel = sentinel_.question(address_);
  const bool writes = request.command == tmcl::Command::SGP && request.type == sentinel.type &&
                      request.motor == sentinel.motor;
  if (writes) sentinel_.forget();
}

Script<tmcl::Result<Sentinel::Verdict>> GatewayModule::give_up_sentinel(std::string why) {
  sentinel_.give_up();
  bus_.log(LogLevel::warning,
           bus_.name() + ": module " + std::to_string(number(address_)) +
               " is watched only while a motor of it was sent to somewhere else than 0, so perhaps "
               "it is not noticed that it starts again: " +
               why);
  return judge_sentinel(tmcl::Proof::none);
}

Script<tmcl::Result<void>> GatewayModule::mark() {
  if (!sentinel_.wants_mark()) co_return tmcl::Result<void>{};
  const auto value = random_mark();
  const auto variable = sentinel_.question(address_);
  co_await must(tmcl::verbs::set_global(address_, variable.motor, variable.type, value));
  const auto now = co_await tmcl::current_time();
  sentinel_.forget();
  sentinel_.take({value, now, now});
  co_return tmcl::Result<void>{};
}

void GatewayModule::latch(GatewayEvent::Kind kind, const std::string& what) {
  ++settings_epoch_;
  forget_drift();
  deadman_.forget_settings();
  bus_.motors().latch(address_, "module " + std::to_string(number(address_)) + " " + what);
  bus_.emit({kind, bus_.name(), number(address_), 0, "it " + what});
}

// ---- what keeps its motors from being stopped ---------------------------------------------------

tmcl::TimePoint GatewayModule::feeding_due() const {
  return state_ == State::ready ? deadman_.due() : tmcl::TimePoint::max();
}

boost::asio::awaitable<void> GatewayModule::feed(tmcl::TimePoint deadline) {
  // The holder of the module feeds it: nothing waits for its end.
  RunOptions options;
  options.deadline = deadline;
  auto question = sentinel_.watches() ? watch({}) : deadman_.ask();
  const auto fed = co_await bus_.run(std::move(question), std::move(options));
  if (!fed) note(fed.error());
  deadman_.end_feeding();
}

// ---- what is known about it --------------------------------------------------------------------

void GatewayModule::adopt(const tmcl::FoundModule& found) {
  const bool runs = !found.version.bootloader;
  const auto state = runs ? State::ready : State::in_bootloader;
  const bool news = state_ != state;
  state_ = state;
  identity_ = found;
  duplicate_suspected_ = duplicate_suspected_ || found.duplicate_suspected;
  ++settings_epoch_;
  if (!news) return;
  if (runs && as_.model != nullptr && as_.model != model())
    bus_.log(LogLevel::warning,
             "module " + std::to_string(number(address_)) + " is not what its file is about, a " +
                 std::string(as_.model->name) + ": its movements are foreseen as usual");
  bus_.look_at_feeding();
  bus_.gate().send_owed_stops(address_);
  const auto kind =
      runs ? GatewayEvent::Kind::module_answers : GatewayEvent::Kind::module_in_bootloader;
  bus_.emit({kind, bus_.name(), number(address_), 0, name_of(found)});
}

void GatewayModule::note(const tmcl::Error& error) {
  const bool silence =
      error.code == tmcl::Errc::reply_timeout || error.code == tmcl::Errc::module_silent;
  if (!silence || state_ == State::silent) return;
  state_ = State::silent;
  bus_.emit({GatewayEvent::Kind::module_silent, bus_.name(), number(address_), 0, error.message});
}

void GatewayModule::forget_state() {
  state_ = State::unknown;
  duplicate_suspected_ = false;
  forget_drift();
  deadman_.forget_settings();
}

void GatewayModule::forget_drift() {
  drift_.reset();
  is_compared_ = false;
}

bool GatewayModule::begin_to_compare_settings() {
  if (is_compared_ || is_comparing_) return false;
  is_compared_ = true;
  is_comparing_ = true;
  return true;
}

void GatewayModule::end_comparing_settings(bool failed) {
  is_comparing_ = false;
  if (failed) forget_drift();
}

}  // namespace tmcld
