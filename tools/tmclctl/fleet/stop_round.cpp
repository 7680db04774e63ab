#include "fleet/stop_round.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "broker/topic_levels.hpp"
#include "connection/json_read.hpp"
#include "tmcl/client_error.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

std::string message_in(const json::object& error) {
  const auto message = tmcl::client::error_from_json(error).message;
  return is_printable(message) ? message : "?";
}

}  // namespace

std::string StopRound::filter() const {
  return tmclmqtt::reply_topic(user_, tmclmqtt::any_level, id_);
}

tmclmqtt::Publication StopRound::stop_on(const std::string& level) const {
  tmclmqtt::Publication stop;
  stop.topic = fmt::format("{}{}/stop", tmclmqtt::topic_root, level);
  stop.payload = "{}";
  stop.response_topic = tmclmqtt::reply_topic(user_, level, id_);
  return stop;
}

std::vector<tmclmqtt::Publication> StopRound::due(tmcl::TimePoint now) {
  std::vector<tmclmqtt::Publication> due;
  if (published_ && now - *published_ < interval) return due;
  // Gateways that no birth names are stopped, too.
  if (!gateways_.has_patterns() && (!published_ || !knows_gateways_)) {
    due.push_back(stop_on(std::string(tmclmqtt::level_of_all)));
  } else {
    for (const auto& [name, gateway] : gateways_.all())
      if (is_missing(name, gateway)) due.push_back(stop_on(name));
    if (!knows_gateways_)
      for (const auto& name : unknown()) due.push_back(stop_on(name));
  }
  if (!due.empty()) published_ = now;
  return due;
}

std::string StopRound::hear(const tmclmqtt::Message& message) {
  if (!message.topic.starts_with(tmclmqtt::reply_root)) return {};
  const auto levels = tmclmqtt::levels_of(message.topic);
  const std::string name(levels[levels.size() - 2]);
  if (!tmclmqtt::is_gateway_name(name) || message.topic != tmclmqtt::reply_topic(user_, name, id_))
    return {};
  if (!gateways_.is_meant(name)) return {};
  const auto answer = object_in(message.payload);
  auto& heard = heard_[name];
  const auto& error = object_at(answer, "error");
  heard.error = error.empty() ? std::string() : message_in(error);
  const auto& result = object_at(answer, "result");
  for (const auto& one : array_at(result, "failed")) {
    if (!one.is_object()) continue;
    const auto axis = text_at(one.get_object(), "axis");
    heard.failed[axis] = message_in(object_at(one.get_object(), "error"));
  }
  bool acknowledges = false;
  for (const auto& one : array_at(result, "stopped")) {
    if (!one.is_object()) continue;
    const auto axis = text_at(one.get_object(), "axis");
    if (axis.empty() || !is_printable(axis)) continue;
    heard.failed.erase(axis);
    acknowledges =
        heard.stopped.try_emplace(axis, number_at(one.get_object(), "milliseconds").value_or(0))
            .second ||
        acknowledges;
  }
  return acknowledges ? name : std::string();
}

const std::map<std::string, double>& StopRound::stopped(const std::string& gateway) const {
  static const std::map<std::string, double> none;
  const auto found = heard_.find(gateway);
  return found == heard_.end() ? none : found->second.stopped;
}

bool StopRound::is_missing(const std::string& name, const FleetGateway& gateway) const {
  if (!gateway.online) return false;
  const auto found = heard_.find(name);
  if (found == heard_.end() || !found->second.error.empty()) return true;
  return std::ranges::any_of(
      gateway.axes, [&](const auto& axis) { return !found->second.stopped.contains(axis); });
}

std::vector<StopRound::Missing> StopRound::missing() const {
  std::vector<Missing> missing;
  for (const auto& [name, gateway] : gateways_.all()) {
    if (!is_missing(name, gateway)) continue;
    const auto found = heard_.find(name);
    if (found == heard_.end()) {
      missing.push_back({name, {}, "no answer"});
    } else if (!found->second.error.empty()) {
      missing.push_back({name, {}, found->second.error});
    } else {
      for (const auto& axis : gateway.axes) {
        if (found->second.stopped.contains(axis)) continue;
        const auto why = found->second.failed.find(axis);
        missing.push_back(
            {name, axis, why == found->second.failed.end() ? "no answer" : why->second});
      }
    }
  }
  return missing;
}

std::vector<std::string> StopRound::unknown() const {
  std::vector<std::string> unknown;
  for (const auto& name : gateways_.named())
    if (!gateways_.all().contains(name) && !heard_.contains(name)) unknown.push_back(name);
  return unknown;
}

std::vector<std::string> StopRound::away() const {
  std::vector<std::string> away;
  for (const auto& [name, gateway] : gateways_.all())
    if (!gateway.online) away.push_back(name);
  return away;
}

}  // namespace tmclctl
