// tmcld-mqtt: see command_line.cpp for what it says of itself.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "async/workers.hpp"
#include "broker/random_text.hpp"
#include "command_line.hpp"
#include "io/bridge.hpp"
#include "log/log.hpp"
#include "mqtt_config.hpp"
#include "service/service.hpp"

namespace {

using namespace tmclmqtt;
using tmcld::LogLevel;

constexpr int ok = 0;
constexpr int runtime_failure = 1;
constexpr int bad_usage = 2;

int report(const std::vector<std::string>& problems) {
  for (const auto& line : problems) std::fprintf(stderr, "%s\n", line.c_str());
  return bad_usage;
}

int say_config(const MqttConfig& config) {
  const auto group =
      config.sparkplug_group.empty() ? "" : ", in Sparkplug group " + config.sparkplug_group;
  std::printf("ok: gateway %s on broker %s:%d%s%s%s\n", config.gateway.c_str(), config.host.c_str(),
              int{config.port}, config.ca.empty() ? ", without TLS" : "", group.c_str(),
              config.home_assistant ? ", for Home Assistant" : "");
  return ok;
}

int serve(const MqttConfig& config) {
  // A peer that has gone is an error value of the write.
  std::signal(SIGPIPE, SIG_IGN);
  auto service = tmcld::Service::of_environment();
  if (!service) {
    tmcld::log(LogLevel::error, service.error());
    return runtime_failure;
  }
  boost::asio::io_context context(1);
  tmcld::Workers workers(1);
  BridgeParts parts;
  parts.connect = [&workers](BrokerOptions options, Broker::OnMessage on_message,
                             std::function<void()> on_room) {
    return connect_to_broker(workers, std::move(options), std::move(on_message),
                             std::move(on_room));
  };
  parts.draw = random_text;
  parts.on_turn = [&service] { service->alive(); };
  const auto bridge = std::make_shared<Bridge>(context.get_executor(), config, std::move(parts));
  boost::asio::signal_set signals(context, SIGTERM, SIGINT);
  signals.async_wait([&](const boost::system::error_code&, int number) {
    tmcld::log(LogLevel::info, number == SIGINT ? "ending: SIGINT" : "ending: SIGTERM");
    service->stopping("ending");
    bridge->stop();
    context.stop();
  });
  if (config.ca.empty())
    tmcld::log(LogLevel::warning,
               fmt::format("without 'ca' what goes to the broker{} is not encrypted",
                           config.password_file.empty() ? "" : ", the password too,"));
  bridge->start();
  service->ready("gateway " + config.gateway);
  context.run();
  tmcld::log(LogLevel::info, "ended");
  if (!bridge->is_connecting()) return ok;
  tmcld::end_log();
  std::_Exit(ok);
}

}  // namespace

int main(int argc, char** argv) {
  const auto parsed = parse_mqtt_command_line(argc, argv);
  if (const auto* code = std::get_if<int>(&parsed)) return *code;
  const auto& command_line = std::get<MqttCommandLine>(parsed);
  const auto config = load_mqtt_config(command_line.config_file);
  if (!config) return report(config.error());
  if (command_line.only_check) return say_config(*config);
  tmcld::start_log(config->log_level);
  int code = runtime_failure;
  try {
    code = serve(*config);
  } catch (...) {
    tmcld::log_failure(tmcld::log, "tmcld-mqtt", std::current_exception());
  }
  if (!tmcld::end_log()) std::_Exit(code);
  return code;
}
