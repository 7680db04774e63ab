// Motors named by where they are: another name of a configured axis, or an axis of their own.
#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>

#include "api/raw_name.hpp"
#include "unit/local_gateway_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

// ---- names -------------------------------------------------------------------------------------

struct RawNames : testing::Test {
  explicit RawNames(const std::string& buses = std::string(bench_bus) + can_bus)
      : gateway(Gateway::create(
            context.get_executor(),
            *parse_config("[daemon]\nsocket = \"s\"\n" + buses + axis_section("x", 0)))) {}
  std::string name_of(const std::string& raw) {
    const auto axis = find_raw_axis(*gateway, "axis", raw);
    return axis ? (*axis)->name() : axis.error().name;
  }
  std::string message(const std::string& raw) {
    const auto axis = find_raw_axis(*gateway, "axis", raw);
    if (axis) return "none";
    return axis.error().message + "; " + axis.error().hint;
  }
  static constexpr auto can_bus = "[[bus]]\nname = \"field\"\nlink = \"can:can0\"\n";
  boost::asio::io_context context;
  std::shared_ptr<Gateway> gateway;
};

TEST_F(RawNames, NeedTheBusWhereThereAreSeveral) {
  EXPECT_EQ(name_of("bench:1/0"), "x");
  EXPECT_EQ(name_of("field:300/5"), "field:300/5");
  EXPECT_EQ(name_of("field:1/0"), "field:1/0");
  EXPECT_THAT(message("1/0"), HasSubstr("'1/0': 2 buses have such an address; name one of them"));
  EXPECT_THAT(message("benhc:1/0"), HasSubstr("there is no bus 'benhc'; Did you mean 'bench'?"));
}

TEST_F(RawNames, ThatNameNoMotorAreToldWhy) {
  for (const auto* bad : {"1/", "/0", "bench:/0", "bench:1/x", ":1/0", "bench:1/0/0", "1/-1", "/"})
    EXPECT_EQ(name_of(bad), "unknown_axis") << bad;
  for (const auto* bad : {"bench:0/0", "bench:256/0", "field:2048/0", "field:1/256",
                          "field:1/70000", "bench:65537/0"})
    EXPECT_EQ(name_of(bad), "out_of_range") << bad;
  EXPECT_THAT(message("bench:256/0"),
              HasSubstr("there is no axis 'bench:256/0': the address 256 is "
                        "outside 1..255, which modules on bus 'bench'"));
}

TEST_F(RawNames, OfTheSameMotorAreOneAxis) {
  EXPECT_EQ(*find_raw_axis(*gateway, "axis", "field:7/1"),
            *find_raw_axis(*gateway, "axis", "field:07/01"));
  EXPECT_EQ(gateway->axes().size(), 1U);
  EXPECT_EQ(gateway->all_axes().size(), 2U);
}

TEST_F(RawNames, AreBounded) {
  for (std::size_t i = 0; i < most_added_axes; ++i)
    EXPECT_NE(name_of("field:" + std::to_string(1 + i) + "/0"), "too_many_axes");
  EXPECT_EQ(name_of("field:1000/0"), "too_many_axes");
  EXPECT_EQ(name_of("field:1/0"), "field:1/0");
  EXPECT_EQ(name_of("bench:1/0"), "x");
}

struct RawNamesOfOneBus : RawNames {
  RawNamesOfOneBus() : RawNames(std::string(bench_bus)) {}
};

TEST_F(RawNamesOfOneBus, AreGivenWithoutItButMayHaveIt) {
  EXPECT_EQ(name_of("1/0"), "x");
  EXPECT_EQ(name_of("bench:1/0"), "x");
  EXPECT_EQ(name_of("bench:1/1"), "1/1");
  EXPECT_EQ(name_of("1/1"), "1/1");
}

// ---- axes --------------------------------------------------------------------------------------

constexpr auto millimetres =
    "unit = \"mm\"\nunits_per_revolution = 5\nmicrosteps = 256\n"
    "soft_limits = [-10, 10]\n";

struct RawAxes : testing::Test {
  explicit RawAxes(GatewayOptions options = {}) {
    bench.wire.modules.at(1).parameter(2, ap::microstep_resolution) = 4;
    EXPECT_EQ(bench.open(std::move(options)), "");
  }
  std::vector<std::string> names(std::string_view method, std::string_view list,
                                 std::string_view key, json::object params = {}) {
    std::vector<std::string> names;
    const auto result = bench.result(method, std::move(params));
    for (const auto& row : result.at(list).as_array()) names.push_back(text(row.at(key)));
    return names;
  }
  std::vector<std::string> stopped() { return names("system.stop_all", "stopped", "axis"); }
  LocalBench bench{std::string(bench_bus) + axis_section("x", 0, millimetres) +
                   axis_section("y", 1)};
};

TEST_F(RawAxes, OfAConfiguredMotorHaveItsNameItsUnitAndItsLimits) {
  EXPECT_EQ(text(bench.result("axis.get_state", {{"axis", "1/0"}}).at("axis")), "x");
  const auto moved = bench.result("axis.move_to", {{"axis", "bench:1/0"}, {"position", 5}});
  EXPECT_EQ(moved.at("target_microsteps"), 51'200);
  const auto beyond = bench.local().call("axis.move_to", {{"axis", "1/0"}, {"position", 11}});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().name, "beyond_soft_limit");
  EXPECT_EQ(text(beyond.error().subject.at("axis")), "x");
}

TEST_F(RawAxes, AreClaimedByEitherName) {
  bench.result("axis.start_home", {{"axis", "1/1"}});
  EXPECT_EQ(bench.error("axis.move_to", {{"axis", "y"}, {"position_microsteps", 1}}),
            "axis_claimed");
  bench.result("axis.start_home", {{"axis", "1/2"}});
  const json::object raw{{"bus", "bench"}, {"address", 1}, {"motor", 2}, {"command", "MVP"}};
  EXPECT_EQ(bench.error("module.execute", raw), "axis_claimed");
}

TEST_F(RawAxes, AreListedIfThatIsAsked) {
  EXPECT_EQ(text(bench.result("axis.get_state", {{"axis", "1/2"}}).at("axis")), "1/2");
  EXPECT_EQ(bench.error("axis.get_state", {{"axis", "9/0"}}), "module_silent");
  EXPECT_THAT(names("axis.list", "axes", "name"), ElementsAre("x", "y"));
  EXPECT_THAT(names("axis.list", "axes", "name", {{"all", true}}),
              ElementsAre("x", "y", "1/2", "9/0"));
  EXPECT_EQ(bench.result("module.list", {}).at("modules").as_array().size(), 1U);
  EXPECT_EQ(bench.result("subscribe", {}).at("states").as_array().size(), 2U);
}

TEST_F(RawAxes, BeyondThoseOfTheModelAreRefusedAndNotStopped) {
  EXPECT_EQ(bench.error("axis.get_state", {{"axis", "1/0"}}), "none");
  EXPECT_EQ(bench.error("axis.get_state", {{"axis", "1/3"}}), "out_of_range");
  EXPECT_THAT(stopped(), ElementsAre("x", "y", "1/2"));
}

TEST_F(RawAxes, AreStoppedAsWellAsWhateverRawCommandsHaveMoved) {
  bench.wire.modules.emplace(std::uint8_t{5}, FakeModule(5));
  bench.wire.modules.emplace(std::uint8_t{6}, FakeModule(6));
  bench.result("axis.get_state", {{"axis", "6/1"}});
  bench.result("module.execute",
               {{"bus", "bench"}, {"address", 5}, {"motor", 2}, {"command", "ROR"}});
  EXPECT_THAT(stopped(), UnorderedElementsAre("x", "y", "1/2", "6/0", "6/1", "6/2", "5/2"));
  EXPECT_THAT(stopped(), UnorderedElementsAre("x", "y", "1/2", "6/0", "6/1", "6/2"));
}

TEST_F(RawAxes, ThatAreSilentAreStoppedLast) {
  bench.result("axis.get_state", {{"axis", "x"}});
  EXPECT_EQ(bench.error("axis.stop", {{"axis", "9/0"}}), "module_silent");
  bench.wire.seen.clear();
  EXPECT_THAT(names("system.stop_all", "failed", "axis"), ElementsAre("9/0"));
  std::vector<unsigned> told;
  for (const auto& request : bench.wire.seen)
    if (request.command == Command::MST) told.push_back(number(request.address));
  ASSERT_GE(told.size(), 3U);
  EXPECT_THAT(std::vector(told.begin(), told.begin() + 3), ElementsAre(1, 1, 1));
}

GatewayOptions with_full_steps(std::int32_t full_steps) {
  GatewayOptions options;
  options.full_steps = full_steps;
  return options;
}

struct RawAxesOf400Steps : RawAxes {
  RawAxesOf400Steps() : RawAxes(with_full_steps(400)) {}
};

TEST_F(RawAxesOf400Steps, HaveThem) {
  EXPECT_EQ(bench.result("axis.get_units", {{"axis", "1/2"}}).at("full_steps"), 400);
  EXPECT_EQ(bench.result("axis.get_units", {{"axis", "x"}}).at("full_steps"), 200);
}

}  // namespace
}  // namespace tmcld::test
