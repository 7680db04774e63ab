#include "gateway/journey/planning_budget.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace tmcld {
namespace {

using testing::HasSubstr;

constexpr std::size_t megabyte = std::size_t{1} << 20;

class Planning : public testing::Test {
 protected:
  Planning() { budget.set_limit(8 * megabyte); }
  auto take(std::uint64_t client, std::size_t megabytes = 1) {
    return budget.take(client, "client " + std::to_string(client), megabytes * megabyte);
  }

  PlanningBudget budget;
};

TEST_F(Planning, OfOneClientTakesHalfOfTheMemory) {
  std::vector<PlanningBudget::Place> held;
  for (int i = 0; i < 4; ++i) held.push_back(take(1).value());
  const auto refused = take(1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, tmcl::Errc::queue_full);
  EXPECT_EQ(refused.error().outcome, tmcl::Outcome::not_sent);
  EXPECT_THAT(refused.error().message, HasSubstr("plans of client 1 wait"));
  EXPECT_THAT(refused.error().message, HasSubstr("4 of 4 MB"));
  EXPECT_TRUE(take(2)) << "others have room";
  held.pop_back();
  EXPECT_TRUE(take(1)) << "it is given back";
}

TEST_F(Planning, OfAllTakesNoMoreThanThereIs) {
  std::vector<PlanningBudget::Place> held;
  for (std::uint64_t client = 1; client <= 8; ++client) held.push_back(take(client).value());
  const auto refused = take(9);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("plans of several clients wait"));
  held.clear();
  EXPECT_TRUE(take(9));
}

TEST_F(Planning, OfWhatIsAloneAlwaysFindsRoom) {
  const auto large = take(1, 100);
  EXPECT_TRUE(large);
  EXPECT_FALSE(take(1));
  EXPECT_FALSE(take(2));
}

TEST_F(Planning, MayOutliveItsBudget) {
  auto other = std::make_unique<PlanningBudget>();
  const auto place = other->take(1, "client 1", megabyte);
  other.reset();
  EXPECT_TRUE(place);
}

}  // namespace
}  // namespace tmcld
