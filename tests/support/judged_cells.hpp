/// What judge() can be asked: what a command does, what is known of the motor, and whose call it
/// is. A cell is one of each.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "gateway/authority/gaps.hpp"
#include "gateway/authority/judge.hpp"
#include "tmcl/address.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld::test {

constexpr std::uint64_t this_call = 10;
constexpr std::uint64_t this_client = 1;
constexpr std::uint64_t other_call = 9;
constexpr std::uint64_t other_client = 2;
constexpr tmcl::TimePoint judged_at{std::chrono::hours(1)};

/// A call and the motor that it is about.
struct JudgedCase {
  MotorState state{};
  Permit permit{this_call, this_client};
  tmcl::TimePoint now = judged_at;

  Verdict verdict(const tmcl::Intent& intent) const { return judge(state, intent, permit, now); }
};

using Makes = std::function<void(JudgedCase& it)>;
using Holds = std::function<bool(const JudgedCase& it)>;

inline void claim(JudgedCase& it, ClaimKind mover, std::uint64_t call) {
  it.state.claimed_for = mover;
  it.state.claimed_by = call;
}

// ---- callers -----------------------------------------------------------------------------------

enum class Asker : std::uint8_t { client, holder, leader, searcher, gateway };

struct KindOfCaller {
  std::string_view name;
  Makes makes;
};

/// In the order of Asker.
inline const std::array<KindOfCaller, 5>& callers() {
  static const std::array<KindOfCaller, 5> all{{
      {"a client", [](JudgedCase&) {}},
      {"the holder of the axis' lease", [](JudgedCase& it) { it.state.leased_to = this_client; }},
      {"the call that leads the axis",
       [](JudgedCase& it) { claim(it, ClaimKind::path, this_call); }},
      {"the call that searches",
       [](JudgedCase& it) {
         claim(it, ClaimKind::search, this_call);
         it.state.searched_by = this_call;
       }},
      {"the gateway, for no call", [](JudgedCase& it) { it.permit = {}; }},
  }};
  return all;
}

inline Asker caller_of(const JudgedCase& it) {
  if (it.permit.number == 0) return Asker::gateway;
  const bool has_claim =
      it.state.claimed_for != ClaimKind::none && it.state.claimed_by == it.permit.number;
  if (has_claim) return it.state.claimed_for == ClaimKind::search ? Asker::searcher : Asker::leader;
  const bool has_lease = it.state.leased_to != 0 && it.state.leased_to == it.permit.client;
  return has_lease ? Asker::holder : Asker::client;
}

// ---- what is known of the motor ----------------------------------------------------------------

/// States of one group exclude each other.
enum class Group : std::uint8_t { claims, leases, turnings, alone };

/// In the order of states().
enum class Known : std::uint8_t {
  claimed,
  stop_uncertain,
  claimed_by_line,
  claimed_by_search,
  daemon_ends,
  stopped_since,
  stale,
  stands_still,
  latched,
  leased_to_other,
  lease_lost,
  client_gone,
  needs_lease,
  misses_reference,
  turns_for_other,
  turns_for_this,
  stop_owed,
  coordinates_held,
};

struct KnownState {
  Known known;
  std::string_view name;
  Group group;
  Makes makes;
  Holds holds;
};

inline bool is_claimed_by_other(const JudgedCase& it) {
  return it.state.claimed_for != ClaimKind::none && it.state.claimed_by != it.permit.number;
}

inline KnownState claimed_by_other(Known known, std::string_view name, ClaimKind kind) {
  return {known, name, Group::claims, [=](JudgedCase& it) { claim(it, kind, other_call); },
          [=](const JudgedCase& it) {
            return is_claimed_by_other(it) && it.state.claimed_for == kind;
          }};
}

inline KnownState with_flag(Known known, std::string_view name, bool MotorState::*flag) {
  return {known, name, Group::alone, [=](JudgedCase& it) { it.state.*flag = true; },
          [=](const JudgedCase& it) { return it.state.*flag; }};
}

inline const std::vector<KnownState>& states() {
  static const std::vector<KnownState> all{
      {Known::claimed, "another call leads the axis on a path, in a Mint program or in a test",
       Group::claims, [](JudgedCase& it) { claim(it, ClaimKind::path, other_call); },
       [](const JudgedCase& it) {
         const auto kind = it.state.claimed_for;
         return is_claimed_by_other(it) && kind != ClaimKind::stop && kind != ClaimKind::line &&
                kind != ClaimKind::search;
       }},
      claimed_by_other(Known::stop_uncertain, "a stop is not certain to have been obeyed",
                       ClaimKind::stop),
      claimed_by_other(Known::claimed_by_line, "another call leads the axis on a line",
                       ClaimKind::line),
      claimed_by_other(Known::claimed_by_search, "another call searches the reference",
                       ClaimKind::search),
      with_flag(Known::daemon_ends, "the daemon ends", &MotorState::is_ending),
      {Known::stopped_since, "a stop came in after the call", Group::alone,
       [](JudgedCase& it) { it.state.last_stop = this_call + 1; },
       [](const JudgedCase& it) { return it.state.last_stop > it.permit.number; }},
      {Known::stale, "the daemon stood still after the call came in", Group::alone,
       [](JudgedCase& it) { it.state.last_stale = this_call; },
       [](const JudgedCase& it) {
         return it.state.last_stale != 0 && it.permit.number <= it.state.last_stale;
       }},
      {Known::stands_still, "the daemon stands still", Group::alone,
       [](JudgedCase& it) {
         it.state.turned_last = judged_at;
         it.now = judged_at + Gaps::longest_gap + tmcl::Duration(1);
       },
       [](const JudgedCase& it) {
         return it.state.turned_last != tmcl::TimePoint{} &&
                it.now - it.state.turned_last > Gaps::longest_gap;
       }},
      with_flag(Known::latched, "the axis is latched", &MotorState::is_latched),
      {Known::leased_to_other, "the axis is leased to another client", Group::leases,
       [](JudgedCase& it) { it.state.leased_to = other_client; },
       [](const JudgedCase& it) {
         return it.state.leased_to != 0 && it.state.leased_to != it.permit.client;
       }},
      {Known::lease_lost, "a lease was lost after the call came in", Group::alone,
       [](JudgedCase& it) { it.state.last_loss = this_call; },
       [](const JudgedCase& it) {
         return it.state.last_loss != 0 && it.permit.number <= it.state.last_loss;
       }},
      with_flag(Known::client_gone, "the client has gone", &MotorState::is_client_gone),
      {Known::needs_lease, "moves need a lease (`moves_need_lease`)", Group::alone,
       [](JudgedCase& it) {
         it.state.is_axis = true;
         it.permit.needs_lease = true;
       },
       [](const JudgedCase& it) { return it.state.is_axis && it.permit.needs_lease; }},
      with_flag(Known::misses_reference, "the axis needs a reference and has none",
                &MotorState::misses_reference),
      {Known::turns_for_other, "the axis turns for another client", Group::turnings,
       [](JudgedCase& it) { it.state.turns_for = other_client; },
       [](const JudgedCase& it) {
         return it.state.turns_for != 0 && it.state.turns_for != it.permit.client;
       }},
      {Known::turns_for_this, "the axis turns for this client", Group::turnings,
       [](JudgedCase& it) { it.state.turns_for = this_client; },
       [](const JudgedCase& it) {
         return it.state.turns_for != 0 && it.state.turns_for == it.permit.client;
       }},
      with_flag(Known::stop_owed, "a stop of the module is owed", &MotorState::owes_stop),
      with_flag(Known::coordinates_held,
                "a move to a coordinate goes out: what changes coordinates waits",
                &MotorState::has_held_coordinates),
  };
  return all;
}

/// Of a caller who has claimed the axis, or has its lease, no other has; and for no client nothing
/// turns.
inline bool is_possible(const KindOfCaller& caller, const KnownState& state) {
  JudgedCase it;
  caller.makes(it);
  const bool has_claim = it.state.claimed_for != ClaimKind::none;
  const bool has_lease = it.state.leased_to != 0;
  const bool lets_turn = it.permit.client != 0 || state.known != Known::turns_for_this;
  return !(has_claim && state.group == Group::claims) &&
         !(has_lease && state.group == Group::leases) && lets_turn;
}

// ---- what a command does -----------------------------------------------------------------------

inline std::vector<tmcl::Intent> find_all_intents() {
  using Key = std::tuple<int, int, int, int, bool, bool>;
  std::set<Key> seen;
  std::vector<tmcl::Intent> all;
  for (int command = 0; command < 256; ++command) {
    for (int type = 0; type < 256; ++type) {
      for (const std::uint8_t motor : std::array<std::uint8_t, 3>{0, 0x83, 255}) {
        for (const std::int32_t value : {0, 1}) {
          const auto it =
              intent_of(tmcl::Request{tmcl::ModuleAddress{1}, static_cast<tmcl::Command>(command),
                                      static_cast<std::uint8_t>(type), motor, value});
          const Key key{static_cast<int>(it.effect),
                        static_cast<int>(it.motion),
                        static_cast<int>(it.subject),
                        static_cast<int>(it.sets),
                        it.is_unseen,
                        it.changes_coordinates};
          if (seen.insert(key).second) all.push_back(it);
        }
      }
    }
  }
  return all;
}

/// One intent for each way in which intents differ.
inline const std::vector<tmcl::Intent>& all_intents() {
  static const auto all = find_all_intents();
  return all;
}

/// What of an intent can matter to judge().
struct KindOfIntent {
  tmcl::Effect effect;
  tmcl::Motion motion;
  bool changes_coordinates;
  auto operator<=>(const KindOfIntent&) const = default;
};

inline KindOfIntent kind_of(const tmcl::Intent& intent) {
  return {intent.effect, intent.motion, intent.changes_coordinates};
}

inline std::string_view word_for(tmcl::Motion motion) {
  switch (motion) {
    case tmcl::Motion::unchanged: return "unchanged";
    case tmcl::Motion::to_position: return "to_position";
    case tmcl::Motion::by_distance: return "by_distance";
    case tmcl::Motion::to_target: return "to_target";
    case tmcl::Motion::turns: return "turns";
    case tmcl::Motion::stops: return "stops";
    case tmcl::Motion::searches: return "searches";
    case tmcl::Motion::by_program: return "by_program";
    case tmcl::Motion::ends_program: return "ends_program";
    case tmcl::Motion::restarts: return "restarts";
    case tmcl::Motion::unforeseen: return "unforeseen";
  }
  return {};
}

inline std::string_view word_for(tmcl::Effect effect) {
  switch (effect) {
    case tmcl::Effect::reads: return "reads";
    case tmcl::Effect::writes: return "writes";
    case tmcl::Effect::moves: return "moves";
    case tmcl::Effect::stops: return "stops";
  }
  return {};
}

inline std::string name_of(const KindOfIntent& kind) {
  return std::string(word_for(kind.effect)) + ' ' + std::string(word_for(kind.motion)) +
         (kind.changes_coordinates ? " +coordinates" : "");
}

/// One intent of each kind; in the order of their kinds.
inline std::vector<tmcl::Intent> one_intent_of_each_kind() {
  std::vector<tmcl::Intent> all = all_intents();
  std::ranges::stable_sort(all, {}, kind_of);
  const auto rest = std::ranges::unique(all, {}, kind_of);
  all.erase(rest.begin(), rest.end());
  return all;
}

}  // namespace tmcld::test
