#include <algorithm>
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "api/local_channel.hpp"
#include "config/load.hpp"
#include "gateway.hpp"
#include "port_choice.hpp"

namespace tmclctl {
namespace {

using tmcld::LocalChannel;

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

/// Its end may take a while, which it explains; everything else is said by the verbs.
void tell_of_end(tmcld::LogLevel level, std::string_view line, const tmcld::LocalGateway* gateway) {
  const bool is_ending = gateway != nullptr && gateway->is_ending();
  if (is_ending && level <= tmcld::LogLevel::warning) std::cerr << "tmclctl: " << line << '\n';
}

}  // namespace

Result<std::unique_ptr<LocalChannel>> open_own_gateway(const OwnBus& bus, tmcl::Duration wait,
                                                       Host& host) {
  const auto name = bus.link == any_port ? only_module(tmcl::list_ports()) : bus.link;
  if (!name) return tl::unexpected(name.error());
  const auto link = attempt(tmcl::parse_link_name(*name));
  if (!link) return tl::unexpected(link.error());
  const auto config = config_of(bus, *link);
  if (!config) return tl::unexpected(config.error());
  const auto waited = await_port(*link, wait, host);
  tmcld::GatewayOptions options;
  options.full_steps = bus.full_steps;
  const auto opened_gateway = std::make_shared<const tmcld::LocalGateway*>(nullptr);
  options.log = [opened_gateway](tmcld::LogLevel level, std::string_view line) {
    tell_of_end(level, line, *opened_gateway);
  };
  auto opened = attempt(tmcld::LocalGateway::open(*config, std::move(options)));
  if (!opened) {
    opened.error().message += tmcl::waited_text(waited);
    return tl::unexpected(opened.error());
  }
  *opened_gateway = opened->get();
  return std::make_unique<LocalChannel>(std::move(*opened), TMCL_VERSION,
                                        [&host] { return host.signal() != 0; });
}

}  // namespace tmclctl
