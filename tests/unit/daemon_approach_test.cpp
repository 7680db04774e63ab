// Axes that come to their targets from one side, on a simulated TMCM-6212 in virtual time.
#include <vector>

#include "tmcl/seconds.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// y does, with a distance of 0.5 mm; x goes straight.
class DaemonApproach : public DaemonPath {
 protected:
  explicit DaemonApproach(const std::string& more = "approach = \"from-below\"\n")
      : DaemonPath(std::string(in_mm) + "approach_distance = 0.5\n" + more) {
    module.before = [this](const tmcl::Request& request) {
      if (request.command == Command::MVP) places.push_back(request.value / microsteps_per_mm);
    };
  }
  ~DaemonApproach() override {
    daemon.on_reactor([&] { module.before = {}; });
  }

  json::object move_to(double position) {
    return client->result("axis.move_to", {{"axis", "y"}, {"position", position}});
  }
  json::object wait_for(double position) {
    return client->result("axis.wait",
                          {{"axis", "y"},
                           {"target_microsteps",
                            static_cast<std::int64_t>(std::lround(position * microsteps_per_mm))}});
  }
  std::vector<double> places_sent_to() {
    return daemon.on_reactor([&] { return std::exchange(places, {}); });
  }
  json::object state() { return client->result("axis.get_state", {{"axis", "y"}}); }
  bool until_y_is_below(double position) {
    return daemon.eventually([&] { return module.mm(1) < position; });
  }

  std::vector<double> places;
};

TEST_F(DaemonApproach, IsNeededOnTheWayDownOnly) {
  EXPECT_EQ(move_to(10).at("target"), 10);
  wait_for(10);
  EXPECT_THAT(places_sent_to(), ElementsAre(10));
  const auto down = move_to(5);
  EXPECT_EQ(down.at("target"), 5);
  EXPECT_EQ(wait_for(5).at("position"), 5);
  EXPECT_EQ(mm(1), 5);
  EXPECT_THAT(places_sent_to(), ElementsAre(4.5, 5));
}

TEST_F(DaemonApproach, IsForeseen) {
  move_to(10);
  wait_for(10);
  const auto begin = daemon.on_reactor([&] { return reactor->clock.now(); });
  const auto started = move_to(5);
  EXPECT_TRUE(started.at("warnings").as_array().empty()) << json::serialize(started);
  const double predicted = started.at("predicted_s").to_number<double>();
  wait_for(5);
  const auto took = tmcl::seconds(daemon.on_reactor([&] { return reactor->clock.now(); }) - begin);
  EXPECT_NEAR(took, predicted, 0.2);
  EXPECT_GT(predicted, 0.2);
}

TEST_F(DaemonApproach, ItsTargetIsTheOneThatWasAskedFor) {
  move_to(10);
  wait_for(10);
  move_to(5);
  bool stood_below = false;
  for (int looks = 0; looks < 2000; ++looks) {
    const auto seen = state();
    EXPECT_EQ(seen.at("target"), 5);
    if (!seen.at("moving").as_bool()) break;
    EXPECT_FALSE(seen.at("position_reached").as_bool());
    EXPECT_TRUE(seen.at("stop_cause").is_null());
    stood_below |= seen.at("velocity_internal") == 0 && seen.at("position").to_number<double>() < 5;
    daemon.run_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(stood_below);
  EXPECT_EQ(state().at("position"), 5);
  EXPECT_TRUE(state().at("position_reached").as_bool());
}

TEST_F(DaemonApproach, HoldsForDistancesToo) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  EXPECT_EQ(client->result("axis.move_by", {{"axis", "y"}, {"distance", -2}}).at("target"), 8);
  wait_for(8);
  EXPECT_THAT(places_sent_to(), ElementsAre(7.5, 8));
}

TEST_F(DaemonApproach, ItsDeadlineIsForTheFirstMove) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  client->result("axis.move_to", {{"axis", "y"}, {"position", 5}, {"deadline_ms", 100}});
  EXPECT_EQ(wait_for(5).at("position"), 5);
  EXPECT_THAT(places_sent_to(), ElementsAre(4.5, 5));
}

TEST_F(DaemonApproach, AStopEndsIt) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  move_to(2);
  const auto waiting = client->send("axis.wait", {{"axis", "y"}});
  ASSERT_TRUE(until_y_is_below(8));
  RpcClient other(daemon.socket());
  other.result("axis.stop", {{"axis", "y"}});
  client->answer_to(waiting);
  daemon.run_for(std::chrono::seconds(2));
  EXPECT_THAT(places_sent_to(), ElementsAre(1.5)) << "and to its target no more";
  EXPECT_FALSE(state().at("moving").as_bool());
  EXPECT_EQ(text(state().at("stop_cause")), "client");
  move_to(3);
  EXPECT_EQ(wait_for(3).at("position"), 3) << "it may be moved again";
}

TEST_F(DaemonApproach, ANewTargetOfItsClientCounts) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  move_to(2);
  ASSERT_TRUE(until_y_is_below(8));
  EXPECT_EQ(move_to(7).at("target"), 7);
  EXPECT_EQ(wait_for(7).at("position"), 7);
  EXPECT_THAT(places_sent_to(), ElementsAre(1.5, 6.5, 7));
}

TEST_F(DaemonApproach, IsNotDisturbedByOtherClients) {
  move_to(10);
  wait_for(10);
  move_to(2);
  RpcClient other(daemon.socket());
  const auto error = other.error("axis.move_to", {{"axis", "y"}, {"position", 4}});
  EXPECT_EQ(name_in(error), "axis_claimed");
  EXPECT_THAT(text(error.at("message")), HasSubstr("comes to from one side"));
  EXPECT_EQ(wait_for(2).at("position"), 2);
}

TEST_F(DaemonApproach, WhoseSecondMoveIsRefusedIsBroken) {
  RpcClient other(daemon.socket());
  other.result("subscribe", {{"axes", json::array{}}});
  move_to(10);
  wait_for(10);
  daemon.on_reactor([&] {
    module.refuse = [this](const tmcl::Request& request) {
      return request.command == Command::MVP && module.mm(1) < 6;
    };
  });
  move_to(5);
  const auto event = other.notification("notify_event");
  EXPECT_EQ(text(event.at("kind")), "approach_broken");
  EXPECT_EQ(json::serialize(event.at("motors")), "[1]");
  EXPECT_FALSE(state().at("moving").as_bool());
  daemon.on_reactor([&] { module.refuse = {}; });
}

class DaemonApproachWithin : public DaemonApproach {
 protected:
  DaemonApproachWithin() : DaemonApproach("approach = \"from-below\"\nsoft_limits = [0, 20]\n") {}
};

TEST_F(DaemonApproachWithin, GoesNoFurtherThanItsSoftLimits) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  move_to(0.25);
  wait_for(0.25);
  EXPECT_THAT(places_sent_to(), ElementsAre(0, 0.25));
  const auto error = client->error("axis.move_to", {{"axis", "y"}, {"position", 20.1}});
  EXPECT_EQ(name_in(error), "beyond_soft_limit");
  EXPECT_TRUE(places_sent_to().empty());
}

TEST_F(DaemonApproachWithin, ATargetBeyondThemLeavesTheMoveBefore) {
  move_to(10);
  wait_for(10);
  places_sent_to();
  move_to(2);
  ASSERT_TRUE(until_y_is_below(8));
  EXPECT_EQ(name_in(client->error("axis.move_to", {{"axis", "y"}, {"position", -1}})),
            "beyond_soft_limit");
  EXPECT_EQ(wait_for(2).at("position"), 2);
}

class DaemonApproachReversed : public DaemonApproach {
 protected:
  DaemonApproachReversed() : DaemonApproach("approach = \"from-below\"\nreverse = true\n") {}
};

TEST_F(DaemonApproachReversed, BelowIsBelowInItsUnit) {
  move_to(10);
  client->result("axis.wait", {{"axis", "y"}});
  places_sent_to();
  move_to(5);
  client->result("axis.wait", {{"axis", "y"}});
  EXPECT_THAT(places_sent_to(), ElementsAre(-4.5, -5));
}

class DaemonApproachFromAbove : public DaemonApproach {
 protected:
  DaemonApproachFromAbove() : DaemonApproach("approach = \"from-above\"\n") {}
};

TEST_F(DaemonApproachFromAbove, IsNeededOnTheWayUpOnly) {
  move_to(10);
  wait_for(10);
  EXPECT_THAT(places_sent_to(), ElementsAre(10.5, 10));
  move_to(5);
  wait_for(5);
  EXPECT_THAT(places_sent_to(), ElementsAre(5));
}

TEST(DaemonConfig, TellsWhatIsWrongWithAnApproach) {
  const auto problem = [](const std::string& lines) {
    const auto config = parse_config("[daemon]\nsocket = \"/run/a\"\n" + std::string(bench_bus) +
                                     axis_section("x", 0, lines));
    return config ? std::string("none") : config.error().front().message;
  };
  EXPECT_EQ(problem("approach = \"from-below\"\napproach_distance = 100\n"), "none");
  EXPECT_THAT(problem("approach = \"below\"\napproach_distance = 100\n"),
              HasSubstr("must be from-below or from-above"));
  EXPECT_THAT(problem("approach = \"from-below\"\n"), HasSubstr("needs 'approach_distance'"));
  EXPECT_THAT(problem("approach_distance = 1\n"), HasSubstr("means nothing without 'approach'"));
  EXPECT_THAT(problem("approach = \"from-above\"\napproach_distance = 0\n"),
              HasSubstr("greater than 0"));
}

}  // namespace
}  // namespace tmcld::test
