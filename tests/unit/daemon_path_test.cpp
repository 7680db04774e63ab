// Paths that the daemon passes, on a simulated TMCM-6212 in the test's own process.
#include <cmath>

#include "tmcl/hex.hpp"
#include "unit/daemon_path_fixture.hpp"
#include "unit/throwing_peer.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

class DaemonPathInEachMode : public DaemonPath, public testing::WithParamInterface<const char*> {
 protected:
  json::object in_mode(json::object more = {}) {
    more["mode"] = GetParam();
    return more;
  }
};

constexpr const char* off_its_axes = "and each axis once";

TEST_P(DaemonPathInEachMode, APathIsPassedToItsExactEnd) {
  const auto id = client->send("path.run", order(short_way, in_mode()));
  const auto news = client->notification("notify_progress");
  EXPECT_EQ(news.at("id"), id);
  EXPECT_GT(news.at("duration_s").to_number<double>(), 0.4);
  const auto report = client->answer_to(id).at("result").as_object();
  EXPECT_EQ(mm(0), 9);
  EXPECT_EQ(mm(1), 2);
  // It is late rather than early: the clock of the path begins when that of passed_s runs.
  const auto late =
      report.at("passed_s").to_number<double>() - news.at("duration_s").to_number<double>();
  EXPECT_GE(late, 0);
  EXPECT_LT(late, 0.3);
  const auto& tracking = report.at("tracking_error").as_array();
  ASSERT_EQ(tracking.size(), 2U);
  for (const auto& axis : tracking) {
    EXPECT_GT(axis.at("readings").as_int64() + 0, 0);
    EXPECT_LT(axis.at("rms").to_number<double>(), 0.5);
  }
  EXPECT_TRUE(report.at("remarks").as_array().empty());
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathInEachMode, SaysWhereItsAxesWereSeenIfAskedTo) {
  auto more = in_mode();
  more["points"] = 20;
  const auto id = client->send("path.run", order(short_way, more));
  const auto report = client->answer_to(id).at("result").as_object();
  const auto& seen = report.at("seen").as_object();
  const auto& places = seen.at("positions").as_array();
  ASSERT_GT(places.size(), 1U);
  EXPECT_LE(places.size(), 20U);
  EXPECT_EQ(seen.at("times_s").as_array().size(), places.size());
  for (const auto& place : places) {
    EXPECT_GT(place.at(0).to_number<double>(), -0.5);
    EXPECT_LT(place.at(0).to_number<double>(), 9.5);
  }
  const auto without = client->send("path.run", order("G1 X1 Y1 F600\n", in_mode()));
  const auto plain = client->answer_to(without).at("result").as_object();
  for (const auto* none : {"seen", "on_path", "motors"}) EXPECT_TRUE(plain.at(none).is_null());
}

TEST_P(DaemonPathInEachMode, SaysByHowMuchATightToleranceWasExceeded) {
  auto more = in_mode();
  more["tolerance"] = 1e-7;
  more["deviation"] = 1;
  const auto id = client->send("path.run", order(short_way, more));
  const auto report = client->answer_to(id).at("result").as_object();
  const double off = report.at("off_path").to_number<double>();
  EXPECT_NEAR(report.at("tolerance_exceeded_by").to_number<double>(), off - 1e-7, 1e-9);
  EXPECT_THAT(json::serialize(report.at("warnings")),
              testing::HasSubstr("the tolerance of 1e-07 was exceeded by at least"));
  const auto wide = client->send("path.run", order("G1 X1 Y1 F600\n", in_mode()));
  const auto kept = client->answer_to(wide).at("result").as_object();
  EXPECT_TRUE(kept.at("tolerance_exceeded_by").is_null());
  EXPECT_EQ(kept.at("warnings").as_array().size(), 0U);
}

/// The simulated one does not count: so the motor of y stands, for all that its encoder says.
class DaemonPathWithAnEncoder : public DaemonPath {
 protected:
  DaemonPathWithAnEncoder() : DaemonPath(std::string(in_mm) + "encoder_counts_per_unit = 800\n") {}
};

TEST_F(DaemonPathWithAnEncoder, TheMotorsAreReportedOnBesideTheAxes) {
  const auto id =
      client->send("path.run", order("G1 X2 Y2 F600\n", {{"points", 20}, {"tolerance", 0.5}}));
  const auto report = client->answer_to(id).at("result").as_object();
  EXPECT_TRUE(report.at("tolerance_exceeded_by").is_null());
  const auto& motors = report.at("motors").as_object();
  ASSERT_EQ(motors.at("tracking_error").as_array().size(), 1U);
  const auto& y = motors.at("tracking_error").at(0);
  EXPECT_EQ(text(y.at("axis")), "y");
  EXPECT_NEAR(y.at("largest").to_number<double>(), 2, 0.1);
  const double off = motors.at("off_path").to_number<double>();
  EXPECT_NEAR(off, std::sqrt(2), 0.1) << "x is at its end, and y at its start";
  EXPECT_NEAR(motors.at("tolerance_exceeded_by").to_number<double>(), off - 0.5, 1e-9);
  EXPECT_NEAR(motors.at("off_path_at").at(1).to_number<double>(), 0, 1e-9);
  EXPECT_EQ(motors.at("seen").at("positions").as_array().size(),
            motors.at("on_path").at("positions").as_array().size());
  EXPECT_THAT(json::serialize(report.at("warnings")),
              testing::HasSubstr("by their encoders the motors exceeded the tolerance of 0.5"));
}

TEST_P(DaemonPathInEachMode, AStopByAnotherClientStopsAll) {
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(2));
  other.result("axis.stop", {{"axis", "y"}});
  const auto error = error_of(id);
  EXPECT_EQ(name_in(error), "stopped_by_other");
  EXPECT_EQ(text(error.at("message")), "y was stopped by another client");
  EXPECT_EQ(text(error.at("data").at("outcome")), "done");
  EXPECT_EQ(text(error.at("data").at("axis")), "y");
  EXPECT_TRUE(error.at("data").at("run").as_object().contains("tracking_error"));
  EXPECT_LT(mm(0), 15);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathInEachMode, WhoWatchesIsToldWhyItEnded) {
  RpcClient other(daemon.socket());
  other.result("subscribe", {{"axes", json::array{}}});
  auto gone = std::make_unique<RpcClient>(daemon.socket());
  gone->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(2));
  gone.reset();
  client->result("axis.stop", {{"axis", "y"}});
  const auto event = other.notification("notify_event");
  EXPECT_EQ(text(event.at("kind")), "path_broken");
  EXPECT_EQ(text(event.at("text")), "y was stopped by another client");
  EXPECT_EQ(json::serialize(event.at("motors")), "[1]");
}

TEST_P(DaemonPathInEachMode, WhatStopsAllStopsPathsToo) {
  const auto id = client->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(2));
  client->result("system.stop_all");
  EXPECT_EQ(name_in(error_of(id)), "stopped_by_other");
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathInEachMode, PathStopAnswersWhenAllIsOver) {
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(2));
  const auto stopped = other.result("path.stop", {{"axes", json::array{"y"}}});
  EXPECT_EQ(json::serialize(stopped.at("axes")), R"(["x","y"])");
  expect_rest_and_own_settings();
  EXPECT_EQ(name_in(error_of(id)), "stopped");
}

TEST_P(DaemonPathInEachMode, NobodyElseMovesItsAxes) {
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(1));
  const std::pair<const char*, json::object> calls[] = {
      {"axis.move_to", {{"axis", "x"}, {"position_microsteps", 5}}},
      {"axis.move_by", {{"axis", "y"}, {"distance_microsteps", 5}}},
      {"axis.rotate", {{"axis", "x"}, {"velocity_internal", 5}}},
      {"axis.home", {{"axis", "x"}}},
      {"axis.start_home", {{"axis", "x"}}},
      {"coordinate.move", {{"axis", "x"}, {"number", 1}}},
      {"parameter.set", {{"axis", "x"}, {"parameter", "max_velocity"}, {"value", 5}}}};
  for (const auto& [method, params] : calls) {
    const auto error = other.error(method, params);
    EXPECT_EQ(name_in(error), "axis_claimed") << method;
    EXPECT_THAT(text(error.at("message")), HasSubstr("is on its way along a path")) << method;
  }
  other.result("path.stop");
  EXPECT_EQ(name_in(error_of(id)), "stopped") << "none of these ended it";
}

TEST_P(DaemonPathInEachMode, ACommandThatFailsStopsAll) {
  on_module([](Played& played) {
    played.refuse = [&played](const tmcl::Request& request) {
      const bool leads_on = request.command == Command::SAP &&
                            (request.type == ap::target_position ||
                             (request.type == ap::max_velocity && request.value != own_velocity));
      return leads_on && request.motor == 1 && played.mm(0) > 2;
    };
    return 0;
  });
  const auto winding = "G1 X4 Y2 F1200\nG1 X8 Y5\nG1 X12 Y5.5\nG1 X16 Y9\nG1 X20 Y12\n";
  const auto error = client->error("path.run", order(winding, in_mode()));
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_THAT(text(error.at("message")), HasSubstr("y: "));
  on_module([](Played& played) {
    played.refuse = {};
    return 0;
  });
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathInEachMode, AnExceptionOnTheWayStopsAll) {
  const auto result = dispatch_for(daemon, std::make_shared<ThrowingPeer>(3), "path.run",
                                   order(long_way, in_mode()));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().name, "internal_error");
  EXPECT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  EXPECT_LT(mm(0), 35);
  const auto is_free = [&] {
    const auto& axis = *daemon.daemon().gateway().axes().front();
    return axis.journey() == nullptr && !axis.bus().has_paths();
  };
  EXPECT_TRUE(daemon.on_reactor(is_free));
}

TEST_P(DaemonPathInEachMode, AClientThatGoesDoesNotEndIt) {
  auto gone = std::make_unique<RpcClient>(daemon.socket());
  gone->send("path.run", order(short_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(1));
  gone.reset();
  EXPECT_TRUE(daemon.eventually([&] { return module.mm(0) == 9 && module.mm(1) == 2; }));
  EXPECT_TRUE(daemon.eventually(
      [&] { return daemon.daemon().gateway().axes().front()->journey() == nullptr; }));
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathInEachMode, TheEndOfTheDaemonStopsIt) {
  const auto id = client->send("path.run", order(long_way, in_mode()));
  ASSERT_TRUE(until_x_is_beyond(2));
  daemon.end();
  EXPECT_EQ(text(error_of(id).at("message")), "tmcld is ending");
  EXPECT_FALSE(module.moves());
  EXPECT_LT(module.mm(0), 15);
  for (std::uint8_t motor = 0; motor < 2; ++motor) {
    EXPECT_EQ(module.get(motor, ap::max_velocity), own_velocity);
    EXPECT_EQ(module.get(motor, ap::max_acceleration), own_acceleration);
    EXPECT_EQ(module.get(motor, 20), 10);
  }
}

TEST_P(DaemonPathInEachMode, ItIsNotBegunWhereTheAxesDoNotStand) {
  const auto away = client->error("path.run", order("x,y\n1,0\n2,2\n", in_mode()));
  EXPECT_EQ(name_in(away), "not_at_start");
  EXPECT_EQ(text(away.at("data").at("outcome")), "not_sent");
  EXPECT_THAT(text(away.at("message")), HasSubstr("x is at 0 and not at 10240"));
  EXPECT_EQ(mm(0), 0);
  client->result("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}});
  EXPECT_EQ(name_in(client->error("path.run", order(short_way, in_mode()))), "moving");
}

TEST_P(DaemonPathInEachMode, GCodeBeginsWhereTheAxesStand) {
  client->result("axis.move_to", {{"axis", "x"}, {"position", 2.5}});
  client->result("axis.wait", {{"axis", "x"}});
  client->result("path.run", order("G91 G1 X1 Y2 F1200\n", in_mode()));
  EXPECT_NEAR(mm(0), 3.5, 1e-4);
  EXPECT_NEAR(mm(1), 2, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Modes, DaemonPathInEachMode,
                         testing::Values("velocity", "segments", "position"),
                         [](const auto& mode) { return std::string(mode.param); });

TEST_F(DaemonPath, APauseStandsUntilItIsOver) {
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  client->result("path.pause", {{"axes", json::array{"x"}}});
  ASSERT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  const auto stood = mm(0);
  EXPECT_LT(stood, 12);
  daemon.run_for(std::chrono::milliseconds(300));
  constexpr double rest = 0.01;  // how far either is from where the path stands
  EXPECT_NEAR(mm(0), stood, rest);
  EXPECT_NEAR(mm(0), 2 * mm(1), rest + 2 * rest) << "on the path";
  client->result("path.resume");
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_EQ(mm(0), 40);
  expect_rest_and_own_settings();
}

TEST_F(DaemonPath, ALineEndsWithTheDaemonToo) {
  client->result("line.move",
                 {{"axes", json::array{"x", "y"}}, {"positions", json::array{40, 10}}});
  ASSERT_TRUE(until_x_is_beyond(1));
  daemon.end();
  EXPECT_FALSE(module.moves());
  for (std::uint8_t motor = 0; motor < 2; ++motor)
    EXPECT_EQ(module.get(motor, ap::max_velocity), own_velocity);
}

TEST_F(DaemonPath, ALineAndAPathExcludeEachOther) {
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way + "G1 X0\nG1 X40\nG1 X0\n"));
  ASSERT_TRUE(until_x_is_beyond(1));
  const auto line = other.error(
      "line.move", {{"axes", json::array{"x", "y"}}, {"positions_microsteps", json::array{0, 0}}});
  EXPECT_THAT(text(line.at("message")), HasSubstr("is on its way along a path"));
  EXPECT_EQ(name_in(other.error("path.run", order(short_way))), "axis_claimed");
  other.result("path.stop");
  error_of(id);
}

TEST_F(DaemonPath, BadInputIsNamedAndMovesNothing) {
  const auto expect = [&](json::object params, const char* name, const char* message) {
    const auto error = client->error("path.run", params);
    EXPECT_EQ(name_in(error), name) << json::serialize(params);
    EXPECT_THAT(text(error.at("message")), HasSubstr(message)) << json::serialize(params);
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
  };
  const auto with = [&](json::object more) { return order(short_way, std::move(more)); };
  expect(with({{"axes", json::array{"x", "yy"}}}), "unknown_axis", "'yy'");
  expect(with({{"axes", json::array{"x", "x"}}}), "bad_argument", off_its_axes);
  expect(with({{"axes", json::array{"x"}}}), "missing_axis", "the file moves Y");
  expect(with({{"file_axes", json::array{"X"}}}), "bad_argument", off_its_axes);
  expect(with({{"file_axes", json::array{"X", "Q"}}}), "unknown_axis", "has no axis Q");
  expect(with({{"file_axes", json::array{"X", "X"}}}), "missing_axis", "the file moves Y");
  expect(with({{"tolerance", 0}}), "out_of_range", "'tolerance'");
  expect(with({{"tolerance", -1}}), "out_of_range", "'tolerance'");
  expect(with({{"feed", 1e300}}), "out_of_range", "'feed'");
  expect(with({{"velocity", -1}}), "out_of_range", "'velocity'");
  expect(with({{"period_ms", 1}}), "out_of_range", "'period_ms'");
  expect(with({{"mode", "fast"}}), "bad_argument", "'mode' must be");
  expect(with({{"format", "svg"}}), "bad_argument", "'format' must be");
  expect(with({{"bytes", 5}}), "bad_argument", "'text' and 'bytes'");
  expect(order("G1 X1 F600\nG99\n"), "bad_path", "line 2: ");
  expect(order("M2\n"), "bad_path", "moves nothing");
  expect(order("G1 X1 Y1 A5 F600\n"), "missing_axis", "the file moves A");
  expect(order("G1 X900000 Y0 F600\n"), "out_of_range", "the path goes to X 900000");
  expect(order("t,x,y\n0,0,0\n0.1,50,0\n"), "bad_path", "line 3: too fast");
  client->send_raw(R"({"jsonrpc":"2.0","id":99,"method":"path.run","params":{"tolerance":NaN}})"
                   "\n");
  EXPECT_EQ(text(client->read().at("error").at("data").at("name")), "parse_error");
  for (const auto command : {Command::ROR, Command::ROL, Command::MVP, Command::SAP})
    EXPECT_EQ(daemon.requests_seen(command), 0U);
}

TEST_F(DaemonPath, WhatOfAFileIsNotCarriedOutIsTold) {
  const auto id = client->send("path.run", order("S5 M3\nG1 X1 Y1 F600\n", {}));
  const auto report = client->answer_to(id).at("result").as_object();
  EXPECT_THAT(json::serialize(report.at("warnings")),
              HasSubstr(R"(["line 1: S is not carried out","line 1: M3 is not carried out")"));
  const auto refused = error_of(client->send("path.plan", order("G1 X2 Y1 E5 F600\n", {})));
  EXPECT_EQ(name_in(refused), "bad_path");
  const auto plan = client->result("path.plan", order("G1 X2 Y1 E5 F600\n", {{"lenient", true}}));
  EXPECT_THAT(json::serialize(plan.at("warnings")),
              HasSubstr("line 1: 'E5' is not known here; skipped"));
  client->result("path.run", {{"plan", plan.at("plan")}});
  EXPECT_EQ(mm(0), 2);
}

TEST_F(DaemonPath, ALongTextComesInParts) {
  const std::string part = "G1 X1 F1200\n";
  const auto stage = [&](std::size_t offset, const std::string& more) {
    const std::vector<std::uint8_t> bytes(more.begin(), more.end());
    return client->result("path.stage", {{"offset", offset}, {"data", tmcl::to_hex(bytes)}});
  };
  EXPECT_EQ(stage(0, part).at("bytes"), part.size());
  EXPECT_EQ(stage(part.size(), "G1 Y1\n").at("bytes"), part.size() + 6);
  json::object params{{"axes", json::array{"x", "y"}}, {"bytes", part.size() + 6}};
  EXPECT_TRUE(client->call("path.run", params).contains("result"));
  EXPECT_EQ(mm(1), 1);
  const auto again = client->error("path.run", params);
  EXPECT_THAT(text(again.at("message")), HasSubstr("of a path of this client there are 0 bytes"));
}

TEST_F(DaemonPath, PausesConcernPathsOnly) {
  EXPECT_EQ(name_in(client->error("path.pause", {{"axes", json::array{"x"}}})), "no_path");
  EXPECT_EQ(json::serialize(client->result("path.stop")), R"({"axes":[]})");
}

class DaemonPathWithLimits : public DaemonPath {
 protected:
  DaemonPathWithLimits() : DaemonPath(std::string(in_mm) + "soft_limits = [-1, 6]\n") {}
};

// Of a turn of 51,200 microsteps that is 5 mm.
class DaemonPathWithLimitsInMicrosteps : public DaemonPath {
 protected:
  DaemonPathWithLimitsInMicrosteps() : DaemonPath("soft_limits = [-10240, 61440]\n") {}
};

TEST_F(DaemonPathWithLimitsInMicrosteps, VelocitiesStayWithinThem) {
  const auto beyond = client->error("path.run", order("G1 X5 Y7 F1200\n", {{"per_turn", 5}}));
  EXPECT_EQ(name_in(beyond), "beyond_soft_limit");
  EXPECT_THAT(text(beyond.at("message")),
              HasSubstr("71680 microsteps is beyond the soft limit of 61440 microsteps"));
  EXPECT_EQ(daemon.requests_seen(Command::ROR), 0U);
  const auto within = client->call("path.run", order("G1 X5 Y6 F1200\n", {{"per_turn", 5}}));
  EXPECT_TRUE(within.contains("result")) << within;
}

TEST_F(DaemonPathWithLimits, VelocitiesStayWithinThem) {
  const auto beyond = client->error("path.run", order("G1 X5 Y7 F1200\n"));
  EXPECT_EQ(name_in(beyond), "beyond_soft_limit");
  EXPECT_THAT(text(beyond.at("message")), HasSubstr("the path goes to Y 7"));
  EXPECT_EQ(daemon.requests_seen(Command::ROR), 0U);
  EXPECT_EQ(mm(0), 0);
  EXPECT_TRUE(client->call("path.run", order("G1 X5 Y6 F1200\n")).contains("result"));
  EXPECT_EQ(mm(1), 6);
}

}  // namespace
}  // namespace tmcld::test
