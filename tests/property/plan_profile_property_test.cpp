// Every subset of every profile: what determines it solves it, and nothing else does.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "support/seed.hpp"
#include "tmcl/plan/profile.hpp"

namespace tmcl::plan {
namespace {

using enum Quantity;
using Kind = SolveError::Kind;
using Subset = unsigned;

constexpr Subset every_subset = 1U << quantity_count;
constexpr std::array assumptions{Assumption::none, Assumption::symmetric, Assumption::thirds};
constexpr double exact = 1e-9;

class Source {
 public:
  explicit Source(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double any_size(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  Subset subset() { return std::uniform_int_distribution<Subset>(0, every_subset - 1)(random_); }

  Profile profile(Assumption assumption) {
    const double scale = any_size(1e-4, 1e4);
    const double up = scale * any_size(1e-2, 1);
    const double slew = assumption == Assumption::thirds ? up : scale * any_size(1e-2, 1);
    const double down = assumption == Assumption::none ? scale * any_size(1e-2, 1) : up;
    return of(any_size(1e-4, 1e7), up, slew, down);
  }
  Profile triangle() { return of(any_size(1e-4, 1e7), any_size(1e-2, 1), 0, any_size(1e-2, 1)); }

 private:
  static Profile of(double top, double up, double slew, double down) {
    return {top * (up / 2 + slew + down / 2),
            top,
            top / up,
            top / down,
            up,
            slew,
            down,
            up + slew + down};
  }

  std::mt19937_64 random_;
};

std::vector<Quantity> members(Subset subset) {
  std::vector<Quantity> list;
  for (const auto quantity : quantities) {
    if (subset >> static_cast<unsigned>(quantity) & 1) list.push_back(quantity);
  }
  return list;
}

Given part_of(const Profile& profile, Subset subset) {
  Given given;
  for (const auto quantity : members(subset)) given[quantity] = profile[quantity];
  return given;
}

using Row = std::array<double, 4>;

// How each quantity changes with speed and with the three times, each relative to itself.
Row gradient(const Profile& p, Quantity quantity, Assumption assumption) {
  const double up = p.acceleration_time;
  const double slew = p.slew_time;
  const double down = p.deceleration_time;
  const double mean = up / 2 + slew + down / 2;
  const std::array<Row, quantity_count> rows{
      Row{1, up / 2 / mean, slew / mean, down / 2 / mean},
      Row{1, 0, 0, 0},
      Row{1, -1, 0, 0},
      Row{1, 0, 0, -1},
      Row{0, 1, 0, 0},
      Row{0, 0, 1, 0},
      Row{0, 0, 0, 1},
      Row{0, up / p.total_time, slew / p.total_time, down / p.total_time}};
  auto row = rows[static_cast<std::size_t>(quantity)];
  if (assumption == Assumption::none) return row;
  row = {row[0], row[1] + row[3], row[2], 0};
  if (assumption == Assumption::thirds) row = {row[0], row[1] + row[2], 0, 0};
  return row;
}

int rank(std::vector<Row> rows) {
  constexpr double nothing = 1e-9;
  int found = 0;
  for (std::size_t column = 0; column < 4; ++column) {
    const auto first = rows.begin() + found;
    if (first == rows.end()) break;
    const auto pivot = std::ranges::max_element(
        first, rows.end(), {}, [&](const Row& row) { return std::abs(row[column]); });
    if (std::abs((*pivot)[column]) < nothing) continue;
    std::iter_swap(first, pivot);
    for (auto row = first + 1; row != rows.end(); ++row) {
      const double factor = (*row)[column] / (*first)[column];
      for (std::size_t i = column; i < 4; ++i) (*row)[i] -= factor * (*first)[i];
    }
    ++found;
  }
  return found;
}

int rank_of(const Profile& profile, Subset subset, Assumption assumption) {
  std::vector<Row> rows;
  for (const auto quantity : members(subset))
    rows.push_back(gradient(profile, quantity, assumption));
  return rank(rows);
}

int unknowns(Assumption assumption) { return 4 - static_cast<int>(assumption); }

std::string trace(Subset subset, Assumption assumption) {
  std::string text =
      "TMCL_SEED=" + std::to_string(tmcl::test::seed()) + ' ' + std::string(name_of(assumption));
  for (const auto quantity : members(subset)) text += ' ' + std::string(name_of(quantity));
  return text;
}

void expect_same(const Profile& solved, const Profile& profile, const std::string& where) {
  for (const auto quantity : quantities) {
    ASSERT_NEAR(solved[quantity], profile[quantity], exact * profile[quantity])
        << name_of(quantity) << ", " << where;
  }
}

void expect_equations(const Profile& p, const std::string& where) {
  ASSERT_NEAR(p.acceleration * p.acceleration_time, p.speed, exact * p.speed) << where;
  ASSERT_NEAR(p.deceleration * p.deceleration_time, p.speed, exact * p.speed) << where;
  ASSERT_NEAR(p.acceleration_time + p.slew_time + p.deceleration_time, p.total_time,
              exact * p.total_time)
      << where;
  ASSERT_NEAR(p.speed * (p.total_time + p.slew_time) / 2, p.distance, exact * p.distance) << where;
  ASSERT_GE(p.slew_time, 0) << where;
}

TEST(PlanProfileProperty, EverySufficientSubsetGivesTheSameProfile) {
  constexpr int profiles = 1000;
  Source source(tmcl::test::seed());
  int solved_subsets = 0;
  for (int i = 0; i < profiles; ++i) {
    for (const auto assumption : assumptions) {
      const auto profile = source.profile(assumption);
      for (Subset subset = 0; subset < every_subset; ++subset) {
        if (rank_of(profile, subset, assumption) < unknowns(assumption)) continue;
        const auto solved = solve(part_of(profile, subset), assumption);
        ASSERT_TRUE(solved) << trace(subset, assumption) << ": " << describe(solved.error());
        expect_same(*solved, profile, trace(subset, assumption));
        if (HasFatalFailure()) return;
        ++solved_subsets;
      }
    }
  }
  EXPECT_GT(solved_subsets, 400 * profiles);
}

TEST(PlanProfileProperty, EveryOtherSubsetIsCalledInsufficient) {
  constexpr int profiles = 10;
  Source source(tmcl::test::seed());
  for (int i = 0; i < profiles; ++i) {
    for (const auto assumption : assumptions) {
      const auto profile = source.profile(assumption);
      for (Subset subset = 0; subset < every_subset; ++subset) {
        const int known = rank_of(profile, subset, assumption);
        ASSERT_EQ(is_sufficient(members(subset), assumption), known == unknowns(assumption))
            << trace(subset, assumption);
        if (known == unknowns(assumption)) continue;
        const auto solved = solve(part_of(profile, subset), assumption);
        ASSERT_FALSE(solved) << trace(subset, assumption);
        ASSERT_EQ(solved.error().kind, Kind::insufficient)
            << trace(subset, assumption) << ": " << describe(solved.error());
        ASSERT_EQ(static_cast<int>(solved.error().missing), unknowns(assumption) - known)
            << trace(subset, assumption) << ": " << describe(solved.error());
        ASSERT_FALSE(solved.error().candidates.empty()) << trace(subset, assumption);
      }
    }
  }
}

TEST(PlanProfileProperty, TrianglesToo) {
  constexpr int profiles = 1000;
  Source source(tmcl::test::seed());
  for (int i = 0; i < profiles; ++i) {
    const auto profile = source.triangle();
    for (Subset subset = 0; subset < every_subset; ++subset) {
      if (!is_sufficient(members(subset))) continue;
      const auto solved = solve(part_of(profile, subset));
      ASSERT_TRUE(solved) << trace(subset, {}) << ": " << describe(solved.error());
      ASSERT_NEAR(solved->slew_time, 0, exact * profile.total_time) << trace(subset, {});
      ASSERT_NEAR(solved->speed, profile.speed, exact * profile.speed) << trace(subset, {});
      expect_equations(*solved, trace(subset, {}));
      if (HasFatalFailure()) return;
    }
  }
}

// One value is changed. If the others determine it, that contradicts; if not, it is another
// profile, or an impossible one, or still not enough.
TEST(PlanProfileProperty, WhatContradictsIsNamed) {
  constexpr int scripts = 4000;
  Source source(tmcl::test::seed());
  int contradictions = 0;
  for (int i = 0; i < scripts; ++i) {
    const auto assumption = assumptions[static_cast<std::size_t>(i) % assumptions.size()];
    const auto profile = source.profile(assumption);
    const auto subset = source.subset();
    const auto list = members(subset);
    if (list.empty()) continue;
    const auto changed = list[static_cast<std::size_t>(i) % list.size()];
    auto given = part_of(profile, subset);
    given[changed] = *given[changed] * (1 + source.any_size(1e-4, 1));
    const auto others = subset & ~(1U << static_cast<unsigned>(changed));
    const bool follows =
        rank_of(profile, others, assumption) == rank_of(profile, subset, assumption);
    const auto solved = solve(given, assumption);
    const auto where = trace(subset, assumption) + ", changed " + std::string(name_of(changed));
    if (solved) {
      ASSERT_FALSE(follows) << where;
      for (const auto quantity : list)
        ASSERT_NEAR((*solved)[quantity], *given[quantity], exact * *given[quantity]) << where;
      expect_equations(*solved, where);
      if (HasFatalFailure()) return;
      continue;
    }
    const auto kind = solved.error().kind;
    ASSERT_EQ(follows, kind == Kind::contradiction || (follows && kind == Kind::impossible))
        << where << ": " << describe(solved.error());
    if (kind == Kind::contradiction) {
      ++contradictions;
      ASSERT_TRUE(solved.error().quantity) << where;
    }
  }
  EXPECT_GT(contradictions, scripts / 10);
}

// What is said to be possible is.
TEST(PlanProfileProperty, BoundsArePossible) {
  constexpr int scripts = 3000;
  Source source(tmcl::test::seed());
  int bounds = 0;
  for (int i = 0; i < scripts; ++i) {
    const auto profile = source.profile(Assumption::none);
    const auto subset = source.subset();
    auto given = part_of(profile, subset);
    for (const auto quantity : members(subset))
      given[quantity] = *given[quantity] * source.any_size(0.1, 10);
    const auto solved = solve(given);
    if (solved || solved.error().kind != Kind::impossible) continue;
    for (const auto& bound : solved.error().bounds) {
      Given better;
      for (const auto quantity : solved.error().culprits) better[quantity] = given[quantity];
      better[bound.quantity] =
          bound.inclusive ? bound.value : bound.value * (bound.at_least ? 1 + 1e-5 : 1 - 1e-5);
      const auto again = solve(better);
      ASSERT_TRUE(again || again.error().kind == Kind::insufficient)
          << trace(subset, {}) << ": " << describe(solved.error());
      ++bounds;
    }
  }
  EXPECT_GT(bounds, 100);
}

// ---- with a speed at the ends ----

Profile with_ends(Source& source, Assumption assumption) {
  Profile p;
  p.speed = source.any_size(1e-2, 1e4);
  p.initial_speed = p.speed * source.between(0, 0.9);
  const bool alike = source.between(0, 1) < 0.3;
  p.final_speed = alike ? p.initial_speed : p.speed * source.between(0, 0.9);
  p.acceleration_time = source.any_size(1e-2, 1);
  p.slew_time = assumption == Assumption::thirds ? p.acceleration_time : source.any_size(1e-2, 1);
  const double up = p.speed - p.initial_speed;
  const double down = p.speed - p.final_speed;
  p.acceleration = up / p.acceleration_time;
  p.deceleration_time = source.any_size(1e-2, 1);
  if (assumption == Assumption::symmetric) p.deceleration_time = down / p.acceleration;
  if (assumption == Assumption::thirds || (assumption == Assumption::symmetric && alike))
    p.deceleration_time = p.acceleration_time;
  p.deceleration = down / p.deceleration_time;
  if (assumption == Assumption::symmetric) p.deceleration = p.acceleration;
  p.total_time = p.acceleration_time + p.slew_time + p.deceleration_time;
  p.acceleration_distance = (p.initial_speed + p.speed) / 2 * p.acceleration_time;
  p.slew_distance = p.speed * p.slew_time;
  p.deceleration_distance = (p.final_speed + p.speed) / 2 * p.deceleration_time;
  p.distance = p.acceleration_distance + p.slew_distance + p.deceleration_distance;
  return p;
}

Given with_ends_of(const Profile& profile, Given given) {
  given[initial_speed] = profile.initial_speed;
  given[final_speed] = profile.final_speed;
  return given;
}

void expect_the_same(const Profile& solved, const Profile& profile, const std::string& where) {
  // Of a difference of speeds as little as a tenth, or of a time between the ends of a line.
  constexpr double rounding = 1e-6;
  for (const auto quantity : quantities)
    ASSERT_NEAR(solved[quantity], profile[quantity], rounding * profile[quantity])
        << name_of(quantity) << ", " << where;
  for (const auto quantity : side_quantities)
    ASSERT_NEAR(solved[quantity], profile[quantity], rounding * profile[quantity])
        << name_of(quantity) << ", " << where;
}

TEST(PlanProfileProperty, FourThatAreEnoughFromRestAreEnoughWithOneSpeedAtBothEnds) {
  Source source(tmcl::test::seed());
  for (int i = 0; i < 2000; ++i) {
    const auto assumption = assumptions[static_cast<std::size_t>(i) % assumptions.size()];
    auto profile = with_ends(source, assumption);
    if (profile.initial_speed != profile.final_speed) continue;
    for (Subset subset = 0; subset < every_subset; ++subset) {
      if (!is_sufficient(members(subset), assumption)) continue;
      const auto solved = solve(with_ends_of(profile, part_of(profile, subset)), assumption);
      ASSERT_TRUE(solved) << trace(subset, assumption) << ": " << describe(solved.error());
      expect_the_same(*solved, profile, trace(subset, assumption));
      if (HasFatalFailure()) return;
    }
  }
}

// What is solved is the profile; and all of it but one value is always enough.
TEST(PlanProfileProperty, UnlikeEndsAreSolvedOrCalledInsufficient) {
  Source source(tmcl::test::seed());
  int solved_subsets = 0;
  for (int i = 0; i < 300; ++i) {
    const auto assumption = assumptions[static_cast<std::size_t>(i) % assumptions.size()];
    const auto profile = with_ends(source, assumption);
    for (Subset subset = 0; subset < every_subset; ++subset) {
      const auto solved = solve(with_ends_of(profile, part_of(profile, subset)), assumption);
      if (solved) {
        ++solved_subsets;
        expect_the_same(*solved, profile, trace(subset, assumption));
        if (HasFatalFailure()) return;
      } else {
        ASSERT_EQ(solved.error().kind, Kind::insufficient)
            << trace(subset, assumption) << ": " << describe(solved.error());
      }
    }
  }
  EXPECT_GT(solved_subsets, 300 * 100);
}

// The five equations of constant acceleration: two of a ramp's speed, rate, time and distance give
// the others.
TEST(PlanProfileProperty, TwoOfARampGiveTheOthers) {
  Source source(tmcl::test::seed());
  constexpr std::array of_ramp{speed, acceleration, acceleration_time, acceleration_distance};
  for (int i = 0; i < 1000; ++i) {
    const auto profile = with_ends(source, Assumption::none);
    for (const auto one : of_ramp) {
      for (const auto other : of_ramp) {
        if (one == other) continue;
        Given given;
        for (const auto quantity :
             {one, other, slew_distance, deceleration_distance, initial_speed, final_speed})
          given[quantity] = profile[quantity];
        const auto solved = solve(given);
        const auto where = std::string(name_of(one)) + " and " + std::string(name_of(other));
        ASSERT_TRUE(solved) << where << ": " << describe(solved.error());
        expect_the_same(*solved, profile, where);
        if (HasFatalFailure()) return;
      }
    }
  }
}

}  // namespace
}  // namespace tmcl::plan
