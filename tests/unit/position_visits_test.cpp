// The positions of a scan, its file, and what it says of an axis.
#include <gmock/gmock.h>

#include "axis/position_visits.hpp"

namespace tmclctl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::int32_t> indices(const std::vector<Visit>& visits) {
  std::vector<std::int32_t> all;
  for (const auto& visit : visits) all.push_back(visit.index);
  return all;
}

TEST(PositionVisits, GoFromTheFirstToTheLastAgainAndAgain) {
  EXPECT_THAT(indices(visits_of(3, 2, false)), ElementsAre(0, 1, 2, 0, 1, 2));
  EXPECT_EQ(visits_of(3, 2, false).back(), (Visit{2, 2}));
}

TEST(PositionVisits, BothWaysNoneIsVisitedTwiceWithoutAMovement) {
  EXPECT_THAT(indices(visits_of(3, 2, true)), ElementsAre(0, 1, 2, 1, 0, 1, 2, 1, 0));
}

std::vector<Reached> of_a_slack_screw() {
  return {{{1, 0}, Approach::none, 0, 0},    {{1, 1}, Approach::up, 1, 0.99},
          {{1, 2}, Approach::up, 2, 1.98},   {{1, 1}, Approach::down, 1, 1.05},
          {{1, 0}, Approach::down, 0, 0.06}, {{2, 1}, Approach::up, 1, 1.01},
          {{2, 2}, Approach::up, 2, 2.0},    {{2, 1}, Approach::down, 1, 1.07},
          {{2, 0}, Approach::down, 0, 0.06}};
}

TEST(PositionVisits, SaysHowWellAPositionIsReachedAgain) {
  const auto found = statistics_of(of_a_slack_screw());
  ASSERT_EQ(found.positions.size(), 3U);
  const auto& middle = found.positions[1];
  EXPECT_EQ(middle.count, 4U);
  EXPECT_EQ(middle.target, 1);
  EXPECT_NEAR(middle.mean_deviation, 0.03, 1e-9);
  EXPECT_NEAR(middle.spread, 0.02, 1e-9) << "from one side";
  EXPECT_NEAR(middle.backlash.value(), 0.06, 1e-9);
  EXPECT_FALSE(found.positions[2].backlash) << "never reached from above";
  EXPECT_FALSE(found.positions[0].backlash) << "never reached from below";
  EXPECT_NEAR(found.repeatability, 0.02, 1e-9);
  EXPECT_NEAR(found.backlash.value(), 0.06, 1e-9);
}

TEST(PositionVisits, ThatNoneWasMadeSaysNothing) {
  const auto nothing = statistics_of(std::vector<Reached>{});
  EXPECT_TRUE(nothing.positions.empty());
  EXPECT_FALSE(nothing.backlash);
}

class ScanFiles : public testing::Test {
 protected:
  tl::expected<ScanFile, std::string> read(const std::string& text) const {
    return read_scan(text, about, columns, visits);
  }
  static std::string row(const Reached& reached) {
    return scan_row(reached, {"2026-01-01T00:00:00.000000Z", 100, 99, -7});
  }

  std::vector<Visit> visits = visits_of(3, 1, false);
  std::string about = "# scan of x\n";
  std::string columns = scan_columns("mm");
  std::string begin = "# tmclctl\n" + about + columns;
};

TEST_F(ScanFiles, RowsAreReadAsTheyWereWritten) {
  const Reached first{{1, 0}, Approach::none, 0.1, 0.10025};
  const auto text = begin + row(first);
  EXPECT_THAT(text, HasSubstr("Z,1,0,none,100,99,-7,0.1,0.10025,0.00025\n"));
  const auto file = read(text);
  ASSERT_TRUE(file) << file.error();
  ASSERT_EQ(file->visits.size(), 1U);
  EXPECT_EQ(file->visits[0].visit, first.visit);
  EXPECT_EQ(file->visits[0].approach, Approach::none);
  EXPECT_EQ(file->visits[0].reached, 0.10025);
  EXPECT_EQ(file->bytes, text.size());
}

TEST_F(ScanFiles, AHalfLineIsWrittenAnew) {
  const auto whole = begin + row({{1, 0}, Approach::up, 0, 0}) + "# resumed\n";
  const auto file = read(whole + "2026-01-01T00:00:00Z,1,1,u");
  ASSERT_TRUE(file);
  EXPECT_EQ(file->visits.size(), 1U);
  EXPECT_EQ(file->bytes, whole.size());
  EXPECT_EQ(read("# tmcl")->bytes, 0U) << "it has hardly begun";
}

TEST_F(ScanFiles, AnotherScanIsNotGoneOnWith) {
  EXPECT_FALSE(read("# scan of y\n" + columns));
  EXPECT_FALSE(read(about + scan_columns("deg")));
  EXPECT_FALSE(read(begin + row({{1, 1}, Approach::up, 0, 0})));
  EXPECT_FALSE(read(begin + "1,2,3\n"));
  EXPECT_THAT(read(begin + row({{1, 0}, Approach::up, 0, 0}) + "\n").error(), HasSubstr("row 2"));
}

}  // namespace
}  // namespace tmclctl
