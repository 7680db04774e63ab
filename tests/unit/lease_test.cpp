// Who has a lease of axes is the only one who moves them; when it goes, they stop.
#include <gmock/gmock.h>

#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

constexpr tmcl::Duration ttl = 1s;

class DaemonLease : public testing::Test {
 protected:
  json::object acquire(json::object more = {}) {
    more["axes"] = json::array{"x", "y"};
    more.emplace("ttl_ms", ttl / 1ms);
    return holder_->result("lease.acquire", std::move(more));
  }
  static json::object key_of(const json::object& granted) {
    return {{"lease", granted.at("lease")}, {"epoch", granted.at("epoch")}};
  }
  json::object state_of(const char* axis) {
    return other_->result("axis.get_state", {{"axis", axis}});
  }
  std::string error_name(RpcClient& client, std::string_view method, json::object params) {
    const auto answer = client.call(method, std::move(params));
    const auto* error = answer.if_contains("error");
    return error == nullptr ? "" : text(error->at("data").at("name"));
  }
  std::string move_by(RpcClient& client) {
    return error_name(client, "axis.move_by", {{"axis", "x"}, {"distance_microsteps", 10}});
  }
  std::size_t stops() { return bench_.daemon.requests_seen(Command::MST); }
  std::ptrdiff_t acts() {
    return bench_.daemon.on_reactor([&] {
      const auto& seen = bench_.daemon.wire().seen;
      return std::ranges::count_if(seen, [](const auto& request) {
        return effect_of(request.command, request.type) != tmcl::Effect::reads;
      });
    });
  }

  MovesBench bench_;
  std::unique_ptr<RpcClient> holder_ = std::make_unique<RpcClient>(bench_.daemon.socket());
  std::unique_ptr<RpcClient> other_ = std::make_unique<RpcClient>(bench_.daemon.socket());
};

TEST_F(DaemonLease, NobodyElseMovesItsAxes) {
  acquire({{"ttl_ms", 60'000}});
  const auto before = acts();
  for (const auto& example : moving_examples()) {
    SCOPED_TRACE(testing::PrintToString(example));
    json::object answer;
    for (const auto& step : example.steps) answer = other_->call(step.method, step.params);
    // No path has begun that they could go on with.
    if (example.method() == "path.resume" || example.method() == "path.feed") continue;
    ASSERT_TRUE(answer.contains("error"));
    EXPECT_EQ(text(answer.at("error").at("data").at("name")), "leased");
    EXPECT_EQ(text(answer.at("error").at("data").at("outcome")), "not_sent");
    EXPECT_EQ(answer.at("error").at("code"), -32003);
  }
  EXPECT_EQ(acts(), before);
}

TEST_F(DaemonLease, NobodyElseChangesWhatTheirModulesAreSetTo) {
  acquire();
  const json::object module{{"bus", "bench"}, {"address", 1}};
  const auto on_module = [&](json::object params) {
    for (const auto& [name, value] : module) params.emplace(name, value);
    return params;
  };
  const std::vector<std::pair<std::string, json::object>> writes{
      {"parameter.set", {{"axis", "x"}, {"parameter", "max_current"}, {"value", 100}}},
      {"parameter.store", {{"axis", "y"}, {"parameter", "max_current"}}},
      {"coordinate.set", {{"axis", "x"}, {"number", 1}, {"position_microsteps", 7}}},
      {"coordinate.capture", {{"axis", "x"}, {"number", 1}}},
      {"global.set", on_module({{"parameter", 0}, {"bank", 2}, {"value", 1}})},
      {"io.set", on_module({{"port", 0}, {"value", 1}})},
  };
  const auto before = acts();
  for (const auto& [method, params] : writes) {
    EXPECT_EQ(error_name(*other_, method, params), "leased") << method;
    EXPECT_EQ(acts(), before);
  }
  const json::object of_another{{"axis", "1/2"}, {"parameter", "max_current"}, {"value", 100}};
  EXPECT_EQ(error_name(*other_, "parameter.set", of_another), "") << "this motor has no lease";
}

TEST_F(DaemonLease, EverybodyReadsAndStops) {
  acquire();
  EXPECT_EQ(error_name(*other_, "axis.get_state", {{"axis", "x"}}), "");
  EXPECT_EQ(error_name(*other_, "parameter.get", {{"axis", "x"}, {"parameter", 4}}), "");
  EXPECT_EQ(error_name(*other_, "axis.stop", {{"axis", "x"}}), "");
  EXPECT_EQ(error_name(*other_, "system.stop_all", {}), "");
  EXPECT_EQ(move_by(*other_), "leased") << "a stop by others does not end the lease";
}

TEST_F(DaemonLease, ItsHolderNeedsNoMoreWords) {
  acquire();
  EXPECT_EQ(move_by(*holder_), "");
  EXPECT_EQ(error_name(*holder_, "axis.wait", {{"axis", "x"}}), "");
  EXPECT_EQ(error_name(*holder_, "line.move",
                       {{"axes", json::array{"x", "y"}},
                        {"positions_microsteps", json::array{50'000, 70'000}}}),
            "");
}

TEST_F(DaemonLease, IsAllOfTheAxesOrNone) {
  other_->result("lease.acquire", {{"axes", json::array{"y"}}});
  const auto error = holder_->error("lease.acquire", {{"axes", json::array{"x", "y"}}});
  EXPECT_EQ(text(error.at("data").at("name")), "leased");
  EXPECT_THAT(text(error.at("data").at("holder")), testing::StartsWith("process "));
  EXPECT_GT(error.at("data").at("expires_ms").as_int64(), 0);
  EXPECT_TRUE(state_of("x").at("lease").is_null());
  EXPECT_EQ(move_by(*other_), "");
}

TEST_F(DaemonLease, IsNotGivenOfAnAxisThatSomebodyMoves) {
  other_->result("line.move", {{"axes", json::array{"x"}},
                               {"positions_microsteps", json::array{6'000'000}},
                               {"time_s", 300}});
  EXPECT_EQ(error_name(*holder_, "lease.acquire", {{"axes", json::array{"y", "x"}}}),
            "axis_claimed");
  EXPECT_TRUE(state_of("y").at("lease").is_null());
}

TEST_F(DaemonLease, StopsItsAxesWhenItIsNotRenewed) {
  other_->result("subscribe", {{"interval_ms", 1000}});
  acquire();
  holder_->result("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 6'000'000}});
  bench_.daemon.run_for(ttl - 100ms);
  EXPECT_EQ(stops(), 0U);
  bench_.daemon.run_for(200ms);
  EXPECT_EQ(stops(), 2U);
  const auto event = other_->notification("notify_event");
  EXPECT_EQ(text(event.at("kind")), "lease_lost");
  EXPECT_EQ(text(event.at("reason")), "expired");
  EXPECT_EQ(move_by(*other_), "");
}

TEST_F(DaemonLease, GoesOnWhenItIsRenewed) {
  const auto granted = acquire();
  for (int i = 0; i < 5; ++i) {
    bench_.daemon.run_for(ttl / 2);
    holder_->result("lease.renew", key_of(granted));
  }
  EXPECT_EQ(move_by(*other_), "leased");
  auto longer = key_of(granted);
  longer["ttl_ms"] = 4000;
  EXPECT_EQ(holder_->result("lease.renew", longer).at("ttl_ms"), 4000);
  bench_.daemon.run_for(3s);
  EXPECT_EQ(move_by(*other_), "leased");
  bench_.daemon.run_for(2s);
  EXPECT_EQ(move_by(*other_), "");
}

TEST_F(DaemonLease, StopsItsAxesWhenItsConnectionCloses) {
  acquire();
  holder_->result("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 6'000'000}});
  holder_.reset();
  ASSERT_TRUE(bench_.daemon.eventually([&] { return stops() == 2; }));
  EXPECT_EQ(move_by(*other_), "");
}

TEST_F(DaemonLease, LetsItsAxesGoOnIfItSaysSo) {
  acquire({{"on_loss", "keep"}});
  holder_->result("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 600'000}});
  holder_.reset();
  bench_.daemon.run_for(1s);
  EXPECT_EQ(stops(), 0U);
  EXPECT_TRUE(state_of("x").at("lease").is_null());
}

TEST_F(DaemonLease, LosesItsMovementsThatWait) {
  const auto granted = acquire({{"on_loss", "keep"}});
  const auto before = bench_.daemon.requests_seen(Command::MVP);
  bench_.daemon.wire().holds = true;
  const auto move = holder_->send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 9}});
  ASSERT_TRUE(bench_.daemon.eventually([&] { return !bench_.daemon.wire().held.empty(); }));
  other_->result("lease.break", {{"axis", "x"}});
  bench_.daemon.on_reactor([&] { bench_.daemon.wire().release(); });
  const auto answer = holder_->answer_to(move);
  ASSERT_TRUE(answer.contains("error"));
  EXPECT_EQ(text(answer.at("error").at("data").at("name")), "lease_lost");
  EXPECT_EQ(bench_.daemon.requests_seen(Command::MVP), before);
}

TEST_F(DaemonLease, IsProvenByItsEpochOnOtherConnections) {
  const auto granted = acquire();
  auto params = key_of(granted);
  params["axis"] = "x";
  params["distance_microsteps"] = 10;
  EXPECT_EQ(error_name(*other_, "axis.move_by", params), "");
  params["epoch"] = granted.at("epoch").as_int64() - 1;
  EXPECT_EQ(error_name(*other_, "axis.move_by", params), "stale_epoch");
  EXPECT_EQ(error_name(*other_, "lease.renew",
                       {{"lease", granted.at("lease")}, {"epoch", params["epoch"]}}),
            "stale_epoch");
  holder_->result("lease.release", key_of(granted));
  params["epoch"] = granted.at("epoch");
  EXPECT_EQ(error_name(*other_, "axis.move_by", params), "lease_lost");
  params.erase("epoch");
  EXPECT_EQ(error_name(*other_, "axis.move_by", params), "bad_argument");
}

TEST_F(DaemonLease, HasAnEpochThatThoseBeforeDoNotTell) {
  const auto first = acquire();
  holder_->result("lease.release", key_of(first));
  const auto second = acquire();
  const auto apart = second.at("epoch").as_int64() - first.at("epoch").as_int64();
  EXPECT_GT(std::abs(apart), 1'000'000) << "at random that is one of 4 thousand million pairs";
}

TEST_F(DaemonLease, IsKeptAndGivenBackWhateverElseIsInProgress) {
  const auto granted = acquire();
  const auto renew = [&](std::string_view method) {
    return error_name(*holder_, method, key_of(granted));
  };
  bench_.daemon.on_reactor([&] { bench_.daemon.wire().holds = true; });
  for (const auto* line :
       {R"({"jsonrpc":"2.0","id":0,"method":"axis.wait","params":{"axis":"x"}})",
        R"({"jsonrpc":"2.0","id":0,"method":"axis.stop","params":{"axis":"x"}})"})
    for (std::size_t i = 0; i < max_requests_in_flight; ++i)
      holder_->send_raw(std::string(line) + "\n");
  EXPECT_EQ(error_name(*holder_, "axis.get_state", {{"axis", "x"}}), "too_many_requests");
  EXPECT_EQ(renew("lease.renew"), "");
  const auto release = holder_->send("lease.release", key_of(granted));
  bench_.daemon.on_reactor([&] {
    bench_.daemon.wire().holds = false;
    bench_.daemon.wire().release();
  });
  EXPECT_TRUE(holder_->answer_to(release).contains("result"));
}

TEST_F(DaemonLease, IsReleasedWhenItsAxesHaveTakenAStop) {
  const auto granted = acquire();
  holder_->result("lease.release", key_of(granted));
  EXPECT_EQ(stops(), 2U);
  EXPECT_EQ(move_by(*other_), "");
  auto keeping = key_of(acquire());
  keeping["stop"] = false;
  holder_->result("lease.release", keeping);
  EXPECT_EQ(stops(), 2U);
}

TEST_F(DaemonLease, IsListedForEverybody) {
  const auto granted = acquire();
  const auto listed = other_->result("lease.list").at("leases").as_array();
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed[0].at("lease"), granted.at("lease"));
  EXPECT_EQ(listed[0].at("axes"), (json::array{"x", "y"}));
  EXPECT_FALSE(listed[0].as_object().contains("epoch"));
  EXPECT_EQ(state_of("x").at("lease"), granted.at("lease"));
}

TEST_F(DaemonLease, ThatWasBrokenIsLost) {
  const auto granted = acquire();
  other_->result("lease.break", {{"axis", "y"}});
  ASSERT_TRUE(bench_.daemon.eventually([&] { return stops() == 2; }));
  EXPECT_EQ(error_name(*holder_, "lease.renew", key_of(granted)), "lease_lost");
}

TEST_F(DaemonLease, EndsWhenItsAxesCannotBeStoppedOnlyWhenTheyStand) {
  acquire();
  bench_.daemon.wire().loses = [](const auto& request) { return request.command == Command::MST; };
  holder_.reset();
  bench_.daemon.run_for(5s);
  EXPECT_EQ(move_by(*other_), "axis_claimed");
  bench_.daemon.on_reactor([&] { bench_.daemon.wire().loses = {}; });
  bench_.daemon.run_for(2s);
  EXPECT_EQ(move_by(*other_), "");
}

// ---- turning without end -----------------------------------------------------------------------

class DaemonTurning : public DaemonLease {
 protected:
  std::string rotate(RpcClient& client, int velocity, bool unattended = false) {
    return error_name(client, "axis.rotate",
                      {{"axis", "x"}, {"velocity_internal", velocity}, {"unattended", unattended}});
  }
};

TEST_F(DaemonTurning, EndsWithTheConnectionThatAskedForIt) {
  EXPECT_EQ(rotate(*holder_, 500), "");
  bench_.daemon.run_for(1s);
  EXPECT_EQ(stops(), 0U);
  holder_.reset();
  ASSERT_TRUE(bench_.daemon.eventually([&] { return stops() == 1; }));
}

TEST_F(DaemonTurning, IsNotDisturbedByOthers) {
  rotate(*holder_, 500);
  EXPECT_EQ(move_by(*other_), "leased");
  EXPECT_EQ(rotate(*other_, 100), "leased");
  EXPECT_EQ(rotate(*holder_, 100), "");
}

TEST_F(DaemonTurning, IsOverWhenAnybodyStopsIt) {
  rotate(*holder_, 500);
  other_->result("axis.stop", {{"axis", "x"}});
  EXPECT_EQ(move_by(*other_), "");
  holder_.reset();
  bench_.daemon.run_for(1s);
  EXPECT_EQ(stops(), 1U);
}

// The answer to the move comes when the axis is told to turn already.
TEST_F(DaemonTurning, IsNotOverByAMoveThatWasSentBefore) {
  auto& wire = bench_.daemon.wire();
  wire.holds = true;
  other_->send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 9}, {"predict", false}});
  ASSERT_TRUE(bench_.daemon.eventually(
      [&] { return !wire.held.empty() && wire.held.back().command == Command::MVP; }));
  holder_->send("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
  bench_.daemon.run_for(10ms);
  bench_.daemon.on_reactor([&] { wire.release(); });
  ASSERT_TRUE(bench_.daemon.eventually([&] { return wire.count(Command::ROR) == 1; }));
  bench_.daemon.run_for(10ms);
  EXPECT_EQ(move_by(*other_), "leased");
  holder_.reset();
  ASSERT_TRUE(bench_.daemon.eventually([&] { return stops() == 1; }));
}

TEST_F(DaemonTurning, IsOverWhenTheAxisIsSentSomewhere) {
  rotate(*holder_, 500);
  EXPECT_EQ(move_by(*holder_), "");
  EXPECT_EQ(move_by(*other_), "");
  rotate(*holder_, 500);
  rotate(*holder_, 0);
  EXPECT_EQ(move_by(*other_), "");
}

TEST_F(DaemonTurning, UnattendedGoesOn) {
  EXPECT_EQ(rotate(*holder_, 500, true), "");
  EXPECT_EQ(state_of("x").at("unattended"), true);
  holder_.reset();
  bench_.daemon.run_for(1s);
  EXPECT_EQ(stops(), 0U);
  EXPECT_EQ(state_of("x").at("unattended"), true);
  EXPECT_EQ(move_by(*other_), "");
  EXPECT_EQ(state_of("x").at("unattended"), false);
}

TEST_F(DaemonTurning, ThatWasRefusedLeavesItAsItWas) {
  rotate(*holder_, 500);
  EXPECT_EQ(rotate(*holder_, 9'999'999), "refused_by_module");
  EXPECT_EQ(move_by(*other_), "leased");
}

TEST_F(DaemonTurning, OfAClientThatHasGoneDoesNotBegin) {
  bench_.daemon.wire().holds = true;
  other_->send("parameter.get", {{"axis", "x"}, {"parameter", 4}});
  ASSERT_TRUE(bench_.daemon.eventually([&] { return !bench_.daemon.wire().held.empty(); }));
  holder_->send("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
  bench_.daemon.run_for(10ms);
  holder_.reset();
  bench_.daemon.run_for(10ms);
  bench_.daemon.on_reactor([&] { bench_.daemon.wire().release(); });
  bench_.daemon.run_for(1s);
  EXPECT_EQ(bench_.daemon.requests_seen(Command::ROR), 0U);
}

TEST_F(DaemonTurning, UnderALeaseEndsWithThat) {
  const auto granted = acquire();
  rotate(*holder_, 500);
  EXPECT_EQ(state_of("x").at("lease"), granted.at("lease"));
  holder_->result("lease.release", key_of(granted));
  EXPECT_EQ(move_by(*other_), "");
}

}  // namespace
}  // namespace tmcld::test
