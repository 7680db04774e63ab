/// What tmcld-mqtt is told to do: plain values, already checked.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "config/config.hpp"
#include "tmcl/text_problem.hpp"

namespace tmclmqtt {

struct MqttConfig {
  std::string host;
  std::uint16_t port = 0;
  std::string gateway;
  std::string socket;
  /// Paths; empty: without TLS, without a certificate of its own.
  std::string ca{};
  std::string certificate{};
  std::string key{};
  /// What the broker calls it, and the path of a file; empty: a certificate says who it is.
  std::string user{};
  std::string password_file{};
  std::chrono::milliseconds nonce_ttl{2000};
  tmcld::LogLevel log_level = tmcld::LogLevel::info;
  /// Levels of topics; empty: without Sparkplug, and its births wait for no host.
  std::string sparkplug_group{};
  std::string sparkplug_host{};
  bool home_assistant = false;
  std::string home_assistant_prefix = "homeassistant";
};

/// Errors: everything that is wrong, in the order of the text. Opens no file. Never throws.
tl::expected<MqttConfig, tmcl::TextProblems> parse_mqtt_config(std::string_view toml,
                                                               const std::string& file = {});
/// From the file and those beside it, as tmcld has them: of /etc/tmcl/mqtt.toml those in
/// /etc/tmcl/mqtt.d. Errors: a line each.
tl::expected<MqttConfig, std::vector<std::string>> load_mqtt_config(const std::string& path);

}  // namespace tmclmqtt
