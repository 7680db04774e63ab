// Jerks, bows and their units.
#include "tmcl/jerk.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tmcl/ramp/tmc457.hpp"

namespace tmcl {
namespace {

AxisUnits axis(std::string unit = {}) {
  AxisUnits units{"x", find_model("TMCM-142"), {}, UserScale{}};
  units.scale->unit = std::move(unit);
  units.scale->units_per_revolution = 5;
  units.scale->steps = {200, 8};
  return units;
}
double pps3(const char* text, const AxisUnits& units) {
  return to_pps3(parse_quantity(text).value(), units).value().value;
}

TEST(Jerk, HasTheUnitsOfAnAccelerationPerSecond) {
  const auto plain = axis();
  for (const auto* text : {"1000pps/s2", "1000pps/s^2", "1000pps/s/s", "1000 pps/s2"})
    EXPECT_EQ(pps3(text, plain), 1000) << text;
  EXPECT_EQ(pps3("2rps/s2", plain), 2 * 51'200);
  EXPECT_EQ(pps3("2rev/s^3", plain), 2 * 51'200);
  for (const auto* text : {"5mm/s^3", "5mm/s3", "5mm/s/s/s", "5000um/s^3"})
    EXPECT_NEAR(pps3(text, axis("mm")), 51'200, 1e-6) << text;
}

TEST(Jerk, IsNothingElse) {
  for (const auto* text : {"5", "5mm", "5mm/s", "5mm/s^2", "5pps", "5pps/s", "5pps/s3"}) {
    const auto quantity = parse_quantity(text).value();
    EXPECT_FALSE(is_jerk(quantity)) << text;
    EXPECT_EQ(to_pps3(quantity, axis("mm")).error().code, Errc::wrong_unit) << text;
  }
  EXPECT_EQ(to_pps3({5, "furlong/s^3"}, axis("mm")).error().code, Errc::unknown_unit);
}

// 2^10 f^3 / 2^52, and an acceleration of 24624 in 1.539 ms: the application note's figures.
TEST(Jerk, OfABowIsThatOfTheNote) {
  EXPECT_NEAR(to_pps3(11).value, 931'322'574.6, 0.1);
  EXPECT_EQ(to_pps3(12).value, 2 * to_pps3(11).value);
  constexpr auto unit = tmc457_acceleration_unit;
  const PulsesPerSecond2 a{24624.0 * unit.numerator / unit.denominator};
  EXPECT_NEAR(seconds_to(a, to_pps3(11)), 1.539e-3, 1e-6);
}

TEST(Jerk, ABowMayOscillateWhereTheGeneratorSaysSo) {
  constexpr auto unit = tmc457_acceleration_unit;
  using R = ramp::Tmc457::Register;
  for (const std::int32_t a : {1, 2, 3, 1000, 24'624, 262'144, 262'145, 16'777'213}) {
    for (std::int32_t bow = 0; bow <= greatest_bow; ++bow) {
      ramp::Tmc457 chip;
      chip.write(R::v_max, 1);
      chip.write(R::a_max_d_max, a);
      chip.write(R::bow_max, bow);
      const PulsesPerSecond2 pps2{double(a) * unit.numerator / unit.denominator};
      EXPECT_EQ(may_oscillate(bow, pps2), !chip.findings().empty()) << a << ' ' << bow;
    }
  }
}

TEST(RampLength, IsOneSecondAndHalfAsMany) {
  constexpr PulsesPerSecond3 at_once{std::numeric_limits<double>::infinity()};
  const auto trapezoid = ramp_length({1000}, {1000}, at_once);
  EXPECT_EQ(trapezoid.seconds, 1);
  EXPECT_EQ(trapezoid.microsteps, 500);
  const auto s_shaped = ramp_length({1000}, {1000}, {2000});
  EXPECT_EQ(s_shaped.seconds, 1.5) << "half a second more to full acceleration";
  EXPECT_EQ(s_shaped.microsteps, 750);
  EXPECT_EQ(ramp_length({1000}, {1e9}, {1000}).seconds, 2) << "which is never reached";
}

}  // namespace
}  // namespace tmcl
