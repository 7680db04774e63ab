// A simulated module's data logger (command 142): that what it records is what a host would have
// read at its ticks, whenever the host asks.
#include <gmock/gmock.h>

#include "sim_fixture.hpp"
#include "tmcl/ram_debug.hpp"

namespace tmcl::sim {
namespace {

using ram_debug::Kind;
using ram_debug::State;
using ram_debug::Trigger;
using ram_debug::Type;

namespace ap = axis_parameter;

class SimDataLogger : public SimTest {
 protected:
  std::optional<Reply> ask_logger(Type type, std::uint8_t motor = 0, std::int32_t value = 0) {
    return ask(Command::RAM_DEBUG, static_cast<std::uint8_t>(type), motor, value);
  }
  void channel(Kind kind, std::int32_t select) {
    EXPECT_EQ(ask_logger(Type::set_channel, static_cast<std::uint8_t>(kind), select)->status,
              Status::ok);
  }
  void enable(Trigger trigger = Trigger::unconditional, std::int32_t threshold = 0) {
    ask_logger(Type::enable_trigger, static_cast<std::uint8_t>(trigger), threshold);
  }
  State state() { return static_cast<State>(ask_logger(Type::get_state)->value); }
  std::vector<std::int32_t> samples(std::int32_t count) {
    std::vector<std::int32_t> values;
    for (std::int32_t i = 0; i < count; ++i) {
      const auto reply = ask_logger(Type::get_sample, 0, i);
      EXPECT_EQ(reply->status, Status::ok) << i;
      values.push_back(reply->value);
    }
    return values;
  }
  void run_to(std::int32_t position) {
    for (const auto address : {1, 2})
      ask({ModuleAddress{static_cast<std::uint16_t>(address)}, Command::MVP, 0, 0, position});
  }
};

TEST_F(SimDataLogger, BelongsToTwoFamiliesUnlessAModuleIsToldOtherwise) {
  for (const auto& model : models()) {
    Bench one(clock);
    const bool usual = model.family == Family::sixpoint || model.family == Family::tmc4361;
    for (const auto told : {std::optional<bool>{}, std::optional(true), std::optional(false)}) {
      auto& module = one.add(model, ModuleAddress{1}, {.data_logger = told});
      const auto status =
          module.execute({ModuleAddress{1}, Command::RAM_DEBUG, 8}, Medium::serial, line).status;
      EXPECT_EQ(status, told.value_or(usual) ? Status::ok : Status::command_not_available)
          << model.name;
    }
  }
}

class SimDataLoggerOf : public SimDataLogger, public testing::WithParamInterface<std::uint16_t> {};

// A second module does the same, and is asked at every tick.
TEST_P(SimDataLoggerOf, RecordsTheRampAtItsTicksAndNotWhenItIsAsked) {
  add(GetParam());
  add(GetParam(), 2);
  pass(std::chrono::microseconds(300));
  channel(Kind::axis_parameter, ap::actual_position);
  channel(Kind::axis_parameter, ap::actual_velocity);
  ask_logger(Type::set_sample_count, 0, 4000);
  ask_logger(Type::set_prescaler, 0, 1);
  run_to(70'000);
  enable();
  pass(std::chrono::microseconds(700));
  std::vector<std::int32_t> asked;
  for (int i = 0; i < 2000; ++i) {
    pass(milliseconds(i == 0 ? 1 : 2));
    for (const auto parameter : {ap::actual_position, ap::actual_velocity}) {
      asked.push_back(ask({ModuleAddress{2}, Command::GAP, parameter, 0, 0})->value);
    }
  }
  EXPECT_EQ(state(), State::complete);
  EXPECT_EQ(samples(4000), asked);
  EXPECT_GT(asked[400], 0);
}

INSTANTIATE_TEST_SUITE_P(Models, SimDataLoggerOf, testing::Values(1276, 1316));

TEST_F(SimDataLogger, TakesNoTimeUnlessItRecords) {
  add(1276);
  EXPECT_EQ(bench.next_due(), never);
  ask_logger(Type::set_sample_count, 0, 10);
  channel(Kind::axis_parameter, ap::actual_position);
  EXPECT_EQ(bench.next_due(), never);
  enable();
  EXPECT_EQ(bench.next_due(), TimePoint{} + milliseconds(1));
  pass(milliseconds(10));
  EXPECT_EQ(state(), State::complete);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimDataLogger, CatchesUpWithTimeThatNobodyLookedAt) {
  add(1276);
  channel(Kind::system_tick, 0);
  ask_logger(Type::set_sample_count, 0, 3);
  ask_logger(Type::set_prescaler, 0, 99);
  enable();
  clock.advance_to(TimePoint{} + std::chrono::seconds(5));
  EXPECT_EQ(samples(3), (std::vector<std::int32_t>{100, 200, 300}));
}

TEST_F(SimDataLogger, TriggersOnTheTickAtWhichASpeedIsReached) {
  add(1276);
  channel(Kind::axis_parameter, ap::actual_velocity);
  ask_logger(Type::set_sample_count, 0, 100);
  ask_logger(Type::set_pretrigger_sample_count, 0, 20);
  ask_logger(Type::set_trigger_channel, 1, ap::actual_velocity);
  enable(Trigger::rising_signed, 10'000);
  pass(milliseconds(500));
  EXPECT_EQ(state(), State::trigger);
  ask(Command::ROR, 0, 0, 50'000);
  pass(std::chrono::seconds(2));
  const auto speeds = samples(100);
  EXPECT_LE(speeds[19], 10'000);
  EXPECT_GT(speeds[20], 10'000);
  EXPECT_LT(speeds[0], speeds[19]);
}

TEST_F(SimDataLogger, ReadsAChannelAsAHostWould) {
  auto& module = add(6212);
  module.set_analog(0, 321);
  ask(Command::SGP, 42, 2, 77);
  ask(Command::SAP, ap::max_velocity, 5, 4711);
  const struct {
    Kind kind;
    std::int32_t select;
    std::int32_t value;
  } cases[] = {
      {Kind::axis_parameter, 5 << 24 | ap::max_velocity, 4711},
      {Kind::axis_parameter, 6 << 24 | ap::max_velocity, 0},
      {Kind::chip_register, 5 << 24 | 0x27, ask(Command::READ_MC, 0x27, 5)->value},
      {Kind::chip_register, 0x127, 0},
      {Kind::analog_input, 0, 321},
      {Kind::global_parameter, 2 << 24 | 42, 77},
      {Kind::ram_debug_parameter, 1, 0},
  };
  for (const auto& one : cases) {
    ask_logger(Type::init);
    channel(one.kind, one.select);
    enable();
    pass(milliseconds(1));
    EXPECT_EQ(samples(1)[0], one.value) << static_cast<int>(one.kind) << ' ' << one.select;
  }
}

// The selector is as it was before, so that whoever uses it does not notice.
TEST_F(SimDataLogger, PutsTheSelectorOfAStackedRegisterBack) {
  add(6212);
  ask(Command::WRITE_MC, 0x27, 0, 5);
  ask(Command::WRITE_MC, 0x23, 0, 99);
  channel(Kind::stacked_register, 7 << 16 | 0x27 << 8 | 0x23);
  enable();
  pass(milliseconds(1));
  EXPECT_EQ(samples(1)[0], ask(Command::READ_MC, 0x23, 0)->value);
  EXPECT_EQ(ask(Command::READ_MC, 0x27, 0)->value, 5);
}

TEST_F(SimDataLogger, ForgetsEverythingWhenTheModuleStartsAgain) {
  auto& module = add(1276);
  channel(Kind::axis_parameter, 1);
  enable();
  pass(milliseconds(10));
  module.power_cycle();
  pass(Module::boot_time);
  EXPECT_EQ(state(), State::idle);
  EXPECT_EQ(ask_logger(Type::get_channel_type)->value, 0);
  EXPECT_EQ(ask_logger(Type::get_info, 0, 3)->value, 0);
}

}  // namespace
}  // namespace tmcl::sim
