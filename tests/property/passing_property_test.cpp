// When an axis passes a place, against looking at every single tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/mc1451a.hpp"
#include "tmcl/ramp/passing.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::ramp {
namespace {

using test::Random;

constexpr std::size_t any_number = 1'000'000;

void some_switches(Random<>& random, auto& axis) {
  axis.set_switches(random.one_in(4), random.one_in(4));
}

void disturb(Random<>& random, Tmc429& axis) {
  using R = Tmc429::Register;
  switch (random.between(0, 7)) {
    case 0: axis.write(R::v_max, random.any_size(2047)); break;
    case 1: axis.write(R::a_max, random.any_size(2047)); break;
    case 2: axis.write(R::mode, random.between(0, 3)); break;
    case 3: axis.write(R::v_target, random.either_way(random.any_size(2047))); break;
    case 4: axis.write(R::x_actual, random.either_way(random.any_size((1 << 23) - 1))); break;
    case 5: some_switches(random, axis); break;
    default: {
      const auto target = axis.x_actual() + random.either_way(random.any_size(3000));
      axis.write(R::x_target, std::clamp<std::int64_t>(target, -(1 << 23), (1 << 23) - 1));
    }
  }
}

Tmc429 begin(Random<>& random, Tmc429 axis) {
  using R = Tmc429::Register;
  axis.write(R::v_min, random.any_size(20));
  axis.write(R::v_max, random.positive(2047));
  axis.write(R::a_max, random.positive(2047));
  axis.write(R::pulse_div, random.between(0, 3));
  axis.write(R::ramp_div, random.between(0, 5));
  axis.write(R::soft_stop, random.between(0, 1));
  return axis;
}

void disturb(Random<>& random, SixPoint& axis) {
  using R = SixPoint::Register;
  switch (random.between(0, 6)) {
    case 0: axis.write(R::vmax, random.any_size(1'000'000)); break;
    case 1: axis.write(R::amax, random.any_size(65'535)); break;
    case 2: axis.write(R::rampmode, random.between(0, 3)); break;
    case 3: axis.write(R::xactual, INT32_MAX - random.any_size(10'000)); break;
    case 4: some_switches(random, axis); break;
    default: {
      const auto way = random.either_way(random.any_size(20'000));
      axis.write(R::xtarget, static_cast<std::int32_t>(axis.motion().position + way));
    }
  }
}

SixPoint begin(Random<>& random, SixPoint axis) {
  using R = SixPoint::Register;
  for (const auto name : {R::a1, R::amax, R::dmax, R::d1}) {
    axis.write(name, random.positive(65'535));
  }
  axis.write(R::vmax, random.positive(1'000'000));
  axis.write(R::v1, random.one_in(2) ? 0 : random.any_size(100'000));
  axis.write(R::vstart, random.any_size(10'000));
  axis.write(R::vstop, 10 + random.any_size(20'000));
  axis.write(R::tzerowait, random.one_in(2) ? 0 : random.any_size(50));
  axis.write(R::sw_mode, random.one_in(2) ? 3 : 3 | SixPoint::en_softstop);
  return axis;
}

void disturb(Random<>& random, Tmc457& axis) {
  using R = Tmc457::Register;
  switch (random.between(0, 6)) {
    case 0: axis.write(R::v_max, random.any_size(0x7FFF0000)); break;
    case 1: axis.write(R::a_max, random.any_size(0xFFFFFD)); break;
    case 2: axis.write(R::mode, random.one_in(2) ? 0 : random.between(2, 3)); break;
    case 3: axis.write(R::v_target, random.either_way(random.any_size(0x7FFF0000))); break;
    case 4: some_switches(random, axis); break;
    case 5: axis.write(R::x_actual, INT32_MAX - random.any_size(3000)); break;
    default: {
      const auto way = random.either_way(random.any_size(3000));
      axis.write(R::x_target, static_cast<std::int32_t>(axis.motion().position + way));
    }
  }
}

Tmc457 begin(Random<>& random, Tmc457 axis) {
  using R = Tmc457::Register;
  axis.write(R::v_max, 0x7FFF0000 / random.between(1, 20));
  axis.write(R::a_max, 0xFFFFFD / random.between(1, 5));
  axis.write(R::d_max, 0xFFFFFD / random.between(1, 5));
  axis.write(R::d_stop, 0xFFFFFD);
  axis.write(R::bow_max, random.one_in(2) ? 0 : random.between(10, 18));
  axis.write(R::enable_stop_l, 1);
  axis.write(R::enable_stop_r, 1);
  return axis;
}

void disturb(Random<>& random, Tmc4361& axis) {
  using R = Tmc4361::Register;
  constexpr R bows[] = {R::bow1, R::bow2, R::bow3, R::bow4};
  switch (random.between(0, 6)) {
    case 0: axis.write(R::vmax, random.either_way(random.any_size(INT32_MAX))); break;
    case 1: axis.write(R::amax, random.any_size(0xFFFFFF)); break;
    case 2: axis.write(R::rampmode, random.one_in(2) ? 2 : 6); break;
    case 3: axis.write(bows[random.between(0, 3)], random.any_size(0xFFFFFF)); break;
    case 4: some_switches(random, axis); break;
    case 5: axis.write(R::xactual, INT32_MAX - random.any_size(3000)); break;
    default: {
      const auto way = random.either_way(random.any_size(3000));
      axis.write(R::xtarget, static_cast<std::int32_t>(axis.motion().position + way));
    }
  }
}

Tmc4361 begin(Random<>& random, Tmc4361 axis) {
  using R = Tmc4361::Register;
  axis.write(R::vmax, INT32_MAX / random.between(1, 20));
  axis.write(R::amax, 0xFFFFFF / random.between(1, 5));
  axis.write(R::dmax, 0xFFFFFF / random.between(1, 5));
  axis.write(R::dstop, 0xFFFFFF);
  for (const auto bow : {R::bow1, R::bow2, R::bow3, R::bow4}) {
    axis.write(bow, random.one_in(3) ? 0 : random.between(1 << 18, 0xFFFFFF));
  }
  axis.write(R::soft_stop_en, random.between(0, 1));
  axis.write(R::stop_left_en, 1);
  axis.write(R::stop_right_en, 1);
  return axis;
}

void disturb(Random<>& random, Mc1451a& axis) {
  using R = Mc1451a::Register;
  axis.write(R::position, axis.motion().position + random.either_way(random.any_size(3000)));
}

Mc1451a begin(Random<>& random, Mc1451a axis) {
  using R = Mc1451a::Register;
  axis.write(R::profile, random.between(0, 1));
  axis.write(R::velocity, random.positive(20'000'000));
  axis.write(R::acceleration, random.positive(32'767));
  axis.write(R::jerk, random.positive(2'000'000'000));
  return axis;
}

// So many scripts take about a second, and enough of their axes are at full speed by then.
template <class G>
struct Scripts {
  static constexpr std::uint64_t count = 1500;
  static constexpr std::int64_t longest_pause = 6000;
};
template <>
struct Scripts<Tmc457> {
  static constexpr std::uint64_t count = 250;
  static constexpr std::int64_t longest_pause = 300'000;
};

template <class G>
class PassingProperty : public testing::Test {};
using Generators = testing::Types<Tmc429, SixPoint, Tmc457, Tmc4361, Mc1451a>;
TYPED_TEST_SUITE(PassingProperty, Generators);

template <class G>
bool is_outside(const G& start, const G& axis, std::int64_t back, std::int64_t ahead) {
  const auto way = way_between(start, axis);
  return way < -back || way > ahead;
}

// Of the ticks up to `limit`, the first for which it is so; `forever` if there is none.
template <class G, class Predicate>
Tick first_tick(G axis, Tick limit, Predicate is_so) {
  while (axis.tick() < limit) {
    axis.advance_to(axis.tick() + 1);
    if (is_so(axis)) return axis.tick();
  }
  return forever;
}

void expect_found(const Passing& found, Tick plain, Tick limit) {
  EXPECT_EQ(found.passed, plain != forever);
  if (found.passed) {
    EXPECT_EQ(found.tick, plain);
  } else {
    EXPECT_GE(found.tick, limit);
  }
}

TYPED_TEST(PassingProperty, EqualsLookingAtEveryTick) {
  constexpr Tick horizon = 3000;
  int passes = 0;
  int turns = 0;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + Scripts<TypeParam>::count; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Random<> random(seed);
    auto axis = begin(random, TypeParam{});
    for (int step = 0; step < 4; ++step) {
      disturb(random, axis);
      const auto back = random.any_size(1000);
      const auto ahead = random.any_size(1000);
      const auto limit = axis.tick() + horizon;
      const auto plain = first_tick(
          axis, limit, [&](const auto& then) { return is_outside(axis, then, back, ahead); });
      expect_found(passing(axis, back, ahead, limit, any_number), plain, limit);
      const auto turn = first_tick(
          axis, limit, [&](const auto& then) { return then.heading() != axis.heading(); });
      expect_found(turning(axis, limit, any_number), turn, limit);
      ASSERT_FALSE(this->HasFailure()) << "step " << step;
      passes += plain != forever ? 1 : 0;
      turns += turn != forever ? 1 : 0;
      const auto pause = random.any_size(Scripts<TypeParam>::longest_pause);
      axis.advance_to(axis.tick() + static_cast<Tick>(pause));
    }
  }
  EXPECT_GT(passes, 50);
  EXPECT_GT(turns, 50);
}

// Too far for every tick: the one before is inside, and the way there has one direction.
TYPED_TEST(PassingProperty, FindsFarPlacesRoundTheRing) {
  int passes = 0;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 1000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Random<> random(seed);
    auto axis = begin(random, TypeParam{});
    for (int step = 0; step < 3; ++step) disturb(random, axis);
    const auto back = random.any_size(longest_way<TypeParam>);
    const auto ahead = random.any_size(longest_way<TypeParam>);
    const auto found = passing(axis, back, ahead, Tick{1} << 44);
    if (!found.passed) continue;
    ++passes;
    auto before = axis;
    before.advance_to(found.tick - 1);
    EXPECT_FALSE(is_outside(axis, before, back, ahead));
    before.advance_to(found.tick);
    ASSERT_TRUE(is_outside(axis, before, back, ahead));
  }
  EXPECT_GT(passes, 50);
}

}  // namespace
}  // namespace tmcl::ramp
