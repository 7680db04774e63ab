// What is remembered of a bus: datagrams and garbage, who asked, and no more than has room.
#include "gateway/traffic_log.hpp"

#include <gmock/gmock.h>

#include <string>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/hex.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using tmcl::Traffic;

class Traced : public testing::Test {
 protected:
  void ask(const tmcl::Request& request, std::uint64_t asker) {
    const auto bytes = tmcl::encode_serial(request);
    log.note({now, Traffic::Direction::out, 0, false, bytes, asker});
  }
  void hear(std::span<const std::uint8_t> bytes) {
    log.note({now, Traffic::Direction::in, 0, false, bytes});
  }
  void hear(const tmcl::Reply& reply) { hear(tmcl::encode_serial(reply)); }
  void hear(const std::string& hex) { hear(tmcl::from_hex(hex).value()); }
  void pass(milliseconds time) { now += time; }

  /// "> 0106 7" and "< 0201 7" with the asker, "!" for garbage; two bytes of each.
  std::vector<std::string> seen(const TrafficLog& of, std::uint64_t after = 0) const {
    std::vector<std::string> lines;
    for (const auto& entry : of.after(after, TrafficLog::most)) {
      const auto* mark = entry.direction == Traffic::Direction::out ? "> " : "< ";
      const std::size_t shown = entry.is_garbage ? entry.size : 2;
      lines.push_back((entry.is_garbage ? "! " : mark) +
                      tmcl::to_hex(std::span(entry.bytes).first(shown)) + ' ' +
                      std::to_string(entry.asker));
    }
    return lines;
  }

  tmcl::TimePoint now{std::chrono::hours(1)};
  TrafficLog log{tmcl::Framing::serial, tmcl::default_host_address};
};

const tmcl::Request position{tmcl::ModuleAddress{1}, tmcl::Command::GAP, 1, 0, 0};
const tmcl::Reply answer{2, 1, tmcl::Status::ok, tmcl::Command::GAP, 51200};

TEST_F(Traced, ARequestAndItsReplyHaveTheSameAsker) {
  EXPECT_EQ(log.last(), 0U);
  ask(position, 7);
  hear(answer);
  EXPECT_THAT(seen(log), ElementsAre("> 0106 7", "< 0201 7"));
  EXPECT_THAT(seen(log, 1), ElementsAre("< 0201 7"));
}

TEST_F(Traced, AReplyToAnotherCommandIsNobodys) {
  ask(position, 7);
  hear(tmcl::Reply{2, 1, tmcl::Status::ok, tmcl::Command::SAP, 1});
  EXPECT_THAT(seen(log), ElementsAre("> 0106 7", "< 0201 0"));
}

TEST_F(Traced, WhatBelongsToNoDatagramIsGarbage) {
  hear("ffee");
  hear(answer);
  hear("0102030405060708090a0b");
  pass(milliseconds(100));
  ask(position, 0);
  EXPECT_THAT(seen(log), ElementsAre("! ffee 0", "< 0201 0", "! 010203040506070809 0", "! 0a0b 0",
                                     "> 0106 0"));
}

TEST_F(Traced, AVersionMayComeAsAText) {
  ask({tmcl::ModuleAddress{1}, tmcl::Command::GET_FIRMWARE_VERSION, 0, 0, 0}, 3);
  hear("02" + tmcl::to_hex(std::vector<std::uint8_t>{'1', '1', '1', '0', 'V', '1', '1', '3'}));
  EXPECT_THAT(seen(log), ElementsAre("> 0188 3", "< 0231 0"));
}

TEST_F(Traced, HowBytesAreCutMakesNoDifference) {
  tmcl::test::Random random(tmcl::test::seed());
  std::vector<std::uint8_t> all;
  for (int i = 0; i < 200; ++i) {
    if (random.one_in(3)) {
      for (auto left = random.between(1, 12); left > 0; --left)
        all.push_back(static_cast<std::uint8_t>(random.between(0, 255)));
    } else {
      const auto bytes = tmcl::encode_serial(answer);
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
  }
  TrafficLog whole(tmcl::Framing::serial, tmcl::default_host_address);
  whole.note({now, Traffic::Direction::in, 0, false, all});
  for (std::span<const std::uint8_t> rest = all; !rest.empty();) {
    const auto count =
        std::min<std::size_t>(rest.size(), static_cast<std::size_t>(random.between(1, 20)));
    hear(rest.first(count));
    rest = rest.subspan(count);
  }
  EXPECT_EQ(seen(log), seen(whole));
  std::size_t kept = 0;
  for (const auto& entry : log.after(0, TrafficLog::most)) kept += entry.size;
  EXPECT_LE(all.size() - kept, 2 * tmcl::serial_datagram_size) << "nothing is lost but what waits";
}

TEST_F(Traced, TheLastReplyToSomebodyIsFound) {
  EXPECT_EQ(log.last_reply_to(7), std::nullopt);
  ask(position, 7);
  EXPECT_EQ(log.last_reply_to(7), std::nullopt);
  const tmcl::Reply refusal{2, 1, tmcl::Status::invalid_value, tmcl::Command::GAP, 4711};
  hear(refusal);
  ask(position, 8);
  hear(answer);
  EXPECT_EQ(log.last_reply_to(7), refusal);
  EXPECT_EQ(log.last_reply_to(8), answer);
  EXPECT_EQ(log.last_reply_to(9), std::nullopt);
}

TEST_F(Traced, OnlyTheLastAreRemembered) {
  constexpr std::size_t more = 10;
  for (std::size_t i = 0; i < TrafficLog::most + more; ++i) ask(position, i);
  EXPECT_EQ(log.last(), TrafficLog::most + more);
  EXPECT_EQ(log.first(), more + 1);
  const auto all = log.after(0, 2 * TrafficLog::most);
  ASSERT_EQ(all.size(), TrafficLog::most);
  EXPECT_EQ(all.front().number, more + 1);
  EXPECT_EQ(all.front().asker, more);
  EXPECT_EQ(log.after(0, 3).back().number, more + 3) << "the oldest first";
  EXPECT_TRUE(log.after(log.last(), 1).empty());
}

TEST_F(Traced, OnCanAFrameIsADatagram) {
  TrafficLog can(tmcl::Framing::can, tmcl::default_host_address);
  const auto out = tmcl::encode_can(position);
  can.note({now, Traffic::Direction::out, out.id, false, std::span(out.data).first(7), 9});
  const auto in = tmcl::encode_can(answer, 2);
  can.note({now, Traffic::Direction::in, in.id, false, std::span(in.data).first(7)});
  can.note({now, Traffic::Direction::in, in.id, true, std::span(in.data).first(3)});
  EXPECT_THAT(seen(can), ElementsAre("> 0601 9", "< 0164 9", "! 016406 9"));
  EXPECT_EQ(can.after(0, 1).front().can_id, 1U);
  EXPECT_TRUE(can.after(2, 1).front().can_extended);
  EXPECT_EQ(can.last_reply_to(9), std::nullopt) << "that was none";
}

}  // namespace
}  // namespace tmcld::test
