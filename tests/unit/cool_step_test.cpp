// coolStep, reading by reading: thresholds in units of 32, steps as the data sheets code them.
#include "sim/module/cool_step.hpp"

#include <gtest/gtest.h>

namespace tmcl::sim {
namespace {

constexpr std::int32_t run_scale = 31;
// Up below 64, down from 64 + 32 * (1 + 1) = 128 on.
constexpr CoolStepSettings settings{.down_step = 3, .hysteresis = 1, .hysteresis_start = 2};

struct Driver {
  CoolStepSettings settings;
  CoolStep cool_step{};
  std::int32_t scale() const { return cool_step.scale(run_scale, settings); }
  std::int32_t after(int readings, std::int32_t load_value) {
    for (int i = 0; i < readings; ++i) cool_step.take(load_value, run_scale, settings);
    return scale();
  }
};

TEST(CoolStep, BeginsWithTheCurrentThatIsSet) {
  EXPECT_EQ(CoolStep().scale(run_scale, settings), run_scale);
  EXPECT_EQ(CoolStep().scale(5, settings), 5);
}

TEST(CoolStep, GoesDownFromTheUpperThresholdOn) {
  Driver driver{settings};
  EXPECT_EQ(driver.after(1, 127), 31);
  EXPECT_EQ(driver.after(1, 128), 30);
  EXPECT_EQ(driver.after(3, 1023), 27);
}

TEST(CoolStep, GoesUpBelowTheLowerThreshold) {
  Driver driver{settings};
  ASSERT_EQ(driver.after(10, 500), 21);
  EXPECT_EQ(driver.after(5, 64), 21);
  EXPECT_EQ(driver.after(1, 63), 22);
  EXPECT_EQ(driver.after(1, 0), 23);
}

TEST(CoolStep, GoesDownToAHalfOrAQuarterAndUpToWhatIsSet) {
  Driver half{settings};
  EXPECT_EQ(half.after(100, 1000), 15);
  EXPECT_EQ(half.after(100, 0), run_scale);
  Driver quarter{settings};
  quarter.settings.minimum = 1;
  EXPECT_EQ(quarter.after(100, 1000), 7);
}

TEST(CoolStep, GoesUpByOneTwoFourOrEight) {
  const int increments[] = {1, 2, 4, 8};
  for (std::int32_t code = 0; code < 4; ++code) {
    Driver driver{settings};
    driver.settings.up_step = code;
    ASSERT_EQ(driver.after(16, 500), 15);
    EXPECT_EQ(driver.after(1, 0), 15 + increments[code]);
  }
}

TEST(CoolStep, GoesDownAfter32Or8Or2ReadingsOr1) {
  const int readings[] = {32, 8, 2, 1};
  for (std::int32_t code = 0; code < 4; ++code) {
    Driver driver{settings};
    driver.settings.down_step = code;
    EXPECT_EQ(driver.after(readings[code] - 1, 500), 31);
    EXPECT_EQ(driver.after(1, 500), 30);
    EXPECT_EQ(driver.after(readings[code], 500), 29);
  }
}

TEST(CoolStep, ALowReadingBeginsToCountAnew) {
  Driver driver{settings};
  driver.settings.down_step = 2;
  EXPECT_EQ(driver.after(1, 500), 31);
  EXPECT_EQ(driver.after(1, 100), 31);
  EXPECT_EQ(driver.after(1, 500), 31);
  EXPECT_EQ(driver.after(1, 500), 30);
}

TEST(CoolStep, ANewSettingBindsIt) {
  Driver driver{settings};
  ASSERT_EQ(driver.after(100, 1000), 15);
  EXPECT_EQ(driver.cool_step.scale(8, settings), 8);
  driver.cool_step.reset();
  EXPECT_EQ(driver.scale(), run_scale);
}

}  // namespace
}  // namespace tmcl::sim
