// What Prometheus is told, and what the alerts and the dashboard ask it for.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <boost/json/parse.hpp>

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

TEST(Metrics, CountRelays) {
  JourneyBench bench;
  EXPECT_THAT(metrics_of(bench), HasSubstr("tmcl_relays 0\n"));
  constexpr std::uint64_t relay = 4003;
  const auto look = [] {
    ConnectedClient client{"socket"};
    client.relays = true;
    return client;
  };
  const auto entry = ClientList::enter(bench.gateway->clients(), relay, {}, look);
  EXPECT_THAT(metrics_of(bench), HasSubstr("tmcl_relays 1\n"));
}

/// What the expression finds in its first group.
std::set<std::string> found_in(const std::string& text, const char* expression) {
  const std::regex regex(expression);
  std::set<std::string> found;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), regex);
       it != std::sregex_iterator(); ++it)
    found.insert((*it)[1].str());
  return found;
}

std::set<std::string> names_in(const std::string& text) {
  return found_in(text, "(tmcl_[a-z_]+[a-z])");
}

std::set<std::string> labels_asked_for(const std::string& text) {
  auto labels = found_in(text, R"([{,]([a-z]+)=)");
  labels.merge(found_in(text, R"(\{\{([a-z]+)\}\})"));
  labels.merge(found_in(text, R"(\$labels\.([a-z]+))"));
  for (const auto& list : found_in(text, R"((?:by|on) \(([a-z, ]+)\))"))
    labels.merge(found_in(list, "([a-z]+)"));
  return labels;
}

std::string file_of(const std::string& path) {
  std::ifstream file(std::string(TMCL_SOURCE_DIR) + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Metrics, AreWhatAlertsAndDashboardsAskFor) {
  JourneyBench bench;
  const auto text = metrics_of(bench);
  const auto told = names_in(text);
  auto labels = found_in(text, R"(([a-z]+)=")");
  // By Prometheus itself, and of a variable.
  labels.merge(std::set<std::string>{"instance", "job"});
  for (const auto* path : {"/config/prometheus/alerts.yml", "/config/grafana/bench.json",
                           "/config/grafana/fleet.json"}) {
    const auto file = file_of(path);
    const auto asked = names_in(file);
    EXPECT_GE(asked.size(), 6U) << path;
    for (const auto& name : asked) EXPECT_TRUE(told.contains(name)) << path << ' ' << name;
    for (const auto& label : labels_asked_for(file))
      EXPECT_TRUE(labels.contains(label)) << path << ' ' << label;
  }
}

TEST(Dashboards, HaveEachPanelOnce) {
  for (const auto* path : {"/config/grafana/bench.json", "/config/grafana/fleet.json"}) {
    const auto dashboard = boost::json::parse(file_of(path)).as_object();
    std::set<std::int64_t> ids;
    for (const auto& panel : dashboard.at("panels").as_array())
      EXPECT_TRUE(ids.insert(panel.at("id").as_int64()).second) << path;
    EXPECT_GE(ids.size(), 8U) << path;
  }
}

}  // namespace
}  // namespace tmcld::test
