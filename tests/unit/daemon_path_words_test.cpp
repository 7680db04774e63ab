// M words on paths that the daemon passes: outputs that they switch, and M0, which waits.
#include "gateway/journey/path_run.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Module 2 is not there.
constexpr std::string_view bound_words =
    "[path]\n"
    "m3 = \"bench:1 output 0 1\"\n"
    "m4 = \"bench:2 output 0 1\"\n"
    "m5 = \"bench:1 output 0 0\"\n"
    "m8 = \"bench:1 output 1 1\"\n"
    "m9 = \"bench:1 output 1 0\"\n";

const std::string switching_way = "M3\nG1 X8 Y4 F1200 M8\nX10 M5\nM9 M7\n";
const std::string waiting_way = "M3\nG1 X8 Y4 F1200\nM0\nG1 X9 Y2\nM5\n";

// Of the path. Axes do not go back to stand nearer.
constexpr double tolerance = 0.05;

class DaemonPathWords : public DaemonPath {
 protected:
  DaemonPathWords() : DaemonPath(std::string(in_mm) + std::string(bound_words)) {
    on_module([&](Played& played) {
      played.before = [&](const tmcl::Request& request) {
        if (request.command != Command::SIO) return;
        switched.push_back(std::to_string(request.type) + "=" + std::to_string(request.value));
        moved_at_switch = moved_at_switch || played.moves();
      };
      return 0;
    });
  }
  ~DaemonPathWords() override {
    on_module([](Played& played) {
      played.before = {};
      played.refuse = {};
      return 0;
    });
  }
  std::vector<std::string> switches() {
    return on_module([&](Played&) { return switched; });
  }
  bool stood() {
    return on_module([&](Played&) { return !moved_at_switch; });
  }
  json::object status() {
    const auto paths = client->result("path.status").at("paths").as_array();
    return paths.empty() ? json::object{} : paths.front().as_object();
  }
  bool until_it_waits() {
    return daemon.eventually([&] {
      const auto path =
          std::dynamic_pointer_cast<PathRun>(daemon.daemon().gateway().find_axis("x")->journey());
      return path && path->waits_at() != nullptr;
    });
  }

  std::vector<std::string> switched;
  bool moved_at_switch = false;
};

class DaemonPathWordsInEachMode : public DaemonPathWords,
                                  public testing::WithParamInterface<const char*> {
 protected:
  int start(const std::string& text) {
    return client->send("path.run", order(text, {{"mode", GetParam()}}));
  }
};

TEST_P(DaemonPathWordsInEachMode, OutputsAreSwitchedWhereTheAxesStand) {
  const auto id = start(switching_way);
  const auto report = client->answer_to(id).at("result").as_object();
  EXPECT_THAT(switches(), ElementsAre("0=1", "1=1", "0=0", "1=0"));
  EXPECT_TRUE(stood());
  EXPECT_EQ(mm(0), 10);
  EXPECT_THAT(json::serialize(report.at("warnings")), HasSubstr("line 4: M7 is not carried out"));
  EXPECT_THAT(json::serialize(report.at("warnings")), testing::Not(HasSubstr("M3")));
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, AnOutputThatIsRefusedEndsThePath) {
  on_module([](Played& played) {
    played.refuse = [](const tmcl::Request& request) {
      return request.command == Command::SIO && request.type == 1 && request.value == 1;
    };
    return 0;
  });
  const auto error = error_of(start(switching_way));
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_THAT(text(error.at("message")),
              HasSubstr("line 2: M8 was not carried out: bench:1 output 1 1: "));
  EXPECT_THAT(switches(), ElementsAre("0=1", "1=1", "0=0", "1=0")) << "what may be on is off";
  EXPECT_EQ(mm(0), 0);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, AnOutputThatIsNotAnsweredEndsThePath) {
  const auto error = error_of(start("G1 X8 Y4 F1200\nM4\nX9\n"));
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_THAT(text(error.at("message")),
              HasSubstr("line 2: M4 was not carried out: bench:2 output 0 1: "));
  EXPECT_THAT(switches(), ElementsAre("0=0"));
  EXPECT_NEAR(mm(0), 8, tolerance);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, AStopOnTheWaySwitchesOff) {
  const auto id = start("M3 M8\n" + long_way);
  ASSERT_TRUE(until_x_is_beyond(2));
  RpcClient other(daemon.socket());
  other.result("axis.stop", {{"axis", "y"}});
  EXPECT_EQ(name_in(error_of(id)), "stopped_by_other");
  EXPECT_THAT(switches(), ElementsAre("0=1", "1=1", "0=0", "1=0"));
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, M0WaitsUntilPathResume) {
  const auto id = start(waiting_way);
  ASSERT_TRUE(until_it_waits());
  daemon.run_for(std::chrono::seconds(20));
  const auto waiting = status();
  EXPECT_EQ(text(waiting.at("phase")), "waiting");
  EXPECT_EQ(waiting.at("waits_at_line").as_int64(), 3);
  EXPECT_TRUE(waiting.at("held").as_bool());
  EXPECT_TRUE(waiting.at("left_s").is_null());
  EXPECT_NEAR(mm(0), 8, tolerance);
  EXPECT_THAT(switches(), ElementsAre("0=1"));
  RpcClient other(daemon.socket());
  EXPECT_EQ(json::serialize(other.result("path.resume").at("axes")), R"(["x","y"])");
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_THAT(switches(), ElementsAre("0=1", "0=0"));
  EXPECT_EQ(mm(0), 9);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, AStopWinsOverM0) {
  const auto id = start(waiting_way);
  ASSERT_TRUE(until_it_waits());
  RpcClient other(daemon.socket());
  other.result("axis.stop", {{"axis", "x"}});
  EXPECT_EQ(name_in(error_of(id)), "stopped_by_other");
  EXPECT_THAT(switches(), ElementsAre("0=1", "0=0"));
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathWordsInEachMode, ALeaseThatIsLostAtM0EndsThePath) {
  auto holder = std::make_unique<RpcClient>(daemon.socket());
  holder->result("lease.acquire", {{"axes", json::array{"x", "y"}}, {"ttl_ms", 60'000}});
  holder->send("path.run", order(waiting_way, {{"mode", GetParam()}}));
  ASSERT_TRUE(until_it_waits());
  const auto refused = client->error("path.resume", {});
  EXPECT_EQ(name_in(refused), "leased");
  EXPECT_EQ(text(status().at("phase")), "waiting");
  holder.reset();
  EXPECT_TRUE(daemon.eventually(
      [&] { return daemon.daemon().gateway().axes().front()->journey() == nullptr; }));
  EXPECT_THAT(switches(), ElementsAre("0=1", "0=0"));
  expect_rest_and_own_settings();
}

INSTANTIATE_TEST_SUITE_P(Modes, DaemonPathWordsInEachMode,
                         testing::Values("velocity", "segments", "position"),
                         [](const auto& mode) { return std::string(mode.param); });

TEST_F(DaemonPathWords, APlanSaysWhatIsSwitchedAndHowOftenItWaits) {
  const auto plan = client->result("path.plan", order(switching_way + "M0 M3\nX9\nM0 M8\n"));
  const auto course = plan.at("course").as_object();
  EXPECT_EQ(course.at("waits").as_int64(), 2);
  EXPECT_EQ(json::serialize(course.at("words")),
            R"([{"number":3,"times":2,"line":1,"switches":"bench:1 output 0 1"},)"
            R"({"number":5,"times":2,"line":3,"switches":"bench:1 output 0 0"},)"
            R"({"number":8,"times":2,"line":2,"switches":"bench:1 output 1 1"},)"
            R"({"number":9,"times":2,"line":4,"switches":"bench:1 output 1 0"}])");
  for (const auto& expected : plan.at("expected").as_array()) {
    EXPECT_TRUE(expected.at("refused").is_null()) << json::serialize(expected);
    EXPECT_TRUE(expected.at("keeps_tolerance").as_bool());
  }
  EXPECT_THAT(switches(), IsEmpty());
}

// With the feed's own words, too.
TEST_F(DaemonPathWords, TheEndOfAHoldLetsM0GoOn) {
  const auto id = client->send("path.run", order(waiting_way));
  ASSERT_TRUE(until_it_waits());
  const auto held = client->result("path.feed", {{"hold", true}, {"factor", 0.5}});
  EXPECT_EQ(text(held.at("paths").at(0).at("phase")), "pausing");
  EXPECT_EQ(held.at("paths").at(0).at("waits_at_line").as_int64(), 3);
  client->result("path.feed", {{"hold", false}});
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_EQ(mm(0), 9);
}

// What it switches off cannot be switched while its bus is gone.
TEST_F(DaemonPathWords, WhatIsNotSwitchedOffIsTold) {
  const auto id = client->send("path.run", order("M3\n" + long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  on_module([](Played& played) {
    played.refuse = [](const tmcl::Request& request) {
      return request.command == Command::SIO && request.value == 0;
    };
    return 0;
  });
  client->result("path.stop");
  const auto error = error_of(id);
  EXPECT_THAT(text(error.at("message")),
              HasSubstr("M5 was not carried out, and what it switches off may be on"));
  EXPECT_THAT(json::serialize(error.at("data").at("run").at("remarks")),
              HasSubstr("M5 was not carried out: bench:1 output 0 0: "));
}

}  // namespace
}  // namespace tmcld::test
