#include "gateway/authority/judge.hpp"

#include <array>

#include "gateway/authority/gaps.hpp"

namespace tmcld {
namespace {

struct Case {
  const MotorState& state;
  const tmcl::Intent& intent;
  const Permit& permit;
  tmcl::TimePoint now;

  bool moves() const { return intent.effect == tmcl::Effect::moves; }
  bool is_led() const { return leads(state, permit); }
  bool is_claimed() const {
    return state.claimed_for != ClaimKind::none && state.claimed_by != permit.number;
  }
  bool is_claimed_for(ClaimKind kind) const { return is_claimed() && state.claimed_for == kind; }
};

struct Row {
  Obstacle obstacle;
  Ruling ruling;
  /// It takes the right to move the motor away, whatever the call does next.
  bool is_of_right;
  bool (*stands)(const Case& it);
};

constexpr bool of_right = true;
constexpr bool of_now = false;

/// In the order in which they are told.
constexpr auto rows = std::to_array<Row>({
    {Obstacle::claimed, Ruling::refuse, of_now,
     [](const Case& it) {
       return it.moves() && it.is_claimed() && !it.is_claimed_for(ClaimKind::search) &&
              !it.is_claimed_for(ClaimKind::line);
     }},
    {Obstacle::daemon_ends, Ruling::refuse, of_right,
     [](const Case& it) { return it.moves() && it.state.is_ending; }},
    {Obstacle::no_call, Ruling::refuse, of_right,
     [](const Case& it) { return it.moves() && it.permit.number == 0; }},
    {Obstacle::stopped, Ruling::refuse, of_right,
     [](const Case& it) { return it.moves() && it.state.last_stop > it.permit.number; }},
    {Obstacle::stale, Ruling::refuse, of_right,
     [](const Case& it) {
       const bool has_begun = it.state.turned_last != tmcl::TimePoint{};
       const bool stands_still = has_begun && it.now - it.state.turned_last > Gaps::longest_gap;
       return it.moves() && (stands_still || it.permit.number <= it.state.last_stale);
     }},
    // A module that starts again is no worse for an axis that is latched.
    {Obstacle::latched, Ruling::refuse, of_right,
     [](const Case& it) {
       const bool searches = it.state.searched_by == it.permit.number;
       const bool restarts = it.intent.motion == tmcl::Motion::restarts;
       return it.moves() && it.state.is_latched && !searches && !restarts;
     }},
    // What the gateway itself sets, as to restore a setting, is of no client.
    {Obstacle::leased, Ruling::refuse, of_right,
     [](const Case& it) {
       const bool is_of_other = it.state.leased_to != 0 && it.state.leased_to != it.permit.client;
       return it.permit.number != 0 && !it.is_led() && is_of_other;
     }},
    {Obstacle::lease_lost, Ruling::refuse, of_right,
     [](const Case& it) {
       return it.permit.number != 0 && !it.is_led() && it.permit.number <= it.state.last_loss;
     }},
    {Obstacle::client_gone, Ruling::refuse, of_right,
     [](const Case& it) {
       const bool is_its_own = !it.is_led() || it.permit.ends_with_client;
       return it.moves() && is_its_own && it.state.is_client_gone;
     }},
    {Obstacle::lease_missing, Ruling::refuse, of_now,
     [](const Case& it) {
       const bool has_lease = it.state.leased_to != 0 && it.state.leased_to == it.permit.client;
       const bool needs_lease = it.permit.needs_lease && it.state.is_axis;
       return it.moves() && needs_lease && !has_lease && !it.is_led();
     }},
    // A search that has ended unseen may have found it: that is asked first.
    {Obstacle::reference_missing, Ruling::refuse, of_now,
     [](const Case& it) {
       const bool needs_reference =
           goes_to_position(it.intent.motion) && !it.permit.needs_no_reference;
       const bool may_be_found = it.is_claimed_for(ClaimKind::search);
       return it.moves() && needs_reference && it.state.misses_reference && !may_be_found;
     }},
    {Obstacle::claimed_by_search, Ruling::ask, of_now,
     [](const Case& it) { return it.moves() && it.is_claimed_for(ClaimKind::search); }},
    {Obstacle::claimed_by_line, Ruling::ask, of_now,
     [](const Case& it) { return it.moves() && it.is_claimed_for(ClaimKind::line); }},
    {Obstacle::turns_for_other, Ruling::ask, of_now,
     [](const Case& it) {
       const auto owner = it.state.leased_to != 0 ? 0 : it.state.turns_for;
       return it.permit.number != 0 && !it.is_led() && owner != 0 && owner != it.permit.client;
     }},
    {Obstacle::stop_owed, Ruling::ask, of_now,
     [](const Case& it) { return it.moves() && it.state.owes_stop; }},
    {Obstacle::coordinates_held, Ruling::ask, of_now,
     [](const Case& it) { return it.intent.changes_coordinates && it.state.has_held_coordinates; }},
});

Verdict first_of(const Case& it, bool only_of_right) {
  for (const auto& row : rows)
    if ((row.is_of_right || !only_of_right) && row.stands(it)) return {row.ruling, row.obstacle};
  return {};
}

}  // namespace

bool leads(const MotorState& state, const Permit& permit) {
  return state.claimed_for != ClaimKind::none && state.claimed_for != ClaimKind::search &&
         state.claimed_by == permit.number;
}

Verdict judge(const MotorState& state, const tmcl::Intent& intent, const Permit& permit,
              tmcl::TimePoint now) {
  if (intent.effect == tmcl::Effect::reads || is_stop(intent)) return {};
  return first_of({state, intent, permit, now}, false);
}

Verdict judge_right(const MotorState& state, const Permit& permit, tmcl::TimePoint now) {
  tmcl::Intent any_move;
  any_move.changes_coordinates = false;
  return first_of({state, any_move, permit, now}, true);
}

}  // namespace tmcld
