// Somebody must be seen to break each promise, or nobody looks.
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "world/world.hpp"

namespace tmcld::test {
namespace {

struct Breach {
  const char* promise;
  Canary canary;
  std::string_view complaint;  ///< What the observer says.
};

constexpr Breach breaches[] = {
    {"AValueBelongsToItsQuestion", Canary::forged_fences, ""},
    {"NothingMovesThatNobodyHasAskedFor", Canary::foreign_movement, "no call has asked for it"},
    {"NothingMovesAfterAStop", Canary::movement_after_stop, "no call has asked for it since its"},
    {"NoAnswerIsAnothers", Canary::swapped_value, "told what the module did not"},
    {"WhatIsDoneWasExecuted", Canary::unheard_movement, "its module has not executed it"},
    {"NothingIsSentTwice", Canary::doubled_movement, "no call has asked for it"},
    {"WhatIsNotSentWasNot", Canary::wrong_outcome, "was sent, but said to be not"},
    {"WhatNobodyOwnsStands", Canary::owner_not_missed, "although its owner is gone"},
    {"WhatAHostHasLeftStands", Canary::host_not_missed, "although its owner is gone"},
    {"NothingIsSentBeyondItsLimits", Canary::no_limits, "is sent beyond its soft limit"},
    {"AStopThatIsDoneWasExecuted", Canary::unheard_stop, "its module has not executed it"},
    {"WhatAProgramMovesIsToldToBeUnattended", Canary::program_not_told, "is unattended"},
    {"AStopOfAllEndsPrograms", Canary::program_not_ended, "goes on after system.stop_all"},
    {"EverybodyGetsAnAnswer", Canary::no_answer, "a call has no end"},
};

void PrintTo(const Breach& breach, std::ostream* stream) { *stream << breach.promise; }

Trouble trouble_with(Canary canary) {
  Trouble trouble{.faults = {.lost = 20}, .deaths = false, .supplies = false, .canary = canary};
  if (canary == Canary::forged_fences || canary == Canary::none)
    trouble.faults = {.late = rarely_late};
  trouble.doors = canary == Canary::host_not_missed;
  trouble.programs = canary == Canary::program_not_told || canary == Canary::program_not_ended;
  return trouble;
}

bool complains(std::uint64_t seed, const Trouble& trouble, std::string_view text) {
  World world(seed, trouble);
  world.run();
  return std::ranges::any_of(world.complaints(), [&](const std::string& complaint) {
    return complaint.find(text) != std::string::npos;
  });
}

class WorldCanary : public testing::TestWithParam<Breach> {};

TEST_P(WorldCanary, IsNoticed) {
  constexpr std::uint64_t most_seeds = 100;
  auto trouble = trouble_with(GetParam().canary);
  std::uint64_t seed = 1;
  while (!complains(seed, trouble, GetParam().complaint))
    ASSERT_LE(++seed, most_seeds) << "nobody has noticed: " << to_text(trouble);
  RecordProperty("seed", static_cast<int>(seed));
  trouble.canary = Canary::none;
  EXPECT_FALSE(complains(seed, trouble, "")) << "seed " << seed << ", " << to_text(trouble);
}

INSTANTIATE_TEST_SUITE_P(Promises, WorldCanary, testing::ValuesIn(breaches),
                         [](const auto& breach) { return breach.param.promise; });

}  // namespace
}  // namespace tmcld::test
