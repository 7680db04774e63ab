// What was recorded of modules is asked of virtual ones.
#include "tools/tmclsim/replay.hpp"

#include <gmock/gmock.h>

#include "sim_fixture.hpp"
#include "tmcl/trace_file.hpp"

namespace tmclsim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::Command;
using tmcl::Request;
using tmcl::TracedDatagram;
using tmcl::Traffic;

class SimReplay : public tmcl::sim::SimTest {
 protected:
  void add_to_trace(Traffic::Direction direction, const std::vector<std::uint8_t>& bytes,
                    std::chrono::milliseconds later) {
    TracedDatagram datagram{tmcl::UtcTime((clock.now() + later).time_since_epoch()), direction};
    datagram.bytes = bytes;
    trace.datagrams.push_back(std::move(datagram));
  }
  /// The module of this test is asked, and answers after 2 ms as far as the record knows.
  void record(Command command, std::uint8_t type, std::int32_t value) {
    const auto bytes =
        tmcl::encode_serial(Request{tmcl::ModuleAddress{1}, command, type, 0, value});
    const std::vector<std::uint8_t> request(bytes.begin(), bytes.end());
    add_to_trace(Traffic::Direction::out, request, {});
    add_to_trace(Traffic::Direction::in, exchange(request), std::chrono::milliseconds(2));
    pass(std::chrono::milliseconds(100));
  }
  ReplayReport replay_on(const char* model) {
    tmcl::VirtualClock other_clock;
    tmcl::sim::Bench other(other_clock);
    other.add(*tmcl::find_model(model), tmcl::ModuleAddress{1});
    lines.clear();
    return replay(trace, other, other_clock,
                  [this](const std::string& text) { lines.push_back(text); });
  }
  void record_a_move() {
    add(1110);
    record(Command::SAP, 4, 1000);
    record(Command::MVP, 0, 20'000);
    for (int i = 0; i < 10; ++i) record(Command::GAP, 1, 0);
  }

  tmcl::Trace trace;
  std::vector<std::string> lines;
};

TEST_F(SimReplay, AModuleIsLikeItself) {
  record_a_move();
  const auto report = replay_on("TMCM-1110");
  EXPECT_EQ(report.requests, 12U);
  EXPECT_EQ(report.equal, 12U);
  EXPECT_TRUE(report.all_equal());
  EXPECT_THAT(lines, IsEmpty());
  EXPECT_EQ(describe(report), "12 requests: 12 replies as recorded");
}

TEST_F(SimReplay, EachDifferenceIsTold) {
  record_a_move();
  trace.datagrams[5].bytes = {2, 1, 100, 6, 0, 0, 0, 5, 114};  // a position of 5
  trace.datagrams[3].bytes = {2, 1, 4, 4, 0, 0, 78, 32, 121};  // the move was refused
  const auto report = replay_on("TMCM-1110");
  EXPECT_EQ(report.equal, 10U);
  EXPECT_EQ(report.other_values, 1U);
  EXPECT_EQ(report.other_replies, 1U);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_THAT(lines[0], HasSubstr("recorded: 1 MVP invalid_value (4) 20000  here: 1 MVP 20000"));
  EXPECT_THAT(lines[1], HasSubstr("recorded: 1 GAP 5  here: 1 GAP "));
  EXPECT_THAT(describe(report), HasSubstr("1 with another value, 1 otherwise different"));
}

TEST_F(SimReplay, AModuleThatIsNotThereIsSilent) {
  record_a_move();
  for (auto& datagram : trace.datagrams) datagram.bytes.front() ^= 4;
  const auto report = replay_on("TMCM-1110");
  EXPECT_EQ(report.equal, 0U);
  EXPECT_GT(report.missing + report.other_replies, 0U);
}

TEST_F(SimReplay, RepliesThatTheRecordLacksAreTooMany) {
  record_a_move();
  trace.datagrams.pop_back();
  const auto report = replay_on("TMCM-1110");
  EXPECT_EQ(report.surplus, 1U);
  EXPECT_THAT(lines, ElementsAre(HasSubstr("not in the record: 1 GAP ")));
}

TEST_F(SimReplay, AnEmptyRecordAsksNothing) {
  EXPECT_EQ(describe(replay_on("TMCM-1110")), "0 requests: 0 replies as recorded");
}

TEST_F(SimReplay, OnCanAsWell) {
  add(1110);
  const Request request{tmcl::ModuleAddress{1}, Command::GAP, 1, 0, 0};
  const auto frame = tmcl::encode_can(request);
  const auto reply = tmcl::encode_can(tmcl::Reply{2, 1, tmcl::Status::ok, Command::GAP, 0}, 2);
  for (const auto* each : {&frame, &reply}) {
    add_to_trace(each == &frame ? Traffic::Direction::out : Traffic::Direction::in,
                 {each->data.begin(), each->data.begin() + each->length}, {});
    trace.datagrams.back().on_can = true;
    trace.datagrams.back().can_id = each->id;
  }
  const auto report = replay_on("TMCM-1110");
  EXPECT_EQ(report.equal, 1U);
  EXPECT_TRUE(report.all_equal());
}

}  // namespace
}  // namespace tmclsim
