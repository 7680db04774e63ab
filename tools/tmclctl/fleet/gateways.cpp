#include "fleet/gateways.hpp"

#include <fnmatch.h>

#include <algorithm>

#include <boost/json/parse.hpp>

#include "broker/topic_levels.hpp"
#include "connection/json_read.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr std::size_t max_depth = 16;

bool fits(const std::string& pattern, const std::string& name) {
  return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

FleetGateway gateway_of(const json::object& birth) {
  FleetGateway gateway;
  gateway.online = flag_at(birth, "online");
  if (!gateway.online) return gateway;
  gateway.daemon = text_at(birth, "tmcld");
  gateway.axes = texts_at(birth, "axes");
  std::erase_if(gateway.axes, [](const std::string& name) { return !is_printable(name); });
  if (!is_printable(gateway.daemon)) gateway.daemon = "?";
  return gateway;
}

}  // namespace

bool is_printable(std::string_view text) {
  constexpr unsigned char first_printable = 0x20;
  constexpr unsigned char rubout = 0x7F;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < first_printable || byte == rubout) return false;
    // In UTF-8 what terminals take for control characters of eight bits.
    const bool is_second = i > 0 && static_cast<unsigned char>(text[i - 1]) == 0xC2;
    if (is_second && byte < 0xA0) return false;
  }
  return true;
}

json::object object_in(const std::string& payload) {
  boost::system::error_code error;
  json::parse_options options;
  options.max_depth = max_depth;
  const auto value = json::parse(payload, error, {}, options);
  return error || !value.is_object() ? json::object() : value.get_object();
}

std::string gateway_in(std::string_view topic, std::string_view& rest) {
  if (!topic.starts_with(tmclmqtt::topic_root)) return {};
  topic.remove_prefix(tmclmqtt::topic_root.size());
  const auto end = topic.find('/');
  if (end == topic.npos || !tmclmqtt::is_gateway_name(topic.substr(0, end))) return {};
  rest = topic.substr(end + 1);
  return std::string(topic.substr(0, end));
}

bool Gateways::is_meant(const std::string& gateway) const {
  return patterns_.empty() ||
         std::ranges::any_of(patterns_, [&](const auto& one) { return fits(one, gateway); });
}

bool Gateways::hear(const tmclmqtt::Message& message) {
  std::string_view rest;
  const auto name = gateway_in(message.topic, rest);
  if (name.empty() || rest != "birth" || !is_meant(name)) return false;
  // Without a text: taken off the broker.
  if (message.payload.empty()) {
    gateways_.erase(name);
  } else {
    gateways_[name] = gateway_of(object_in(message.payload));
  }
  return true;
}

bool Gateways::is_online(const std::string& gateway) const {
  const auto found = gateways_.find(gateway);
  return found != gateways_.end() && found->second.online;
}

std::vector<std::string> Gateways::named() const {
  std::vector<std::string> names;
  std::ranges::copy_if(patterns_, std::back_inserter(names), &tmclmqtt::is_gateway_name);
  return names;
}

std::vector<std::string> Gateways::unknown() const {
  std::vector<std::string> unknown;
  std::ranges::copy_if(patterns_, std::back_inserter(unknown), [&](const auto& pattern) {
    return std::ranges::none_of(gateways_,
                                [&](const auto& one) { return fits(pattern, one.first); });
  });
  return unknown;
}

}  // namespace tmclctl
