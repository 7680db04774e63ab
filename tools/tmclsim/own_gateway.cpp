#include "own_gateway.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>
#include <utility>
#include <variant>

#include <unistd.h>

#include "config/http_config.hpp"
#include "config/load.hpp"
#include "console.hpp"
#include "number_text.hpp"
#include "sim/ports/socket_port.hpp"
#include "sim/wire/rates.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/seconds.hpp"
#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

namespace sim = tmcl::sim;

// Of virtual time: modules that do not answer are not waited for any longer.
constexpr auto time_to_be_known = std::chrono::seconds(10);
// Of the computer's time: a client that does not take what it is told loses some of it afterwards.
constexpr auto time_to_read = std::chrono::seconds(1);
constexpr double longest_run_s = 1e6;
constexpr std::uint32_t usual_serial_rate = 115'200;
constexpr std::uint32_t usual_can_rate = 1'000'000;

std::uint32_t rate_of(const tmcl::LinkName& link) {
  const auto* serial = std::get_if<tmcl::SerialName>(&link);
  return serial != nullptr ? serial->baud : usual_serial_rate;
}

/// Time must pass while something is asked, or a loop of questions would never end.
sim::SerialWire serial_wire(const Wires& wires, const tmcl::LinkName& link) {
  sim::SerialWire wire;
  wire.pace = {wires.baud != 0 ? wires.baud : rate_of(link), sim::usual_time_to_answer};
  wire.echoes = wires.echo;
  wire.noise = wires.noise;
  wire.seed = wires.seed;
  return wire;
}

}  // namespace

tl::expected<tmcld::Config, std::vector<std::string>> load_gateway_config(const std::string& path) {
  auto loaded = tmcld::load_config(path);
  if (!loaded) return tl::unexpected(std::move(loaded.error()));
  const auto http = tmcld::load_http_config(path);
  if (!http) return tl::unexpected(http.error());
  if (*http || !loaded->config.ports.empty()) {
    return tl::unexpected(
        std::vector{path + ": in virtual time clients come by the socket of [daemon] alone: leave "
                           "[http] and [[port]] out"});
  }
  return std::move(loaded->config);
}

OwnGateway::OwnGateway(boost::asio::io_context& io, tmcl::VirtualTime& time,
                       sim::Scheduler& modules, const Wires& wires)
    : io_(&io), time_(&time), modules_(&modules), wires_(wires) {}

OwnGateway::~OwnGateway() = default;

tl::expected<std::unique_ptr<OwnGateway>, std::string> OwnGateway::create(
    boost::asio::io_context& io, tmcl::VirtualTime& time, sim::Scheduler& modules,
    const tmcld::Config& config, const Wires& wires) {
  std::unique_ptr<OwnGateway> own(new OwnGateway(io, time, modules, wires));
  auto daemon = tmcld::Daemon::create(
      io, config, [it = own.get()](const tmcld::BusConfig& bus) { return it->open(bus); });
  if (!daemon) return tl::unexpected(std::move(daemon.error()));
  own->daemon_ = std::move(*daemon);
  own->become_ready();
  return own;
}

/// In virtual time the reactor does that, too.
tmcl::Result<tmcl::Link> OwnGateway::open(const tmcld::BusConfig& bus) {
  const bool is_can = std::holds_alternative<tmcl::CanName>(bus.link);
  auto ends = tmcl::Link::memory_pair(is_can ? tmcl::Framing::can : tmcl::Framing::serial);
  if (!ends) return tl::unexpected(std::move(ends.error()));
  tmcl::FileDescriptor far(::dup(ends->second.descriptor()));
  auto& line = lines_[bus.name];
  if (is_can) {
    const sim::Pace pace{usual_can_rate, sim::usual_time_to_answer};
    line = sim::serve_can_socket(*io_, *modules_, std::move(far), pace);
  } else {
    const auto wire = serial_wire(wires_, bus.link);
    line = sim::serve_serial_socket(*io_, *modules_, std::move(far), wire);
  }
  return std::move(ends->first);
}

void OwnGateway::become_ready() {
  daemon_->start();
  const auto is_known = [](const auto& axis) {
    return axis->module().state() == tmcld::GatewayModule::State::ready;
  };
  const auto is_ready = [&] {
    return daemon_->is_serving() && std::ranges::all_of(daemon_->gateway().axes(), is_known);
  };
  time_->run_while_not(is_ready, time_to_be_known);
  began_ = time_->now();
}

// ---- how time goes on --------------------------------------------------------------------------

void OwnGateway::run() {
  daemon_->end_on_signals();
  while (!daemon_->has_ended()) turn();
}

void OwnGateway::turn() {
  time_->settle();
  if (daemon_->has_ended() || (goes_on() && go_on())) return;
  io_->restart();
  io_->run_one();
}

bool OwnGateway::goes_on() const {
  return asked_until_ || daemon_->has_calls_in_flight() || daemon_->is_ending();
}

/// False if nothing will happen before something comes from outside.
bool OwnGateway::go_on() {
  if (waits_for_reader()) return true;
  const auto due = time_->next_due();
  if (asked_until_ && (!due || *due > *asked_until_)) {
    time_->run_until(*std::exchange(asked_until_, std::nullopt));
    std::cout << "ok" << std::endl;
    return true;
  }
  if (!due) return false;
  if (!asked_until_) {
    const auto ahead = std::max(*due - time_->now(), tmcl::Duration{});
    daemon_->gateway().leases()->put_off(ahead);
  }
  time_->step();
  return true;
}

/// Else what a client is told would depend on how fast it reads.
bool OwnGateway::waits_for_reader() {
  if (!daemon_->has_output() || daemon_->is_ending()) {
    has_slow_reader_ = false;
    return false;
  }
  if (has_slow_reader_) return false;
  io_->restart();
  has_slow_reader_ = io_->run_one_for(time_to_read) == 0;
  return true;
}

// ---- the console -------------------------------------------------------------------------------

std::string OwnGateway::answer(std::string_view line) {
  const auto blank = std::min(line.find(' '), line.size());
  const auto word = line.substr(0, blank);
  if (word == "run") return run_for(line.substr(std::min(blank + 1, line.size())));
  if (word == "now") return "ok " + tmcl::plain_number(tmcl::seconds(elapsed()));
  auto answer = run_console_line(modules_->bench(), line);
  modules_->touch();
  return answer;
}

std::string OwnGateway::run_for(std::string_view text) {
  const auto seconds = parse_number<double>(text);
  if (!seconds || !(*seconds >= 0 && *seconds <= longest_run_s))
    return "error: " + tmcl::quoted(text) + " is no number of seconds from 0 to 1000000";
  if (asked_until_) return "error: the time that was asked for before is not over";
  const std::chrono::duration<double> asked(*seconds);
  asked_until_ = time_->now() + std::chrono::round<std::chrono::microseconds>(asked);
  return "";
}

}  // namespace tmclsim
