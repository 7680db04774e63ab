#include "fleet/gateway.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <pwd.h>
#include <unistd.h>

#include <fmt/format.h>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "fleet/names.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmclfleet {
namespace {

constexpr auto model = "TMCM-6110";
constexpr auto module_address = tmcl::ModuleAddress{1};
constexpr auto look_interval = std::chrono::milliseconds(5);

std::string tmcld_config(const FleetPlace& place, const std::string& name) {
  auto text = fmt::format(R"(
[daemon]
socket = "{0}/{1}.sock"
audit = "{0}/{1}.audit"
[[access]]
role = "operate"
users = ["{2}"]
relay = true
[[bus]]
name = "line"
link = "serial:/dev/none@115200"
)",
                          place.folder, name, ::getpwuid(::geteuid())->pw_name);
  for (int motor = 0; motor < axes_of_a_gateway; ++motor) {
    text += fmt::format("[[axis]]\nname = \"{}\"\nbus = \"line\"\naddress = 1\nmotor = {}\n",
                        name_of_axis(motor), motor);
  }
  return text;
}

tmclmqtt::MqttConfig mqtt_config(const FleetPlace& place, const std::string& name) {
  tmclmqtt::MqttConfig config;
  config.host = place.host;
  config.port = place.port;
  config.gateway = name;
  config.socket = fmt::format("{}/{}.sock", place.folder, name);
  config.ca = place.authority();
  config.certificate = place.file_of(name, ".crt");
  config.key = place.file_of(name, ".key");
  return config;
}

tmclmqtt::BridgeParts bridge_parts(tmcld::Workers& workers, const std::string& name) {
  tmclmqtt::BridgeParts parts;
  parts.connect = [&workers](tmclmqtt::BrokerOptions options,
                             tmclmqtt::Broker::OnMessage on_message,
                             std::function<void()> on_room) {
    return tmclmqtt::connect_to_broker(workers, std::move(options), std::move(on_message),
                                       std::move(on_room));
  };
  parts.draw = [name, last = 0]() mutable { return fmt::format("{}-{:026x}", name, ++last); };
  parts.on_turn = [] {};
  return parts;
}

}  // namespace

// ---- the line ----------------------------------------------------------------------------------

SimulatedLine::SimulatedLine(boost::asio::io_context& context)
    : clock_(context),
      bench_(clock_),
      scheduler_(context, bench_),
      serial_(bench_, [this](std::span<const std::uint8_t> bytes) { (void)far_->write(bytes); },
              {}),
      readiness_(context) {
  bench_.add(*tmcl::find_model(model), module_address);
  auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
  if (!ends) throw std::runtime_error("no line in memory: " + tmcl::describe(ends.error()));
  near_ = std::move(ends->first);
  far_ = std::move(ends->second);
  readiness_.assign(::dup(far_->descriptor()));
  wait();
}

tmcl::Result<tmcl::Link> SimulatedLine::open() {
  if (auto end = std::exchange(near_, std::nullopt)) return std::move(*end);
  return tl::unexpected(tmcl::not_sent(tmcl::Errc::link_open_failed, "the line was opened before"));
}

void SimulatedLine::wait() {
  readiness_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                        [this](const boost::system::error_code& error) {
                          if (!error && read()) wait();
                        });
}

/// False when the gateway has closed its end.
bool SimulatedLine::read() {
  std::array<std::uint8_t, tmcl::serial_datagram_size> bytes{};
  const auto count = far_->read(bytes);
  if (!count || *count == 0) return false;
  const auto said = std::span<const std::uint8_t>(bytes).first(*count);
  note(said);
  serial_.receive(said);
  scheduler_.touch();
  return true;
}

void SimulatedLine::note(std::span<const std::uint8_t> bytes) const {
  if (bytes.size() != tmcl::serial_datagram_size) return;
  const auto request = tmcl::decode_serial_request(bytes.first<tmcl::serial_datagram_size>());
  if (request && request->command == tmcl::Command::MST) on_stop();
}

bool SimulatedLine::stands() {
  scheduler_.touch();
  const auto& module = *bench_.modules().front();
  for (std::size_t motor = 0; motor < axes_of_a_gateway; ++motor)
    if (module.axis(motor).get(tmcl::axis_parameter::actual_velocity) != 0) return false;
  return true;
}

// ---- the gateway -------------------------------------------------------------------------------

SimulatedGateway::SimulatedGateway(boost::asio::io_context& context, tmcld::Workers& workers,
                                   const FleetPlace& place, int number)
    : context_(context), line_(context) {
  const auto name = name_of_gateway(number);
  auto config = tmcld::parse_config(tmcld_config(place, name));
  if (!config) throw std::runtime_error("the configuration of " + name + " is none");
  auto daemon = tmcld::Daemon::create(context, *config,
                                      [this](const tmcld::BusConfig&) { return line_.open(); });
  if (!daemon) throw std::runtime_error(daemon.error());
  daemon_ = std::move(*daemon);
  bridge_ = std::make_shared<tmclmqtt::Bridge>(context.get_executor(), mqtt_config(place, name),
                                               bridge_parts(workers, name));
  line_.on_stop = [this] {
    if (std::exchange(is_watched_, true)) return;
    tmcld::spawn(context_.get_executor(), watch_until_it_stands(*this));
  };
}

void SimulatedGateway::start() {
  daemon_->start();
  bridge_->start();
}

boost::asio::awaitable<void> SimulatedGateway::watch_until_it_stands(SimulatedGateway& gateway) {
  const tmcl::ContextClock clock(gateway.context_);
  while (!gateway.line_.stands()) co_await tmcld::rest(look_interval);
  if (!gateway.stood_) gateway.stood_ = clock.now();
}

}  // namespace tmclfleet
