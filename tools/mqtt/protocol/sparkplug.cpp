#include "protocol/sparkplug.hpp"

#include <algorithm>
#include <array>

#include <boost/json/parse.hpp>

#include "broker/topic_levels.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;

constexpr std::string_view topic_root_of_sparkplug = "spBv1.0/";
constexpr std::string_view birth_number_metric = "bdSeq";

/// A member of a state, as a metric of a device.
struct Row {
  std::string_view metric;
  MetricType type;
  std::string_view member;
  std::string_view without_unit{};  ///< Where the axis has no unit: this member, in microsteps.
  bool per_second = false;
};
constexpr std::array rows{
    Row{"Position", MetricType::floating, "position", "position_microsteps"},
    Row{"Velocity", MetricType::floating, "velocity", "velocity_pps", true},
    Row{"Target", MetricType::floating, "target", "target_microsteps"},
    Row{"Moving", MetricType::boolean, "moving"},
    Row{"Referenced", MetricType::boolean, "referenced"},
    Row{"Latched", MetricType::boolean, "latched"},
    Row{"Faults", MetricType::text, "faults"},
    Row{"Stop cause", MetricType::text, "stop_cause"},
    Row{"Owner", MetricType::text, "owner"},
    Row{"Unattended", MetricType::boolean, "unattended"},
};

bool tells_the_place(std::string_view metric) {
  return metric == rows[0].metric || metric == rows[1].metric;
}

std::string unit_of(const Row& row, const std::string& unit) {
  if (row.without_unit.empty()) return {};
  return (unit.empty() ? "microsteps" : unit) + (row.per_second ? "/s" : "");
}

Metric metric_of(const Row& row, const json::object& values, const std::string& unit) {
  return {std::string(row.metric), row.type, values.at(row.metric), unit_of(row, unit)};
}

json::value joined(const json::array& texts) {
  json::string all;
  for (const auto& text : texts) {
    if (!text.is_string()) continue;
    if (!all.empty()) all += ", ";
    all += text.get_string();
  }
  return all;
}

/// Null where it is not of the type.
json::value value_of(MetricType type, const json::value& told) {
  if (type == MetricType::floating && told.is_number()) return told.to_number<double>();
  if (type == MetricType::boolean && told.is_bool()) return told;
  if (type == MetricType::text && told.is_string()) return told;
  if (type == MetricType::text && told.is_array()) return joined(told.get_array());
  return nullptr;
}

std::string text_in(const json::object& told, std::string_view name) {
  const auto* value = told.if_contains(name);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string();
}

json::object values_of(const json::object& state, const std::string& unit) {
  json::object values;
  for (const auto& row : rows) {
    const bool in_microsteps = unit.empty() && !row.without_unit.empty();
    const auto* told = state.if_contains(in_microsteps ? row.without_unit : row.member);
    values[row.metric] = told == nullptr ? json::value() : value_of(row.type, *told);
  }
  return values;
}

}  // namespace

Sparkplug::Sparkplug(SparkplugNames names, std::string_view version)
    : names_(std::move(names)), version_(version) {}

std::string Sparkplug::topic(std::string_view verb, const std::string& device) const {
  auto text = std::string(topic_root_of_sparkplug) + names_.group + '/' + std::string(verb) + '/' +
              names_.node;
  if (!device.empty()) text += '/' + device;
  return text;
}

std::vector<std::string> Sparkplug::filters() const {
  std::vector<std::string> filters{topic("NCMD")};
  if (!names_.host.empty())
    filters.push_back(std::string(topic_root_of_sparkplug) + "STATE/" + names_.host);
  return filters;
}

// ---- the connection ----------------------------------------------------------------------------

Publication Sparkplug::begin(tmcl::UtcTime utc) {
  end();
  birth_number_ = birth_number_ ? static_cast<std::uint8_t>(*birth_number_ + 1) : std::uint8_t{};
  return death(utc);
}

void Sparkplug::end() {
  is_connected_ = false;
  is_born_ = false;
  rebirth_wanted_ = false;
  born_.reset();
  // It says so again on the next connection: its message is retained.
  host_is_online_ = false;
  forget_told();
}

void Sparkplug::forget_told() {
  for (auto& [name, device] : devices_) device.told.reset();
  drop_unknown();
}

void Sparkplug::drop_unknown() {
  std::erase_if(devices_,
                [](const auto& one) { return !one.second.is_listed && !one.second.told; });
}

Publication Sparkplug::death(tmcl::UtcTime utc) const {
  const Metric number{std::string(birth_number_metric), MetricType::int64, *birth_number_};
  return {.topic = topic("NDEATH"),
          .payload = sparkplug_payload({number}, utc, std::nullopt),
          .qos = 1};
}

std::optional<Publication> Sparkplug::farewell(tmcl::UtcTime utc) const {
  if (!is_born_) return std::nullopt;
  return death(utc);
}

// ---- what there is -----------------------------------------------------------------------------

void Sparkplug::hear(const json::object& told) {
  const auto axis = text_in(told, "axis");
  if (axis.empty()) return;
  auto& device = devices_[axis];
  device.unit = text_in(told, "unit");
  device.metrics = values_of(told, device.unit);
}

void Sparkplug::know(const std::string& daemon, const std::vector<ListedAxis>& axes) {
  daemon_ = daemon;
  for (auto& [name, device] : devices_) device.is_listed = false;
  for (const auto& axis : axes) {
    if (!is_level(axis.name)) continue;
    auto& device = devices_[axis.name];
    device.is_listed = true;
    device.answers = axis.answers;
  }
  for (auto& [name, device] : devices_)
    if (!device.is_listed) device.metrics.clear();
  drop_unknown();
}

void Sparkplug::take(const Message& message) {
  if (message.topic == topic("NCMD")) {
    // One that a broker keeps was not sent now, and would come with each connection.
    const bool asks = !message.retained && asks_for_rebirth(message.payload);
    rebirth_wanted_ = rebirth_wanted_ || asks;
  } else {
    take_state(message);
  }
}

void Sparkplug::take_state(const Message& message) {
  const auto known = filters();
  if (std::ranges::count(known, message.topic) == 0) return;
  boost::system::error_code error;
  const auto said = json::parse(message.payload, error);
  if (error || !said.is_object()) return;
  const auto* online = said.get_object().if_contains("online");
  const auto* time = said.get_object().if_contains("timestamp");
  if (online == nullptr || !online->is_bool() || time == nullptr || !time->is_int64()) return;
  // A late will of the host's connection before is older than what it has said since.
  if (host_time_ && time->get_int64() < *host_time_) return;
  host_time_ = time->get_int64();
  host_is_online_ = online->get_bool();
}

// ---- what is to be said ------------------------------------------------------------------------

std::optional<Publication> Sparkplug::next(tmcl::TimePoint now, tmcl::UtcTime utc) {
  if (!is_connected_ || !has_host()) return std::nullopt;
  // Also before a rebirth: hosts need not take a birth of the node as the death of a device.
  if (auto death = next_death(utc)) return death;
  if (rebirth_wanted_ && is_born_ && now - *born_ < birth_interval) return std::nullopt;
  if (auto birth = next_birth(now, utc)) return birth;
  return next_data(now, utc);
}

Publication Sparkplug::said(std::string_view verb, const std::string& device,
                            std::vector<Metric> metrics, tmcl::UtcTime utc) {
  return {.topic = topic(verb, device), .payload = sparkplug_payload(metrics, utc, sequence_++)};
}

std::optional<Publication> Sparkplug::next_death(tmcl::UtcTime utc) {
  const auto dead = std::ranges::find_if(
      devices_, [](const auto& one) { return one.second.told && !one.second.is_there(); });
  if (dead == devices_.end()) return std::nullopt;
  const auto name = dead->first;
  dead->second.told.reset();
  drop_unknown();
  return said("DDEATH", name, {}, utc);
}

std::optional<Publication> Sparkplug::next_birth(tmcl::TimePoint now, tmcl::UtcTime utc) {
  if (!is_born_ || rebirth_wanted_) return birth_of_node(now, utc);
  for (auto& [name, device] : devices_) {
    // What a metric is in is said in births alone.
    if (!device.is_there() || (device.told && device.told->unit == device.unit)) continue;
    device.told = Told{device.metrics, device.unit, now};
    std::vector<Metric> metrics;
    for (const auto& row : rows) metrics.push_back(metric_of(row, device.metrics, device.unit));
    return said("DBIRTH", name, std::move(metrics), utc);
  }
  return std::nullopt;
}

Publication Sparkplug::birth_of_node(tmcl::TimePoint now, tmcl::UtcTime utc) {
  is_born_ = true;
  rebirth_wanted_ = false;
  born_ = now;
  sequence_ = 0;
  forget_told();
  daemon_told_ = daemon_;
  const Metric number{std::string(birth_number_metric), MetricType::int64, *birth_number_};
  const Metric rebirth{std::string(rebirth_metric), MetricType::boolean, false};
  const Metric own{"Properties/tmcld-mqtt version", MetricType::text, json::string(version_)};
  return said("NBIRTH", {}, {number, rebirth, own, daemon_metric()}, utc);
}

Metric Sparkplug::daemon_metric() const {
  json::value version;
  if (!daemon_.empty()) version = json::string(daemon_);
  return {"Properties/tmcld version", MetricType::text, std::move(version)};
}

std::optional<Publication> Sparkplug::next_data(tmcl::TimePoint now, tmcl::UtcTime utc) {
  if (daemon_ != daemon_told_) {
    daemon_told_ = daemon_;
    return said("NDATA", {}, {daemon_metric()}, utc);
  }
  for (auto& [name, device] : devices_) {
    auto changed = take_changes(device, now);
    if (!changed.empty()) return said("DDATA", name, std::move(changed), utc);
  }
  return std::nullopt;
}

/// They count as told; empty if nothing is due.
std::vector<Metric> Sparkplug::take_changes(Device& device, tmcl::TimePoint now) {
  std::vector<Metric> changed;
  if (!device.told) return changed;
  for (const auto& row : rows) {
    if (device.metrics.at(row.metric) != device.told->metrics.at(row.metric))
      changed.push_back(metric_of(row, device.metrics, device.unit));
  }
  const bool waits =
      now - device.told->at < data_interval &&
      std::ranges::all_of(changed, [](const auto& one) { return tells_the_place(one.name); });
  if (waits) return {};
  if (!changed.empty()) device.told = Told{device.metrics, device.unit, now};
  return changed;
}

}  // namespace tmclmqtt
