// Random lines of six axes of one module: how well they arrive together, and stay on the line.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcl::plan {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr int lines = 200;
constexpr std::size_t axes_of_a_line = 6;
constexpr std::int64_t greatest_ratio = 20;

// The ways of a line: the longest is the first one's, the others down to a twentieth of it.
std::vector<std::int32_t> ways(tmcl::test::Random<>& random, std::int64_t from, std::int64_t to) {
  std::vector<std::int32_t> ways;
  const auto longest = random.between(from, to);
  for (std::size_t i = 0; i < axes_of_a_line; ++i) {
    const auto way = i == 0 ? longest : random.between(longest / greatest_ratio, longest);
    ways.push_back(static_cast<std::int32_t>(random.either_way(way)));
  }
  return ways;
}

std::vector<LineAxis> axes_for(const AxisTwin& twin, const std::vector<std::int32_t>& ways,
                               InternalVelocity velocity, InternalAcceleration acceleration) {
  std::vector<LineAxis> axes;
  for (const auto way : ways)
    axes.push_back({twin, {way}, twin.to_pps(velocity), twin.to_pps2(acceleration)});
  return axes;
}

AxisTwin tmc429_axis() {
  auto twin = *AxisTwin::of(*find_model("TMCM-6110"));
  twin.set({154, 3});
  twin.set({153, 6});
  twin.place({0});
  return twin;
}

double part(std::vector<double> values, double quantile) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(quantile * static_cast<double>(values.size() - 1))];
}

struct Length {
  std::int64_t from;
  std::int64_t to;
};

class LineSpread : public testing::TestWithParam<Length> {};

TEST_P(LineSpread, SixAxesOfATmc429ModuleArriveTogetherOnAStraightLine) {
  tmcl::test::Random<> random(tmcl::test::seed());
  const auto twin = tmc429_axis();
  std::vector<double> spreads;
  for (int i = 0; i < tmcl::test::rounds(lines); ++i) {
    const auto all = ways(random, GetParam().from, GetParam().to);
    const auto line = plan_line(axes_for(twin, all, {1500}, {150}));
    ASSERT_TRUE(line) << line.error().message;
    spreads.push_back(Milliseconds(line->spread).count());
    EXPECT_LE(line->deviation, 0.012);
  }
  EXPECT_LE(part(spreads, 0.5), 0.5);
  EXPECT_LE(part(spreads, 0.95), 1.0);
  EXPECT_LE(part(spreads, 1.0), 2.0);
}

INSTANTIATE_TEST_SUITE_P(LineProperty, LineSpread,
                         testing::Values(Length{20'000, 100'000}, Length{100'000, 400'000}),
                         [](const auto& length) {
                           return "UpTo" + std::to_string(length.param.to) + "Microsteps";
                         });

// Slow and fast ones, with ramps that take nearly no time and ramps that are all of it.
TEST(LineProperty, AxesOfATmc429ModuleArriveTogetherWhateverTheirLimits) {
  tmcl::test::Random<> random(tmcl::test::seed());
  const auto twin = tmc429_axis();
  std::vector<double> spreads;
  for (int i = 0; i < tmcl::test::rounds(lines); ++i) {
    const InternalVelocity velocity{static_cast<std::int32_t>(random.between(150, 2047))};
    const InternalAcceleration acceleration{static_cast<std::int32_t>(random.between(100, 2047))};
    const auto line =
        plan_line(axes_for(twin, ways(random, 20'000, 400'000), velocity, acceleration));
    ASSERT_TRUE(line) << line.error().message;
    spreads.push_back(Milliseconds(line->spread).count());
    EXPECT_LE(line->deviation, 0.012);
  }
  EXPECT_LE(part(spreads, 0.5), 0.5);
  EXPECT_LE(part(spreads, 0.95), 2.0);
  EXPECT_LE(part(spreads, 1.0), 8.5);
}

TEST(LineProperty, SaysWhenEachAxisArrivesAndThatIsWhatItsSettingsMakeItDo) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (const auto* name : {"TMCM-6110", "TMCM-6212", "TMCM-142"}) {
    SCOPED_TRACE(name);
    auto twin = *AxisTwin::of(*find_model(name));
    twin.place({0});
    const bool is_tmc429 = twin.tmc429() != nullptr;
    const auto velocity = is_tmc429 ? InternalVelocity{1500} : InternalVelocity{40'000};
    const auto acceleration = is_tmc429 ? InternalAcceleration{500} : InternalAcceleration{120'000};
    for (int i = 0; i < 20; ++i) {
      const auto all = ways(random, 20'000, 100'000);
      const auto interval = std::chrono::microseconds(random.between(0, 3000));
      const auto line =
          plan_line(axes_for(twin, all, velocity, acceleration), ExchangeTimes{interval});
      if (!line) continue;  // too slow for some axis, which the unit tests are about
      for (std::size_t k = 0; k < all.size(); ++k) {
        auto axis = twin;
        ASSERT_TRUE(axis.set(line->axes[k].settings));
        axis.move_to({all[k]});
        EXPECT_EQ(line->axes[k].start + axis.time_to_arrival().value(), line->axes[k].arrival);
      }
      for (std::size_t place = 0; place < line->order.size(); ++place)
        EXPECT_EQ(line->axes[line->order[place]].start, interval * place);
    }
  }
}

}  // namespace
}  // namespace tmcl::plan
