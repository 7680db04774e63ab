// A gateway as an edge node of Sparkplug, judged by a host that follows the specification.
#include <gmock/gmock.h>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "protocol/sparkplug.hpp"
#include "sparkplug_host.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

const std::string rebirth_command("\x12\x1a\x0a\x14Node Control/Rebirth\x20\x0b\x70\x01", 28);

json::object axis_state(const std::string& axis, int place, bool moving = false) {
  return {{"axis", axis},          {"position_microsteps", place * 10},
          {"velocity_pps", 100.5}, {"target_microsteps", 5000},
          {"unit", "mm"},          {"position", place},
          {"velocity", 2},         {"target", 50.0},
          {"moving", moving},      {"referenced", true},
          {"latched", false},      {"faults", json::array()},
          {"stop_cause", nullptr}, {"owner", "anna"},
          {"unattended", false},   {"age_ms", 7}};
}

/// The node, its broker and a host there.
class SparkplugNode : public testing::Test {
 protected:
  void connect() {
    host.expect_will(node.begin(utc()));
    node.connected();
  }
  void lose() {
    host.lose();
    node.end();
  }
  /// What it has to say now, in the words of topics behind the group.
  std::vector<std::string> said() {
    std::vector<std::string> topics;
    while (const auto next = node.next(now, utc())) {
      host.take(*next);
      topics.push_back(next->topic.substr(std::string("spBv1.0/plant/").size()));
      if (topics.size() > 1000) throw std::runtime_error("it says more and more");
    }
    return topics;
  }
  void command(const std::string& payload, bool retained = false) {
    node.take({.topic = "spBv1.0/plant/NCMD/hall", .payload = payload, .retained = retained});
  }
  void know(const std::vector<std::string>& names) {
    std::vector<ListedAxis> axes;
    for (const auto& name : names) axes.push_back({name, "mm", true});
    node.know("0.2", axes);
  }
  tmcl::UtcTime utc() const { return tmcl::UtcTime(seconds(1'700'000'000)) + (now - begun); }
  double place_of(const std::string& axis) {
    return std::get<double>(host.devices.at(axis).metrics.at("Position").value);
  }

  const tmcl::TimePoint begun{std::chrono::hours(1)};
  tmcl::TimePoint now = begun;
  Sparkplug node{{"plant", "hall"}, "0.3"};
  test::SparkplugHost host{"plant", "hall"};
};

/// With two axes of which hosts know.
class SparkplugNodeOnline : public SparkplugNode {
 protected:
  void SetUp() override {
    know({"x", "y"});
    node.hear(axis_state("x", 1));
    node.hear(axis_state("y", 2));
    connect();
    ASSERT_THAT(said(), ElementsAre("NBIRTH/hall", "DBIRTH/hall/x", "DBIRTH/hall/y"));
    now += seconds(10);
  }
};

TEST_F(SparkplugNodeOnline, IsBornWithAllMetricsAndTheirUnits) {
  EXPECT_EQ(std::get<std::string>(host.metrics.at("Properties/tmcld version").value), "0.2");
  EXPECT_EQ(std::get<std::string>(host.metrics.at("Properties/tmcld-mqtt version").value), "0.3");
  const auto& x = host.devices.at("x").metrics;
  EXPECT_EQ(std::get<double>(x.at("Position").value), 1);
  EXPECT_EQ(x.at("Position").unit, "mm");
  EXPECT_EQ(x.at("Velocity").unit, "mm/s");
  EXPECT_EQ(x.at("Target").unit, "mm");
  EXPECT_FALSE(std::get<bool>(x.at("Moving").value));
  EXPECT_TRUE(std::get<bool>(x.at("Referenced").value));
  EXPECT_FALSE(std::get<bool>(x.at("Latched").value));
  EXPECT_EQ(std::get<std::string>(x.at("Faults").value), "");
  EXPECT_EQ(x.at("Stop cause").value.index(), 0U) << "null";
  EXPECT_EQ(std::get<std::string>(x.at("Owner").value), "anna");
  EXPECT_EQ(x.at("Position").time, 1'700'000'000'000U);
}

TEST_F(SparkplugNodeOnline, CountsInMicrostepsWithoutAUnitAndIsBornAgainWithAnother) {
  auto state = axis_state("x", 3);
  for (const auto* name : {"unit", "position", "velocity", "target"}) state[name] = nullptr;
  node.hear(state);
  EXPECT_THAT(said(), ElementsAre("DBIRTH/hall/x"));
  EXPECT_EQ(place_of("x"), 30);
  EXPECT_EQ(host.devices.at("x").metrics.at("Position").unit, "microsteps");
  EXPECT_EQ(host.devices.at("x").metrics.at("Velocity").unit, "microsteps/s");
}

TEST_F(SparkplugNodeOnline, TellsWhatHasChanged) {
  node.hear(axis_state("x", 1));
  EXPECT_THAT(said(), IsEmpty());
  auto state = axis_state("x", 1);
  state["faults"] = json::array{"stall", "undervoltage"};
  state["stop_cause"] = "stall";
  state["owner"] = nullptr;
  node.hear(state);
  EXPECT_THAT(said(), ElementsAre("DDATA/hall/x"));
  const auto& x = host.devices.at("x").metrics;
  EXPECT_EQ(std::get<std::string>(x.at("Faults").value), "stall, undervoltage");
  EXPECT_EQ(std::get<std::string>(x.at("Stop cause").value), "stall");
  EXPECT_EQ(x.at("Owner").value.index(), 0U) << "null";
}

TEST_F(SparkplugNodeOnline, TellsTwiceASecondWhereAnAxisIs) {
  node.hear(axis_state("x", 1, true));
  EXPECT_THAT(said(), ElementsAre("DDATA/hall/x")) << "it moves";
  int told = 0;
  for (int i = 2; i < 102; ++i) {
    now += milliseconds(50);
    node.hear(axis_state("x", i, true));
    for (const auto& topic : said()) told += topic == "DDATA/hall/x";
  }
  EXPECT_EQ(told, 10) << "in 5 s";
  node.hear(axis_state("x", 500));
  EXPECT_THAT(said(), ElementsAre("DDATA/hall/x")) << "it stands";
  EXPECT_EQ(place_of("x"), 500);
}

TEST_F(SparkplugNodeOnline, TellsTheLastPlaceWhenItIsDue) {
  node.hear(axis_state("x", 2));
  EXPECT_THAT(said(), ElementsAre("DDATA/hall/x"));
  node.hear(axis_state("x", 3));
  EXPECT_THAT(said(), IsEmpty());
  now += Sparkplug::data_interval;
  EXPECT_THAT(said(), ElementsAre("DDATA/hall/x"));
  EXPECT_EQ(place_of("x"), 3);
}

TEST_F(SparkplugNodeOnline, CountsOnAt255) {
  for (int i = 0; i < 600; ++i) {
    node.hear(axis_state("x", i, i % 2 == 0));
    said();
  }
  EXPECT_GT(host.count["DDATA"], 512);
}

TEST_F(SparkplugNodeOnline, DiesByItsWillAndIsBornWithTheNextNumber) {
  EXPECT_EQ(host.birth_number, 0);
  for (int number = 1; number < 260; ++number) {
    lose();
    EXPECT_FALSE(host.is_alive);
    EXPECT_FALSE(host.devices.at("x").is_alive);
    EXPECT_THAT(said(), IsEmpty());
    connect();
    EXPECT_THAT(said(), ElementsAre("NBIRTH/hall", "DBIRTH/hall/x", "DBIRTH/hall/y"));
    EXPECT_EQ(host.birth_number, number % 256);
  }
}

TEST_F(SparkplugNodeOnline, CountsConnectionsThatCameToNothing) {
  node.begin(utc());
  node.begin(utc());
  connect();
  said();
  EXPECT_EQ(host.birth_number, 3);
}

TEST_F(SparkplugNodeOnline, SaysFarewellAsItsWillWould) {
  const auto farewell = node.farewell(utc());
  ASSERT_TRUE(farewell);
  host.take(*farewell);
  EXPECT_FALSE(host.is_alive);
  node.end();
  EXPECT_FALSE(node.farewell(utc())) << "it is not born";
}

TEST_F(SparkplugNodeOnline, OutlivesTmcld) {
  node.forget();
  EXPECT_THAT(said(), ElementsAre("DDEATH/hall/x", "DDEATH/hall/y", "NDATA/hall"));
  EXPECT_TRUE(host.is_alive);
  EXPECT_EQ(host.metrics.at("Properties/tmcld version").value.index(), 0U) << "null";
  node.hear(axis_state("x", 7));
  EXPECT_THAT(said(), IsEmpty()) << "it is not listed";
  know({"x", "y"});
  EXPECT_THAT(said(), ElementsAre("DBIRTH/hall/x", "NDATA/hall"));
  EXPECT_EQ(place_of("x"), 7);
  node.hear(axis_state("y", 8));
  EXPECT_THAT(said(), ElementsAre("DBIRTH/hall/y"));
}

TEST_F(SparkplugNodeOnline, FollowsALoadedConfiguration) {
  know({"x", "z"});
  EXPECT_THAT(said(), ElementsAre("DDEATH/hall/y"));
  node.hear(axis_state("z", 9));
  EXPECT_THAT(said(), ElementsAre("DBIRTH/hall/z"));
  know({"z"});
  EXPECT_THAT(said(), ElementsAre("DDEATH/hall/x"));
  lose();
  connect();
  EXPECT_THAT(said(), ElementsAre("NBIRTH/hall", "DBIRTH/hall/z"));
}

TEST_F(SparkplugNodeOnline, LetsAnAxisDieWhoseModuleIsSilent) {
  node.know("0.2", {{"x", "mm", false}, {"y", "mm", true}});
  EXPECT_THAT(said(), ElementsAre("DDEATH/hall/x"));
  node.hear(axis_state("x", 4));
  EXPECT_THAT(said(), IsEmpty());
  know({"x", "y"});
  EXPECT_THAT(said(), ElementsAre("DBIRTH/hall/x"));
  EXPECT_EQ(place_of("x"), 4);
}

TEST_F(SparkplugNodeOnline, IsBornAgainWhenAHostAsksOnceASecond) {
  command(rebirth_command);
  EXPECT_THAT(said(), ElementsAre("NBIRTH/hall", "DBIRTH/hall/x", "DBIRTH/hall/y"));
  EXPECT_EQ(host.birth_number, 0);
  now += milliseconds(100);
  command(rebirth_command);
  command(rebirth_command);
  node.hear(axis_state("x", 4));
  EXPECT_THAT(said(), IsEmpty()) << "data stops at once, and the birth is not due";
  now += Sparkplug::birth_interval;
  EXPECT_THAT(said(), ElementsAre("NBIRTH/hall", "DBIRTH/hall/x", "DBIRTH/hall/y"));
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(SparkplugNodeOnline, SaysWhichDevicesHaveDiedBeforeItIsBornAgain) {
  command(rebirth_command);
  know({"y"});
  EXPECT_THAT(said(), ElementsAre("DDEATH/hall/x", "NBIRTH/hall", "DBIRTH/hall/y"));
}

TEST_F(SparkplugNodeOnline, TakesNoOtherCommand) {
  command(rebirth_command, true);
  command("");
  command("no payload");
  command(rebirth_command.substr(0, 20));
  auto other = rebirth_command;
  other[4] = 'n';
  command(other);
  other = rebirth_command;
  other.back() = '\0';
  command(other);
  node.take({.topic = "spBv1.0/plant/DCMD/hall/x", .payload = rebirth_command});
  node.take({.topic = "spBv1.0/plant/NCMD/other", .payload = rebirth_command});
  EXPECT_THAT(said(), IsEmpty());
  EXPECT_THAT(node.filters(), ElementsAre("spBv1.0/plant/NCMD/hall"));
}

TEST_F(SparkplugNode, IsNotLedAstrayByRandomCommands) {
  test::SparkplugHost unused("plant", "hall");
  tmcl::test::Random random(tmcl::test::seed());
  connect();
  said();
  for (int i = 0; i < 2000; ++i) {
    auto text = rebirth_command;
    for (int n = 0; n < 3; ++n)
      text[static_cast<std::size_t>(random.between(0, 27))] =
          static_cast<char>(random.between(0, 255));
    command(text.substr(0, static_cast<std::size_t>(random.between(0, 28))));
  }
  now += seconds(2);
  EXPECT_LE(said().size(), 1U);
}

// ---- a host that births wait for ---------------------------------------------------------------

class SparkplugNodeWithHost : public SparkplugNode {
 protected:
  SparkplugNodeWithHost() { node = Sparkplug({"plant", "hall", "scada"}, "0.3"); }
  void state(const std::string& text, const std::string& of = "scada") {
    node.take({.topic = "spBv1.0/STATE/" + of, .payload = text, .retained = true});
  }
};

TEST_F(SparkplugNodeWithHost, WaitsForItBeforeItIsBorn) {
  EXPECT_THAT(node.filters(), ElementsAre("spBv1.0/plant/NCMD/hall", "spBv1.0/STATE/scada"));
  connect();
  EXPECT_THAT(said(), IsEmpty());
  state(R"({"online":true,"timestamp":10})", "other");
  for (const auto* text : {"", "ONLINE", "[]", R"({"online":true})", R"({"timestamp":1})",
                           R"({"online":1,"timestamp":1})", R"({"online":true,"timestamp":"1"})",
                           R"({"online":false,"timestamp":10})"})
    state(text);
  EXPECT_THAT(said(), IsEmpty());
  EXPECT_FALSE(node.is_over());
  state(R"({"online":true,"timestamp":9})");
  EXPECT_THAT(said(), IsEmpty()) << "older than what it said before";
  state(R"({"online":true,"timestamp":10})");
  EXPECT_THAT(said(), ElementsAre("NBIRTH/hall"));
}

TEST_F(SparkplugNodeWithHost, EndsWithItAndWaitsAgain) {
  connect();
  state(R"({"online":true,"timestamp":10})");
  said();
  state(R"({"online":false,"timestamp":9})");
  EXPECT_FALSE(node.is_over()) << "a late will";
  state(R"({"online":false,"timestamp":11})");
  EXPECT_TRUE(node.is_over());
  EXPECT_THAT(said(), IsEmpty());
  host.take(node.farewell(utc()).value());
  EXPECT_FALSE(host.is_alive);
  connect();
  EXPECT_THAT(said(), IsEmpty());
  state(R"({"online":true,"timestamp":12})");
  EXPECT_THAT(said(), ElementsAre("NBIRTH/hall"));
  EXPECT_EQ(host.birth_number, 1);
}

// ---- any order of events -----------------------------------------------------------------------

class SparkplugNodeInAnyOrder : public SparkplugNode {
 protected:
  std::string any_axis() { return names[static_cast<std::size_t>(random.between(0, 3))]; }

  void something_happens() {
    const auto drawn = random.between(0, 99);
    if (drawn < 1) {
      lose();
      is_connected = false;
    } else if (drawn < 4) {
      if (is_connected) lose();
      connect();
      is_connected = true;
    } else if (drawn < 5) {
      node.forget();
    } else if (drawn < 10) {
      list_some();
    } else if (drawn < 12) {
      command(rebirth_command);
    } else if (drawn < 30) {
      now += milliseconds(random.between(1, 2000));
    } else if (drawn < 60) {
      say_something();
    } else {
      hear_something();
    }
  }
  void list_some() {
    std::vector<ListedAxis> axes;
    for (const auto& name : names) {
      if (random.one_in(3)) continue;
      axes.push_back({name, "mm", !random.one_in(4)});
    }
    node.know("0." + std::to_string(random.between(1, 3)), axes);
  }
  void hear_something() {
    auto state = axis_state(any_axis(), static_cast<int>(random.between(0, 9)), random.one_in(2));
    if (random.one_in(10)) state["unit"] = nullptr;
    if (random.one_in(10)) state["faults"] = json::array{"stall"};
    node.hear(state);
  }
  /// The broker takes some of it.
  void say_something() {
    for (auto left = random.between(0, 5); left > 0; --left)
      if (const auto next = node.next(now, utc())) host.take(*next);
  }

  const std::vector<std::string> names{"x", "y", "z", "phi.2"};
  bool is_connected = false;
  tmcl::test::Random<> random{tmcl::test::seed()};
};

TEST_F(SparkplugNodeInAnyOrder, IsUnderstoodByAHost) {
  for (int i = 0; i < 20'000 && !HasFailure(); ++i) {
    something_happens();
    if (random.one_in(50)) {
      now += seconds(2);
      said();
    }
    for (const auto& [name, device] : host.devices)
      if (device.is_alive && !host.is_alive) ADD_FAILURE() << name << " outlives its node";
  }
  if (!is_connected) connect();
  std::vector<ListedAxis> axes;
  for (const auto& name : names) axes.push_back({name, "mm", name != "z"});
  node.know("0.9", axes);
  for (const auto& name : names) node.hear(axis_state(name, 77));
  now += seconds(2);
  said();
  for (const auto& name : names) {
    EXPECT_EQ(host.devices[name].is_alive, name != "z") << name;
    if (name != "z") {
      EXPECT_EQ(place_of(name), 77) << name;
    }
  }
  EXPECT_EQ(std::get<std::string>(host.metrics.at("Properties/tmcld version").value), "0.9");
  for (const auto* verb : {"NBIRTH", "NDEATH", "NDATA", "DBIRTH", "DDEATH", "DDATA"})
    EXPECT_GT(host.count[verb], 10) << verb;
}

}  // namespace
}  // namespace tmclmqtt
