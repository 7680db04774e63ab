#include <algorithm>
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "api/local_gateway.hpp"
#include "config/load.hpp"
#include "door.hpp"
#include "following.hpp"
#include "port_choice.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

// How often a signal is looked at.
constexpr tmcl::Duration listen_interval = std::chrono::milliseconds(20);
// For a call that a signal has ended: a module in download mode is brought out of it.
constexpr tmcl::Duration time_to_end_call = std::chrono::seconds(1);

class OwnGatewayDoor final : public Door {
 public:
  explicit OwnGatewayDoor(Host& host) : host_(host) {}
  // What moves by itself goes on.
  ~OwnGatewayDoor() override {
    is_ending_ = true;
    if (gateway_) gateway_->end();
  }

  Result<void> open(const tmcld::Config& config, std::int32_t full_steps, tmcl::Duration waited);

  Result<json::object> call(std::string_view method, json::object params,
                            CallOptions options) override;
  Result<void> listen(tmcl::Duration at_most) override;
  Result<void> reopen() override { return check_bus(); }
  void on_notification(Listener listener) override {
    gateway_->on_notification(std::move(listener));
  }
  void sleep(tmcl::Duration duration) override;
  Result<void> see_through(bool tell, Output& output) override;

 private:
  Result<void> check_bus() const;
  Result<json::object> cut_short(const tmcld::LocalCall& call);

  Host& host_;
  bool is_ending_ = false;
  std::unique_ptr<tmcld::LocalGateway> gateway_;
};

Result<void> OwnGatewayDoor::open(const tmcld::Config& config, std::int32_t full_steps,
                                  tmcl::Duration waited) {
  tmcld::GatewayOptions options;
  options.full_steps = full_steps;
  // Its end may take a while, which it explains; everything else is said by the verbs.
  options.log = [this](tmcld::LogLevel level, std::string_view line) {
    if (is_ending_ && level <= tmcld::LogLevel::warning) std::cerr << "tmclctl: " << line << '\n';
  };
  auto opened = attempt(tmcld::LocalGateway::open(config, std::move(options)));
  if (!opened) {
    opened.error().message += tmcl::waited_text(waited);
    return tl::unexpected(opened.error());
  }
  gateway_ = std::move(*opened);
  return {};
}

Result<json::object> result_of(const tmcld::LocalCall& call) {
  return tmcld::RpcResult(call.result()).map_error([](const tmcld::RpcError& error) {
    return tmcl::client::error_from_json(to_json(error));
  });
}

Result<json::object> OwnGatewayDoor::call(std::string_view method, json::object params,
                                          CallOptions options) {
  const auto call = gateway_->begin(method, std::move(params));
  while (!call.has_ended()) {
    gateway_->listen(listen_interval);
    if (options.meanwhile) {
      options.meanwhile();
    } else if (host_.signal() != 0) {
      return cut_short(call);
    }
  }
  return result_of(call);
}

Result<json::object> OwnGatewayDoor::cut_short(const tmcld::LocalCall& call) {
  gateway_->hang_up();
  const auto until = host_.now() + time_to_end_call;
  while (!call.has_ended() && host_.now() < until) gateway_->listen(listen_interval);
  if (call.has_ended() && call.result()) return call.result().value();
  return tl::unexpected(Error{std::string(tmcl::client::error_name::cancelled),
                              ErrorKind::interrupted, tmcl::Outcome::unknown,
                              "interrupted before it was done"});
}

Result<void> OwnGatewayDoor::check_bus() const {
  for (const auto& bus : gateway_->gateway().buses()) {
    if (bus->state() == tmcld::GatewayBus::State::open) continue;
    return tl::unexpected(Error{std::string(name_of(tmcl::Errc::link_lost)), ErrorKind::failed,
                                tmcl::Outcome::not_sent, bus->error()});
  }
  return {};
}

Result<void> OwnGatewayDoor::listen(tmcl::Duration at_most) {
  const auto until = host_.now() + at_most;
  while (host_.signal() == 0 && host_.now() < until) {
    if (gateway_->listen(std::min(until - host_.now(), listen_interval))) break;
  }
  return check_bus();
}

void OwnGatewayDoor::sleep(tmcl::Duration duration) {
  const auto until = host_.now() + duration;
  while (host_.signal() == 0 && host_.now() < until)
    gateway_->listen(std::min(until - host_.now(), listen_interval));
}

Result<void> OwnGatewayDoor::see_through(bool tell, Output& output) {
  const auto& gateway = gateway_->gateway();
  if (tell && gateway.has_journeys()) {
    output.err << "tmclctl: watching the axes until they stand and have their settings back; "
                  "Ctrl-C stops them"
               << std::endl;
  }
  while (gateway.has_journeys() && host_.signal() == 0) gateway_->listen(listen_interval);
  if (!gateway.has_journeys()) return {};
  gateway_->end();
  return tl::unexpected(
      interrupted_error(host_.signal(), "the axes were stopped on their way", ""));
}

/// Lets a pty appear that a simulator is about to make, or an adapter that was just plugged in; a
/// signal ends that. Returns how long it took.
tmcl::Duration await_port(const tmcl::LinkName& name, tmcl::Duration wait, Host& host) {
  const auto* port = std::get_if<tmcl::SerialName>(&name);
  if (port == nullptr) return {};
  const auto began = host.now();
  while (host.now() - began < wait && host.signal() == 0 && tmcl::is_missing(port->device) &&
         tmcl::may_appear(port->device)) {
    host.sleep(tmcl::file_look_interval);
  }
  return host.now() - began;
}

Result<tmcld::Config> config_in(const OwnBus& bus, const tmcl::LinkName& link) {
  if (bus.config.empty()) return tmcld::config_for_link(link);
  return tmcld::load_config_for_link(bus.config, link)
      .map_error([](const std::vector<std::string>& problems) {
        return usage_error("bad_config", fmt::format("{}", fmt::join(problems, "\n")));
      });
}

Result<tmcld::Config> config_of(const OwnBus& bus, const tmcl::LinkName& link) {
  return config_in(bus, link).map([&](tmcld::Config config) {
    for (auto& one : config.buses)
      one.bus_options.reply_timeout = bus.reply_timeout.value_or(one.bus_options.reply_timeout);
    return config;
  });
}

}  // namespace

Result<std::unique_ptr<Door>> open_own_gateway(const OwnBus& bus, tmcl::Duration wait, Host& host) {
  const auto name = bus.link == any_port ? only_module(tmcl::list_ports()) : bus.link;
  if (!name) return tl::unexpected(name.error());
  const auto link = attempt(tmcl::parse_link_name(*name));
  if (!link) return tl::unexpected(link.error());
  const auto config = config_of(bus, *link);
  if (!config) return tl::unexpected(config.error());
  auto door = std::make_unique<OwnGatewayDoor>(host);
  return door->open(*config, bus.full_steps, await_port(*link, wait, host)).map([&] {
    return std::unique_ptr<Door>(std::move(door));
  });
}

}  // namespace tmclctl
