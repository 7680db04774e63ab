// Lines: the note's figures, axes that stay, and wishes that make no line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcl::plan {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Seconds = std::chrono::duration<double>;

tl::expected<Line, LineError> plan(const std::vector<LineAxis>& axes,
                                   const ExchangeTimes& exchanges = {}) {
  return plan_line(axes, exchanges);
}

LineAxis axis(std::int32_t target, double velocity, double acceleration,
              const char* model = "TMCM-6212") {
  auto twin = *AxisTwin::of(*find_model(model));
  twin.place({0});
  return {twin, {target}, {velocity}, {acceleration}};
}

std::int32_t value(const AxisOfLine& axis, std::uint8_t parameter) {
  const auto found = std::ranges::find(axis.settings, parameter, &Setting::parameter);
  return found == axis.settings.end() ? -1 : found->value;
}

// AN-035, equation 1.
TEST(Line, GivesEachAxisItsPartOfTheLongestWay) {
  const auto line = plan({axis(40'000, 50'000, 200'000), axis(-10'000, 50'000, 200'000),
                          axis(2'500, 50'000, 200'000)});
  ASSERT_TRUE(line);
  EXPECT_NEAR(value(line->axes[0], 4), 50'000, 1);
  EXPECT_NEAR(value(line->axes[1], 4), 12'500, 12'500 * 0.02);
  EXPECT_NEAR(value(line->axes[2], 4), 3'125, 3'125 * 0.02);
  EXPECT_NEAR(value(line->axes[1], 5), 50'000, 50'000 * 0.15);
  EXPECT_NEAR(value(line->axes[2], 17), 12'500, 12'500 * 0.15);
  EXPECT_NEAR(Seconds(line->duration).count(), 1.05, 0.005);
  EXPECT_LT(line->spread, std::chrono::milliseconds(1));
}

TEST(Line, TakesItsWaysFromWhereTheAxesStand) {
  const auto from_zero = plan({axis(40'000, 50'000, 200'000), axis(-10'000, 50'000, 200'000)});
  std::vector<LineAxis> elsewhere{axis(40'000 + 70'000, 50'000, 200'000),
                                  axis(-10'000 - 3'000, 50'000, 200'000)};
  elsewhere[0].twin.place({70'000});
  elsewhere[1].twin.place({-3'000});
  const auto line = plan(elsewhere);
  ASSERT_TRUE(from_zero && line);
  EXPECT_EQ(line->duration, from_zero->duration);
  for (std::size_t i = 0; i < elsewhere.size(); ++i)
    EXPECT_EQ(line->axes[i].settings, from_zero->axes[i].settings) << i;
}

TEST(Line, TheSlowestAxisRules) {
  const auto line = plan(
      {axis(40'000, 50'000, 200'000), axis(-10'000, 5'000, 200'000), axis(2'500, 50'000, 2'000)});
  ASSERT_TRUE(line);
  EXPECT_NEAR(Seconds(line->duration).count(), 2.625, 0.01);
}

TEST(Line, TakesAsLongAsItIsAskedTo) {
  const std::vector<LineAxis> axes{axis(40'000, 50'000, 200'000), axis(-10'000, 50'000, 200'000)};
  const auto line = plan_line(axes, {}, std::chrono::seconds(3));
  ASSERT_TRUE(line);
  EXPECT_NEAR(Seconds(line->duration).count(), 3, 0.001);
  EXPECT_LT(line->spread, std::chrono::milliseconds(1));
  const auto too_short = plan_line(axes, {}, std::chrono::milliseconds(900));
  EXPECT_THAT(too_short.error().message,
              HasSubstr("after 0.9 s; the shortest time possible is 1.0"));
}

// An acceleration of less than one unit of the register is none: the axis goes to its target at its
// start velocity, but a stop on the way would never end.
TEST(Line, LeavesEachAxisAnAccelerationThatCanStopIt) {
  auto slow = axis(-100, 50'000, 50'000, "TMCM-1240");
  ASSERT_TRUE(slow.twin.set({number_of("stop_velocity"), 100}));
  ASSERT_TRUE(slow.twin.set({number_of(Family::sixpoint, "start_velocity"), 100}));
  for (const auto longest : {4'000, 8'000, 20'000, 60'000, 200'000}) {
    const auto line = plan({slow, axis(longest, 50'000, 10'000, "TMCM-1240")});
    if (!line) continue;
    auto twin = slow.twin;
    ASSERT_TRUE(twin.set(line->axes[0].settings));
    twin.move_to(slow.target);
    twin.advance(std::chrono::milliseconds(100));
    ASSERT_NE(twin.motion().velocity.value, 0) << longest;
    twin.stop();
    twin.advance(std::chrono::seconds(10));
    EXPECT_EQ(twin.motion().velocity.value, 0) << longest;
  }
}

TEST(Line, AnAxisThatIsThereAlreadyStays) {
  const auto line = plan({axis(0, 50'000, 200'000), axis(10'000, 50'000, 200'000)});
  ASSERT_TRUE(line);
  EXPECT_THAT(line->order, ElementsAre(1));
  EXPECT_THAT(line->axes[0].settings, IsEmpty());
  EXPECT_THAT(plan({axis(0, 1, 1)})->order, IsEmpty());
}

TEST(Line, TheSlowestStartsFirstAndNobodyWaitsForALateStart) {
  const ExchangeTimes starts{std::chrono::milliseconds(2)};
  const auto line = plan(
      {axis(2'500, 50'000, 1'500'000, "TMCM-6110"), axis(40'000, 50'000, 1'500'000, "TMCM-6110"),
       axis(-10'000, 50'000, 1'500'000, "TMCM-6110")},
      starts);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->axes[line->order[1]].start, starts[0]);
  EXPECT_EQ(line->axes[line->order[2]].start, 2 * starts[0]);
  EXPECT_LT(line->spread, std::chrono::milliseconds(9));
}

TEST(Line, StartsGoOutOnAllBusesAtTheSameTimeAndOneAfterTheOtherOnEach) {
  using namespace std::chrono_literals;
  const std::vector<std::size_t> buses{0, 1, 0, 1};
  EXPECT_THAT(start_times(buses, {2ms, 10ms}), ElementsAre(0ms, 4ms, 2ms, 14ms));
  EXPECT_THAT(start_times(buses, {2ms}), ElementsAre(1ms, 0ms, 3ms, 0ms));
  EXPECT_THAT(start_times(buses, {}), ElementsAre(0ms, 0ms, 0ms, 0ms));
  EXPECT_THAT(start_times({}, {2ms}), IsEmpty());
}

TEST(Line, ASlowTmc429GetsOtherDividersBeforeItsSpeed) {
  const auto line =
      plan({axis(100'000, 50'000, 200'000, "TMCM-6110"), axis(25, 50'000, 200'000, "TMCM-6110")});
  ASSERT_TRUE(line) << line.error().message;
  EXPECT_EQ(value(line->axes[0], 154), -1) << "the longest way keeps its own";
  const auto& slow = line->axes[1];
  EXPECT_EQ(slow.settings[0].parameter, 154);
  EXPECT_EQ(slow.settings[1].parameter, 153);
  EXPECT_GT(slow.settings[0].value, 2);
  EXPECT_GE(value(slow, 5), 64);
  EXPECT_LT(line->spread, std::chrono::milliseconds(2));
}

// Its speed is 5.2 in the register of the dividers that it has, and 5 is 4 % too slow.
TEST(Line, ACoarseTmc429DoesNotHoldUpTheOthers) {
  const auto line = plan({axis(-480'000, 17'067, 1'800'000, "TMCM-6110"),
                          axis(9'000, 17'067, 1'800'000, "TMCM-6110")});
  ASSERT_TRUE(line);
  EXPECT_LT(line->spread, std::chrono::milliseconds(2));
  EXPECT_NEAR(Seconds(line->duration).count(), 28.13, 0.15);
}

TEST(Line, SaysWhoseFaultItIsThatThereIsNone) {
  const auto fault = [](const std::vector<LineAxis>& axes) { return plan(axes).error(); };
  EXPECT_THAT(fault({}).message, HasSubstr("1 to 16 axes"));
  EXPECT_EQ(fault({axis(1, 1, 1), axis(1, 0, 1)}).axis, 1U);
  EXPECT_THAT(fault({axis(1, 1, -1)}).message, HasSubstr("acceleration must be greater than 0"));
  EXPECT_THAT(fault({axis(1, std::nan(""), 1)}).message, HasSubstr("velocity must be"));
  auto moving = axis(1000, 1000, 1000);
  moving.twin.rotate({500});
  moving.twin.advance(std::chrono::seconds(1));
  EXPECT_THAT(fault({moving}).message, HasSubstr("it moves"));
  const auto slow =
      fault({axis(8'000'000, 50'000, 200'000, "TMCM-6110"), axis(1, 50'000, 200'000, "TMCM-6110")});
  EXPECT_EQ(slow.axis, 1U);
  EXPECT_THAT(slow.message, HasSubstr("too slow for its registers"));
}

}  // namespace
}  // namespace tmcl::plan
