// line.move on simulated modules: its limits, its units, and what becomes of it when something goes
// wrong at any of its steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "unit/simulated_modules.hpp"

namespace tmcld::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using tmcl::Command;
using tmcl::Request;

namespace ap = tmcl::axis_parameter;

constexpr std::string_view quick_bench = R"(
[[bus]]
name = "bench"
link = "serial:/dev/none@115200"
reply_timeout_ms = 100
)";

std::string axis(const std::string& name, int module, int motor, const std::string& more = {}) {
  return axis_section(name, motor, more, module);
}

std::string in(const std::string& unit, int per_revolution) {
  return "unit = \"" + unit + "\"\nunits_per_revolution = " + std::to_string(per_revolution) +
         "\nreverse = true\n";
}

std::string axes_without_units() {
  return std::string(quick_bench) + axis("x", 1, 0) + axis("y", 1, 1) + axis("z", 2, 0);
}

/// Two TMCM-3110, on which motors move in virtual time. The requests of a line are counted, and one
/// of them can be made to go wrong.
class LineBench {
 public:
  explicit LineBench(const std::string& config = axes_without_units()) : daemon_(config, reactor_) {
    for (std::uint8_t address = 1; address <= 2; ++address) {
      modules_.add(daemon_.wire(), "TMCM-3110", address);
      daemon_.wire().modules.at(address).play = [this](const Request& request) {
        return std::optional(play(request));
      };
    }
    daemon_.wire().loses = [this](const Request& request) {
      return count_ == loses_at || tmcl::reply_byte(request.address) == silent_module;
    };
    daemon_.start();
    client = std::make_unique<RpcClient>(daemon_.socket());
  }

  // What the tests arrange; the first request is 1.
  std::size_t refuses_at = 0;
  Command refused{};
  std::size_t loses_at = 0;  // the answer
  std::size_t stops_at = 0;  // somebody stops x
  std::atomic<int> silent_module = 0;
  std::atomic<bool> loses_link_at_start = false;  // for good, when the first one has started

  /// The next line reads everything anew, so that its requests are always the same.
  void begin() {
    for (const auto* axis : {"x", "y", "z"}) {
      client->result("parameter.set",
                     {{"axis", axis}, {"parameter", "max_velocity"}, {"value", 1000}});
    }
    daemon_.on_reactor([&] { return count_ = started_at_ = first_set_at_ = 0; });
  }
  /// The number of the last request that has started a motor; 0 if none has.
  std::size_t started_at() {
    return daemon_.on_reactor([&] { return started_at_; });
  }
  /// The number of the first request that has changed a setting.
  std::size_t first_set_at() {
    return daemon_.on_reactor([&] { return first_set_at_; });
  }
  std::int32_t value(const std::string& axis, std::uint8_t parameter) {
    const std::uint16_t module = axis == "z" ? 2 : 1;
    const std::uint8_t motor = axis == "y" ? 1 : 0;
    const Request request{tmcl::ModuleAddress{module}, Command::GAP, parameter, motor, 0};
    return daemon_.on_reactor([&] { return carry_out(request).value; });
  }
  /// Nothing moves, no line goes on, and all settings are what they were at first.
  bool is_at_rest(const std::string& axis) {
    const auto& model = *tmcl::find_model("TMCM-3110");
    const auto is_as_before = [&](std::uint8_t parameter) {
      return value(axis, parameter) ==
             find_parameter(tmcl::axis_parameters(model), parameter)->initial;
    };
    return value(axis, ap::actual_velocity) == 0 &&
           std::ranges::all_of(tmcl::plan::AxisTwin::parameters(model), is_as_before) &&
           daemon_.on_reactor(
               [&] { return !daemon_.daemon().gateway().find_axis(axis)->is_on_journey(); });
  }
  /// False after ten seconds.
  template <class Condition>
  bool eventually(Condition condition) {
    return daemon_.eventually(condition);
  }
  void expect_rest() {
    const auto all_rest = [&] { return is_at_rest("x") && is_at_rest("y") && is_at_rest("z"); };
    EXPECT_TRUE(eventually(all_rest));
  }

  json::object line(json::array axes, json::array positions, json::object more = {}) {
    more["axes"] = std::move(axes);
    more["positions_microsteps"] = std::move(positions);
    return client->call("line.move", std::move(more));
  }

  /// As a stop switch does: the module itself ends the movement.
  void limit_x(std::int32_t velocity) {
    daemon_.on_reactor([&] {
      return carry_out({tmcl::ModuleAddress{1}, Command::SAP, ap::max_velocity, 0, velocity})
          .status;
    });
  }
  /// The link is lost; unless it `stays_away`, it can be opened again at once.
  void unplug(bool stays_away = false) {
    daemon_.on_reactor([&] {
      daemon_.wire().is_absent = stays_away;
      return daemon_.wire().unplug(), 0;
    });
  }
  void plug_in() {
    daemon_.on_reactor([&] { return daemon_.wire().is_absent = false; });
  }
  DaemonSocket socket() const { return daemon_.socket(); }
  std::unique_ptr<RpcClient> client;

 private:
  tmcl::Reply play(const Request& request) {
    ++count_;
    if (count_ == stops_at) stop();
    if (count_ == refuses_at) {
      refused = request.command;
      return {2, tmcl::reply_byte(request.address), tmcl::Status::invalid_value, request.command,
              0};
    }
    if (request.command == Command::SAP && first_set_at_ == 0) first_set_at_ = count_;
    if (request.command == Command::MVP) {
      started_at_ = count_;
      if (loses_link_at_start) lose_link();
    }
    return carry_out(request);
  }
  tmcl::Reply carry_out(const Request& request) { return modules_.carry_out(request); }
  // After the answer.
  void lose_link() {
    boost::asio::post(daemon_.daemon().context(), [this] {
      daemon_.wire().is_absent = true;
      daemon_.wire().unplug();
    });
  }
  // Somebody else does it.
  void stop() {
    const auto axis = daemon_.daemon().gateway().find_axis("x");
    boost::asio::co_spawn(
        daemon_.daemon().context(),
        [axis]() -> boost::asio::awaitable<void> { co_await axis->stop(); }, boost::asio::detached);
  }

  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModules modules_{reactor_->clock};
  std::size_t count_ = 0;
  std::size_t started_at_ = 0;
  std::size_t first_set_at_ = 0;
  TestDaemon daemon_;
};

std::string axes_with_units() {
  return std::string(quick_bench) + axis("x", 1, 0, in("mm", 5)) + axis("y", 1, 1, in("mm", 10)) +
         axis("z", 2, 0, in("deg", 360));
}

std::string message_of(const json::object& answer) {
  return answer.contains("error") ? text(answer.at("error").at("message")) : "no error";
}
double predicted(const json::object& answer) {
  return answer.at("result").at("predicted_s").to_number<double>();
}

TEST(DaemonLineLimits, NoAxisExceedsAVelocityInTheUnitOfAll) {
  LineBench bench(axes_with_units());
  const json::object at_5_mm_per_s{{"velocity", 2.5}};
  // 0.5 mm with 2.5 mm/s; without that it is a triangle of 0.05 s.
  const auto answer = bench.line({"x", "y"}, {-5120, -2560}, at_5_mm_per_s);
  ASSERT_FALSE(answer.contains("error")) << json::serialize(answer);
  EXPECT_NEAR(predicted(answer), 0.2, 0.03);
  const auto& axes = answer.at("result").at("axes");
  EXPECT_DOUBLE_EQ(axes.at(0).at("target").to_number<double>(), 0.5);
  EXPECT_DOUBLE_EQ(axes.at(1).at("target").to_number<double>(), 0.5);
  EXPECT_EQ(axes.at(0).at("unit"), "mm");
  bench.expect_rest();
}

TEST(DaemonLineLimits, NoAxisExceedsAVelocityAndAnAccelerationInMicrosteps) {
  LineBench bench;
  const auto answer =
      bench.line({"x", "z"}, {1000, 500}, {{"velocity_pps", 5000}, {"acceleration_pps2", 50'000}});
  ASSERT_FALSE(answer.contains("error")) << json::serialize(answer);
  EXPECT_NEAR(predicted(answer), 0.2 + 0.1, 0.02);
  EXPECT_TRUE(answer.at("result").at("axes").at(0).at("target").is_null());
  bench.expect_rest();
}

TEST(DaemonLineLimits, ALineTakesAsLongAsItIsSaidTo) {
  LineBench bench;
  EXPECT_NEAR(predicted(bench.line({"x", "z"}, {1000, 500}, {{"time_s", 0.3}})), 0.3, 0.01);
  bench.expect_rest();
  EXPECT_THAT(message_of(bench.line({"x", "z"}, {0, 0}, {{"time_s", 0.01}})),
              HasSubstr("cannot be there after 0.01 s; the shortest time possible is 0.0"));
  EXPECT_THAT(message_of(bench.line({"x", "z"}, {0, 0}, {{"time_s", 0}})),
              HasSubstr("'time_s' must be greater than 0"));
  bench.expect_rest();
}

TEST(DaemonLineLimits, NoLineIsOfNoAxis) {
  LineBench bench;
  const auto answer = bench.line({}, {});
  EXPECT_THAT(message_of(answer), HasSubstr("a line is of one axis at least"));
  EXPECT_EQ(answer.at("error").at("data").at("param"), "axes");
  EXPECT_FALSE(bench.line({"x"}, {1000}).contains("error"));
  bench.expect_rest();
}

TEST(DaemonLineLimits, NoPositionIsOutsideWhatAModuleCanHold) {
  LineBench bench;
  bench.begin();
  for (const std::int64_t beyond : {8'388'608, -8'388'609}) {
    const auto answer = bench.line({"x", "y"}, {1000, beyond});
    ASSERT_TRUE(answer.contains("error")) << json::serialize(answer);
    EXPECT_EQ(answer.at("error").at("data").at("name"), "out_of_range");
    EXPECT_EQ(answer.at("error").at("data").at("param"), "positions_microsteps");
    EXPECT_THAT(message_of(answer), HasSubstr("-8388608..8388607"));
  }
  EXPECT_EQ(bench.started_at(), 0U);
  EXPECT_EQ(bench.first_set_at(), 0U);
}

TEST(DaemonLineLimits, SaysWhatIsWrongWithThem) {
  LineBench bench(axes_with_units());
  const auto refusal = [&](json::array axes, json::object limits) {
    bench.begin();
    const auto message = message_of(bench.line(axes, {100, 100}, limits));
    EXPECT_EQ(bench.started_at(), 0U);
    return message;
  };
  EXPECT_THAT(refusal({"x", "y"}, {{"velocity", 0}}), HasSubstr("'velocity' must be greater"));
  EXPECT_THAT(refusal({"x", "y"}, {{"acceleration_pps2", -1}}),
              HasSubstr("'acceleration_pps2' must be greater than 0"));
  EXPECT_THAT(refusal({"x", "y"}, {{"velocity", 1}, {"velocity_pps", 1}}), HasSubstr("not both"));
  EXPECT_THAT(refusal({"x", "y"}, {{"velocity", 13}}),
              HasSubstr("axis 'x': 13 mm/s is too fast; the nearest possible value is 12.2"));
  EXPECT_THAT(refusal({"y", "z"}, {{"velocity", 1}}),
              HasSubstr("axis 'y' is in mm and axis 'z' is in deg"));
  EXPECT_THAT(refusal({"x", "y"}, {{"acceleration_pps2", 1e12}}),
              HasSubstr("axis 'x': 1000000000000"));
  EXPECT_THAT(message_of(bench.line({"x", "y"}, {8'000'000, 1})),
              HasSubstr("axis 'y': its part of the line, 1.25e-07 of the longest way, is too slow "
                        "for its registers: 0.000001"));
  LineBench without(axes_without_units());
  EXPECT_THAT(message_of(without.line({"x", "y"}, {1, 1}, {{"velocity", 1}})),
              HasSubstr("axis 'x' has no unit of its own"));
}

TEST(DaemonLine, NothingIsWrongWithAnAxisThatIsThereAlready) {
  LineBench bench;
  EXPECT_EQ(bench.line({"x", "y"}, {0, 0}).at("result").at("warnings"), json::array{});
  EXPECT_EQ(bench.line({"x", "y"}, {1000, 0}).at("result").at("warnings"), json::array{});
}

TEST(DaemonLine, AStartThatCannotBeUndoneIsToldWhoAskedForIt) {
  LineBench bench;
  bench.loses_link_at_start = true;
  const auto answer = bench.line({"x", "z"}, {100'000, 50'000});
  EXPECT_THAT(message_of(answer), HasSubstr("axis 'x' could not be stopped and may still move"));
  EXPECT_EQ(answer.at("error").at("data").at("outcome"), "unknown");
  bench.plug_in();
}

constexpr std::int32_t whole_way = 6000;
constexpr std::int32_t way_of_others = 2000;

struct Axes {
  std::string name;
  json::array axes;
  json::array targets;
};
void PrintTo(const Axes& axes, std::ostream* out) { *out << axes.name; }

class LineFaults : public testing::TestWithParam<Axes> {
 protected:
  json::object move() { return bench.line(GetParam().axes, GetParam().targets); }
  json::object back() { return bench.line(GetParam().axes, {0, 0}); }
  bool is_at_start() {
    return bench.value("x", ap::actual_position) == 0 &&
           bench.value("y", ap::actual_position) == 0 && bench.value("z", ap::actual_position) == 0;
  }
  /// How many requests a line takes until all have started.
  std::size_t steps() {
    bench.begin();
    EXPECT_FALSE(move().contains("error"));
    bench.expect_rest();
    const auto steps = bench.started_at();
    first_setting_ = bench.first_set_at();
    go_back();
    return steps;
  }
  void go_back() {
    const auto answer = back();
    EXPECT_FALSE(answer.contains("error")) << json::serialize(answer);
    bench.expect_rest();
    EXPECT_TRUE(is_at_start());
  }
  /// A line to which the same happens at each of its requests.
  template <class Check>
  void at_each_step(std::size_t LineBench::*fault, const Check& check, bool with_readings = true) {
    const auto all = steps();
    const auto first = with_readings ? 1 : first_setting_ - 1;
    for (std::size_t step = first; step <= all; ++step) {
      SCOPED_TRACE("request " + std::to_string(step));
      bench.begin();
      bench.*fault = step;
      const auto answer = move();
      bench.expect_rest();
      bench.*fault = 0;
      EXPECT_TRUE(bench.started_at() > 0 || is_at_start());
      check(answer);
      go_back();
    }
  }
  std::int32_t way_of_x() { return bench.value("x", ap::actual_position); }
  void expect_that_all_have_arrived() {
    for (std::size_t i = 0; i < GetParam().axes.size(); ++i) {
      const auto axis = text(GetParam().axes[i]);
      EXPECT_EQ(bench.value(axis, ap::actual_position), GetParam().targets[i].as_int64()) << axis;
    }
  }

  LineBench bench;

 private:
  std::size_t first_setting_ = 0;
};

TEST_P(LineFaults, WhateverIsRefusedNothingMovesOrAllStop) {
  at_each_step(&LineBench::refuses_at, [&](const json::object& answer) {
    // One is asked to tell the other answers apart, and any answer does that; the tick timer is
    // asked for again, and a position, which is read twice.
    const bool may_go_on = bench.refused == Command::GET_FIRMWARE_VERSION ||
                           bench.refused == Command::GGP || bench.refused == Command::GAP;
    if (may_go_on && !answer.contains("error")) return expect_that_all_have_arrived();
    EXPECT_TRUE(answer.contains("error")) << json::serialize(answer);
    EXPECT_LT(way_of_x(), whole_way);
  });
}

// Readings and settings are repeated; what starts a motor is not, and then all stop.
TEST_P(LineFaults, WhicheverAnswerIsLostAllArriveOrAllStop) {
  at_each_step(
      &LineBench::loses_at,
      [&](const json::object& answer) {
        if (!answer.contains("error")) expect_that_all_have_arrived();
      },
      false);
}

TEST_P(LineFaults, WheneverSomebodyStopsOneAllStop) {
  at_each_step(&LineBench::stops_at, [&](const json::object& answer) {
    EXPECT_TRUE(answer.contains("error") || bench.started_at() > 0) << json::serialize(answer);
    EXPECT_LT(way_of_x(), whole_way);
    for (const auto* axis : {"y", "z"})
      EXPECT_GT(bench.value(axis, ap::actual_position), -way_of_others);
  });
}

INSTANTIATE_TEST_SUITE_P(
    DaemonLine, LineFaults,
    testing::Values(Axes{"OfOneModule", {"x", "y"}, {whole_way, -way_of_others}},
                    Axes{"OfTwoModules", {"x", "z"}, {whole_way, -way_of_others}}),
    [](const auto& axes) { return axes.param.name; });

class LineOnTheWay : public testing::Test {
 protected:
  explicit LineOnTheWay(std::int32_t way = 40'000) {
    bench.client->result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 60'000}});
    EXPECT_FALSE(bench.line({"x", "z"}, {way, way / 2}).contains("error"));
  }
  std::string event(std::string_view kind = "line_broken") {
    while (true) {
      const auto news = bench.client->notification("notify_event");
      if (text(news.at("kind")) == kind) return text(news.at("text"));
    }
  }

  LineBench bench{axes_with_units()};
};

TEST_F(LineOnTheWay, AModuleThatFallsSilentStopsTheOthers) {
  bench.silent_module = 2;
  EXPECT_THAT(event(), HasSubstr("module 2"));
  EXPECT_THAT(event(), HasSubstr("axis 'z' could not be stopped and may still move"));
  EXPECT_THAT(event(), AllOf(HasSubstr("axis 'z' keeps settings of the line: parameter"),
                             HasSubstr("parameter 4 was 1000 before"),
                             HasSubstr("parameter 5 was 500 before")));
  EXPECT_LT(bench.value("x", ap::actual_position), 40'000);
  EXPECT_EQ(bench.value("x", ap::actual_velocity), 0);
  EXPECT_EQ(bench.value("x", ap::max_acceleration), 500);
  bench.silent_module = 0;
}

class LongLine : public LineOnTheWay {
 protected:
  LongLine() : LineOnTheWay(way) {
    EXPECT_TRUE(bench.eventually([&] { return bench.value("x", ap::actual_velocity) != 0; }));
  }
  static constexpr std::int32_t way = 4'000'000;  // of half a minute
};

TEST_F(LongLine, ALinkThatIsGoneForAMomentIsUsedToStopAllAndToSetBack) {
  bench.unplug();
  EXPECT_THAT(event(), Not(HasSubstr("could not be stopped")));
  bench.expect_rest();
  EXPECT_LT(bench.value("x", ap::actual_position), way);
}

// Not only what is told about the first parameter helps whoever has to set them back.
TEST_F(LongLine, ALinkThatStaysAwayLeavesWhatIsTold) {
  bench.unplug(true);
  EXPECT_THAT(event(), HasSubstr("link"));
  EXPECT_THAT(event(), HasSubstr("axis 'x' could not be stopped and may still move: "));
  EXPECT_THAT(event(), HasSubstr("axis 'z' could not be stopped and may still move: "));
  EXPECT_THAT(event(), HasSubstr("axis 'x' keeps settings of the line: parameter"));
  EXPECT_THAT(event(), AllOf(HasSubstr("axis 'z' keeps settings of the line: parameter"),
                             HasSubstr("parameter 4 was 1000 before"),
                             HasSubstr("parameter 5 was 500 before")));
  bench.plug_in();
  for (int axis = 0; axis < 2; ++axis)
    EXPECT_THAT(event("axis_stopped"), testing::MatchesRegex("axis '[xz]' stands now; .*"));
  EXPECT_LT(bench.value("x", ap::actual_position), way);
}

TEST_F(LineOnTheWay, AnAxisThatStandsShortIsToldInItsUnit) {
  ASSERT_TRUE(bench.eventually([&] { return bench.value("x", ap::actual_position) > 5'000; }));
  bench.limit_x(0);
  EXPECT_THAT(event(), testing::MatchesRegex(
                           "axis 'x' stands at -[0-9.]+ mm, short of its target -3.90625 mm"));
  bench.limit_x(1000);
  bench.expect_rest();
  EXPECT_LT(bench.value("z", ap::actual_position), 20'000);
}

}  // namespace
}  // namespace tmcld::test
