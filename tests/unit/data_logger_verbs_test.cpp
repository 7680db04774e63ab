// Recording in a module, as scripts: what can be recorded, and what is said where it cannot.
#include <gmock/gmock.h>

#include "support/data_logger.hpp"
#include "support/scripted_bus.hpp"
#include "tmcl/data_logger.hpp"

namespace tmcl {
namespace {

using ram_debug::State;
using ram_debug::Trigger;
using testing::HasSubstr;

constexpr ModuleAddress module{1};
constexpr DataLoggerInfo usual{4, 8192, 1000};

CaptureRequest request(std::size_t channels = 1) {
  CaptureRequest all;
  for (std::size_t i = 0; i < channels; ++i)
    all.channels.push_back(capture_channel(0, static_cast<std::uint8_t>(i)));
  return all;
}

std::string objection(const CaptureRequest& request) {
  const auto setup = plan_capture(usual, request);
  return setup ? "" : setup.error().message;
}

TEST(CapturePlan, FillsTheBufferAtFullRateIfNothingElseIsSaid) {
  const auto setup = plan_capture(usual, request(3));
  ASSERT_TRUE(setup);
  EXPECT_EQ(setup->samples, 2730U);
  EXPECT_EQ(setup->divider, 1U);
  EXPECT_EQ(setup->pretrigger, 0U);
}

TEST(CapturePlan, TakesRatesThatDivideThatOfTheModule) {
  auto asked = request();
  for (const auto& [rate, divider] :
       {std::pair{1000.0, 1U}, {500.0, 2U}, {333.333, 3U}, {0.1, 10'000U}}) {
    asked.rate_hz = rate;
    const auto setup = plan_capture(usual, asked);
    ASSERT_TRUE(setup) << rate;
    EXPECT_EQ(setup->divider, divider);
  }
  asked.rate_hz = 300;
  EXPECT_THAT(objection(asked),
              HasSubstr("at 300 Hz; the nearest that it can are 250 Hz and 333.333 Hz"));
  asked.rate_hz = 2000;
  EXPECT_THAT(objection(asked), HasSubstr("2000 Hz is faster than the module can: 1000 Hz"));
  asked.rate_hz = 0;
  EXPECT_THAT(objection(asked), HasSubstr("0 Hz is no rate"));
  asked.rate_hz = 1e-9;
  EXPECT_NE(objection(asked), "");
}

TEST(CapturePlan, SaysHowMuchThereIsRoomFor) {
  EXPECT_THAT(objection(request(5)),
              HasSubstr("5 channels are to be recorded, and the module can record 1 to 4"));
  EXPECT_THAT(objection(request(0)), HasSubstr("0 channels"));
  auto asked = request(2);
  asked.samples = 5000;
  EXPECT_THAT(objection(asked),
              HasSubstr("are 10000 values, and the buffer of the module holds 8192: 1 to 4096"));
  asked.samples = 0;
  EXPECT_NE(objection(asked), "");
}

TEST(CapturePlan, KeepsOneSampleForTheTrigger) {
  auto asked = request();
  asked.pretrigger_percent = 20;
  EXPECT_THAT(objection(asked), HasSubstr("without a trigger"));
  asked.trigger = CaptureTrigger{capture_channel(0, 3), Trigger::rising_signed, 100};
  EXPECT_EQ(plan_capture(usual, asked)->pretrigger, 1638U);
  asked.pretrigger_percent = 100;
  EXPECT_EQ(plan_capture(usual, asked)->pretrigger, 8191U);
}

class Capture : public testing::Test {
 protected:
  Capture() { test::give_data_logger(bus.add_module(1), bus.clock()); }
  void start(const CaptureRequest& request) {
    const auto setup = plan_capture(usual, request);
    ASSERT_TRUE(setup);
    const auto started = bus.run(verbs::start_capture(module, *setup));
    ASSERT_TRUE(started) << describe(started.error());
  }
  State state() { return *bus.run(verbs::capture_state(module)); }
  test::ScriptedBus bus;
};

TEST_F(Capture, AsksTheModuleWhatItCan) {
  const auto info = bus.run(verbs::data_logger_info(module));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->channels, 4U);
  EXPECT_EQ(info->elements, 8192U);
  EXPECT_EQ(info->ticks_per_second, 1000U);
}

TEST_F(Capture, AModuleWithoutCommand142IsSaidToHaveNone) {
  for (const auto status : {Status::invalid_command, Status::command_not_available}) {
    test::ScriptedBus other;
    other.add_module(1).refuse = [status](const Request&) { return status; };
    const auto info = other.run(verbs::data_logger_info(module));
    ASSERT_FALSE(info);
    EXPECT_EQ(info.error().outcome, Outcome::refused);
    EXPECT_THAT(info.error().message, HasSubstr("module 1 has no data logger"));
  }
}

TEST_F(Capture, ReadsWhatTheModuleHasRecorded) {
  auto asked = request(2);
  asked.samples = 50;
  asked.rate_hz = 500;
  const auto begun = bus.clock().now();
  start(asked);
  EXPECT_EQ(state(), State::capture);
  while (state() != State::complete) bus.pass(std::chrono::milliseconds(1));
  EXPECT_GE(bus.clock().now() - begun, std::chrono::milliseconds(100));
  const auto values = bus.run(verbs::read_samples(module, 0, 100));
  ASSERT_TRUE(values);
  ASSERT_EQ(values->size(), 100U);
  for (std::size_t i = 0; i + 2 < 100; ++i) EXPECT_EQ((*values)[i + 2] - (*values)[i], 2) << i;
  EXPECT_EQ((*values)[1] - (*values)[0], 1000);
  EXPECT_EQ(bus.run(verbs::read_samples(module, 90, 10)),
            std::vector<std::int32_t>(values->end() - 10, values->end()));
  const auto beyond = bus.run(verbs::read_samples(module, 98, 3));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, HasSubstr("module 1 has no sample 100"));
}

TEST_F(Capture, CanBeTakenUpAgainByWhoeverKnowsWhatItIs) {
  auto asked = request(2);
  asked.samples = 10;
  const auto setup = *plan_capture(usual, asked);
  EXPECT_THAT(bus.run(verbs::match_capture(module, setup)).error().message,
              HasSubstr("records nothing"));
  start(asked);
  EXPECT_TRUE(bus.run(verbs::match_capture(module, setup)));
  for (const std::size_t channels : {1U, 3U}) {
    const auto other = *plan_capture(usual, request(channels));
    EXPECT_THAT(bus.run(verbs::match_capture(module, other)).error().message,
                HasSubstr("records something else"));
  }
  EXPECT_TRUE(bus.run(verbs::end_capture(module)));
  EXPECT_EQ(state(), State::idle);
}

TEST_F(Capture, ATriggerThatIsIgnoredIsAnError) {
  auto asked = request();
  asked.trigger = CaptureTrigger{{}, Trigger::rising_signed, 0};
  const auto started = bus.run(verbs::start_capture(module, *plan_capture(usual, asked)));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, Errc::unexpected_value);
}

// A channel that was set twice would be recorded twice.
TEST_F(Capture, WhatIsLostOnTheWayIsSetUpAnew) {
  auto asked = request(2);
  asked.samples = 10;
  for (const auto fault : test::all_faults) {
    for (std::size_t datagram = 0; datagram < 8; ++datagram) {
      test::ScriptedBus lossy;
      test::give_data_logger(lossy.add_module(1), lossy.clock());
      lossy.fail(datagram, fault);
      const auto setup = *plan_capture(usual, asked);
      ASSERT_TRUE(lossy.run(verbs::start_capture(module, setup)))
          << datagram << ' ' << test::name_of(fault);
      EXPECT_TRUE(lossy.run(verbs::match_capture(module, setup)));
    }
  }
}

}  // namespace
}  // namespace tmcl
