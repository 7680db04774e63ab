// The module's own deadman: who sets it, who feeds it, and what becomes of a motor when nobody
// does.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "sim/module/event_sink.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::Command;
namespace gp = tmcl::global_parameter;

std::string with_deadman(int ms, std::string_view link = "serial:/dev/none@115200") {
  std::string config = cable_config;
  const std::string before = "serial:/dev/none@115200";
  config.replace(config.find(before), before.size(), link);
  return config + "[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = " + std::to_string(ms) +
         "\n";
}

class Deadmen : public Cable {
 protected:
  explicit Deadmen(int ms = 1000, std::string_view model = "TMCM-6212")
      : Deadmen(with_deadman(ms), model, tmcl::Framing::serial) {}
  Deadmen(const std::string& config, std::string_view model, tmcl::Framing framing)
      : Cable(config, model, framing) {
    wire.on_request = [this](const tmcl::Request& request) { requests.push_back(request); };
  }

  /// And then nothing gets through.
  void lose_answer_to(Command command, std::uint8_t type = gp::serial_heartbeat) {
    wire.on_answer = [=, this](const tmcl::Request& request, std::int32_t) {
      if (request.command == command && request.type == type) wire.is_cut = true;
    };
  }
  void set_elsewhere(std::uint8_t parameter, std::int32_t value) {
    other_master({tmcl::ModuleAddress{1}, Command::SGP, parameter, 0, value});
  }
  /// The daemon is not there while these are set.
  void restart_with(const std::vector<std::pair<std::uint8_t, std::int32_t>>& parameters,
                    const std::string& file = {}) {
    end_gateway();
    for (const auto& [parameter, value] : parameters) set_elsewhere(parameter, value);
    logged.clear();
    audited.clear();
    requests.clear();
    start_gateway({}, file);
  }
  json::value told() {
    return call("module.list", {})->at("modules").as_array().front().at("deadman");
  }
  auto count(Command command, std::uint8_t type) const {
    return std::ranges::count_if(requests, [&](const auto& request) {
      return request.command == command && request.type == type;
    });
  }
  auto lines_with(const std::string& text) const {
    return std::ranges::count_if(
        logged, [&](const auto& line) { return line.find(text) != std::string::npos; });
  }
  void set_out() {
    ASSERT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 700}}));
    time.run_for(500ms);
    ASSERT_TRUE(moves());
  }

  void stand_within(tmcl::Duration limit) {
    time.run_for(limit);
    EXPECT_FALSE(moves());
  }
  static constexpr tmcl::Duration time_to_ramp_down = 60ms;

  std::vector<tmcl::Request> requests;
};

TEST_F(Deadmen, AreWrittenOnceAndAuditedAndOnlyWhereTheyDiffer) {
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 1000);
  EXPECT_EQ(std::ranges::count_if(audited,
                                  [](const auto& line) {
                                    return line.find(
                                               "deadman of module 1 from 0 to 1000 ms "
                                               "outcome=done") != std::string::npos;
                                  }),
            1);
  restart_with({});
  EXPECT_EQ(count(Command::GGP, gp::serial_heartbeat), 1);
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 0);
  EXPECT_THAT(audited, IsEmpty());
}

TEST_F(Deadmen, AreNotWrittenToAModuleThatStartsAProgramByItself) {
  restart_with({{gp::serial_heartbeat, 0}, {gp::auto_start_mode, 1}});
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 0);
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 0);
  EXPECT_EQ(lines_with("starts a program by itself"), 1);
  set_out();
}

TEST_F(Deadmen, AreNotWrittenToALockedEepromAndThatIsSaidOnce) {
  constexpr std::int32_t lock = 1234;
  restart_with({{gp::serial_heartbeat, 0}, {gp::eeprom_lock, lock}});
  time.run_for(30s);
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 1);
  EXPECT_EQ(lines_with("keeps its deadman of 0 ms"), 1);
  ASSERT_EQ(audited.size(), 1U);
  EXPECT_THAT(audited.front(), HasSubstr("error=refused_by_module"));
  set_out();
}

TEST_F(Deadmen, AreFedAlsoIfNobodyHeardThatTheyWereSet) {
  lose_answer_to(Command::SGP);
  restart_with({{gp::serial_heartbeat, 0}});
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 1000);
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 1);
  set_out();
  time.run_for(5s);
  EXPECT_TRUE(moves());
}

TEST_F(Deadmen, AreSetLaterWhereAQuestionBeforeItWasNotAnswered) {
  lose_answer_to(Command::GGP, gp::auto_start_mode);
  restart_with({{gp::serial_heartbeat, 0}});
  wire.on_answer = {};
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 1000);
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 1);
}

TEST_F(Deadmen, KeepAMovingMotorGoingAsLongAsTheDaemonIsThere) {
  set_out();
  stand_within(1min);
  EXPECT_NEAR(mm(0), 700, 0.001);
}

// A stream sends nothing itself while its axes stand on the path.
TEST_F(Deadmen, AreFedWhileAPathIsHeld) {
  for (const auto* mode : {"velocity", "segments", "position"}) {
    SCOPED_TRACE(mode);
    const auto path = begin("path.run", {{"axes", json::array{"x", "y"}},
                                         {"text", "G1 X20 Y10 F1200\nG1 X0 Y0\n"},
                                         {"mode", mode}});
    ASSERT_TRUE(time.run_while_not([&] { return mm(0) > 5; }, 1min));
    ASSERT_TRUE(call("path.feed", {{"hold", true}}));
    time.run_for(10s);
    EXPECT_FALSE(moves());
    ASSERT_TRUE(call("path.feed", {{"hold", false}}));
    const auto ended = end(path);
    ASSERT_TRUE(ended) << ended.error().message;
    EXPECT_NEAR(mm(0), 0, 0.001);
  }
}

TEST_F(Deadmen, GetACommandInEveryThirdOfTheirTimeAndNoMore) {
  requests.clear();
  time.run_for(10s);
  EXPECT_GE(requests.size(), 29U);
  EXPECT_LE(requests.size(), 31U);
}

TEST_F(Deadmen, CostNothingWhileSomethingElseIsSent) {
  call("parameter.get", {{"axis", "x"}, {"parameter", 1}});
  requests.clear();
  for (int i = 0; i < 50; ++i) {
    call("parameter.get", {{"axis", "x"}, {"parameter", 1}});
    time.run_for(200ms);
  }
  EXPECT_EQ(requests.size(), 50U);
}

TEST_F(Deadmen, StopTheMotorsWhenTheDaemonIsNotThereAnyMore) {
  set_out();
  end_gateway();
  EXPECT_TRUE(moves());
  stand_within(1000ms + time_to_ramp_down);
  EXPECT_LT(mm(0), 200);
}

TEST_F(Deadmen, DoNotStopTheMotorsAfterOneLostAnswer) {
  set_out();
  lose_answer_to(Command::MVP, 0);
  EXPECT_FALSE(call("axis.move_to", {{"axis", "y"}, {"position", 1}}));
  EXPECT_TRUE(wire.is_cut);
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_TRUE(moves());
}

TEST_F(Deadmen, StopTheMotorsWhenTheCableIsCut) {
  set_out();
  wire.is_cut = true;
  stand_within(1000ms + time_to_ramp_down);
}

TEST_F(Deadmen, AreFedByWhoeverHoldsTheModuleAndAfterwards) {
  set_out();
  const auto loaded =
      call("program.load", {{"bus", "bench"}, {"address", 1}, {"program", "1c0000000000001c"}});
  EXPECT_TRUE(loaded) << loaded.error().message;
  time.run_for(5s);
  EXPECT_TRUE(moves());
}

class DeadmenOnCan : public Deadmen {
 protected:
  DeadmenOnCan() : Deadmen(with_deadman(1000, "can:none"), "TMCM-6212", tmcl::Framing::can) {}
};

TEST_F(DeadmenOnCan, AreAnotherParameter) {
  EXPECT_EQ(module.globals().value(gp::can_heartbeat), 1000);
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 0);
  set_out();
  time.run_for(5s);
  EXPECT_TRUE(moves());
  end_gateway();
  stand_within(1000ms + time_to_ramp_down);
}

class ModuleWithoutDeadman : public Deadmen {
 protected:
  ModuleWithoutDeadman() : Deadmen(1000, "TMCM-1276") {}
};

TEST_F(ModuleWithoutDeadman, IsSaidOnceAndWorks) {
  time.run_for(10s);
  EXPECT_EQ(lines_with("has no deadman"), 1);
  EXPECT_EQ(count(Command::SGP, gp::serial_heartbeat), 0);
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 700}}));
  end_gateway();
  time.run_for(2s);
  EXPECT_TRUE(moves());
}

class DeadmanOff : public Deadmen {
 protected:
  DeadmanOff() : Deadmen(0) {}
};

TEST_F(DeadmanOff, IsSwitchedOffWhereItIsOn) {
  restart_with({{gp::serial_heartbeat, 500}});
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 0);
  requests.clear();
  time.run_for(10s);
  EXPECT_THAT(requests, IsEmpty()) << "nothing is to be fed";
}

class DeadmanLeftAlone : public Deadmen {
 protected:
  DeadmanLeftAlone() : Deadmen(cable_config, "TMCM-6212", tmcl::Framing::serial) {}
};

TEST_F(DeadmanLeftAlone, IsNotEvenRead) {
  restart_with({{gp::serial_heartbeat, 500}});
  EXPECT_EQ(count(Command::GGP, gp::serial_heartbeat), 0);
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 500);
}

// ---- set by a call -----------------------------------------------------------------------------

TEST_F(DeadmanLeftAlone, IsSetByACallAndFedFromThenOn) {
  EXPECT_EQ(told(), "unknown");
  const auto set = call("axis.set_deadman", {{"axis", "x"}, {"ms", 700}});
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->at("ms"), 700);
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 700);
  EXPECT_THAT(audited.back(), HasSubstr("method=axis.set_deadman"));
  EXPECT_EQ(told(), "unknown") << "what it is set to proves nothing";
  set_out();
  time.run_for(5s);
  EXPECT_TRUE(moves());
  ASSERT_TRUE(call("axis.set_deadman", {{"axis", "x"}, {"ms", 0}}));
  EXPECT_EQ(told(), "none");
  requests.clear();
  time.run_for(5s);
  EXPECT_THAT(requests, IsEmpty());
}

TEST_F(DeadmanLeftAlone, IsFedAlsoIfNobodyHeardThatItWasSet) {
  lose_answer_to(Command::SGP);
  EXPECT_FALSE(call("axis.set_deadman", {{"axis", "x"}, {"ms", 700}}));
  wire.is_cut = false;
  time.run_for(5s);
  set_out();
  time.run_for(5s);
  EXPECT_TRUE(moves());
}

TEST_F(DeadmanLeftAlone, IsNotSetToWhatCannotWork) {
  EXPECT_EQ(name_of_error(call("axis.set_deadman", {{"axis", "x"}, {"ms", 99}})), "out_of_range");
  set_elsewhere(gp::auto_start_mode, 1);
  EXPECT_EQ(name_of_error(call("axis.set_deadman", {{"axis", "x"}, {"ms", 500}})), "bad_argument");
  EXPECT_EQ(module.globals().value(gp::serial_heartbeat), 0);
}

TEST_F(ModuleWithoutDeadman, SaysSoWhenItIsToBeSet) {
  const auto set = call("axis.set_deadman", {{"axis", "x"}, {"ms", 500}});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("has no deadman"));
  EXPECT_EQ(told(), "none");
}

// ---- tested ------------------------------------------------------------------------------------

constexpr std::int32_t set_ms = 500;

class DeadmanTest : public Deadmen {
 protected:
  explicit DeadmanTest(std::string_view model = "TMCM-6212") : Deadmen(set_ms, model) {
    speed_ = get(0, ap::max_velocity);
  }
  Answer begin_test() { return begin("axis.test_deadman", {{"axis", "x"}}); }
  /// It has begun, and its module is sent nothing.
  Answer begin_silence() {
    auto test = begin_test();
    time.run_for(300ms);
    EXPECT_TRUE(moves());
    requests.clear();
    return test;
  }
  void expect_measured(const Result<boost::json::object>& result) {
    ASSERT_TRUE(result) << result.error().message;
    const auto& found = result->at("deadman");
    ASSERT_TRUE(found.is_object()) << result->at("reason");
    EXPECT_EQ(found.at("ms"), set_ms);
    EXPECT_NEAR(found.at("measured").to_number<double>(), set_ms, 5);
    EXPECT_GT(result->at("way_microsteps").to_number<int>(), 0);
    EXPECT_EQ(told(), found);
    expect_in_order();
  }
  void expect_in_order() {
    EXPECT_FALSE(moves());
    EXPECT_EQ(get(0, ap::max_velocity), speed_);
    EXPECT_EQ(name_of_error(call("axis.move_to", {{"axis", "x"}, {"position", 1}})), "none");
  }

  const std::string file_ = std::filesystem::temp_directory_path() /
                            ("tmcl-deadman-" + std::to_string(::getpid()) + ".json");

 private:
  std::int32_t speed_;
};

TEST_F(DeadmanTest, TellsWhenTheMotorStopped) { expect_measured(end(begin_test())); }

class DeadmanTestOfTmc429 : public DeadmanTest {
 protected:
  DeadmanTestOfTmc429() : DeadmanTest("TMCM-3110") {}
};

TEST_F(DeadmanTestOfTmc429, TellsWhenTheMotorStopped) { expect_measured(end(begin_test())); }

TEST_F(DeadmanTest, TellsThatItDoesNotStop) {
  const auto test = begin_test();
  while (!test->has_value()) {
    time.run_for(100ms);
    // It is as if the module did not heed what it is set to.
    other_master({tmcl::ModuleAddress{1}, Command::GAP, ap::actual_position, 0, 0});
  }
  const auto result = end(test);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->at("deadman"), "none");
  EXPECT_EQ(result->at("reason"), "the motor went on for 2000 ms without a command");
  EXPECT_EQ(told(), "none");
  EXPECT_FALSE(moves());
}

TEST_F(DeadmanTest, MovesNothingWhereItIsOff) {
  set_elsewhere(gp::serial_heartbeat, 0);
  const auto result = end(begin_test());
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->at("deadman"), "none");
  EXPECT_EQ(result->at("reason"), "it is switched off");
  EXPECT_EQ(count(Command::MVP, 0), 0);
}

TEST_F(DeadmanTest, KeepsEverybodyElseFromTheModule) {
  const auto test = begin_silence();
  const auto looks = begin("axis.get_state", {{"axis", "x"}});
  const auto reads = begin("parameter.get", {{"axis", "y"}, {"parameter", 1}});
  const auto sets = begin("parameter.set", {{"axis", "y"}, {"parameter", 4}, {"value", 5}});
  const auto moves = begin("axis.move_to", {{"axis", "y"}, {"position_microsteps", 5}});
  time.run_for(1s);
  EXPECT_THAT(requests, IsEmpty());
  EXPECT_EQ(name_of_error(end(moves)), "axis_claimed");
  expect_measured(end(test));
  EXPECT_TRUE(end(looks));
  EXPECT_TRUE(end(reads));
  EXPECT_TRUE(end(sets));
}

TEST_F(DeadmanTest, EndsWithAStop) {
  const auto test = begin_silence();
  EXPECT_TRUE(call("axis.stop", {{"axis", "x"}}));
  EXPECT_LT(time_to_stand(), 100ms);
  const auto result = end(test);
  EXPECT_EQ(name_of_error(result), "superseded_by_stop");
  EXPECT_EQ(result.error().outcome, tmcl::Outcome::unknown) << "it has moved";
  EXPECT_EQ(told(), "unknown");
  expect_in_order();
}

TEST_F(DeadmanTest, EndsWithAStopOfAll) {
  const auto test = begin_silence();
  EXPECT_TRUE(call("system.stop_all", {}));
  EXPECT_LT(time_to_stand(), 100ms);
  EXPECT_EQ(name_of_error(end(test)), "superseded_by_stop");
}

TEST_F(DeadmanTest, EndsWithItsCaller) {
  const auto test = begin_silence();
  client_leaves();
  time.run_for(300ms);
  EXPECT_FALSE(moves());
  EXPECT_FALSE(end(test));
}

TEST_F(DeadmanTest, IsNoMeasurementWhereTheCableIsCut) {
  const auto test = begin_silence();
  wire.is_cut = true;
  EXPECT_FALSE(end(test));
  EXPECT_EQ(told(), "unknown");
  wire.is_cut = false;
  time.run_for(5s);
  expect_in_order();
}

TEST_F(DeadmanTest, EndsWhenTheLinkIsLost) {
  const auto test = begin_silence();
  const auto began = time.now();
  wire.unplug();
  EXPECT_EQ(name_of_error(end(test)), "link_lost");
  EXPECT_LT(time.now() - began, 3s);
  time.run_for(5s);
  expect_in_order();
}

TEST_F(DeadmanTest, IsNoMeasurementWhereASwitchHasStoppedTheAxis) {
  const auto test = begin_silence();
  module.at_stage(
      0, [](tmcl::sim::Stage& stage) { stage.press(tmcl::sim::StageSwitch::right, true); });
  const auto result = end(test);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("something else: right_limit"));
  EXPECT_EQ(told(), "unknown");
}

TEST_F(DeadmanTest, DoesNotBeginWhileAnotherMotorOfTheModuleMoves) {
  ASSERT_TRUE(call("axis.move_to", {{"axis", "y"}, {"position", 700}}));
  EXPECT_EQ(name_of_error(end(begin_test())), "axis_claimed");
  EXPECT_EQ(count(Command::MVP, 0), 1);
}

TEST_F(DeadmanTest, DoesNotBeginOnAnAxisThatIsLatched) {
  module.power_cycle();
  wire.touch();
  time.run_for(500ms);
  requests.clear();
  EXPECT_EQ(name_of_error(end(begin_test())), "latched");
  EXPECT_EQ(count(Command::MVP, 0), 0);
  EXPECT_FALSE(moves());
}

TEST_F(DeadmanTest, DoesNotBeginOnAnAxisThatSomebodyElseHasLeased) {
  ASSERT_TRUE(call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}}));
  be_another_client();
  EXPECT_EQ(name_of_error(end(begin_test())), "leased");
  EXPECT_EQ(count(Command::MVP, 0), 0);
  EXPECT_FALSE(moves());
}

TEST_F(DeadmanTest, IsRemembered) {
  restart_with({}, file_);
  expect_measured(end(begin_test()));
  const auto found = told();
  restart_with({}, file_);
  EXPECT_EQ(told(), found);
  restart_with({{gp::serial_heartbeat, 400}, {gp::auto_start_mode, 1}}, file_);
  EXPECT_EQ(told(), "unknown") << "it is set to something else";
  std::filesystem::remove(file_);
}

TEST_F(DeadmanTest, IsForgottenWithADamagedFile) {
  for (const auto* text : {"", "{", "[]", "{\"modules\":[5]}", "{\"modules\":[{\"bus\":5}]}"}) {
    std::ofstream(file_) << text;
    restart_with({}, file_);
    EXPECT_EQ(told(), "unknown") << text;
    EXPECT_EQ(lines_with("is not known any more"), 1) << text;
  }
  std::filesystem::remove(file_);
}

/// The soft limits of x are these.
std::string within(const std::string& limits, const std::string& more = {}) {
  auto config = with_deadman(set_ms);
  config.insert(config.find("units_per_revolution = 5\n"), "soft_limits = " + limits + "\n" + more);
  return config;
}

class DeadmanTestWithinLimits : public Deadmen {
 protected:
  DeadmanTestWithinLimits()
      : Deadmen(within("[-0.1, 100]", "max_velocity = 0.25\n"), "TMCM-6212",
                tmcl::Framing::serial) {}
};

TEST_F(DeadmanTestWithinLimits, KeepsToSoftLimitsAndToTheGreatestSpeed) {
  for (const auto* speed : {"max_velocity", "reference_search_speed", "reference_switch_speed"})
    call("parameter.set", {{"axis", "x"}, {"parameter", speed}, {"value", 2000}});
  const auto test = begin("axis.test_deadman", {{"axis", "x"}});
  double least = 0, greatest = 0;
  while (!test->has_value()) {
    time.run_for(10ms);
    least = std::min(least, mm(0));
    greatest = std::max(greatest, static_cast<double>(get(0, ap::actual_velocity)));
  }
  const auto result = end(test);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GE(least, -0.1);
  EXPECT_GT(greatest, 1'000);
  EXPECT_LE(greatest, 2'000);
}

class DeadmanTestWithoutRoom : public Deadmen {
 protected:
  DeadmanTestWithoutRoom() : Deadmen(within("[-0.1, 0.1]"), "TMCM-6212", tmcl::Framing::serial) {}
};

TEST_F(DeadmanTestWithoutRoom, IsRefused) {
  const auto result = call("axis.test_deadman", {{"axis", "x"}});
  EXPECT_EQ(name_of_error(result), "beyond_soft_limit");
  EXPECT_EQ(count(Command::MVP, 0), 0);
}

// ---- what is said of an axis that it has stopped ------------------------------------------------

TEST_F(Deadmen, AreToBlameWhenNobodyHasSentAnythingForTooLong) {
  set_out();
  call("axis.get_state", {{"axis", "x"}});
  wire.is_cut = true;
  time.run_for(3s);
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("stop_cause"), "deadman");
}

TEST_F(Deadmen, AreNotToBlameWhenSomethingElseHasStoppedIt) {
  set_out();
  call("axis.get_state", {{"axis", "x"}});
  module.at_stage(
      0, [](tmcl::sim::Stage& stage) { stage.press(tmcl::sim::StageSwitch::right, true); });
  wire.touch();
  time.run_for(500ms);
  EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("stop_cause"), "right_limit");
}

}  // namespace
}  // namespace tmcld::test
