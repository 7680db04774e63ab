// Clients that call at random, and die, while replies get lost and late: what moves was asked for,
// a stop is a stop, nothing turns for a client that has gone, and a run can be repeated exactly.
#include <gmock/gmock.h>

#include <chrono>
#include <iostream>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/world.hpp"

namespace tmcld::test {
namespace {

constexpr Faults bad_line{.lost = 20, .late = 20, .doubled = 10};
constexpr int usual_runs = 100;
// Every so many runs one is repeated.
constexpr int repeat_every = 10;

std::uint64_t seed_of(int run) { return tmcl::test::seed() + static_cast<std::uint64_t>(run); }

TEST(WorldCalls, MoveWhatWasAskedForAndNothingAfterAStop) {
  std::size_t requests = 0, movements = 0;
  tmcl::Duration lasted{};
  const int runs = tmcl::test::rounds(usual_runs);
  for (int run = 0; run < runs && !HasFailure(); ++run) {
    SCOPED_TRACE("replay with TMCL_ROUNDS=1 TMCL_SEED=" + std::to_string(seed_of(run)));
    World world(seed_of(run), bad_line);
    const auto began = world.now();
    world.run();
    lasted += world.now() - began;
    EXPECT_TRUE(world.all_ended()) << "a call has no end";
    EXPECT_TRUE(world.journeys_ended()) << "a line has no end";
    EXPECT_THAT(world.turning(), testing::IsEmpty()) << "although nobody is there";
    EXPECT_THAT(world.ledger().complaints(), testing::IsEmpty());
    requests += world.requests();
    movements += world.ledger().movements();
    if (run % repeat_every != 0) continue;
    World again(seed_of(run), bad_line);
    again.run();
    EXPECT_EQ(again.trace(), world.trace()) << "the same seed gave another run";
  }
  std::cout << runs << " runs of " << World::clients * World::calls_of_each
            << " calls: " << requests << " requests on the wires, " << movements << " movements, "
            << std::chrono::duration_cast<std::chrono::seconds>(lasted).count()
            << " s of virtual time\n";
}

}  // namespace
}  // namespace tmcld::test
