// The USB port of a module: packets, no addresses, and answers that take their time.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <random>

#include "sim/wire/usb_line.hpp"
#include "sim_fixture.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

Bytes packet_of(const Request& request) {
  const auto bytes = encode_serial(request);
  return {bytes.begin(), bytes.end()};
}

class SimUsb : public SimTest {
 protected:
  std::optional<Reply> ask_by_usb(const Request& request) { return answer_to(packet_of(request)); }
  std::optional<Reply> answer_to(const Bytes& packet) {
    answers.clear();
    usb.receive(packet);
    EXPECT_THAT(answers, IsEmpty()) << "at once";
    pass(UsbLine::longest_answer);
    if (answers.empty()) return std::nullopt;
    EXPECT_THAT(answers, SizeIs(1));
    return reply_in(answers.front());
  }

  Module& module = add(3110, 7);
  std::vector<Bytes> answers;
  UsbLine usb{bench, module,
              [this](auto bytes) { answers.emplace_back(bytes.begin(), bytes.end()); }, 1};
};

TEST_F(SimUsb, IgnoresTheAddressAndAnswersWithItsOwn) {
  for (const auto address : std::to_array<std::uint16_t>({0, 1, 7, 255})) {
    const auto reply = ask_by_usb({ModuleAddress{address}, Command::GAP, 4, 0, 0});
    ASSERT_TRUE(reply) << address;
    EXPECT_EQ(reply->module, 7);
    EXPECT_EQ(reply->status, Status::ok);
    EXPECT_EQ(reply->value, module.axis(0).get(axis_parameter::max_velocity));
  }
}

TEST_F(SimUsb, AnswersAProbeOfZerosAndAWrongChecksum) {
  const auto zeros = answer_to(Bytes(9, 0));
  EXPECT_EQ(zeros->status, Status::invalid_command);
  EXPECT_EQ(zeros->module, 7);
  auto wrong = packet_of({ModuleAddress{1}, Command::GAP, 4, 0, 0});
  ++wrong.back();
  EXPECT_EQ(answer_to(wrong)->status, Status::wrong_checksum);
}

TEST_F(SimUsb, TakesNineBytesOfAPacketAndNoneOfAShorterOne) {
  const auto whole = packet_of({ModuleAddress{7}, Command::GAP, 4, 0, 0});
  auto twice = whole;
  twice.insert(twice.end(), whole.begin(), whole.end());
  EXPECT_TRUE(answer_to(twice)) << "the second is surplus";
  EXPECT_FALSE(answer_to({whole.begin(), whole.end() - 1}));
  EXPECT_FALSE(answer_to({whole.back()})) << "nor is it the rest of the last packet";
  EXPECT_TRUE(answer_to(whole));
}

TEST_F(SimUsb, AnswersWithinAQuarterToTwoMillisecondsByTheSeed) {
  const auto times_of = [this](std::uint64_t seed) {
    std::vector<Duration> times;
    TimePoint begin;
    UsbLine other(
        bench, module, [&](auto) { times.push_back(clock.now() - begin); }, seed);
    for (int i = 0; i < 200; ++i) {
      begin = clock.now();
      other.receive(packet_of({ModuleAddress{1}, Command::GAP, 4, 0, 0}));
      pass(UsbLine::longest_answer);
    }
    return times;
  };
  const auto times = times_of(5);
  ASSERT_THAT(times, SizeIs(200));
  EXPECT_GE(std::ranges::min(times), UsbLine::shortest_answer);
  EXPECT_LT(std::ranges::min(times), milliseconds(1));
  EXPECT_LE(std::ranges::max(times), UsbLine::longest_answer);
  EXPECT_GT(std::ranges::max(times), milliseconds(1));
  EXPECT_EQ(times_of(5), times);
  EXPECT_NE(times_of(6), times);
}

TEST_F(SimUsb, TellsAnArrivalToTheHostThatAskedForIt) {
  ask_by_usb({ModuleAddress{7}, Command::TARGET_REACHED_EVENT, 1, 0, 1});
  ask_by_usb({ModuleAddress{7}, Command::MVP, 0, 0, 100});
  answers.clear();
  pass(std::chrono::seconds(5));
  ASSERT_THAT(answers, SizeIs(1));
  EXPECT_EQ(reply_in(answers.front())->status, Status::delayed);
  EXPECT_EQ(reply_in(answers.front())->value, 1);
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(SimUsb, SaysNothingWhereTheModuleSaysNothing) {
  EXPECT_FALSE(ask_by_usb({ModuleAddress{7}, Command::FACTORY_RESET, 0, 0, 1234}));
  EXPECT_FALSE(ask_by_usb({ModuleAddress{7}, Command::GAP, 4, 0, 0})) << "it starts again";
  pass(Module::boot_time);
  EXPECT_TRUE(ask_by_usb({ModuleAddress{7}, Command::GAP, 4, 0, 0}));
}

TEST_F(SimUsb, SurvivesAnythingThatComes) {
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < 20'000; ++i) {
    Bytes packet(random() % 65);
    for (auto& byte : packet) byte = static_cast<std::uint8_t>(random());
    usb.receive(packet);
    pass(std::chrono::microseconds(random() % 500));
  }
  pass(std::chrono::seconds(10));
  EXPECT_TRUE(ask_by_usb({ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 1, 0, 0}));
}

}  // namespace
}  // namespace tmcl::sim
