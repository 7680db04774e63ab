// What holds for every quantity of every axis.
#include <bit>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/correction.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl::test {
namespace {

constexpr int tries = 20'000;

double any_double(Random<>& random) {
  while (true) {
    const auto bits = static_cast<std::uint64_t>(random.between(INT64_MIN, INT64_MAX));
    const auto number = std::bit_cast<double>(bits);
    if (std::isfinite(number)) return number;
  }
}

std::shared_ptr<const Correction> any_correction(Random<>& random) {
  std::string text;
  double counted = static_cast<double>(random.either_way(random.any_size(1'000'000)));
  double actual = counted + static_cast<double>(random.either_way(random.any_size(1000)));
  for (auto rows = random.between(2, 20); rows > 0; --rows) {
    text += fmt::format("{},{}\n", counted, actual);
    const double way = static_cast<double>(random.positive(1'000'000)) / 1000;
    counted += way;
    actual += way * (1 + static_cast<double>(random.between(-90, 90)) / 1000);
  }
  return std::make_shared<const Correction>(*Correction::of(text));
}

AxisUnits any_axis(Random<>& random) {
  constexpr const char* names[] = {"mm", "um", "cm", "m", "in", "deg", "rad", "slides", ""};
  constexpr const char* models[] = {"TMCM-1110", "TMCM-142", "TMCM-6212"};
  AxisUnits units{"x", find_model(models[random.between(0, 2)])};
  units.module = initial_units(*units.model);
  units.scale = UserScale{names[random.between(0, 8)],
                          static_cast<double>(random.positive(1'000'000)) / 1000,
                          random.one_in(2),
                          {200, static_cast<std::int32_t>(random.between(0, 8))},
                          static_cast<double>(random.positive(100'000)) / 1000};
  if (units.has_unit() && random.one_in(2)) units.scale->correction = any_correction(random);
  return units;
}

TEST(QuantityProperty, WhatIsPrintedIsReadAsTheSameNumber) {
  Random random(seed());
  for (int i = 0; i < tries; ++i) {
    for (const auto* unit : {"", "mm", "e", "in", "pps/s", "slides/s^2", "µm"}) {
      const Quantity quantity{any_double(random), unit};
      ASSERT_EQ(parse_quantity(to_string(quantity)), quantity) << to_string(quantity);
    }
  }
}

TEST(QuantityProperty, WhatIsToldOfAParameterSetsItToTheSame) {
  Random random(seed());
  for (int i = 0; i < tries; ++i) {
    const auto units = any_axis(random);
    for (const auto number : {axis_parameter::target_position, axis_parameter::target_velocity,
                              axis_parameter::max_velocity, axis_parameter::max_acceleration}) {
      const auto* row = find_parameter(units.parameters(), number);
      if (row == nullptr) continue;
      const auto value = static_cast<std::int32_t>(
          row->minimum + random.any_size(std::int64_t{row->maximum} - row->minimum));
      const auto told = from_parameter(value, units, *row);
      ASSERT_TRUE(told) << told.error().message;
      const auto read = parse_quantity(to_string(*told));
      ASSERT_TRUE(read);
      ASSERT_EQ(to_parameter(*read, units, *row), value) << to_string(*told);
    }
  }
}

TEST(QuantityProperty, AUnitThatConvertsIsTheSamePlace) {
  Random random(seed());
  int converted = 0;
  for (int i = 0; i < tries; ++i) {
    const auto units = any_axis(random);
    const Quantity own{std::ldexp(static_cast<double>(random.between(-1000, 1000)), -4),
                       units.scale->unit};
    for (const auto* other : {"um", "mm", "cm", "m", "in", "deg", "rad"}) {
      const auto of_one = in_own_unit({1, other}, units);
      if (!of_one) continue;
      const Quantity same{own.number / *of_one, other};
      const auto place = to_microsteps(own, units);
      const auto same_place = to_microsteps(same, units);
      ASSERT_EQ(place.has_value(), same_place.has_value());
      if (!place) continue;
      // The middle between two microsteps may be rounded either way.
      ASSERT_LE(std::abs(std::int64_t{place->value} - same_place->value), 1);
      ASSERT_NEAR(*in_own_unit(same, units), own.number, 1e-12 * std::abs(own.number));
      ++converted;
    }
  }
  EXPECT_GT(converted, tries);
}

}  // namespace
}  // namespace tmcl::test
