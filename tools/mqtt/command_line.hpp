/// What tmcld-mqtt was called with.
#pragma once

#include <string>
#include <variant>

namespace tmclmqtt {

struct MqttCommandLine {
  /// Where the package has it.
  std::string config_file = "/etc/tmcl/mqtt.toml";
  bool only_check = false;
};

/// The exit code where there is nothing more to do: --help, --version, or a mistake that has been
/// explained.
std::variant<MqttCommandLine, int> parse_mqtt_command_line(int argc, const char* const* argv);

}  // namespace tmclmqtt
