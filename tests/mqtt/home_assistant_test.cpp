// What Home Assistant is told, held against the rules of its MQTT discovery.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "protocol/home_assistant.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using std::chrono::seconds;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using Words = std::set<std::string>;

// As its schemas have them: what a component must have, and may have beside what every one may.
const Words of_every_entity{"p", "unique_id", "name", "entity_category", "qos"};
const std::map<std::string, Words> needed{{"sensor", {"p", "unique_id", "state_topic"}},
                                          {"binary_sensor", {"p", "unique_id", "state_topic"}},
                                          {"button", {"p", "unique_id", "command_topic"}}};
const std::map<std::string, Words> allowed{
    {"sensor",
     {"state_topic", "value_template", "unit_of_measurement", "device_class", "state_class"}},
    {"binary_sensor", {"state_topic", "value_template", "device_class"}},
    {"button", {"command_topic", "retain"}}};
const std::map<std::string, Words> device_classes{{"sensor", {"distance"}},
                                                  {"binary_sensor", {"moving", "problem"}}};
const Words units_of_distance{"mm", "cm", "m", "km", "in", "ft", "yd", "mi"};

std::string text_of(const json::object& object, std::string_view name) {
  return std::string(object.at(name).as_string());
}

void expect_component(const json::object& component) {
  SCOPED_TRACE(json::serialize(component));
  const auto platform = text_of(component, "p");
  ASSERT_TRUE(needed.contains(platform));
  for (const auto& name : needed.at(platform)) EXPECT_TRUE(component.contains(name)) << name;
  for (const auto& [name, value] : component) {
    const auto known = [&](const Words& words) { return words.contains(std::string(name)); };
    EXPECT_TRUE(known(of_every_entity) || known(allowed.at(platform))) << name;
    const bool is_topic = name.ends_with("_topic");
    if (is_topic) {
      EXPECT_EQ(value.as_string().find_first_of("+#"), std::string::npos);
    }
  }
  if (const auto* of_class = component.if_contains("device_class")) {
    const std::string text(of_class->as_string());
    EXPECT_TRUE(device_classes.at(platform).contains(text)) << text;
    if (text == "distance") {
      EXPECT_TRUE(units_of_distance.contains(text_of(component, "unit_of_measurement")));
    }
  }
  if (const auto* category = component.if_contains("entity_category")) {
    EXPECT_THAT(std::string(category->as_string()), AnyOf("config", "diagnostic"));
  }
  if (const auto* state_class = component.if_contains("state_class")) {
    EXPECT_EQ(*state_class, "measurement");
  }
  if (const auto* text = component.if_contains("value_template")) {
    EXPECT_THAT(std::string(text->as_string()), StartsWith("{{ "));
  }
}

void expect_rules(const json::object& config) {
  const Words of_root{"dev", "o", "cmps", "availability_topic", "availability_template"};
  for (const auto& [name, value] : config) EXPECT_TRUE(of_root.contains(std::string(name))) << name;
  const auto& device = config.at("dev").as_object();
  EXPECT_FALSE(device.at("ids").as_array().empty());
  const Words of_device{"ids", "name", "mf", "mdl", "sw"};
  for (const auto& [name, value] : device) EXPECT_TRUE(of_device.contains(std::string(name)));
  EXPECT_FALSE(text_of(config.at("o").as_object(), "name").empty());
  Words unique;
  for (const auto& [name, component] : config.at("cmps").as_object()) {
    const auto& one = component.as_object();
    if (one.size() == 1) continue;
    expect_component(one);
    EXPECT_TRUE(unique.insert(text_of(one, "unique_id")).second) << name;
  }
}

class MqttHomeAssistant : public testing::Test {
 protected:
  json::object told() {
    const auto publication = home.due(now);
    if (!publication) return {};
    EXPECT_EQ(publication->topic, "homeassistant/device/hall-1/config");
    EXPECT_TRUE(publication->retained);
    EXPECT_EQ(publication->qos, 1);
    auto config = json::parse(publication->payload).as_object();
    expect_rules(config);
    return config;
  }
  json::object component(const std::string& name) {
    const auto config = told();
    const auto* found = config.at("cmps").as_object().if_contains(name);
    return found == nullptr ? json::object() : found->as_object();
  }
  void status(const std::string& text) {
    home.take({.topic = "homeassistant/status", .payload = text}, now);
  }
  void config_there(const std::string& text) {
    home.take({.topic = "homeassistant/device/hall-1/config", .payload = text, .retained = true},
              now);
  }

  HomeAssistant home{"hall-1", "homeassistant", "0.3"};
  tmcl::TimePoint now{seconds(100)};
};

TEST_F(MqttHomeAssistant, IsToldOnceTheAxesAreKnown) {
  EXPECT_THAT(home.filters(),
              ElementsAre("homeassistant/device/hall-1/config", "homeassistant/status"));
  home.begin(now);
  EXPECT_TRUE(told().empty());
  home.know({{"x", "mm", true}, {"phi", "", false}}, now);
  const auto config = told();
  EXPECT_EQ(text_of(config, "availability_topic"), "tmcl/v1/hall-1/birth");
  EXPECT_THAT(text_of(config, "availability_template"), HasSubstr("value_json.online"));
  EXPECT_EQ(config.at("cmps").as_object().size(), 2 * 7 + 1);
  EXPECT_TRUE(told().empty());
  home.know({{"x", "mm", false}, {"phi", "", true}}, now);
  EXPECT_TRUE(told().empty()) << "nothing that it is told of has changed";
  home.begin(now);
  EXPECT_EQ(told(), config) << "on a new connection";
}

TEST_F(MqttHomeAssistant, ReadsTheStatesOfAxes) {
  home.know({{"x", "mm", true}, {"phi", "", true}, {"turn", "deg", true}}, now);
  const auto config = told();
  const auto& all = config.at("cmps").as_object();
  const auto& position = all.at("x_position").as_object();
  EXPECT_EQ(text_of(position, "state_topic"), "tmcl/v1/hall-1/state/x");
  EXPECT_EQ(text_of(position, "value_template"), "{{ value_json.position }}");
  EXPECT_EQ(text_of(position, "unit_of_measurement"), "mm");
  EXPECT_EQ(text_of(position, "unique_id"), "tmcl_hall-1_x_position");
  const auto& phi = all.at("phi_position").as_object();
  EXPECT_EQ(text_of(phi, "value_template"), "{{ value_json.position_microsteps }}");
  EXPECT_FALSE(phi.contains("device_class"));
  EXPECT_EQ(text_of(all.at("turn_position").as_object(), "unit_of_measurement"), "deg");
  EXPECT_FALSE(all.at("turn_position").as_object().contains("device_class"));
  EXPECT_EQ(text_of(all.at("x_moving").as_object(), "device_class"), "moving");
  EXPECT_EQ(text_of(all.at("x_fault").as_object(), "device_class"), "problem");
}

TEST_F(MqttHomeAssistant, HasOneButtonThatStopsAndNothingThatMoves) {
  home.know({{"x", "mm", true}}, now);
  const auto config = told();
  int commands = 0;
  for (const auto& [name, value] : config.at("cmps").as_object())
    commands += value.as_object().contains("command_topic");
  EXPECT_EQ(commands, 1);
  const auto& stop = config.at("cmps").at("stop").as_object();
  EXPECT_EQ(text_of(stop, "command_topic"), "tmcl/v1/hall-1/stop");
  EXPECT_EQ(stop.at("retain"), false);
}

TEST_F(MqttHomeAssistant, IsToldAgainWhenItStarts) {
  home.know({{"x", "mm", true}}, now);
  const auto config = told();
  status("offline");
  now += seconds(10);
  EXPECT_TRUE(told().empty());
  status("online");
  now += HomeAssistant::longest_delay;
  EXPECT_EQ(told(), config);
  EXPECT_TRUE(told().empty());
}

TEST_F(MqttHomeAssistant, RemovesTheComponentsOfAnAxisThatHasGone) {
  home.know({{"x", "mm", true}, {"y", "mm", true}}, now);
  told();
  home.know({{"x", "mm", true}}, now);
  auto config = told();
  const auto* all = &config.at("cmps").as_object();
  EXPECT_EQ(all->size(), 2 * 7 + 1);
  EXPECT_EQ(all->at("y_position"), (json::object{{"p", "sensor"}}));
  EXPECT_EQ(all->at("y_moving"), (json::object{{"p", "binary_sensor"}}));
  EXPECT_GT(all->at("x_position").as_object().size(), 1U);
  home.know({{"x", "mm", true}, {"y", "mm", true}}, now);
  config = told();
  EXPECT_GT(config.at("cmps").at("y_position").as_object().size(), 1U);
}

TEST_F(MqttHomeAssistant, RemovesWhatAnEarlierRunHasLeft) {
  home.know({{"x", "mm", true}}, now);
  told();
  config_there(
      R"({"cmps":{"old_position":{"p":"sensor","unique_id":"u"},"x_position":{"p":"sensor"},
                  "lamp":{"p":"light"},"a/b":{"p":"sensor"},"c":7,"d":{}}})");
  EXPECT_TRUE(told().empty()) << "once a second at most";
  now += HomeAssistant::least_interval;
  const auto config = told();
  const auto& all = config.at("cmps").as_object();
  EXPECT_EQ(all.size(), 7 + 1 + 1);
  EXPECT_EQ(all.at("old_position"), (json::object{{"p", "sensor"}}));
  for (const auto* text : {"x", "[]", "{}", R"({"cmps":7})"}) {
    config_there(text);
    now += HomeAssistant::least_interval;
    EXPECT_EQ(told(), config) << text;
  }
}

TEST_F(MqttHomeAssistant, LeavesADeviceDeletedUntilItStartsAgain) {
  home.know({{"x", "mm", true}}, now);
  told();
  config_there("");
  now += seconds(10);
  EXPECT_TRUE(told().empty());
  status("online");
  now += HomeAssistant::longest_delay;
  EXPECT_FALSE(told().empty());
}

TEST_F(MqttHomeAssistant, KeepsWhatIsRemovedWithinBounds) {
  home.know({}, now);
  std::string text = R"({"cmps":{)";
  for (std::size_t i = 0; i < 2 * HomeAssistant::most_removed; ++i)
    text += (i == 0 ? "" : ",") + ("\"c" + std::to_string(i)) + R"(":{"p":"sensor"})";
  config_there(text + "}}");
  now += HomeAssistant::least_interval;
  EXPECT_EQ(told().at("cmps").as_object().size(), HomeAssistant::most_removed + 1);
}

TEST(MqttHomeAssistantId, IsWhatItsTopicsTake) {
  EXPECT_TRUE(is_home_assistant_id("Hall-1_b"));
  for (const auto* name : {"", "a.b", "a@b", "a/b", "ä"})
    EXPECT_FALSE(is_home_assistant_id(name)) << name;
}

}  // namespace
}  // namespace tmclmqtt
