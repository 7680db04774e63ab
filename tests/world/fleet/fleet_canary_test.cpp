// What is broken on purpose must be complained of, or the worlds with a broker see nothing.
#include <gmock/gmock.h>

#include <algorithm>
#include <string_view>

#include "world/fleet/fleet_world.hpp"

namespace tmcld::test {
namespace {

struct FleetBreach {
  const char* promise;
  FleetCanary canary;
  std::string_view complaint;
};

constexpr FleetBreach fleet_breaches[] = {
    {"NothingMovesByAnOldConnection", FleetCanary::same_nonce,
     "from before the connection by which it came"},
    {"AStopThatIsReadStops", FleetCanary::deaf_to_stops, "a stop that was read has not gone to"},
    {"NothingTurnsBeyondItsLease", FleetCanary::lease_for_long, "although its lease has ended"},
};

void PrintTo(const FleetBreach& breach, std::ostream* stream) { *stream << breach.promise; }

bool fleet_complains(std::uint64_t seed, const FleetBreach& breach) {
  FleetWorld world(seed, {.canary = breach.canary});
  world.run();
  return std::ranges::any_of(world.complaints(), [&](const std::string& complaint) {
    return complaint.find(breach.complaint) != complaint.npos;
  });
}

class FleetWorldCanary : public testing::TestWithParam<FleetBreach> {};

TEST_P(FleetWorldCanary, IsNoticed) {
  constexpr std::uint64_t most_seeds = 50;
  std::uint64_t seed = 1;
  while (!fleet_complains(seed, GetParam())) ASSERT_LE(++seed, most_seeds);
  RecordProperty("seed", std::to_string(seed));
}

INSTANTIATE_TEST_SUITE_P(Promises, FleetWorldCanary, testing::ValuesIn(fleet_breaches),
                         [](const auto& breach) { return std::string(breach.param.promise); });

}  // namespace
}  // namespace tmcld::test
