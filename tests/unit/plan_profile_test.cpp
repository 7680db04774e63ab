// The trapezoid solver: the examples of application note AN00115-001, and what it says when it
// cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include "tmcl/plan/profile.hpp"

namespace tmcl::plan {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using enum Quantity;
using Kind = SolveError::Kind;

Given given(std::initializer_list<std::pair<Quantity, double>> values) {
  Given made;
  for (const auto& [quantity, value] : values) made[quantity] = value;
  return made;
}

void expect_profile(const tl::expected<Profile, SolveError>& solved, const Profile& expected) {
  ASSERT_TRUE(solved) << describe(solved.error());
  for (const auto quantity : quantities)
    EXPECT_NEAR((*solved)[quantity], expected[quantity], 1e-9 * expected[quantity])
        << name_of(quantity);
}

SolveError error_of(const Given& known, Assumption assumption = Assumption::none) {
  const auto solved = solve(known, assumption);
  EXPECT_FALSE(solved);
  return solved ? SolveError{} : solved.error();
}

std::string words_for(const Given& known, Assumption assumption = Assumption::none) {
  return describe(error_of(known, assumption), "mm", "s");
}

TEST(PlanProfile, FirstExampleOfTheNote) {
  const auto known = given({{speed, 8}, {acceleration, 16}, {deceleration, 16}, {distance, 12}});
  expect_profile(solve(known), {12, 8, 16, 16, 0.5, 1, 0.5, 2});
}

// The note computes with 12 units where it says 20, and so prints 30 and 150.
TEST(PlanProfile, TwentyUnitsInThirdsOf600Milliseconds) {
  const auto known = given({{distance, 20}, {total_time, 0.6}});
  expect_profile(solve(known, Assumption::thirds), {20, 50, 250, 250, 0.2, 0.2, 0.2, 0.6});
}

TEST(PlanProfile, TheProgramPrintedForThemTakesLonger) {
  const auto known = given({{distance, 20}, {speed, 30}, {acceleration, 150}});
  const auto solved = solve(known, Assumption::symmetric);
  ASSERT_TRUE(solved);
  EXPECT_NEAR(solved->total_time, 0.6 + 0.8 / 3, 1e-12);
}

TEST(PlanProfile, ExerciseOfTheNoteIsDetermined) {
  const auto known = given({{distance, 200}, {total_time, 1}, {speed, 250}});
  expect_profile(solve(known, Assumption::symmetric), {200, 250, 1250, 1250, 0.2, 0.6, 0.2, 1});
}

TEST(PlanProfile, TriangleFromDistanceTimeAndRates) {
  const auto known =
      given({{distance, 100}, {total_time, 20}, {acceleration, 1}, {deceleration, 1}});
  expect_profile(solve(known), {100, 10, 1, 1, 10, 0, 10, 20});
}

TEST(PlanProfile, SlewTimeMayBeNothing) {
  const auto known = given({{slew_time, 0}, {distance, 100}, {acceleration, 1}});
  expect_profile(solve(known, Assumption::symmetric), {100, 10, 1, 1, 10, 0, 10, 20});
}

TEST(PlanProfile, MoreThanEnoughThatAgrees) {
  const auto known = given({{speed, 8},
                            {acceleration, 16},
                            {deceleration, 16},
                            {distance, 12},
                            {total_time, 2},
                            {slew_time, 1}});
  expect_profile(solve(known), {12, 8, 16, 16, 0.5, 1, 0.5, 2});
}

TEST(PlanProfile, WhatIsMissingIsNamed) {
  const auto error = error_of(given({{speed, 8}, {acceleration, 16}, {distance, 12}}));
  EXPECT_EQ(error.kind, Kind::insufficient);
  EXPECT_EQ(error.missing, 1U);
  EXPECT_THAT(error.candidates,
              ElementsAre(deceleration, slew_time, deceleration_time, total_time));
  EXPECT_THAT(error.sufficient_assumptions, ElementsAre(Assumption::symmetric));
  EXPECT_EQ(describe(error),
            "distance, speed and acceleration are not enough; deceleration, slew_time, "
            "deceleration_time or total_time is missing, or the assumption 'symmetric'");
}

TEST(PlanProfile, TheAssumptionThatWouldBeEnoughIsOffered) {
  const auto error = error_of(given({{distance, 20}, {total_time, 0.6}}));
  EXPECT_EQ(error.kind, Kind::insufficient);
  EXPECT_EQ(error.missing, 2U);
  EXPECT_THAT(error.sufficient_assumptions, ElementsAre(Assumption::thirds));
  EXPECT_EQ(describe(error),
            "distance and total_time are not enough; 2 more are missing, such as speed and "
            "acceleration, or the assumption 'thirds'");
}

TEST(PlanProfile, AnAssumptionThatContradictsIsNotOffered) {
  const auto error = error_of(given({{distance, 200}, {total_time, 1}, {speed, 250}}));
  EXPECT_THAT(error.sufficient_assumptions, ElementsAre(Assumption::symmetric));
}

TEST(PlanProfile, TimesAloneAreNeverEnough) {
  const auto error = error_of(
      given({{acceleration_time, 1}, {slew_time, 2}, {deceleration_time, 1}, {total_time, 4}}));
  EXPECT_EQ(error.kind, Kind::insufficient);
  EXPECT_THAT(error.candidates, ElementsAre(distance, speed, acceleration, deceleration));
  EXPECT_THAT(error.sufficient_assumptions, IsEmpty());
}

TEST(PlanProfile, NothingAtAllIsNotEnough) {
  EXPECT_THAT(words_for({}), HasSubstr("nothing is given; 4 more are missing"));
}

TEST(PlanProfile, ContradictionSaysByHowMuch) {
  const auto known =
      given({{speed, 8}, {acceleration, 16}, {deceleration, 16}, {distance, 12}, {total_time, 3}});
  const auto error = error_of(known);
  EXPECT_EQ(error.kind, Kind::contradiction);
  ASSERT_TRUE(error.quantity);
  EXPECT_EQ(error.culprits.size(), 4U);
  EXPECT_NE(error.given, error.implied);
}

TEST(PlanProfile, TheFewestThatContradictAreNamed) {
  const auto known = given({{speed, 8}, {acceleration, 16}, {acceleration_time, 1}, {distance, 9}});
  EXPECT_EQ(words_for(known),
            "speed 8 mm/s and acceleration 16 mm/s^2 make acceleration_time 0.5 s, and it is given "
            "as 1 s: 0.5 s too much");
}

TEST(PlanProfile, ContradictionToAnAssumption) {
  EXPECT_EQ(
      words_for(given({{acceleration, 1}, {deceleration, 2}}), Assumption::symmetric),
      "acceleration 1 mm/s^2 and the assumption 'symmetric' make deceleration 1 mm/s^2, and it "
      "is given as 2 mm/s^2: 1 mm/s^2 too much");
}

TEST(PlanProfile, SmallContradictionsAreShownWithTheirDigits) {
  const auto words =
      words_for(given({{speed, 8}, {acceleration, 16}, {acceleration_time, 0.50000001}}));
  EXPECT_THAT(words, HasSubstr("15.99999968 mm/s^2"));
}

TEST(PlanProfile, TooFastForTheDistance) {
  const auto error =
      error_of(given({{distance, 12}, {speed, 20}, {acceleration, 16}, {deceleration, 16}}));
  EXPECT_EQ(error.kind, Kind::impossible);
  EXPECT_EQ(error.quantity, slew_time);
  EXPECT_NEAR(error.implied, -0.65, 1e-12);
  EXPECT_EQ(
      describe(error, "mm", "s"),
      "distance 12 mm, speed 20 mm/s, acceleration 16 mm/s^2 and deceleration 16 mm/s^2 are "
      "impossible together: slew_time would be -0.65 s; possible with distance at least 25 mm "
      "or speed at most 13.8564 mm/s");
}

TEST(PlanProfile, TooLittleTimeForTheAcceleration) {
  const auto words =
      words_for(given({{distance, 100}, {total_time, 2}, {acceleration, 1}, {deceleration, 1}}));
  EXPECT_THAT(words, HasSubstr("there is no speed for them"));
  EXPECT_THAT(words, HasSubstr("distance at most 1 mm"));
  EXPECT_THAT(words, HasSubstr("total_time at least 20 s"));
}

TEST(PlanProfile, TooSlowForTheTime) {
  const auto words =
      words_for(given({{distance, 10}, {total_time, 2}, {speed, 4}}), Assumption::symmetric);
  EXPECT_THAT(words, HasSubstr("speed more than 5 mm/s"));
}

TEST(PlanProfile, ValuesThatAreNone) {
  for (const double bad : {0.0, -3.0, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    const auto error = error_of(given({{distance, 1}, {speed, bad}}));
    EXPECT_EQ(error.kind, Kind::invalid) << bad;
    EXPECT_THAT(error.culprits, ElementsAre(speed));
    EXPECT_THAT(describe(error), HasSubstr("speed must be a finite number above 0"));
  }
  EXPECT_EQ(error_of(given({{slew_time, -1}})).kind, Kind::invalid);
}

TEST(PlanProfile, BeyondAllNumbersIsImpossible) {
  const auto error = error_of(given({{acceleration, 1e300}, {acceleration_time, 1e300}}));
  EXPECT_EQ(error.kind, Kind::impossible);
  EXPECT_EQ(error.quantity, speed);
}

TEST(PlanProfile, PositionAndSpeedOverTime) {
  const Profile profile{12, 8, 16, 16, 0.5, 1, 0.5, 2};
  EXPECT_EQ(profile.position_at(-1), 0);
  EXPECT_EQ(profile.position_at(0.5), 2);
  EXPECT_EQ(profile.position_at(1), 6);
  EXPECT_EQ(profile.position_at(1.75), 11.5);
  EXPECT_EQ(profile.position_at(3), 12);
  EXPECT_EQ(profile.speed_at(0.25), 4);
  EXPECT_EQ(profile.speed_at(1), 8);
  EXPECT_EQ(profile.speed_at(2), 0);
}

/// Accel = Sp / Ta, Decel = Sp / Td, and the distance is the area: here of ten thousand strips.
TEST(PlanProfile, RatesAreSpeedOverTimeAndTheDistanceIsTheArea) {
  for (const double up : {0.1, 0.5, 2.0}) {
    for (const double down : {0.2, 0.5}) {
      const auto solved = solve(
          given({{speed, 8}, {acceleration_time, up}, {deceleration_time, down}, {total_time, 4}}));
      ASSERT_TRUE(solved) << describe(solved.error());
      EXPECT_NEAR(solved->acceleration, 8 / up, 1e-9);
      EXPECT_NEAR(solved->deceleration, 8 / down, 1e-9);
      constexpr int strips = 10'000;
      constexpr double width = 4.0 / strips;
      double area = 0;
      for (int i = 0; i < strips; ++i) area += width * solved->speed_at((i + 0.5) * width);
      EXPECT_NEAR(solved->distance, area, 1e-4);
      EXPECT_NEAR(area, 8 * (4 - (up + down) / 2), 1e-4);
    }
  }
}

// v = u + a t = 2 + 3 * 4; s = (u + v) t / 2 = 32; and v^2 = u^2 + 2 a s: 196 = 4 + 2 * 3 * 32.
TEST(PlanProfile, ARampFromASpeedObeysTheEquationsOfConstantAcceleration) {
  const auto solved = solve(given({{initial_speed, 2},
                                   {acceleration, 3},
                                   {acceleration_distance, 32},
                                   {slew_time, 1},
                                   {final_speed, 10},
                                   {deceleration_time, 2}}));
  ASSERT_TRUE(solved) << describe(solved.error());
  EXPECT_DOUBLE_EQ(solved->speed, 14);
  EXPECT_DOUBLE_EQ(solved->acceleration_time, 4);
  EXPECT_DOUBLE_EQ(solved->slew_distance, 14);
  EXPECT_DOUBLE_EQ(solved->deceleration, 2);
  EXPECT_DOUBLE_EQ(solved->deceleration_distance, 24);
  EXPECT_DOUBLE_EQ(solved->distance, 70);
  EXPECT_EQ(solved->speed_at(-1), 2);
  EXPECT_EQ(solved->speed_at(2), 8);
  EXPECT_EQ(solved->position_at(2), 10);
  EXPECT_EQ(solved->position_at(6), 32 + 14 + 13);
  EXPECT_EQ(solved->speed_at(8), 10);
}

// Of a ramp its rate, its time, its distance and the greatest speed: any two that say something of
// it are enough, on either side.
TEST(PlanProfile, AnyTwoQuantitiesOfARampThatEndsWithASpeedGiveTheOthers) {
  const std::array<std::pair<Quantity, double>, 4> up{
      {{acceleration, 3}, {acceleration_time, 4}, {acceleration_distance, 32}, {speed, 14}}};
  const std::array<std::pair<Quantity, double>, 4> down{
      {{deceleration, 2}, {deceleration_time, 2}, {deceleration_distance, 24}, {speed, 14}}};
  for (const auto& [ramp, other] : {std::pair(up, down), std::pair(down, up)}) {
    for (std::size_t first = 0; first < ramp.size(); ++first) {
      for (std::size_t second = first + 1; second < ramp.size(); ++second) {
        SCOPED_TRACE(std::string(name_of(ramp[first].first)) + " and " +
                     std::string(name_of(ramp[second].first)));
        Given known{};
        known[initial_speed] = 2, known[final_speed] = 10, known[slew_time] = 1;
        known[other[1].first] = other[1].second;
        for (const auto at : {first, second}) known[ramp[at].first] = ramp[at].second;
        const auto solved = solve(known);
        ASSERT_TRUE(solved) << describe(solved.error());
        EXPECT_DOUBLE_EQ(solved->speed, 14);
        EXPECT_DOUBLE_EQ(solved->acceleration, 3);
        EXPECT_DOUBLE_EQ(solved->acceleration_time, 4);
        EXPECT_DOUBLE_EQ(solved->deceleration, 2);
        EXPECT_DOUBLE_EQ(solved->deceleration_time, 2);
        EXPECT_DOUBLE_EQ(solved->distance, 70);
      }
    }
  }
}

TEST(PlanProfile, DistancesOfThePartsAreThoseOfTheNote) {
  const auto solved =
      solve(given({{speed, 8}, {acceleration, 16}, {deceleration, 16}, {distance, 12}}));
  ASSERT_TRUE(solved);
  EXPECT_EQ(solved->acceleration_distance, 2);
  EXPECT_EQ(solved->slew_distance, 8);
  EXPECT_EQ(solved->deceleration_distance, 2);
}

// The triangle of one ramp, turned over, fills up the other: distance = Sp (Ta + Ts), and by the
// area of a trapezoid Sp (Ts + T) / 2.
TEST(PlanProfile, EqualRampsMakeARectangle) {
  for (const double ramp : {0.05, 0.2, 0.3}) {
    const auto solved = solve(given(
        {{distance, 12}, {total_time, 0.6}, {acceleration_time, ramp}, {deceleration_time, ramp}}));
    ASSERT_TRUE(solved) << describe(solved.error());
    const double slew = solved->slew_time;
    EXPECT_NEAR(solved->speed * (ramp + slew), 12, 1e-9);
    EXPECT_NEAR(solved->speed * (slew + 0.6) / 2, 12, 1e-9);
    EXPECT_NEAR(solved->acceleration, solved->speed / ramp, 1e-9);
  }
}

TEST(PlanProfile, ASpeedThatIsNoGreaterThanAtAnEndIsImpossible) {
  const auto solved = solve(given(
      {{initial_speed, 9}, {speed, 8}, {acceleration, 16}, {deceleration, 16}, {distance, 12}}));
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().kind, SolveError::Kind::impossible);
  EXPECT_THAT(describe(solved.error()), HasSubstr("initial_speed 9"));
}

TEST(PlanProfile, ADistanceOfAPartThatDoesNotAgreeIsAContradiction) {
  const auto solved = solve(given(
      {{speed, 8}, {acceleration, 16}, {deceleration, 16}, {distance, 12}, {slew_distance, 7}}));
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().kind, SolveError::Kind::contradiction);
}

TEST(PlanProfile, SymmetricRampsBetweenUnlikeSpeedsHaveOneRate) {
  const auto solved = solve(
      given({{initial_speed, 2}, {final_speed, 6}, {speed, 10}, {acceleration, 4}, {distance, 40}}),
      Assumption::symmetric);
  ASSERT_TRUE(solved) << describe(solved.error());
  EXPECT_EQ(solved->deceleration, 4);
  EXPECT_EQ(solved->acceleration_time, 2);
  EXPECT_EQ(solved->deceleration_time, 1);
  EXPECT_EQ(solved->slew_time, 2);
}

TEST(PlanProfile, NamesThereAndBack) {
  for (const auto quantity : quantities) EXPECT_EQ(quantity_named(name_of(quantity)), quantity);
  for (const auto quantity : side_quantities)
    EXPECT_EQ(quantity_named(name_of(quantity)), quantity);
  EXPECT_EQ(quantity_named("velocity"), std::nullopt);
  EXPECT_EQ(assumption_named("thirds"), Assumption::thirds);
  EXPECT_EQ(assumption_named("halves"), std::nullopt);
}

}  // namespace
}  // namespace tmcl::plan
