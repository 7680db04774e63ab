// An axis that a client moves on a line, on a path or in a reference search is moved by no client
// else, whichever method is tried.
#include <set>

#include <gmock/gmock.h>

#include "api/method.hpp"
#include "gateway/journey/path_run.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;

struct Movement {
  std::string name;
  ClaimKind mover;
  std::string method;
  json::object params;
  std::string words;
};
void PrintTo(const Movement& movement, std::ostream* out) { *out << movement.name; }

TEST(DaemonMovingMethods, HaveExamples) {
  std::set<std::string> shown;
  for (const auto& example : moving_examples()) shown.insert(example.method());
  for (const auto& method : method_table()) {
    if (method.effect != tmcl::Effect::moves) continue;
    EXPECT_TRUE(shown.contains(std::string(method.name)))
        << method.name << " can move a motor: give moving_examples() an example of it";
  }
}

class DaemonClaim : public testing::TestWithParam<Movement> {
 protected:
  void begin() {
    mover_.send(GetParam().method, GetParam().params);
    ASSERT_TRUE(bench_.daemon.eventually(
        [&] { return x().claim_kind() == GetParam().mover && x_moves() && !sends_starts(); }));
    seen_before_ = bench_.daemon.requests_seen();
  }
  GatewayAxis& x() { return *bench_.daemon.daemon().gateway().axes()[0]; }
  // The start has been answered: what moves from now on was asked for by another client.
  bool sends_starts() {
    const auto path = std::dynamic_pointer_cast<PathRun>(x().journey());
    return path && path->passed() == 0;
  }
  bool x_moves() {
    return std::ranges::any_of(bench_.daemon.wire().seen,
                               [](const auto& request) { return can_move(request, {}); });
  }
  std::vector<tmcl::Request> moves_of_others() {
    return bench_.daemon.on_reactor([&] {
      std::vector<tmcl::Request> moves;
      const auto& seen = bench_.daemon.wire().seen;
      for (auto i = seen_before_; i < seen.size(); ++i) {
        if (is_example(seen[i])) moves.push_back(seen[i]);
      }
      return moves;
    });
  }
  json::object error_of_last(const MovingExample& example) {
    json::object answer;
    for (const auto& step : example.steps) answer = bench_.client->call(step.method, step.params);
    return answer.contains("error") ? answer.at("error").as_object() : json::object{};
  }

  MovesBench bench_;
  RpcClient mover_{bench_.daemon.socket()};
  std::size_t seen_before_ = 0;
};

TEST_P(DaemonClaim, NobodyElseMovesTheAxis) {
  begin();
  for (const auto& example : moving_examples()) {
    // It can only go on with the path that has claimed the axis.
    if (example.method() == "path.resume" || example.method() == "path.feed") continue;
    SCOPED_TRACE(testing::PrintToString(example));
    const auto error = error_of_last(example);
    ASSERT_FALSE(error.empty()) << "it was not refused";
    EXPECT_EQ(error.at("code"), -32003);
    EXPECT_EQ(text(error.at("data").at("name")), "axis_claimed");
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
    EXPECT_EQ(text(error.at("data").at("hint")), "wait for its end, or stop it");
    EXPECT_EQ(text(error.at("message")), "axis 'x' " + GetParam().words);
    EXPECT_THAT(moves_of_others(), testing::IsEmpty());
    EXPECT_EQ(bench_.daemon.on_reactor([&] { return x().claim_kind(); }), GetParam().mover);
  }
  EXPECT_EQ(bench_.daemon.requests_seen(Command::MST), 0U);
  // A stop is always let through, and then the axis is free.
  bench_.client->result("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(bench_.daemon.eventually([&] { return x().claim_kind() == ClaimKind::none; }));
  bench_.client->result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}});
}

TEST_P(DaemonClaim, ItsSettingsCanBeSetUnlessItIsOnAPath) {
  begin();
  const auto answer = bench_.client->call(
      "parameter.set", {{"axis", "x"}, {"parameter", "max_current"}, {"value", 100}});
  EXPECT_EQ(answer.contains("error"), GetParam().mover == ClaimKind::path)
      << json::serialize(answer);
}

INSTANTIATE_TEST_SUITE_P(
    By, DaemonClaim,
    testing::Values(Movement{"line",
                             ClaimKind::line,
                             "line.move",
                             {{"axes", json::array{"x", "y"}},
                              {"positions_microsteps", json::array{6'000'000, 5'000'000}},
                              {"time_s", 300}},
                             "is on its way along a line"},
                    Movement{"path",
                             ClaimKind::path,
                             "path.run",
                             {{"axes", json::array{"x", "y"}}, {"text", "G1 X400 Y300 F300\n"}},
                             "is on its way along a path"},
                    Movement{"search",
                             ClaimKind::search,
                             "axis.start_home",
                             {{"axis", "x"}, {"mode", 1}},
                             "searches its reference"}),
    [](const auto& one) { return one.param.name; });

// A line looks at its axes now and then, and so sees them arrive later than others do.
TEST(DaemonLineClaim, WhoHasSeenTheEndOfALineCanMoveTheAxis) {
  MovesBench bench;
  for (const int place : {2'000, -2'000, 3'000}) {
    bench.client->result("line.move", {{"axes", json::array{"x", "y"}},
                                       {"positions_microsteps", json::array{place, place}}});
    bench.client->result("axis.wait", {{"axis", "x"}});
    bench.client->result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}});
    bench.client->result("axis.wait", {{"axis", "x"}});
  }
}

class DaemonSearchClaim : public testing::Test {
 protected:
  void search_ends() {
    bench_.daemon.on_reactor([&] {
      auto& module = bench_.daemon.wire().modules.at(1);
      const auto search = tmcl::Request{tmcl::ModuleAddress{1}, Command::RFS, 1, 0, 0};
      module.execute(search);
      return 0;
    });
  }
  MovesBench bench_;
};

// Nobody waits for what axis.start_home begins.
TEST_F(DaemonSearchClaim, ASearchThatHasEndedUnseenLocksNobodyOut) {
  bench_.client->result("axis.start_home", {{"axis", "x"}, {"mode", 1}});
  EXPECT_EQ(bench_.client->error("axis.rotate", {{"axis", "x"}, {"velocity_internal", 5}})
                .at("data")
                .at("name"),
            "axis_claimed");
  search_ends();
  bench_.client->result("axis.rotate", {{"axis", "x"}, {"velocity_internal", 5}});
  bench_.client->result("axis.stop", {{"axis", "x"}});
}

TEST_F(DaemonSearchClaim, ARawSearchIsOneToo) {
  bench_.client->result("module.execute",
                        {{"bus", "bench"}, {"address", 1}, {"command", "RFS"}, {"type", "START"}});
  const auto error = bench_.client->error(
      "line.move",
      {{"axes", json::array{"y", "x"}}, {"positions_microsteps", json::array{100, 100}}});
  EXPECT_EQ(error.at("data").at("name"), "axis_claimed");
  EXPECT_EQ(error.at("data").at("axis"), "x");
  bench_.client->result("axis.stop_home", {{"axis", "x"}});
  bench_.client->result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}});
}

}  // namespace
}  // namespace tmcld::test
