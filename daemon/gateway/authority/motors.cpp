#include "gateway/authority/motors.hpp"

#include <algorithm>
#include <utility>

#include "gateway/journey/awaited_run.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/ensure.hpp"

namespace tmcld {
namespace {

using tmcl::AxisAddress;
using tmcl::Command;
using tmcl::Errc;
using tmcl::Motion;
using tmcl::Request;
using tmcl::Subject;

/// Stands for all motors of a module that have no axis.
constexpr std::uint8_t no_motor = 255;

/// Nothing where the motor does as before.
std::optional<Sent> sent_by(Motion motion) {
  if (goes_to_position(motion)) return Sent::to_position;
  if (is_unpredictable(motion)) return Sent::unseen;
  const bool leaves_positions =
      motion == Motion::turns || motion == Motion::stops || motion == Motion::searches;
  return leaves_positions ? std::optional(Sent::elsewhere) : std::nullopt;
}

/// Once its module has taken the command, the motor turns without end no more.
bool ends_turning(Motion motion) {
  return motion == Motion::to_position || motion == Motion::by_distance ||
         motion == Motion::stops || motion == Motion::searches;
}

std::string_view words_for(ClaimKind by) {
  switch (by) {
    case ClaimKind::none: break;
    case ClaimKind::line: return "is on its way along a line";
    case ClaimKind::path: return "is on its way along a path";
    case ClaimKind::mint: return "is moved by a Mint program";
    case ClaimKind::jog: return "is jogged";
    case ClaimKind::approach: return "is on its way to a target that it comes to from one side";
    case ClaimKind::search: return "searches its reference";
    case ClaimKind::deadman_test: return "moves to test the deadman of its module";
    case ClaimKind::verification: return "moves so that its module can be verified";
    case ClaimKind::tuning: return "moves so that it can be tuned";
    case ClaimKind::settings: return "is held while the settings of its module are loaded";
    case ClaimKind::stop:
      return "could not be stopped, and is stopped until its module says it stands";
  }
  return "is moved by no client";
}

}  // namespace

tmcl::Error client_gone() { return tmcl::bad_argument("the client has gone that asked for it"); }

void Motors::add(AxisAddress motor, const std::string& axis, bool needs_reference) {
  auto& added = motors_[motor];
  // It may have been stopped before it had an axis.
  added.last_stop = std::max(added.last_stop, last_stop_of_others_);
  added.axis = axis;
  added.needs_reference = needs_reference;
}

// ---- stops -------------------------------------------------------------------------------------

void Motors::stop(AxisAddress motor) {
  auto& stopped = motors_[motor];
  stopped.last_stop = arrivals_->admit().number;
  forget_other_motors();
}

void Motors::forget_other_motors() {
  const auto is_other = [](const auto& one) { return one.second.axis.empty(); };
  const auto others = std::ranges::count_if(motors_, is_other);
  if (static_cast<std::size_t>(others) <= most_other_motors) return;
  std::erase_if(motors_, is_other);
  last_stop_of_others_ = arrivals_->last;
}

// ---- judgement ---------------------------------------------------------------------------------

MotorState Motors::state_of(AxisAddress motor, Permit permit) const {
  MotorState state;
  state.is_ending = arrivals_->closing;
  state.last_stop = arrivals_->stop_of_all;
  state.last_stale = arrivals_->gaps.last_stale();
  state.turned_last = arrivals_->gaps.looked();
  state.is_client_gone = !arrivals_->is_there(permit.client);
  state.has_held_coordinates = coordinates_.holds.has(motor.module);
  state.is_axis = is_axis(motor);
  if (!state.is_axis) state.last_stop = std::max(state.last_stop, last_stop_of_others_);
  const auto found = motors_.find(motor);
  if (found == motors_.end()) return state;
  const auto& it = found->second;
  state.last_stop = std::max(state.last_stop, it.last_stop);
  state.claimed_for = it.claim_owner.by;
  state.claimed_by = it.claim_owner.of.number;
  state.leased_to = it.holder.client;
  state.last_loss = it.last_loss;
  state.turns_for = it.turning.client;
  state.is_latched = !it.latch_cause.empty();
  state.searched_by = it.searcher.number;
  state.misses_reference = it.needs_reference && !it.is_referenced;
  return state;
}

Motors::Judgement Motors::judge(const Request& request, Permit permit, tmcl::TimePoint now,
                                bool owes_stop) const {
  const auto intent = intent_of(request);
  const bool moves = intent.effect == tmcl::Effect::moves;
  Judgement strictest;
  const auto look_at = [&](AxisAddress motor) {
    auto state = state_of(motor, permit);
    state.owes_stop = owes_stop;
    const auto verdict = tmcld::judge(state, intent, permit, now);
    const auto& so_far = strictest.verdict;
    const bool is_told_first = verdict.ruling == so_far.ruling && verdict.because < so_far.because;
    if (verdict.ruling > so_far.ruling || is_told_first) strictest = {verdict, motor};
  };
  // The first may have no axis, and stands for all those of the module that have none.
  look_at(intent.subject == Subject::motor ? AxisAddress{request.address, request.motor}
                                           : AxisAddress{request.address, no_motor});
  for (const auto& [address, motor] : motors_)
    if (moves ? can_move(request, address) : concerns(request, address)) look_at(address);
  return strictest;
}

std::optional<tmcl::Error> Motors::objection(AxisAddress motor, Permit permit,
                                             tmcl::TimePoint now) const {
  const auto verdict = judge_right(state_of(motor, permit), permit, now);
  if (verdict.ruling == Ruling::allow) return std::nullopt;
  return refusal(motor, verdict.because);
}

tmcl::Error Motors::refusal(AxisAddress motor, Obstacle because) const {
  const auto found = motors_.find(motor);
  const auto& it = found == motors_.end() ? Motor{} : found->second;
  const auto axis = "axis '" + it.axis + "'";
  switch (because) {
    case Obstacle::claimed:
    case Obstacle::claimed_by_search:
    case Obstacle::claimed_by_line:
      return error(Errc::axis_claimed, axis + " " + std::string(words_for(it.claim_owner.by)),
                   "wait for its end, or stop it");
    case Obstacle::daemon_ends: return error(Errc::daemon_ending, "the daemon is ending", {});
    case Obstacle::no_call:
      return error(Errc::bad_argument, "nothing moves a motor that no call has asked for", {});
    case Obstacle::coordinates_held:
      return error(Errc::axis_claimed, "a move to a coordinate of the module goes out",
                   "try again");
    case Obstacle::none:
    case Obstacle::stopped:
    case Obstacle::stop_owed: return error(Errc::superseded_by_stop, "a stop came first", {});
    case Obstacle::stale:
      return error(Errc::stale_request, stale_text(arrivals_->gaps), std::string(stale_hint));
    case Obstacle::latched:
      return error(Errc::latched, axis + " is latched: " + it.latch_cause,
                   "its position and its settings are what the module starts with; search its "
                   "reference, or, when you know that it may move, say so: 'tmclctl recover " +
                       it.axis + "'");
    case Obstacle::leased:
      return error(Errc::leased, axis + " is leased to " + it.holder.name,
                   "wait until that releases it; a stop is always let through");
    case Obstacle::turns_for_other:
      return error(Errc::leased, axis + " turns for " + it.turning.name, "stop it first");
    case Obstacle::lease_lost:
      return error(Errc::lease_lost, "the lease of " + axis + " was lost",
                   "lease.acquire gives a new one");
    case Obstacle::client_gone: return error(Errc::bad_argument, client_gone().message, {});
    case Obstacle::lease_missing:
      return error(Errc::not_permitted, axis + " moves only under a lease: 'moves_need_lease'",
                   "'tmclctl lease run " + it.axis + " -- COMMAND' has one while COMMAND runs");
    case Obstacle::reference_missing:
      return error(Errc::latched, axis + " has not searched its reference",
                   "search it first: 'tmclctl home " + it.axis +
                       "'; the configuration requires that: 'reference'");
  }
  return error(Errc::bad_argument, "it must not go out", {});
}

bool Motors::is_led_by(AxisAddress motor, Permit permit) const {
  return leads(state_of(motor, permit), permit);
}

// ---- leases ------------------------------------------------------------------------------------

void Motors::lease(AxisAddress motor, Holder holder) {
  if (is_axis(motor)) motors_.at(motor).holder = std::move(holder);
}

void Motors::lose_lease(AxisAddress motor) {
  if (!is_axis(motor)) return;
  auto& lost = motors_.at(motor);
  // Whether it turns on without its owner, the lease has said.
  if (lost.turning.client == lost.holder.client) lost.turning.client = 0;
  lost.holder = {};
  lost.last_loss = arrivals_->admit().number;
}

Holder Motors::holder_of(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  if (found == motors_.end()) return {};
  const auto& holder = found->second.holder;
  const auto& turning = found->second.turning;
  return holder.lease != 0 ? holder : Holder{turning.client, 0, turning.name};
}

// ---- turning without end -----------------------------------------------------------------------

void TurningAttempt::End::operator()(Motors* motors) const {
  --motors->motors_.at(motor).turning_attempts;
}

void TurningAttempt::withdraw() {
  if (!held_) return;
  auto& turning = held_->motors_.at(held_.get_deleter().motor).turning;
  // Meanwhile it may turn for another reason.
  if (turning.number == number_) turning = before_;
}

void Motors::turn(Motor& motor, Permit of) {
  const bool has_owner = !of.unattended || motor.holder.lease != 0;
  const auto owner = arrivals_->clients.find(has_owner ? of.client : 0);
  motor.turning = {++last_turning_, has_owner ? of.client : 0,
                   owner == arrivals_->clients.end() ? "" : owner->second};
}

std::vector<TurningAttempt> Motors::begin_turning(const std::set<AxisAddress>& motors, Permit of) {
  std::vector<TurningAttempt> attempts;
  for (const auto motor : motors)
    if (is_axis(motor))
      if (auto attempt = begin_turning(motor, of)) attempts.push_back(std::move(attempt));
  return attempts;
}

TurningAttempt Motors::begin_turning(AxisAddress motor, Permit of) {
  const auto holder = holder_of(motor);
  const bool is_of_other = holder.client != 0 && holder.client != of.client;
  if (is_of_other || is_led_by(motor, of)) return {};
  auto& it = motors_.at(motor);
  TurningAttempt attempt(*this, motor, it.turning);
  ++it.turning_attempts;
  turn(it, of);
  attempt.number_ = it.turning.number;
  return attempt;
}

void Motors::note_unattended(AxisAddress motor) {
  if (is_axis(motor) && motors_.at(motor).turning.number == 0) turn(motors_.at(motor), {});
}

Turning Motors::turning_of(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found == motors_.end() ? Turning{} : found->second.turning;
}

void Motors::end_turning(AxisAddress motor, std::uint64_t number) {
  const auto found = motors_.find(motor);
  if (found == motors_.end()) return;
  auto& it = found->second;
  if (it.turning_attempts == 0 && it.turning.number == number) it.turning = {};
}

void Motors::note_turning(const Request& request, bool is_done, const Before& before) {
  const auto motion = intent_of(request).motion;
  for (auto& [address, motor] : motors_) {
    const bool names_it = request.address == address.module && request.motor == address.motor;
    if (!names_it && !can_move(request, address)) continue;
    // Its owner may have let it turn again while this was on its way, or is about to.
    const bool is_ended = is_done && ends_turning(motion) && motor.turning_attempts == 0;
    if (is_ended && motor.turning.number <= before.turnings) motor.turning = {};
    const bool is_new = motor.turning.number == 0 && !motor.axis.empty();
    const bool turns = before.turned.contains(address);
    if (turns && is_new && !is_led_by(address, before.of)) turn(motor, before.of);
  }
}

// ---- coordinates -------------------------------------------------------------------------------

ModuleMarks::Mark ModuleMarks::set(tmcl::ModuleAddress module) {
  ++counts_[module];
  return Mark(this, End{module});
}

void ModuleMarks::End::operator()(ModuleMarks* marks) const {
  const auto count = marks->counts_.find(module);
  if (--count->second == 0) marks->counts_.erase(count);
}

// ---- latches -----------------------------------------------------------------------------------

void Motors::latch(tmcl::ModuleAddress module, const std::string& cause) {
  for (auto& [address, motor] : motors_) {
    if (address.module != module || motor.axis.empty()) continue;
    motor.latch_cause = cause;
    ++motor.latches;
    motor.searcher = {};
    motor.is_referenced = false;
    if (const auto journey = motor.claim_owner.journey.lock()) journey->look();
  }
}

void Motors::recover(AxisAddress motor, std::uint64_t latches) {
  const auto found = motors_.find(motor);
  if (found != motors_.end() && found->second.latches == latches) found->second.latch_cause.clear();
}

std::uint64_t Motors::latches(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found == motors_.end() ? 0 : found->second.latches;
}

std::optional<tmcl::Error> Motors::latched(AxisAddress motor) const {
  if (!state_of(motor, {}).is_latched) return std::nullopt;
  return refusal(motor, Obstacle::latched);
}

void Motors::let_search(AxisAddress motor, Permit permit) {
  if (is_axis(motor)) motors_.at(motor).searcher = permit;
}

bool Motors::is_referenced(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found != motors_.end() && found->second.is_referenced;
}

void Motors::set_referenced(AxisAddress motor, bool is_referenced) {
  if (is_axis(motor)) motors_.at(motor).is_referenced = is_referenced;
}

// ---- requests on their way ---------------------------------------------------------------------

bool Motors::is_axis(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found != motors_.end() && !found->second.axis.empty();
}

void Motors::begin(const Request& request, Permit of) {
  on_their_way_.push_back(request);
  if (starts_search(request)) note_claim({request.address, request.motor}, {ClaimKind::search, of});
}

void Motors::end(const Request& request) {
  const auto found = std::ranges::find(on_their_way_, request);
  if (found != on_their_way_.end()) on_their_way_.erase(found);
}

void Motors::note_moved(const Request& request) {
  if (!can_move(request)) return;
  for (const auto& [address, motor] : motors_)
    if (!motor.axis.empty() && can_move(request, address)) moved_.insert(address);
  const auto subject = intent_of(request).subject;
  if (subject != Subject::motor && subject != Subject::several) return;
  const auto others = std::ranges::count_if(moved_, [&](auto motor) { return !is_axis(motor); });
  if (static_cast<std::size_t>(others) < most_other_motors) moved_.merge(motors_of(request));
}

void Motors::note_target(const Request& request, const Before& before) {
  const auto intent = intent_of(request);
  const auto sent = sent_by(intent.motion);
  if (!sent) return;
  for (auto& [address, motor] : motors_) {
    const bool names_it = request.address == address.module && request.motor == address.motor;
    const bool concerns_it = intent.subject == Subject::chip
                                 ? before.turned.contains(address)
                                 : names_it || can_move(request, address);
    // A target that is written does not end what turns by velocity, in some firmwares.
    const bool may_turn_on = intent.motion == Motion::to_target && motor.sent == Sent::unseen;
    if (concerns_it && !may_turn_on) motor.sent = *sent;
  }
}

void Motors::note_program(const Request& request, bool is_done) {
  const auto motion = intent_of(request).motion;
  // A module that starts again may start its program by itself.
  if (is_unpredictable(motion) || motion == Motion::restarts) programs_.insert(request.address);
  const bool ends_one = motion == Motion::ends_program && is_done;
  if (!ends_one || programs_.erase(request.address) == 0) return;
  // Whatever they were sent to before, the program may have set them turning since.
  for (auto& [address, motor] : motors_)
    if (address.module == request.address) motor.sent = Sent::unseen;
}

bool Motors::was_sent_to_position(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found != motors_.end() && found->second.sent == Sent::to_position;
}

bool Motors::may_move(AxisAddress motor) const {
  return moved_.contains(motor) || claim_owner_of(motor).by != ClaimKind::none ||
         std::ranges::any_of(on_their_way_,
                             [&](const Request& request) { return can_move(request, motor); });
}

std::vector<std::string> Motors::under_way() const {
  std::vector<std::string> names;
  for (const auto& [address, motor] : motors_) {
    if (motor.axis.empty()) continue;
    const bool has_no_end = moved_.contains(address) && motor.sent != Sent::to_position;
    const bool turns = turning_of(address).number != 0;
    if (has_no_end || turns || motor.claim_owner.by != ClaimKind::none) names.push_back(motor.axis);
  }
  return names;
}

std::set<AxisAddress> Motors::others_that_may_move() const {
  auto others = moved_;
  for (const auto& request : on_their_way_) others.merge(motors_of(request));
  std::erase_if(others, [&](AxisAddress motor) { return is_axis(motor); });
  return others;
}

// ---- claims ------------------------------------------------------------------------------------

void Claim::Release::operator()(Motors* motors) const { motors->release(motor, of); }

void Motors::note_claim(AxisAddress motor, ClaimOwner claim_owner) {
  if (is_axis(motor)) motors_.at(motor).claim_owner = std::move(claim_owner);
}

Claim Motors::claim(AxisAddress motor, ClaimOwner claim_owner) {
  // A stop takes the axis away from whatever moves it.
  tmcl::ensure(claim_owner.by == ClaimKind::stop || claim_owner_of(motor).by == ClaimKind::none);
  const auto of = claim_owner.of;
  note_claim(motor, std::move(claim_owner));
  return {*this, motor, of};
}

void Motors::release(AxisAddress motor, Permit of) {
  const auto found = motors_.find(motor);
  if (found != motors_.end() && found->second.claim_owner.of == of) found->second.claim_owner = {};
}

ClaimOwner Motors::claim_owner_of(AxisAddress motor) const {
  const auto found = motors_.find(motor);
  return found == motors_.end() ? ClaimOwner{} : found->second.claim_owner;
}

std::ptrdiff_t Motors::claimed_by(ClaimKind by) const {
  return std::ranges::count_if(motors_,
                               [&](const auto& one) { return one.second.claim_owner.by == by; });
}

void Motors::note(const Request& request, const tmcl::Result<tmcl::Answer>& answer,
                  const Before& before) {
  const AxisAddress motor{request.address, request.motor};
  if (answer || answer.error().outcome == tmcl::Outcome::unknown) {
    note_moved(request);
    note_target(request, before);
    note_program(request, answer.has_value());
    note_turning(request, answer.has_value(), before);
  }
  if (answer && request.command == Command::MST) moved_.erase(motor);
  if (request.command != Command::RFS) return;
  switch (request.type) {
    case tmcl::search_type::start: {
      const bool never_began = !answer && answer.error().outcome != tmcl::Outcome::unknown;
      if (never_began) {
        release(motor, before.claim_owner.of);
      } else {
        recover(motor, latches(motor));
        // It may count from somewhere else at any time now.
        set_referenced(motor, false);
      }
      return;
    }
    case tmcl::search_type::stop:
      if (answer && before.claim_owner.by == ClaimKind::search)
        release(motor, before.claim_owner.of);
      return;
  }
}

tmcl::Error Motors::error(Errc code, std::string message, std::string hint) const {
  auto error = tmcl::not_sent(code, std::move(message), std::move(hint));
  error.bus = bus_;
  return error;
}

}  // namespace tmcld
