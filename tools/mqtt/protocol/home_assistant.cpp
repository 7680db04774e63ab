#include "protocol/home_assistant.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/json/array.hpp>
#include <boost/json/parse.hpp>

#include "tmcl/json_text.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;

constexpr std::string_view sensor_platform = "sensor";
constexpr std::string_view binary_platform = "binary_sensor";
constexpr std::string_view button_platform = "button";
constexpr std::array platforms{sensor_platform, binary_platform, button_platform};
constexpr std::string_view stop_component = "stop";
/// Units that Home Assistant knows as distances, and converts.
constexpr std::array<std::string_view, 4> distances{"mm", "cm", "m", "in"};

// Templates of Home Assistant. A null becomes None, which it takes as unknown.
constexpr auto is_available =
    "{{ 'online' if value_json.online and value_json.tmcld else 'offline' }}";
constexpr auto faults_text =
    "{{ (value_json.faults | join(', '))[:255] if value_json.faults else 'none' }}";
constexpr auto stop_cause_text = "{{ value_json.stop_cause or 'none' }}";

std::string value_of(std::string_view member) {
  return "{{ value_json." + std::string(member) + " }}";
}
std::string whether(std::string_view member) {
  return "{{ 'ON' if value_json." + std::string(member) + " else 'OFF' }}";
}

/// By the name of the gateway, the same each time.
tmcl::Duration delay_of(std::string_view gateway) {
  const auto longest = static_cast<std::size_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(HomeAssistant::longest_delay).count());
  return std::chrono::milliseconds(std::hash<std::string_view>{}(gateway) % longest);
}

}  // namespace

bool is_home_assistant_id(std::string_view name) {
  return is_level(name) && name.find_first_of(".@") == name.npos;
}

HomeAssistant::HomeAssistant(const std::string& gateway, const std::string& prefix,
                             std::string_view version)
    : gateway_(gateway),
      topics_(gateway),
      version_(version),
      config_(prefix + "/device/" + gateway + "/config"),
      status_(prefix + "/status") {}

// ---- components --------------------------------------------------------------------------------

json::object HomeAssistant::sensor(const ListedAxis& axis, std::string_view what,
                                   std::string_view name) const {
  return {{"p", sensor_platform},
          {"name", axis.name + ' ' + std::string(name)},
          {"unique_id", "tmcl_" + gateway_ + '_' + axis.name + '_' + std::string(what)},
          {"state_topic", topics_.state(axis.name)}};
}

json::object HomeAssistant::components_of(const ListedAxis& axis) const {
  json::object all;
  const auto add = [&](std::string_view what, json::object component) {
    all[axis.name + '_' + std::string(what)] = std::move(component);
  };
  // A velocity would be that of the begin of a move: states are not told on the way.
  auto position = sensor(axis, "position", "position");
  position["value_template"] = value_of(axis.unit.empty() ? "position_microsteps" : "position");
  position["state_class"] = "measurement";
  position["unit_of_measurement"] = axis.unit.empty() ? "microsteps" : json::string(axis.unit);
  if (std::ranges::count(distances, std::string_view(axis.unit)) != 0)
    position["device_class"] = "distance";
  add("position", std::move(position));
  const auto add_text = [&](std::string_view what, std::string_view name, const char* text) {
    auto component = sensor(axis, what, name);
    component["value_template"] = text;
    component["entity_category"] = "diagnostic";
    add(what, std::move(component));
  };
  add_text("faults", "faults", faults_text);
  add_text("stop_cause", "stop cause", stop_cause_text);
  const auto add_binary = [&](std::string_view what, std::string_view member,
                              std::string_view device_class) {
    auto component = sensor(axis, what, what);
    component["p"] = binary_platform;
    component["value_template"] = whether(member);
    if (device_class.empty()) component["entity_category"] = "diagnostic";
    if (!device_class.empty()) component["device_class"] = device_class;
    add(what, std::move(component));
  };
  add_binary("moving", "moving", "moving");
  add_binary("fault", "faults", "problem");
  add_binary("latched", "latched", "problem");
  add_binary("referenced", "referenced", {});
  return all;
}

json::object HomeAssistant::stop_button() const {
  return {{"p", button_platform},
          {"name", "Stop all axes"},
          {"unique_id", "tmcl_" + gateway_ + "_stop"},
          {"command_topic", topics_.stop()},
          // A broker would give a retained stop to the gateway again and again.
          {"retain", false},
          {"qos", 1}};
}

// ---- what comes --------------------------------------------------------------------------------

void HomeAssistant::remove(const std::string& component, std::string_view platform) {
  if (components_.contains(component) || removed_.size() >= most_removed) return;
  removed_.insert_or_assign(component, std::string(platform));
}

void HomeAssistant::know(const std::vector<ListedAxis>& axes, tmcl::TimePoint now) {
  json::object components;
  components[stop_component] = stop_button();
  for (const auto& axis : axes)
    for (auto& [name, component] : components_of(axis)) components[name] = std::move(component);
  if (is_known_ && components == components_) return;
  const auto before = std::exchange(components_, std::move(components));
  is_known_ = true;
  for (const auto& [name, component] : before)
    remove(name, json::string_view(component.at("p").as_string()));
  std::erase_if(removed_, [&](const auto& one) { return components_.contains(one.first); });
  due_ = now;
}

void HomeAssistant::take(const Message& message, tmcl::TimePoint now) {
  if (message.topic == config_) return see_config(message, now);
  if (message.topic != status_ || message.payload != "online") return;
  due_ = now + delay_of(gateway_);
}

void HomeAssistant::see_config(const Message& message, tmcl::TimePoint now) {
  // Its user has deleted the device: it comes with the next connection, or when that starts again.
  if (message.payload.empty()) return;
  due_ = std::max(now, told_ + least_interval);
  boost::system::error_code error;
  const auto said = json::parse(message.payload, error);
  if (error || !said.is_object()) return;
  const auto* components = said.get_object().if_contains("cmps");
  if (components == nullptr || !components->is_object()) return;
  for (const auto& [key, component] : components->get_object()) {
    const std::string name(key);
    if (!component.is_object() || !is_level(name)) continue;
    const auto* platform = component.get_object().if_contains("p");
    if (platform == nullptr || !platform->is_string()) continue;
    const std::string_view text(platform->get_string());
    if (std::ranges::count(platforms, text) != 0) remove(name, text);
  }
}

std::optional<Publication> HomeAssistant::due(tmcl::TimePoint now) {
  if (!is_known_ || !due_ || now < *due_) return std::nullopt;
  due_.reset();
  told_ = now;
  json::object device{{"ids", json::array{"tmcl_" + gateway_}},
                      {"name", gateway_},
                      {"mf", "tmcl"},
                      {"mdl", "gateway to TMCM modules"},
                      {"sw", version_}};
  json::object origin{{"name", "tmcld-mqtt"}, {"sw", version_}};
  // A component without anything but its platform is removed.
  auto components = components_;
  for (const auto& [name, platform] : removed_) components[name] = json::object{{"p", platform}};
  const json::object config{{"dev", std::move(device)},
                            {"o", std::move(origin)},
                            {"cmps", std::move(components)},
                            {"availability_topic", topics_.birth()},
                            {"availability_template", is_available}};
  return Publication{
      .topic = config_, .payload = tmcl::json_text(config), .retained = true, .qos = 1};
}

}  // namespace tmclmqtt
