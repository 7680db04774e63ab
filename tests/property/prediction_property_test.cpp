// A twin of an axis and the axis of a simulated module are told the same at the same time: the
// module takes what the twin takes, is where the twin is, and arrives when the twin said it would.
#include <gtest/gtest.h>

#include <array>

#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
namespace ap = axis_parameter;

constexpr int modules = 25;
constexpr int moves_per_module = 100;
constexpr std::int32_t farthest = 400'000;
constexpr Duration most_patience = std::chrono::minutes(10);

class Pair {
 public:
  Pair(const Model& model, std::uint64_t seed)
      : model_(model),
        random_(seed),
        module_(model, ModuleAddress{1}, clock_),
        twin_(*AxisTwin::of(model)) {}

  void move_somewhere() {
    change_settings();
    if (random_.one_in(8)) turn();
    const Microsteps target{
        static_cast<std::int32_t>(random_.either_way(random_.any_size(farthest)))};
    ASSERT_EQ(Status::ok, ask(Command::MVP, 0, target.value));
    twin_.move_to(target);
    if (random_.one_in(5)) pass(Duration(random_.any_size(seconds(2).count())));
    compare();
    arrive(target);
  }

 private:
  void change_settings() {
    for (const auto parameter : AxisTwin::parameters(model_)) {
      if (!random_.one_in(4)) continue;
      const auto* row = find_parameter(axis_parameters(model_), parameter);
      Setting setting{parameter, value_for(*row)};
      const bool taken = ask(Command::SAP, parameter, setting.value) == Status::ok;
      EXPECT_EQ(taken, twin_.set(setting)) << row->name << " = " << setting.value;
    }
  }

  // A TMC457 with a bow above its acceleration goes to and fro for ever.
  std::int32_t value_for(const ParameterInfo& row) {
    constexpr std::int64_t greatest_exponent = 13;
    constexpr std::int32_t least_acceleration = 1 << greatest_exponent;
    if (row.maximum <= 18)
      return static_cast<std::int32_t>(
          random_.between(0, std::min<std::int64_t>(row.maximum, greatest_exponent)));
    const auto value = static_cast<std::int32_t>(random_.positive(row.maximum));
    const bool has_bow = model_.family == Family::tmc457 && row.scale == Scale::acceleration;
    return has_bow ? std::max(value, least_acceleration) : value;
  }

  void turn() {
    const auto speed = static_cast<std::int32_t>(random_.any_size(2000));
    const bool taken = ask(Command::ROR, 0, speed) == Status::ok;
    EXPECT_EQ(taken, twin_.rotate({speed}));
    pass(milliseconds(random_.between(0, 500)));
    compare();
    if (random_.one_in(2)) return;
    ask(Command::MST, 0, 0);
    twin_.stop();
    pass(milliseconds(random_.between(0, 500)));
    compare();
  }

  void arrive(Microsteps target) {
    const auto arrival = twin_.time_to_arrival(most_patience);
    if (!arrival) return pass(seconds(1));
    ++arrivals;
    const auto& outlook = module_.axis(0).outlook();
    if (outlook.look_again == sim::never) {
      EXPECT_EQ(std::max(outlook.arrival, clock_.now()), clock_.now() + *arrival);
    }
    pass(random_.between(0, arrival->count()) * nanoseconds(1));
    compare();
    pass(*twin_.time_to_arrival(most_patience));
    EXPECT_TRUE(stands_on(target));
    compare();
  }

  bool stands_on(Microsteps target) {
    return get(ap::actual_position) == target.value && get(ap::position_reached) == 1 &&
           get(ap::actual_velocity) == 0;
  }

  void pass(Duration time) {
    clock_.advance(time);
    module_.run_due();
    twin_.advance(time);
  }

  void compare() {
    const auto motion = twin_.motion();
    EXPECT_EQ(get(ap::actual_position), motion.position.value);
  }

  Status ask(Command command, std::uint8_t type, std::int32_t value) {
    const auto answer =
        module_.execute({ModuleAddress{1}, command, type, 0, value}, sim::Medium::serial, events_);
    return answer.status;
  }
  std::int32_t get(std::uint8_t parameter) { return *module_.axis(0).get(parameter); }

  const Model& model_;
  tmcl::test::Random<> random_;
  VirtualClock clock_;
  tmcl::test::NoEvents events_;
  sim::Module module_;
  AxisTwin twin_;

 public:
  int arrivals = 0;
};

class Prediction : public testing::TestWithParam<std::uint16_t> {};

TEST_P(Prediction, ComesTrueToTheTick) {
  int arrivals = 0;
  for (int i = 0; i < modules; ++i) {
    SCOPED_TRACE(i);
    Pair pair(*find_model(GetParam()), tmcl::test::seed() + static_cast<std::uint64_t>(i));
    for (int move = 0; move < moves_per_module && !testing::Test::HasFailure(); ++move)
      pair.move_somewhere();
    arrivals += pair.arrivals;
  }
  EXPECT_GT(arrivals, modules * moves_per_module / 2);
}

INSTANTIATE_TEST_SUITE_P(Models, Prediction, testing::Values(1110, 142, 1276, 3216),
                         [](const auto& model) { return "Tmcm" + std::to_string(model.param); });

}  // namespace
}  // namespace tmcl::plan
