// What a module records by itself, as clients of the daemon get it: in virtual time, from a
// simulated TMCM-6212.
#include <gmock/gmock.h>

#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

class DaemonCapture : public testing::Test {
 protected:
  static json::object of_x(json::object more) {
    more["axis"] = "x";
    return more;
  }
  json::object start(json::object more = {}) {
    more.emplace("channels", json::array{"actual_position", "actual_velocity"});
    more.emplace("samples", 100);
    return bench_.client->result("capture.start", of_x(std::move(more)));
  }
  std::string state(const json::value& capture) {
    const auto result = bench_.client->result("capture.state", of_x({{"capture", capture}}));
    return std::string(result.at("state").as_string());
  }
  void wait_for(std::string_view wanted, const json::value& capture) {
    for (int looks = 0; looks < 5000 && state(capture) != wanted; ++looks) {
    }
    ASSERT_EQ(state(capture), wanted);
  }
  json::array read(const json::value& capture, int first, int count) {
    return bench_.client
        ->result("capture.read", of_x({{"capture", capture}, {"first", first}, {"count", count}}))
        .at("values")
        .as_array();
  }
  std::string why_not(std::string_view method, json::object params) {
    const auto error = bench_.client->error(method, of_x(std::move(params)));
    return std::string(error.at("data").at("name").as_string()) + ": " +
           std::string(error.at("message").as_string());
  }

  MovesBench bench_;
};

TEST_F(DaemonCapture, IsOfTheMoveThatHasPulledTheTrigger) {
  const auto started = start({{"rate_hz", 500},
                              {"trigger_parameter", "actual_velocity"},
                              {"trigger_edge", "rising"},
                              {"trigger_value", 1000},
                              {"pretrigger_percent", 20}});
  EXPECT_EQ(started.at("pretrigger"), 20);
  EXPECT_EQ(started.at("rate_hz").to_number<double>(), 500);
  EXPECT_EQ(started.at("channels").at(1).at("parameter"), "actual_velocity");
  const auto capture = started.at("capture");
  wait_for("trigger", capture);
  EXPECT_THAT(why_not("capture.read", {{"capture", capture}, {"first", 0}, {"count", 1}}),
              HasSubstr("refused_by_module: module 1 has no sample 0"));
  bench_.client->result("axis.move_to", of_x({{"position_microsteps", 51'200}}));
  wait_for("complete", capture);
  EXPECT_LE(read(capture, 39, 1)[0].as_int64(), 1000);
  EXPECT_GT(read(capture, 41, 1)[0].as_int64(), 1000);
  EXPECT_EQ(read(capture, 0, 128).size(), 128U);
  bench_.client->result("capture.end", of_x({{"capture", capture}}));
  EXPECT_EQ(state(capture), "idle");
}

TEST_F(DaemonCapture, LeavesTheBusToAPath) {
  const auto capture = start().at("capture");
  RpcClient mover(bench_.daemon.socket());
  mover.send("path.run",
             {{"axes", json::array{"x", "y"}}, {"text", "G1 X20 Y10 F1200\nG1 X40 Y0\n"}});
  auto& x = *bench_.daemon.daemon().gateway().axes()[0];
  ASSERT_TRUE(bench_.daemon.eventually([&] { return x.claim_kind() == ClaimKind::path; }));
  const auto asked = bench_.daemon.requests_seen(tmcl::Command::RAM_DEBUG);
  EXPECT_THAT(why_not("capture.start", {{"channels", json::array{"actual_position"}}}),
              HasSubstr("axis_claimed"));
  EXPECT_THAT(why_not("capture.state", {{"capture", capture}}), HasSubstr("axis_claimed"));
  EXPECT_THAT(why_not("capture.read", {{"capture", capture}, {"first", 0}, {"count", 1}}),
              HasSubstr("axis_claimed"));
  EXPECT_EQ(bench_.daemon.requests_seen(tmcl::Command::RAM_DEBUG), asked);
  ASSERT_TRUE(bench_.daemon.eventually([&] { return x.claim_kind() == ClaimKind::none; }));
}

TEST_F(DaemonCapture, TellsWhoeverReadsThatAnotherHasBegun) {
  const auto first = start().at("capture");
  const auto second = start().at("capture");
  EXPECT_NE(first, second);
  EXPECT_THAT(why_not("capture.state", {{"capture", first}}),
              HasSubstr("unexpected_value: the module of 'x' records something else"));
  EXPECT_THAT(why_not("capture.read", {{"capture", first}, {"first", 0}, {"count", 1}}),
              HasSubstr("unexpected_value"));
  bench_.client->result("capture.end", of_x({{"capture", first}}));
  wait_for("complete", second);
}

TEST_F(DaemonCapture, IsTakenUpAgainIfItIsTheSame) {
  EXPECT_THAT(
      why_not("capture.start", {{"channels", json::array{"actual_position"}}, {"resume", true}}),
      HasSubstr("records nothing"));
  start();
  const auto capture = start({{"resume", true}}).at("capture");
  wait_for("complete", capture);
  EXPECT_THAT(
      why_not("capture.start", {{"channels", json::array{"actual_position"}}, {"resume", true}}),
      HasSubstr("records something else"));
}

TEST_F(DaemonCapture, SaysWhatItCannotRecord) {
  const auto refused = [this](json::object params) {
    params.emplace("channels", json::array{"actual_position"});
    return why_not("capture.start", std::move(params));
  };
  EXPECT_THAT(refused({{"samples", 9000}}), HasSubstr("bad_argument"));
  EXPECT_THAT(refused({{"rate_hz", 300}}), HasSubstr("250 Hz and 333.333 Hz"));
  EXPECT_THAT(refused({{"channels", json::array{"actual_positon"}}}),
              HasSubstr("unknown_parameter"));
  EXPECT_THAT(refused({{"trigger_edge", "rising"}}), HasSubstr("go together"));
  EXPECT_THAT(refused({{"trigger_parameter", "1"}, {"trigger_edge", "up"}, {"trigger_value", 1}}),
              HasSubstr("'up' is no edge"));
}

}  // namespace
}  // namespace tmcld::test
