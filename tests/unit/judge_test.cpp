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

#include "gateway/authority/judge.hpp"
#include "support/build_paths.hpp"
#include "support/judged_cells.hpp"
#include "tmcl/address.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld {
namespace {

using test::all_intents;
using test::Asker;
using test::caller_of;
using test::callers;
using test::Group;
using test::is_possible;
using test::kind_of;
using test::KindOfCaller;
using test::Known;
using test::KnownState;
using test::states;
using tmcl::Command;
using tmcl::Intent;
using tmcl::Request;
using Case = test::JudgedCase;

Intent of(Command command, std::uint8_t type, std::int32_t value = 1) {
  return intent_of(Request{tmcl::ModuleAddress{1}, command, type, 0, value});
}

const Intent a_move = of(Command::MVP, 0);
const Intent a_setting = of(Command::SAP, 5);

/// Calls `does` for each combination of states that a caller can meet, with the states in it.
void for_each_combination(const KindOfCaller& caller,
                          const std::function<void(const Case&, const std::vector<int>&)>& does) {
  Case bare;
  caller.makes(bare);
  std::vector<int> in_it;
  const std::function<void(std::size_t, const Case&)> go_on = [&](std::size_t next,
                                                                  const Case& it) {
    if (next == states().size()) return does(it, in_it);
    const auto& state = states()[next];
    go_on(next + 1, it);
    const bool excluded = state.group != Group::alone && std::ranges::any_of(in_it, [&](int one) {
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

Ruling ruling_of(const KindOfCaller& caller, const KnownState& state, const Intent& intent) {
  Case it;
  caller.makes(it);
  state.makes(it);
  return it.verdict(intent).ruling;
}

/// The search of another call may have ended unseen, and have found the reference: the module is
/// asked before that is missed.
bool may_be_found(const Case& it, const KnownState& state) {
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

/// What docs/SAFETY.md says becomes of a command of which nothing else is known.
Ruling ruling_by_document(Asker caller, Known known, const Intent& intent) {
  const bool moves = intent.effect == tmcl::Effect::moves;
  const bool leads = caller == Asker::leader;
  const bool has_lease = caller == Asker::holder;
  const bool has_call = caller != Asker::gateway;
  const auto if_so = [](bool so, Ruling ruling) { return so ? ruling : Ruling::allow; };
  if (intent.effect == tmcl::Effect::reads || is_stop(intent)) return Ruling::allow;
  if (moves && !has_call) return Ruling::refuse;
  switch (known) {
    case Known::claimed:
    case Known::stop_uncertain:
    case Known::daemon_ends:
    case Known::stopped_since:
    case Known::stale:
    case Known::stands_still: return if_so(moves, Ruling::refuse);
    case Known::claimed_by_line:
    case Known::claimed_by_search:
    case Known::stop_owed: return if_so(moves, Ruling::ask);
    case Known::latched: {
      const bool restarts = intent.motion == tmcl::Motion::restarts;
      return if_so(moves && !restarts && caller != Asker::searcher, Ruling::refuse);
    }
    case Known::leased_to_other:
    case Known::lease_lost: return if_so(has_call && !leads, Ruling::refuse);
    case Known::client_gone: return if_so(moves && !leads, Ruling::refuse);
    case Known::needs_lease: return if_so(moves && !leads && !has_lease, Ruling::refuse);
    case Known::misses_reference: {
      const bool names_position =
          intent.motion == tmcl::Motion::to_position || intent.motion == tmcl::Motion::to_target;
      return if_so(moves && names_position, Ruling::refuse);
    }
    case Known::turns_for_other: return if_so(has_call && !leads && !has_lease, Ruling::ask);
    case Known::turns_for_this: return Ruling::allow;
    case Known::coordinates_held: return if_so(intent.changes_coordinates, Ruling::ask);
  }
  return Ruling::refuse;
}

TEST(Judge, RulesInEachCellAsTheDocumentSays) {
  std::size_t cells = 0;
  for (std::size_t caller = 0; caller < callers().size(); ++caller) {
    for (const auto& state : states()) {
      if (!is_possible(callers().at(caller), state)) continue;
      Case it;
      callers().at(caller).makes(it);
      state.makes(it);
      for (const auto& intent : all_intents()) {
        ++cells;
        EXPECT_EQ(it.verdict(intent).ruling,
                  ruling_by_document(static_cast<Asker>(caller), state.known, intent))
            << test::name_of(kind_of(intent)) << ", by " << callers().at(caller).name << ": "
            << state.name;
      }
    }
  }
  EXPECT_GT(cells, 1000U);
}

/// The worlds count cells by it.
TEST(Judge, ACellIsTakenForWhatItIs) {
  for (std::size_t caller = 0; caller < callers().size(); ++caller) {
    for (const auto& state : states()) {
      if (!is_possible(callers().at(caller), state)) continue;
      Case it;
      callers().at(caller).makes(it);
      state.makes(it);
      EXPECT_TRUE(state.holds(it)) << state.name;
      EXPECT_EQ(caller_of(it), static_cast<Asker>(caller)) << state.name;
    }
  }
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

std::string cells_of(const std::vector<const KnownState*>& in_it) {
  std::string cells;
  for (const auto& column : columns()) {
    const auto& caller = callers().at(column.caller);
    Case it;
    caller.makes(it);
    bool is_possible = true;
    for (const auto* state : in_it) {
      is_possible = is_possible && test::is_possible(caller, *state);
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
      const bool excludes =
          &one == &other || (one.group != Group::alone && one.group == other.group);
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
