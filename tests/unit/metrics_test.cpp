// What Prometheus is told, and what the alerts and the dashboard ask it for.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "async/spawn.hpp"
#include "fronts/metrics.hpp"
#include "support/build_paths.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

std::string metrics_of(JourneyBench& bench) {
  std::optional<std::string> text;
  const auto scrape = [&]() -> boost::asio::awaitable<void> {
    const auto axes = co_await measure_axes(bench.gateway);
    text = metrics_text(*bench.gateway, axes, Latency(), 0);
  };
  spawn(bench.gateway->find_bus("line")->executor(), scrape());
  bench.time.run_while_not([&] { return text.has_value(); }, 1min);
  return text.value_or("no answer");
}

TEST(Metrics, SayWhatAxesDo) {
  JourneyBench bench("TMCM-3110", "unit = \"mm\"\nunits_per_revolution = 5\n");
  ASSERT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position", 2.5}}));
  bench.time.run_for(100ms);
  EXPECT_THAT(metrics_of(bench), HasSubstr("tmcl_axis_moving{axis=\"x\",bus=\"line\"} 1\n"));
  bench.time.run_for(20s);
  const auto text = metrics_of(bench);
  for (const auto* line : {"tmcl_axis_position{axis=\"x\",bus=\"line\",unit=\"mm\"} 2.5\n",
                           "tmcl_axis_target{axis=\"x\",bus=\"line\",unit=\"mm\"} 2.5\n",
                           "tmcl_axis_velocity{axis=\"x\",bus=\"line\",unit=\"mm\"} 0\n",
                           "tmcl_axis_moving{axis=\"x\",bus=\"line\"} 0\n",
                           "tmcl_supply_volts{axis=\"x\",bus=\"line\"} 24\n",
                           "tmcl_axis_error{axis=\"x\",bus=\"line\",flag=\"undervoltage\"} 0\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_THAT(text, HasSubstr("tmcl_temperature_celsius{axis=\"x\",bus=\"line\"} "));
}

TEST(Metrics, ReadTheTemperatureOfAModuleOnce) {
  JourneyBench bench;
  bench.requests.clear();
  metrics_of(bench);
  const auto read = std::ranges::count_if(bench.requests, [](const tmcl::Request& request) {
    constexpr std::uint8_t temperature = 9;
    return request.command == tmcl::Command::GIO && request.type == temperature;
  });
  EXPECT_EQ(read, 2) << "the axes are on two modules";
}

TEST(Metrics, CountMicrostepsWithoutAUnit) {
  JourneyBench bench;
  EXPECT_THAT(metrics_of(bench),
              HasSubstr("tmcl_axis_position{axis=\"far\",bus=\"line\",unit=\"microsteps\"} 0\n"));
}

TEST(Metrics, SayWhatADriverReports) {
  JourneyBench bench;
  bench.wire.bench().modules().front()->set_supply(52);
  bench.time.run_for(2s);
  const auto text = metrics_of(bench);
  EXPECT_THAT(text,
              HasSubstr("tmcl_axis_error{axis=\"x\",bus=\"line\",flag=\"undervoltage\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("tmcl_supply_volts{axis=\"x\",bus=\"line\"} 5.2\n"));
}

TEST(Metrics, LeaveOutWhatDoesNotAnswer) {
  JourneyBench bench;
  bench.wire.bench().modules().front()->power_off();
  bench.call("axis.get_state", {{"axis", "x"}});
  const auto text = metrics_of(bench);
  EXPECT_THAT(text, HasSubstr("tmcl_axis_up{axis=\"x\",bus=\"line\"} 0\n"));
  EXPECT_THAT(text, Not(HasSubstr("tmcl_axis_position{axis=\"x\"")));
  EXPECT_THAT(text, HasSubstr("tmcl_axis_position{axis=\"far\""));
}

std::set<std::string> names_in(const std::string& text) {
  static const std::regex name("tmcl_[a-z_]+[a-z]");
  std::set<std::string> names;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), name); it != std::sregex_iterator();
       ++it)
    names.insert(it->str());
  return names;
}

TEST(Metrics, AreWhatAlertsAndTheDashboardAskFor) {
  JourneyBench bench;
  const auto told = names_in(metrics_of(bench));
  for (const auto* path : {"/config/prometheus/alerts.yml", "/config/grafana/bench.json"}) {
    std::ifstream file(std::string(TMCL_SOURCE_DIR) + path);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto asked = names_in(text);
    EXPECT_GE(asked.size(), 6U) << path;
    for (const auto& name : asked) EXPECT_TRUE(told.contains(name)) << path << ' ' << name;
  }
}

}  // namespace
}  // namespace tmcld::test
