/// The gateways on a broker, by what they say of themselves. Does no I/O. What comes from a broker
/// may be anything.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"

namespace tmclctl {

struct FleetGateway {
  bool online = false;
  std::string daemon{};  ///< Version of tmcld; empty: it is not there.
  std::vector<std::string> axes{};
};

class Gateways {
 public:
  static constexpr const char* filter = "tmcl/v1/+/birth";

  /// Names and patterns of the shell; none: all there are.
  explicit Gateways(std::vector<std::string> patterns) : patterns_(std::move(patterns)) {}

  bool has_patterns() const { return !patterns_.empty(); }
  bool has_only_names() const { return named().size() == patterns_.size(); }
  bool is_meant(const std::string& gateway) const;
  /// Whether it was a birth of a gateway that is meant.
  bool hear(const tmclmqtt::Message& message);
  const std::map<std::string, FleetGateway>& all() const { return gateways_; }
  bool is_online(const std::string& gateway) const;
  /// Those of the patterns that are names.
  std::vector<std::string> named() const;
  /// Names and patterns that no gateway has.
  std::vector<std::string> unknown() const;

 private:
  std::vector<std::string> patterns_;
  std::map<std::string, FleetGateway> gateways_;
};

/// The level in the place of the gateway, if the topic has one that a gateway can have:
/// tmcl/v1/GATEWAY/...; empty if not. `rest`: what stands behind it.
std::string gateway_in(std::string_view topic, std::string_view& rest);
/// A JSON object; empty if it is none.
boost::json::object object_in(const std::string& payload);
/// Whether a terminal can show it: no control characters.
bool is_printable(std::string_view text);

}  // namespace tmclctl
