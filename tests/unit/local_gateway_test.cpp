// The methods of the gateway without a socket.
#include <gmock/gmock.h>

#include "unit/local_gateway_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::Contains;

struct LocalGatewayTest : testing::Test {
  LocalGatewayTest() { EXPECT_EQ(bench.open(), ""); }
  LocalBench bench;
};

TEST_F(LocalGatewayTest, AnswersAsTmcldDoes) {
  const auto state = bench.result("axis.get_state", {{"axis", "x"}});
  EXPECT_EQ(text(state.at("axis")), "x");
  EXPECT_TRUE(state.contains("position_microsteps"));
  EXPECT_EQ(bench.error("axis.get_state", {{"axis", "z"}}), "unknown_axis");
  EXPECT_EQ(bench.error("axis.get_state", {}), "bad_argument");
  EXPECT_EQ(bench.error("axis.sing", {{"axis", "x"}}), "method_not_found");
}

TEST_F(LocalGatewayTest, HasNoConfigurationForClientsToSet) {
  EXPECT_EQ(bench.error("configuration.get", {}), "not_managed");
  EXPECT_EQ(bench.error("configuration.set", {{"toml", ""}}), "not_managed");
}

TEST_F(LocalGatewayTest, MakesACallWhileAnotherIsInProgress) {
  bench.result("axis.get_state", {{"axis", "x"}});
  bench.wire.holds = true;
  std::size_t axes = 0;
  const auto state = bench.local().call("axis.get_state", {{"axis", "x"}}, [&] {
    if (bench.wire.held.empty()) return;
    axes = bench.result("axis.list", {}).at("axes").as_array().size();
    bench.wire.release();
  });
  EXPECT_EQ(axes, 2U);
  EXPECT_TRUE(state);
}

TEST_F(LocalGatewayTest, TellsStatesAndProgressAsTheyCome) {
  std::vector<std::string> told;
  bench.local().on_notification(
      [&](std::string_view method, const json::object&) { told.emplace_back(method); });
  bench.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  bench.wire.modules.at(1).parameter(0, ap::actual_position) = 77;
  while (told.empty()) bench.local().listen(1s);
  EXPECT_THAT(told, Contains("notify_state"));
  bench.result("bus.scan", {{"first", 1}, {"last", 1}});
  EXPECT_THAT(told, Contains("notify_progress"));
}

// The bus has a reply timeout of 500 ms; a scan waits for a quarter of it at each address.
TEST_F(LocalGatewayTest, AScanWaitsLongerWhereAnswersTakeLong) {
  bench.wire.delay = 100ms;
  const auto modules = bench.result("bus.scan", {{"last", 3}}).at("modules").as_array();
  ASSERT_EQ(modules.size(), 1U);
  EXPECT_EQ(modules[0].at("address"), 1);
}

TEST_F(LocalGatewayTest, AScanTellsEachModuleAsItIsFound) {
  std::vector<json::value> told;
  bench.local().on_notification([&](std::string_view, const json::object& params) {
    if (params.contains("found")) told.push_back(params.at("found"));
  });
  bench.wire.modules.emplace(std::uint8_t{3}, FakeModule(3));
  const auto result = bench.result("bus.scan", {{"last", 3}});
  EXPECT_TRUE(result.at("silent").as_array().empty());
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told.at(0), result.at("modules").at(0));
  EXPECT_EQ(told.at(1), result.at("modules").at(1));
  EXPECT_TRUE(told.at(2).is_null());
}

TEST_F(LocalGatewayTest, ASilentBusTellsWhatCameInstead) {
  const auto heard = [&] {
    const auto found = bench.result("bus.scan", {{"first", 9}, {"last", 12}});
    return text(found.at("silent").at(0).at("heard").at("kind"));
  };
  bench.result("axis.get_state", {{"axis", "x"}});  // its module is known, and not asked any more
  EXPECT_EQ(heard(), "nothing");
  bench.wire.stray_bytes = {'l', 'o', 'g', 'i', 'n', ':', ' '};
  EXPECT_EQ(heard(), "text");
  bench.wire.stray_bytes = {0x91, 0x00, 0xF8};
  EXPECT_EQ(heard(), "other_baud_rate");
  const auto bus = bench.result("bus.list", {}).at("buses").at(0).as_object();
  EXPECT_EQ(bus.at("heard").at("kind"), "other_baud_rate");
  EXPECT_GT(bus.at("heard").at("bytes").to_number<int>(), 0);
}

TEST_F(LocalGatewayTest, ListensAsLongAsNothingComes) {
  bench.result("axis.get_state", {{"axis", "x"}});
  const auto before = bench.now();
  EXPECT_FALSE(bench.local().listen(1ms));
  EXPECT_EQ(bench.now() - before, 1ms);
}

TEST_F(LocalGatewayTest, CallsInProgressHaveEndedAtTheEnd) {
  bench.result("axis.get_state", {{"axis", "x"}});
  bench.wire.holds = true;
  const auto held = bench.local().begin("axis.get_state", {{"axis", "x"}});
  bench.local().end();
  ASSERT_TRUE(held.has_ended());
  EXPECT_EQ(held.result().error().name, "link_lost");
  EXPECT_EQ(bench.error("axis.get_state", {{"axis", "x"}}), "daemon_ending");
}

TEST(LocalGatewayLinks, ThatCannotBeOpenedAreTold) {
  LocalBench bench;
  bench.wire.is_absent = true;
  EXPECT_EQ(bench.open(), "no such device");
}

struct LocalPath : testing::Test {
  LocalPath() {
    module.be_played_by(bench.wire.modules.at(1));
    EXPECT_EQ(bench.open(), "");
  }
  LocalCall begin(const std::string& path) {
    return bench.local().begin("path.run",
                               {{"axes", json::array{"x", "y"}}, {"text", path}, {"deviation", 4}});
  }
  void listen_until_x_is_beyond(double position) {
    while (module.mm(0) <= position) bench.local().listen(10ms);
  }
  void expect_rest_and_own_settings() {
    EXPECT_FALSE(module.moves());
    EXPECT_FALSE(bench.local().gateway().has_journeys());
    for (std::uint8_t motor = 0; motor < 2; ++motor)
      EXPECT_EQ(module.get(motor, ap::max_velocity), own_velocity);
  }
  std::shared_ptr<VirtualReactor> reactor = std::make_shared<VirtualReactor>();
  Played module{reactor->clock};
  LocalBench bench{path_bench(std::string(in_mm)), reactor};
};

TEST_F(LocalPath, IsPassedWhileSomebodyListens) {
  const auto path = begin(short_way);
  while (!path.has_ended()) bench.local().listen(100ms);
  ASSERT_TRUE(path.result()) << path.result().error().message;
  EXPECT_EQ(module.mm(0), 9);
  expect_rest_and_own_settings();
}

TEST_F(LocalPath, IsStoppedByAnotherCall) {
  const auto path = begin(long_way);
  listen_until_x_is_beyond(1);
  bench.result("path.stop", {{"axes", json::array{"x", "y"}}});
  while (!path.has_ended()) bench.local().listen(100ms);
  EXPECT_FALSE(path.result());
  expect_rest_and_own_settings();
}

TEST_F(LocalPath, IsStoppedAtTheEnd) {
  const auto path = begin(long_way);
  listen_until_x_is_beyond(1);
  bench.local().end();
  ASSERT_TRUE(path.has_ended());
  EXPECT_FALSE(path.result());
  expect_rest_and_own_settings();
}

}  // namespace
}  // namespace tmcld::test
