// Whether a command may go to a motor: all states, alone and together, for all intents and callers.
// TMCL_DRAW=1 draws the table in docs/SAFETY.md anew.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gateway/authority/gaps.hpp"
#include "gateway/authority/judge.hpp"
#include "support/build_paths.hpp"
#include "tmcl/address.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld {
namespace {

using tmcl::Command;
using tmcl::Intent;
using tmcl::Request;

constexpr std::uint64_t this_call = 10;
constexpr std::uint64_t this_client = 1;
constexpr std::uint64_t other_call = 9;
constexpr std::uint64_t other_client = 2;
constexpr tmcl::TimePoint begin{std::chrono::hours(1)};

/// A call and the motor that it is about.
struct Case {
  MotorState state{};
  Permit permit{this_call, this_client};
  tmcl::TimePoint now = begin;

  Verdict verdict(const Intent& intent) const { return judge(state, intent, permit, now); }
};

using Makes = std::function<void(Case& it)>;

struct Caller {
  std::string_view name;
  Makes makes;
};

void claim(Case& it, ClaimKind mover, std::uint64_t call) {
  it.state.claimed_for = mover;
  it.state.claimed_by = call;
}

const std::array<Caller, 5>& callers() {
  static const std::array<Caller, 5> all{{
      {"a client", [](Case&) {}},
      {"the holder of the axis' lease", [](Case& it) { it.state.leased_to = this_client; }},
      {"the call that leads the axis", [](Case& it) { claim(it, ClaimKind::path, this_call); }},
      {"the call that searches",
       [](Case& it) {
         claim(it, ClaimKind::search, this_call);
         it.state.searched_by = this_call;
       }},
      {"the gateway, for no call", [](Case& it) { it.permit = {}; }},
  }};
  return all;
}

/// States of one group exclude each other.
struct State {
  std::string_view name;
  int group;
  Makes makes;
};

enum Group : int { claims, leases, turnings, alone };

const std::vector<State>& states() {
  static const std::vector<State> all{
      {"another call leads the axis on a path, in a Mint program or in a test", claims,
       [](Case& it) { claim(it, ClaimKind::path, other_call); }},
      {"a stop is not certain to have been obeyed", claims,
       [](Case& it) { claim(it, ClaimKind::stop, other_call); }},
      {"another call leads the axis on a line", claims,
       [](Case& it) { claim(it, ClaimKind::line, other_call); }},
      {"another call searches the reference", claims,
       [](Case& it) { claim(it, ClaimKind::search, other_call); }},
      {"the daemon ends", alone, [](Case& it) { it.state.is_ending = true; }},
      {"a stop came in after the call", alone,
       [](Case& it) { it.state.last_stop = this_call + 1; }},
      {"the daemon stood still after the call came in", alone,
       [](Case& it) { it.state.last_stale = this_call; }},
      {"the daemon stands still", alone,
       [](Case& it) {
         it.state.turned_last = begin;
         it.now = begin + Gaps::longest_gap + tmcl::Duration(1);
       }},
      {"the axis is latched", alone, [](Case& it) { it.state.is_latched = true; }},
      {"the axis is leased to another client", leases,
       [](Case& it) { it.state.leased_to = other_client; }},
      {"a lease was lost after the call came in", alone,
       [](Case& it) { it.state.last_loss = this_call; }},
      {"the client has gone", alone, [](Case& it) { it.state.is_client_gone = true; }},
      {"moves need a lease (`moves_need_lease`)", alone,
       [](Case& it) {
         it.state.is_axis = true;
         it.permit.needs_lease = true;
       }},
      {"the axis needs a reference and has none", alone,
       [](Case& it) { it.state.misses_reference = true; }},
      {"the axis turns for another client", turnings,
       [](Case& it) { it.state.turns_for = other_client; }},
      {"the axis turns for this client", turnings,
       [](Case& it) { it.state.turns_for = this_client; }},
      {"a stop of the module is owed", alone, [](Case& it) { it.state.owes_stop = true; }},
      {"a move to a coordinate goes out: what changes coordinates waits", alone,
       [](Case& it) { it.state.has_held_coordinates = true; }},
  };
  return all;
}

/// Of a caller who has claimed the axis, or has its lease, no other has.
bool is_possible(const Caller& caller, const State& state) {
  Case it;
  caller.makes(it);
  const bool has_claim = it.state.claimed_for != ClaimKind::none;
  const bool has_lease = it.state.leased_to != 0;
  return !(has_claim && state.group == claims) && !(has_lease && state.group == leases);
}

std::vector<Intent> all_intents() {
  std::set<std::array<int, 6>> seen;
  std::vector<Intent> all;
  for (int command = 0; command < 256; ++command) {
    for (int type = 0; type < 256; ++type) {
      for (const std::uint8_t motor : std::array<std::uint8_t, 3>{0, 0x83, 255}) {
        for (const std::int32_t value : {0, 1}) {
          const auto it = intent_of(Request{tmcl::ModuleAddress{1}, static_cast<Command>(command),
                                            static_cast<std::uint8_t>(type), motor, value});
          const bool is_new = seen.insert({static_cast<int>(it.effect), static_cast<int>(it.motion),
                                           static_cast<int>(it.subject), static_cast<int>(it.sets),
                                           it.is_unseen, it.changes_coordinates})
                                  .second;
          if (is_new) all.push_back(it);
        }
      }
    }
  }
  return all;
}

Intent of(Command command, std::uint8_t type, std::int32_t value = 1) {
  return intent_of(Request{tmcl::ModuleAddress{1}, command, type, 0, value});
}

const Intent a_move = of(Command::MVP, 0);
const Intent a_setting = of(Command::SAP, 5);

/// Calls `does` for each combination of states that a caller can meet, with the states in it.
void for_each_combination(const Caller& caller,
                          const std::function<void(const Case&, const std::vector<int>&)>& does) {
  Case bare;
  caller.makes(bare);
  std::vector<int> in_it;
  const std::function<void(std::size_t, const Case&)> go_on = [&](std::size_t next,
                                                                  const Case& it) {
    if (next == states().size()) return does(it, in_it);
    const auto& state = states()[next];
    go_on(next + 1, it);
    const bool excluded = state.group != alone && std::ranges::any_of(in_it, [&](int one) {
                            return states()[static_cast<std::size_t>(one)].group == state.group;
                          });
    if (excluded || !is_possible(caller, state)) return;
    auto with = it;
    state.makes(with);
    in_it.push_back(static_cast<int>(next));
    go_on(next + 1, with);
    in_it.pop_back();
  };
  go_on(0, bare);
}

Ruling ruling_of(const Caller& caller, const State& state, const Intent& intent) {
  Case it;
  caller.makes(it);
  state.makes(it);
  return it.verdict(intent).ruling;
}

/// The search of another call may have ended unseen, and have found the reference: the module is
/// asked before that is missed.
bool may_be_found(const Case& it, const State& state) {
  Case only;
  state.makes(only);
  return only.state.misses_reference && it.state.claimed_for == ClaimKind::search &&
         it.state.claimed_by != it.permit.number;
}

TEST(Judge, IsNeverWeakerThanAnyStateByItself) {
  const auto intents = all_intents();
  std::size_t judged = 0;
  for (const auto& caller : callers()) {
    std::vector<std::vector<Ruling>> alone_ruled;
    for (const auto& state : states()) {
      alone_ruled.emplace_back();
      for (const auto& intent : intents)
        alone_ruled.back().push_back(is_possible(caller, state) ? ruling_of(caller, state, intent)
                                                                : Ruling::allow);
    }
    for_each_combination(caller, [&](const Case& it, const std::vector<int>& in_it) {
      for (std::size_t i = 0; i < intents.size(); ++i) {
        const auto together = it.verdict(intents[i]).ruling;
        ++judged;
        for (const auto state : in_it) {
          const auto one = static_cast<std::size_t>(state);
          if (together >= alone_ruled[one][i] || may_be_found(it, states()[one])) continue;
          ADD_FAILURE() << caller.name << ": weaker than '" << states()[one].name << "', intent "
                        << i;
          return;
        }
      }
    });
  }
  EXPECT_GT(judged, 100'000U);
}

TEST(Judge, LetsAStopAndAQuestionThroughWhateverTheStateIs) {
  for (const auto& intent : all_intents()) {
    if (intent.effect != tmcl::Effect::reads && !is_stop(intent)) continue;
    for (const auto& caller : callers())
      for_each_combination(caller, [&](const Case& it, const std::vector<int>&) {
        ASSERT_EQ(it.verdict(intent), Verdict{}) << caller.name;
      });
  }
}

TEST(Judge, LetsNothingMoveThatNoCallHasAskedFor) {
  for (const auto& intent : all_intents()) {
    Case it;
    it.permit = {};
    const auto wanted = intent.effect == tmcl::Effect::moves ? Ruling::refuse : Ruling::allow;
    EXPECT_EQ(it.verdict(intent).ruling, wanted);
  }
}

TEST(Judge, MeetsEachObstacle) {
  std::set<Obstacle> met;
  for (const auto& caller : callers())
    for_each_combination(caller, [&](const Case& it, const std::vector<int>&) {
      for (const auto& intent : {a_move, of(Command::GCO, 0), of(static_cast<Command>(250), 0)})
        met.insert(it.verdict(intent).because);
    });
  EXPECT_EQ(met.size(), static_cast<std::size_t>(last_obstacle) + 1);
}

TEST(Judge, AnAxisThatIsLatchedMaySeeItsModuleStartAgain) {
  Case it;
  it.state.is_latched = true;
  EXPECT_EQ(it.verdict(of(Command::SOFTWARE_RESET, 0)).ruling, Ruling::allow);
  EXPECT_EQ(it.verdict(a_move).because, Obstacle::latched);
}

TEST(Judge, AMoveOfADistanceNeedsNoReference) {
  Case it;
  it.state.misses_reference = true;
  EXPECT_EQ(it.verdict(a_move).because, Obstacle::reference_missing);
  it.permit.needs_no_reference = true;
  EXPECT_EQ(it.verdict(a_move).ruling, Ruling::allow);
}

// ---- the table in docs/SAFETY.md ---------------------------------------------------------------

struct Column {
  std::string_view name;
  std::size_t caller;
  const Intent& intent;
};

const std::array<Column, 5>& columns() {
  static const std::array<Column, 5> all{{
      {"a movement of a client", 0, a_move},
      {"a setting of a client", 0, a_setting},
      {"a movement of the holder of the lease", 1, a_move},
      {"a movement of the call that leads the axis", 2, a_move},
      {"a movement of the call that searches", 3, a_move},
  }};
  return all;
}

std::string_view word_for(Ruling ruling) {
  switch (ruling) {
    case Ruling::allow: return "";
    case Ruling::ask: return "asked";
    case Ruling::refuse: return "refused";
  }
  return "";
}

std::string cells_of(const std::vector<const State*>& in_it) {
  std::string cells;
  for (const auto& column : columns()) {
    const auto& caller = callers().at(column.caller);
    Case it;
    caller.makes(it);
    bool is_possible = true;
    for (const auto* state : in_it) {
      is_possible = is_possible && tmcld::is_possible(caller, *state);
      state->makes(it);
    }
    cells += fmt::format(" {} |", is_possible ? word_for(it.verdict(column.intent).ruling) : "-");
  }
  return cells;
}

/// Where two states together are judged otherwise than by the stricter of them.
std::string rows_of_pairs() {
  std::string rows;
  for (const auto& one : states()) {
    for (const auto& other : states()) {
      const bool excludes = &one == &other || (one.group != alone && one.group == other.group);
      if (&one > &other || excludes) continue;
      const bool differs = std::ranges::any_of(columns(), [&](const Column& column) {
        const auto& caller = callers().at(column.caller);
        if (!is_possible(caller, one) || !is_possible(caller, other)) return false;
        Case it;
        caller.makes(it);
        one.makes(it);
        other.makes(it);
        return it.verdict(column.intent).ruling !=
               std::max(ruling_of(caller, one, column.intent),
                        ruling_of(caller, other, column.intent));
      });
      if (differs)
        rows += fmt::format("| {}; {} |{}\n", one.name, other.name, cells_of({&one, &other}));
    }
  }
  return rows;
}

constexpr std::string_view table_begin = "| what is known |";

std::string table() {
  std::string drawn(table_begin);
  for (const auto& column : columns()) drawn += fmt::format(" {} |", column.name);
  drawn += "\n| --- | --- | --- | --- | --- | --- |\n";
  for (const auto& state : states())
    drawn += fmt::format("| {} |{}\n", state.name, cells_of({&state}));
  return drawn + rows_of_pairs() + '\n';
}

TEST(Judge, IsDrawnInTheDocumentOfSafety) {
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "SAFETY.md";
  std::ifstream file(path);
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  const auto first = kept.find(table_begin);
  ASSERT_NE(first, std::string::npos);
  const auto behind = kept.find("\n\n", first) + 2;
  const auto drawn = kept.substr(0, first) + table() + kept.substr(behind);
  if (std::getenv("TMCL_DRAW") != nullptr) {
    std::ofstream(path) << drawn;
    return;
  }
  EXPECT_TRUE(kept == drawn) << "docs/SAFETY.md has another table; TMCL_DRAW=1 draws it anew";
}

}  // namespace
}  // namespace tmcld
