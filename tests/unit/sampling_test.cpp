// Parameters that a subscription reads beside the states of its axes.
#include <gmock/gmock.h>

#include "tmcl/api/system.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto load_value = tmcl::number_of("load_value");
constexpr auto max_current = tmcl::number_of("max_current");

class Sampling : public DaemonTest {
 protected:
  std::int32_t& parameter(std::uint8_t number) {
    return daemon.wire().modules.at(1).parameter(0, number);
  }
  static json::object subscription(json::array parameters, int interval_ms = 100) {
    return {{"axes", json::array{"x"}},
            {"interval_ms", interval_ms},
            {"parameters", std::move(parameters)}};
  }
  /// How often the module was asked for it since the last time.
  std::map<int, int> reads() {
    return daemon.on_reactor([&] {
      std::map<int, int> counts;
      for (const auto& request : daemon.wire().seen)
        if (request.command == tmcl::Command::GAP) ++counts[request.type];
      daemon.wire().seen.clear();
      return counts;
    });
  }
};

TEST_F(Sampling, AStateHasTheParametersThatTheSubscriptionNames) {
  parameter(load_value) = 17;
  parameter(max_current) = 3;
  const auto answer = client.result("subscribe", subscription({"max_current", "206"}));
  const auto& samples = answer.at("states").at(0).at("samples").as_array();
  ASSERT_EQ(samples.size(), 2U) << "in the order in which they were named";
  EXPECT_EQ(samples.at(0).at("parameter"), "max_current");
  EXPECT_EQ(samples.at(0).at("value"), 3);
  EXPECT_EQ(samples.at(1).at("parameter"), "load_value");
  EXPECT_EQ(samples.at(1).at("number"), load_value);
  EXPECT_EQ(samples.at(1).at("value"), 17);
  EXPECT_TRUE(samples.at(1).at("unit").is_null());
  EXPECT_GE(samples.at(0).at("age_ms").as_int64(), samples.at(1).at("age_ms").as_int64());
}

TEST_F(Sampling, AnotherValueIsNews) {
  parameter(load_value) = 17;
  client.result("subscribe", subscription({"load_value"}));
  client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 100}});
  while (!client.notification("notify_state", 300).is_null()) continue;
  daemon.on_reactor([&] { return parameter(load_value) = 18; });
  const auto news = client.notification("notify_state", 300);
  EXPECT_EQ(news.at("subscription"), 1);
  EXPECT_EQ(news.at("samples").at(0).at("value"), 18);
  EXPECT_LT(news.at("samples").at(0).at("age_ms").as_int64(), 100);
  EXPECT_TRUE(client.notification("notify_state", 300).is_null())
      << "who has not named it is told nothing";
}

TEST_F(Sampling, EveryLookIsToldToWhoWantsThat) {
  auto wish = subscription({});
  wish["every_look"] = true;
  client.result("subscribe", wish);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(client.notification("notify_state", 150).is_null());
}

TEST_F(Sampling, ANameThatTheModelDoesNotHaveIsAnsweredWithTheNearest) {
  const auto error = client.error("subscribe", subscription({"load_valeu"}));
  EXPECT_EQ(error.at("data").at("name"), "unknown_parameter");
  EXPECT_EQ(error.at("data").at("param"), "parameters");
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("load_value"));
}

TEST_F(Sampling, SoManyAreReadAtMost) {
  json::array many;
  for (std::size_t i = 0; i <= tmcl::api::most_sampled_parameters; ++i)
    many.emplace_back(std::to_string(i));
  const auto error = client.error("subscribe", subscription(many));
  EXPECT_EQ(error.at("data").at("name"), "too_many_parameters");
  many.pop_back();
  client.result("subscribe", subscription(many));
}

TEST_F(Sampling, EndsWithTheSubscription) {
  client.result("subscribe", subscription({"load_value"}));
  client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 100}});
  client.result("unsubscribe", {{"subscription", 1}});
  daemon.run_for(milliseconds(200));
  reads();
  daemon.run_for(milliseconds(1000));
  const auto asked = reads();
  EXPECT_FALSE(asked.contains(load_value));
  EXPECT_TRUE(asked.contains(tmcl::axis_parameter::actual_position)) << "the state is read on";
}

// An answer takes 15 ms, so that in the half of 200 ms there is room for seven of the eight.
TEST_F(Sampling, TakesHalfOfTheIntervalAndTurns) {
  client.result("subscribe", subscription({"4", "5", "6", "7", "194", "195", "204", "206"}, 200));
  daemon.on_reactor([&] { return daemon.wire().delay = milliseconds(15), 0; });
  daemon.run_for(milliseconds(400));
  reads();
  daemon.run_for(milliseconds(3200));
  auto asked = reads();
  const auto looks = asked[tmcl::axis_parameter::actual_position];
  EXPECT_GE(looks, 8) << "also where looking takes the other half, and more";
  for (const auto parameter : {4, 5, 6, 7, 194, 195, 204, 206})
    EXPECT_NEAR(asked[parameter], looks * 7 / 8, 2) << parameter;
}

TEST_F(Sampling, EachLookHasOneHoweverShortTheInterval) {
  client.result("subscribe", subscription({"4", "5", "6", "7"}, 5));
  daemon.on_reactor([&] { return daemon.wire().delay = milliseconds(10), 0; });
  daemon.run_for(milliseconds(200));
  reads();
  daemon.run_for(milliseconds(2000));
  auto asked = reads();
  const auto looks = asked[tmcl::axis_parameter::actual_position];
  EXPECT_NEAR(asked[4] + asked[5] + asked[6] + asked[7], looks, 2);
}

TEST_F(Sampling, WhoLooksMoreOftenDoesNotMakeItReadMoreOften) {
  client.result("subscribe", subscription({"load_value"}, 1000));
  client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 20}});
  daemon.run_for(milliseconds(1000));
  reads();
  daemon.run_for(milliseconds(4000));
  auto asked = reads();
  EXPECT_GE(asked[load_value], 3);
  EXPECT_LE(asked[load_value], 9);
  EXPECT_GE(asked[tmcl::axis_parameter::actual_position], 150);
}

TEST_F(Sampling, AModuleThatRefusesOneIsAskedForTheOthers) {
  client.result("subscribe", subscription({"max_current", "load_value"}));
  daemon.on_reactor([&] {
    daemon.wire().modules.at(1).refuse =
        [](const tmcl::Request& request) -> std::optional<tmcl::Status> {
      if (request.command != tmcl::Command::GAP || request.type != max_current) return std::nullopt;
      return tmcl::Status::wrong_type;
    };
    return parameter(load_value) = 99;
  });
  json::value news;
  for (int i = 0; i < 10 && (news.is_null() || news.at("samples").at(1).at("value") != 99); ++i)
    news = client.notification("notify_state", 500);
  ASSERT_FALSE(news.is_null());
  EXPECT_EQ(news.at("samples").at(1).at("value"), 99);
}

TEST_F(Sampling, AModuleThatComesToAnswerIsSampledThen) {
  daemon.on_reactor([&] {
    parameter(load_value) = 17;
    return daemon.wire().loses = [](const tmcl::Request&) { return true; }, 0;
  });
  const auto answer = client.result("subscribe", subscription({"load_value"}));
  EXPECT_EQ(answer.at("failed").as_array().size(), 1U);
  daemon.on_reactor([&] { return daemon.wire().loses = {}, 0; });
  json::value news;
  for (int i = 0; i < 20 && (news.is_null() || news.at("samples").as_array().empty()); ++i)
    news = client.notification("notify_state", 2000);
  ASSERT_FALSE(news.is_null());
  EXPECT_EQ(news.at("samples").at(0).at("value"), 17);
}

}  // namespace
}  // namespace tmcld::test
