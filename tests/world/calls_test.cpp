// Clients that call at random, and die, while replies get lost and late and supplies of modules
// fail: what moves was asked for, a stop is a stop, nothing moves on for a client that has gone,
// and a run can be repeated exactly.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/cells.hpp"
#include "world/world.hpp"

namespace tmcld::test {
namespace {

constexpr int usual_runs = 100;
// Every so many runs one is repeated.
constexpr int repeat_every = 10;

/// In each second world replies only get lost: then no value may be told wrongly. In each third the
/// gateway stands still now and then.
Trouble trouble_of(std::uint64_t seed) {
  if (const char* given = std::getenv("TMCL_WORLD")) return trouble_from(given);
  Trouble trouble{
      .faults = {.lost = 20}, .gaps = seed % 3 == 0, .raw = seed % 4 != 0, .doors = seed % 5 != 0};
  trouble.programs = seed % 7 < 3;
  if (seed % 2 == 0) trouble.faults = {.lost = 20, .late = 20, .doubled = 10};
  return trouble;
}

std::string command_for(std::uint64_t seed, const Trouble& trouble) {
  return "TMCL_ROUNDS=1 TMCL_SEED=" + std::to_string(seed) + " TMCL_WORLD=" + to_text(trouble) +
         " build/release/bin/world_tests --gtest_filter=WorldCalls.MoveWhat*";
}

bool fails(std::uint64_t seed, const Trouble& trouble) {
  World world(seed, trouble);
  world.run();
  return !world.complaints().empty();
}

/// For whoever counts seeds: see tests/world/seeds.
void note_failure(std::uint64_t seed) {
  const char* file = std::getenv("TMCL_FAILED_SEEDS");
  if (file != nullptr) std::ofstream(file, std::ios::app) << seed << '\n';
}

TEST(WorldCalls, MoveWhatWasAskedForAndNothingAfterAStop) {
  std::size_t requests = 0, movements = 0, done_for_hosts = 0, programs = 0, unattended = 0;
  tmcl::Duration lasted{};
  const int runs = tmcl::test::rounds(usual_runs);
  for (int run = 0; run < runs && !HasFailure(); ++run) {
    const auto seed = tmcl::test::seed() + static_cast<std::uint64_t>(run);
    const auto trouble = trouble_of(seed);
    World world(seed, trouble);
    const auto began = world.now();
    world.run();
    const auto complaints = world.complaints();
    lasted += world.now() - began;
    requests += world.requests();
    movements += world.ledger().movements();
    done_for_hosts += world.done_for_hosts();
    programs += world.programs_run();
    unattended += world.unattended();
    if (!complaints.empty()) {
      note_failure(seed);
      const auto least = shrunk(trouble, [&](const auto& less) { return fails(seed, less); });
      ADD_FAILURE() << testing::PrintToString(complaints) << "\nreplay with\n  "
                    << command_for(seed, trouble) << "\nand with as little as makes it fail\n  "
                    << command_for(seed, least);
    }
    if (run % repeat_every != 0) continue;
    World again(seed, trouble);
    again.run();
    EXPECT_EQ(again.trace(), world.trace())
        << "the same seed gave another run: " << command_for(seed, trouble);
  }
  std::cout << runs << " runs: " << requests << " requests on the wires, " << movements
            << " movements, " << done_for_hosts << " requests done for hosts at ports, " << programs
            << " programs run in modules, and " << unattended << " looks at axes that one turned, "
            << std::chrono::duration_cast<std::chrono::seconds>(lasted).count()
            << " s of virtual time\n";
  EXPECT_GT(cell_count().judgements(), 0U)
      << "judge() is asked past the count: a source that asks it is joined with its own";
  if (std::getenv("TMCL_CELLS") != nullptr) cell_count().print(std::cout);
}

struct KnownWorld {
  std::uint64_t seed;
  const char* trouble;
};

class OnceFailed : public testing::TestWithParam<KnownWorld> {};

TEST_P(OnceFailed, NowRunsWithoutAComplaint) {
  World world(GetParam().seed, trouble_from(GetParam().trouble));
  world.run();
  EXPECT_THAT(world.complaints(), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, OnceFailed,
    testing::Values(
        // A movement that waited for its turn while the gateway stood still went out after that.
        KnownWorld{880371, "20,0,0,0,0,4,14,0,1"},
        // A search whose module started again was said not to have been sent.
        KnownWorld{3434676156, "20,20,10,1,1,4,32,0,1"},
        // A deadman was thought to be off: a late answer to something else came after setting it.
        KnownWorld{202796, "20,20,0,0,0,2,9,0,0"},
        // A module had started again, and a late answer from before that said it had not.
        KnownWorld{307012, "20,20,10,1,1,4,39,0,0"},
        // The same of a module that is watched by a target: a late answer to another question.
        KnownWorld{4850, "20,20,10,1,1,4,31,0,0,1"},
        // A program that was never started left its module unwatched.
        KnownWorld{2200, "20,20,10,0,1,4,23,0,0,0,0,1"}));

TEST(WorldTrouble, IsShrunkToWhatMakesAWorldFail) {
  const auto fails_by_late_replies = [](const Trouble& trouble) {
    return trouble.faults.late > 0 && trouble.calls >= 7;
  };
  const Trouble all{.faults = {.lost = 20, .late = 20, .doubled = 10}};
  EXPECT_EQ(to_text(shrunk(all, fails_by_late_replies)), "0,20,0,0,0,1,7,0,0");
  EXPECT_EQ(to_text(trouble_from(to_text(all))), to_text(all));
}

}  // namespace
}  // namespace tmcld::test
