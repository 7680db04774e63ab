// Users on a broker who call well, carelessly and with bad intent, while connections, the broker
// and the gateway fail: nothing moves late, twice or without end, and a stop that is read is one.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/fleet/fleet_world.hpp"

namespace tmcld::test {
namespace {

constexpr int usual_runs = 50;

/// One in ten has no faults: there it shows what a fault excuses.
FleetTrouble fleet_trouble_of(std::uint64_t seed) { return {.faults = seed % 10 != 0}; }

void note_failed_seed(std::uint64_t seed) {
  const char* file = std::getenv("TMCL_FAILED_SEEDS");
  if (file != nullptr) std::ofstream(file, std::ios::app) << seed << '\n';
}

TEST(FleetCalls, MoveWhatIsWantedNow) {
  FleetCells cells;
  std::size_t movements = 0, answered = 0, requests = 0;
  tmcl::Duration oldest{}, lasted{};
  const int runs = tmcl::test::rounds(usual_runs);
  for (int run = 0; run < runs && !HasFailure(); ++run) {
    const auto seed = tmcl::test::seed() + static_cast<std::uint64_t>(run);
    const auto trouble = fleet_trouble_of(seed);
    FleetWorld world(seed, trouble);
    const auto began = world.now();
    world.run();
    lasted += world.now() - began;
    movements += world.ledger().movements();
    answered += world.answered();
    requests += world.requests();
    oldest = std::max(oldest, world.ledger().oldest());
    cells.add(world.cells());
    if (!world.complaints().empty()) {
      note_failed_seed(seed);
      ADD_FAILURE() << "seed " << seed << ": " << world.complaints().front()
                    << "\nreplay with\n  TMCL_ROUNDS=1 TMCL_SEED=" << seed
                    << " build/release/bin/fleet_world_tests --gtest_filter=FleetCalls.Move*";
    }
  }
  using std::chrono::duration_cast;
  std::cout << runs << " runs: " << movements << " movements, the latest "
            << duration_cast<std::chrono::milliseconds>(oldest).count()
            << " ms after its call was published, " << answered << " answers, " << requests
            << " requests on the wires, " << duration_cast<std::chrono::seconds>(lasted).count()
            << " s of virtual time, " << cells.never() << " cells never reached\n";
  if (std::getenv("TMCL_CELLS") != nullptr) cells.print(std::cout);
}

TEST(FleetCalls, GoTheSameWayWithTheSameSeed) {
  constexpr std::uint64_t seeds = 5;
  for (auto seed = tmcl::test::seed(); seed < tmcl::test::seed() + seeds; ++seed) {
    FleetWorld first(seed, fleet_trouble_of(seed));
    first.run();
    FleetWorld again(seed, fleet_trouble_of(seed));
    again.run();
    EXPECT_EQ(again.trace(), first.trace()) << seed;
  }
}

}  // namespace
}  // namespace tmcld::test
