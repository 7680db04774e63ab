// The only file of tmcld-mqtt that knows the command-line library: it takes long to compile.
#include "command_line.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

namespace tmclmqtt {
namespace {

constexpr int bad_usage = 2;

constexpr auto description =
    "tmcld-mqtt puts a gateway on an MQTT 5 broker: it uses the socket of tmcld as a relay.";

constexpr auto footer = R"(The least configuration file:

    [mqtt]
    broker = "localhost"
    gateway = "hall-1"
    socket = "/run/tmcld/tmcld.sock"

With TLS: ca, certificate and key, each a file. tmcld.toml must let it in:

    [[access]]
    role = "operate"
    users = ["tmcld-mqtt"]
    relay = true

Exit codes: 0 ended as asked, 1 failure while running, 2 bad command line or configuration.
tmcld-mqtt(8) and share/doc/tmcl/FLEET.md say what it publishes and takes.)";

int complain(const std::string& what) {
  std::cerr << "tmcld-mqtt: " << what
            << "\n  'tmcld-mqtt --help' shows the least configuration file\n";
  return bad_usage;
}

}  // namespace

std::variant<MqttCommandLine, int> parse_mqtt_command_line(int argc, const char* const* argv) {
  CLI::App app(description, "tmcld-mqtt");
  app.footer(footer);
  app.set_version_flag("--version", std::string("tmcld-mqtt ") + TMCL_VERSION);
  MqttCommandLine result;
  app.add_option("-c,--config", result.config_file, "the configuration file, in TOML")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_flag("--check", result.only_check,
               "check the configuration file, say what is in it, and end");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return 0;
  } catch (const CLI::ParseError& error) {
    return complain(error.what());
  }
  return result;
}

}  // namespace tmclmqtt
