// A reference search whose switch never closes goes no further than it may, for each client.
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "unit/port_fixture.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;
using tmcl::sim::StageSettings;

constexpr double steps_per_mm = 51'200 / 5.0;

std::string with(const std::string& keys) {
  std::string config = cable_config;
  const std::string before = "motor = 0\n";
  return config.insert(config.find(before), keys);
}

struct Stage {
  const char* model;
  int mode;
};
void PrintTo(const Stage& stage, std::ostream* out) { *out << stage.model << ' ' << stage.mode; }

std::vector<Stage> all_modes() {
  std::vector<Stage> all;
  for (const int mode : {1, 2, 3, 4, 5, 6, 7, 8, 65, 66, 67, 68, 133, 134, 135, 136})
    for (const auto* model : {"TMCM-6212", "TMCM-3110"}) all.push_back({model, mode});
  return all;
}

class Searches : public Cable, public testing::WithParamInterface<Stage> {
 protected:
  explicit Searches(const std::string& keys = "soft_limits = [-40, 40]\n")
      : Cable(with(keys), GetParam().model) {
    const bool counts_pps = std::string_view(GetParam().model) == "TMCM-6212";
    for (const auto& [parameter, value] :
         {std::pair{194, counts_pps ? 102'400 : 1000}, {195, counts_pps ? 20'480 : 300}})
      call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
    // Nothing closes its switches where it gets to.
    module.mount(0, StageSettings{.left_switch = -1'000'000'000, .right_switch = 1'000'000'000});
    if (counts_pps) return;
    for (const int parameter : {4, 5})
      call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", 1000}});
  }
  bool is_inverted() const { return GetParam().mode > 128; }
  /// Looks at where the motor really is until it stands; the greatest way in one direction.
  double greatest_way() {
    double turned_at = real_mm();
    double last = turned_at;
    double greatest = 0;
    double direction = 0;
    for (int still = 0; still < 50;) {
      time.run_for(10ms);
      const double here = real_mm();
      const double step = here - last;
      still = step == 0 ? still + 1 : 0;
      if (step * direction < 0) turned_at = last;
      if (step != 0) direction = step;
      greatest = std::max(greatest, std::abs(here - turned_at));
      last = here;
      if (time.now() - began_ > 10min) {
        ADD_FAILURE() << "it never stands";
        break;
      }
    }
    return greatest;
  }
  /// Of the motor, whatever its module counts.
  double real_mm() {
    wire.bench().run_due();
    double steps = 0;
    module.at_stage(
        0, [&](tmcl::sim::Stage& stage) { steps = static_cast<double>(stage.position()); });
    return steps / steps_per_mm;
  }
  json::object x(json::object more = {}) {
    more["axis"] = "x";
    more["mode"] = GetParam().mode;
    return more;
  }
  void expect_stopped_within(double mm, const Result<boost::json::object>& homed) {
    ASSERT_FALSE(homed);
    EXPECT_EQ(name_of_error(homed), "move_interrupted") << homed.error().message;
    EXPECT_THAT(homed.error().message, HasSubstr("search_limit"));
    EXPECT_LT(way_, mm);
    EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("stop_cause"), "search_limit");
    EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("referenced"), false);
    EXPECT_FALSE(moves());
  }
  Result<boost::json::object> home(json::object more = {}) {
    began_ = time.now();
    const auto pending = begin("axis.home", x(std::move(more)));
    time.run_for(50ms);
    way_ = greatest_way();
    return end(pending);
  }

  double way_ = 0;
  tmcl::TimePoint began_{};
};

TEST_P(Searches, EndWhereTheSwitchesAreGood) {
  constexpr int mm = static_cast<int>(steps_per_mm);
  StageSettings stage{.left_switch = -41 * mm, .right_switch = 41 * mm};
  if (is_inverted())
    stage.home = tmcl::sim::Interval{-10 * mm, 10 * mm};
  else
    stage.home = tmcl::sim::Interval{-10 * mm, -9 * mm};
  module.mount(0, stage);
  const auto homed = home();
  // The home switch may be on the other side, where modes 7 and 8 do not turn.
  const int mode = GetParam().mode & ~(64 | 128);
  if (!homed) {
    EXPECT_TRUE(mode >= 7) << homed.error().message;
    EXPECT_THAT(homed.error().message, HasSubstr("search_limit"));
    return;
  }
  EXPECT_EQ(homed->at("max_travel"), 88.0);
  EXPECT_EQ(homed->at("switch_distance").is_null(), mode != 2 && mode != 3);
}

TEST_P(Searches, AreStoppedWhereTheSwitchesAreDead) {
  const auto homed = home({{"max_travel", "30mm"}});
  if (is_inverted() && homed) return;  // An open switch is a closed one then.
  expect_stopped_within(33, homed);
  EXPECT_GT(way_, 29);
}

TEST_P(Searches, OfAHostAtAPortAreStoppedByTheirLimit) {
  if (is_inverted()) return;
  for (const bool host_stays : {true, false}) {
    PortHost host(*this, "a", Role::operate);
    EXPECT_EQ(host.status_of(request_of(Command::SAP, 193, 0, GetParam().mode)), tmcl::Status::ok);
    began_ = time.now();
    EXPECT_EQ(host.status_of(request_of(Command::RFS, 0)), tmcl::Status::ok);
    if (!host_stays) host.go();
    EXPECT_LT(greatest_way(), 91) << host_stays;
    EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("stop_cause"), "search_limit");
    EXPECT_THAT(stopped, testing::Contains(HasSubstr("search_limit")));
    stopped.clear();
  }
}

TEST_P(Searches, AreStoppedByTheirLimitWhoeverBeganThem) {
  if (is_inverted()) return;
  call("parameter.set", {{"axis", "x"}, {"parameter", 193}, {"value", GetParam().mode}});
  began_ = time.now();
  const auto started = call("module.execute", {{"bus", "bench"},
                                               {"address", 1},
                                               {"command", "RFS"},
                                               {"type", 0},
                                               {"motor", 0},
                                               {"value", 0}});
  ASSERT_TRUE(started);
  EXPECT_LT(greatest_way(), 91);
  EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("stop_cause"), "search_limit");
  EXPECT_THAT(stopped, testing::Contains(HasSubstr("search_limit")));
}

TEST_P(Searches, AreStoppedWhateverBecomesOfTheCounter) {
  if (is_inverted()) return;
  began_ = time.now();
  const auto pending = begin("axis.home", x({{"max_travel", 30}}));
  const double from = real_mm();
  std::int32_t value = 0;
  while (!pending->has_value() && time.now() - began_ < 2min) {
    time.run_for(70ms);
    value = value == 0 ? 123'456 : 0;
    other_master({tmcl::ModuleAddress{1}, Command::SAP, ap::actual_position, 0, value});
  }
  way_ = greatest_way();
  const auto homed = end(pending);
  ASSERT_FALSE(homed);
  EXPECT_THAT(homed.error().message, HasSubstr("search_limit"));
  EXPECT_LT(std::abs(real_mm() - from), 33);
  EXPECT_GT(std::abs(real_mm() - from), 25);
}

class SearchTimeouts : public Cable {
 protected:
  SearchTimeouts() : Cable(with("home_max_travel = 500\n")) {}
};

TEST_F(SearchTimeouts, StopTheSearch) {
  const auto late = call("axis.home", {{"axis", "x"}, {"mode", 7}, {"timeout_ms", 500}});
  ASSERT_FALSE(late);
  EXPECT_EQ(name_of_error(late), "deadline_passed");
  EXPECT_THAT(late.error().message, HasSubstr("was stopped"));
  time.run_for(2s);
  EXPECT_FALSE(moves());
}

TEST_F(SearchTimeouts, LetItGoOnIfAskedTo) {
  const auto late =
      call("axis.home",
           {{"axis", "x"}, {"mode", 7}, {"timeout_ms", 500}, {"leave", true}, {"max_travel", 20}});
  ASSERT_FALSE(late);
  time.run_for(2s);
  EXPECT_TRUE(moves());
  time.run_for(60s);
  EXPECT_FALSE(moves()) << "it is stopped by its limit";
  EXPECT_LT(std::abs(mm(0)), 22);
}

TEST_F(SearchTimeouts, OfTheConfigurationAreTold) {
  module.mount(0, StageSettings{.left_switch = -30'000});
  const auto homed = call("axis.home", {{"axis", "x"}, {"mode", 1}});
  ASSERT_TRUE(homed) << homed.error().message;
  EXPECT_EQ(homed->at("max_travel"), 500.0);
  EXPECT_TRUE(homed->at("warnings").as_array().empty());
  EXPECT_TRUE(homed->at("switch_distance").is_null());
}

TEST(SearchLimits, AreToldWhereThereAreNone) {
  CableBench bench;
  bench.module.mount(0, StageSettings{.left_switch = -30'000});
  const auto homed = bench.call("axis.home", {{"axis", "x"}, {"mode", 1}});
  ASSERT_TRUE(homed) << homed.error().message;
  EXPECT_TRUE(homed->at("max_travel").is_null());
  EXPECT_THAT(std::string(homed->at("warnings").as_array().at(0).as_string()),
              HasSubstr("nothing bounds the search"));
  const auto started = bench.call("axis.start_home", {{"axis", "x"}, {"max_travel", "2rev"}});
  ASSERT_TRUE(started) << started.error().message;
  EXPECT_EQ(started->at("max_travel"), 10.0);
  for (const auto* travel : {"0mm", "-5mm"})
    EXPECT_FALSE(bench.call("axis.home", {{"axis", "x"}, {"max_travel", travel}})) << travel;
}

INSTANTIATE_TEST_SUITE_P(AllModes, Searches, testing::ValuesIn(all_modes()), [](const auto& one) {
  auto name = std::string(one.param.model).substr(5) + "Mode" + std::to_string(one.param.mode);
  return name;
});

}  // namespace
}  // namespace tmcld::test
