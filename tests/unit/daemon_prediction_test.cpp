// A move's answer says how long it will take; what that costs on the wire, and what it never costs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon_fixture.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;
using tmcl::plan::AxisTwin;

// Motor 0 of the wire's TMCM-3110, standing at 1000 as it is after power-up.
class DaemonPrediction : public DaemonTest {
 protected:
  DaemonPrediction() {
    daemon.on_reactor([&] {
      for (const auto parameter : AxisTwin::parameters(model))
        parameter_of_module(parameter) =
            find_parameter(tmcl::axis_parameters(model), parameter)->initial;
      return parameter_of_module(tmcl::axis_parameter::actual_velocity) = 0;
    });
  }
  std::int32_t& parameter_of_module(std::uint8_t number) {
    return daemon.wire().modules.at(1).parameter(0, number);
  }
  json::object move(json::object more = {}) {
    daemon.on_reactor(
        [&] { return parameter_of_module(tmcl::axis_parameter::actual_position) = 1000; });
    more["axis"] = "x";
    more["position_microsteps"] = 51'000;
    return client.result("axis.move_to", std::move(more));
  }

  const tmcl::Model& model = *tmcl::find_model("TMCM-3110");
};

TEST_F(DaemonPrediction, IsWhatTheTwinMakesOfTheMove) {
  auto twin = *AxisTwin::of(model);
  twin.place({1000});
  twin.move_to({51'000});
  const std::chrono::duration<double> expected = twin.time_to_arrival().value();
  EXPECT_DOUBLE_EQ(move().at("predicted_s").as_double(), expected.count());
}

TEST_F(DaemonPrediction, CostsTwoReadingsOnceTheSettingsAreKnown) {
  move();
  const auto known = daemon.requests_seen(Command::GAP);
  move();
  EXPECT_EQ(daemon.requests_seen(Command::GAP), known + 2);
  const double before = move().at("predicted_s").as_double();
  client.result("parameter.set", {{"axis", "x"}, {"parameter", "max_velocity"}, {"value", 500}});
  EXPECT_GT(move().at("predicted_s").as_double(), before + 0.5);
}

TEST_F(DaemonPrediction, CostsNothingWhereItIsNotWanted) {
  const auto before = daemon.requests_seen(Command::GAP);
  EXPECT_TRUE(move({{"predict", false}}).at("predicted_s").is_null());
  EXPECT_EQ(daemon.requests_seen(Command::GAP), before);
}

TEST_F(DaemonPrediction, IsNullForAnAxisThatWillNotArrive) {
  daemon.on_reactor([&] { return parameter_of_module(tmcl::axis_parameter::max_velocity) = 0; });
  EXPECT_TRUE(move().at("predicted_s").is_null());
}

// While it is known when a move ends, it is looked at once a second; whoever turns the axis instead
// may want to know sooner what becomes of it.
TEST_F(DaemonPrediction, IsForgottenWhenTheAxisIsSentElsewhere) {
  daemon.on_reactor([&] { return parameter_of_module(tmcl::axis_parameter::max_velocity) = 100; });
  ASSERT_GT(move().at("predicted_s").as_double(), 5);
  std::atomic<int> looks = 0;
  daemon.on_reactor([&] {
    parameter_of_module(tmcl::axis_parameter::actual_velocity) = 500;
    parameter_of_module(tmcl::axis_parameter::position_reached) = 0;
    daemon.wire().modules.at(1).before = [&](FakeModule&, const tmcl::Request& request) {
      if (request.command != Command::GAP || request.type != tmcl::axis_parameter::position_reached)
        return;
      if (++looks < 3) return;
      parameter_of_module(tmcl::axis_parameter::actual_velocity) = 0;
      parameter_of_module(tmcl::axis_parameter::position_reached) = 1;
    };
    return 0;
  });
  client.result("axis.rotate", {{"axis", "x"}, {"velocity_internal", 500}});
  const auto begin = daemon.now();
  client.result("axis.wait", {{"axis", "x"}});
  // Two pauses of poll_interval, which is 20 ms; of an end that is foreseen they take a second
  // each.
  EXPECT_LT(daemon.now() - begin, std::chrono::seconds(1));
  EXPECT_GE(looks, 3);
}

TEST_F(DaemonPrediction, LetsTheMoveGoOutWhenTheReadingsAreRefused) {
  daemon.on_reactor([&] {
    daemon.wire().modules.at(1).refuse = [](const tmcl::Request& request) {
      return request.command == Command::GAP ? std::optional(tmcl::Status::wrong_type)
                                             : std::nullopt;
    };
    return 0;
  });
  EXPECT_TRUE(move().at("predicted_s").is_null());
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 1U);
}

}  // namespace
}  // namespace tmcld::test
