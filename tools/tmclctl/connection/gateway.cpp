#include "gateway.hpp"

#include <cstdlib>

#include <fmt/format.h>

#include "api/local_channel.hpp"
#include "command_line/lease_environment.hpp"

namespace tmclctl {
namespace {

using tmcl::client::Channel;

std::string socket_path(const Where& where) {
  if (!where.socket.empty()) return where.socket;
  const char* wished = std::getenv("TMCLD_SOCKET");
  return wished != nullptr && *wished != '\0' ? wished : std::string(default_socket);
}

// What the environment says will hold for the user's next command, too.
OwnBus own_bus(const Where& where) {
  OwnBus bus{where.direct, where.config, {}, where.full_steps};
  if (where.reply_timeout_ms)
    bus.reply_timeout = std::chrono::milliseconds(*where.reply_timeout_ms);
  return bus;
}

Result<Gateway> open_own(const Where& where, tmcl::Duration wait, Host& host) {
  return open_own_gateway(own_bus(where), wait, host)
      .map([&](std::unique_ptr<tmcld::LocalChannel> channel) {
        auto* own = channel.get();
        const auto axes = where.config.empty() ? AxesFrom::scan : AxesFrom::configuration;
        return Gateway{tmcl::client::Caller(std::move(channel)), axes, own};
      });
}

}  // namespace

std::string options_of(const Where& where) {
  std::string options;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) options += fmt::format(" {} {}", name, value);
  };
  add("--socket", where.socket);
  add("--url", where.web.url);
  add("--token-file", where.web.token_file);
  add("--fleet", where.fleet.url);
  add("--ca", where.web.ca_file);
  add("--cert", where.fleet.certificate_file);
  add("--key", where.fleet.key_file);
  add("--direct", where.direct);
  add("--config", where.config);
  if (where.reply_timeout_ms) add("--reply-timeout", std::to_string(*where.reply_timeout_ms));
  return options;
}

Result<std::unique_ptr<Channel>> open_daemon(const Where& where, tmcl::client::Options options) {
  if (!where.web.url.empty()) {
    const auto open = [place = where.web](const tmcl::client::Options& how) {
      return open_web_socket(place, how.hello_timeout, how.cancelled);
    };
    return tmcl::client::open_channel(open, std::move(options));
  }
  auto channel = tmcl::client::open_channel(socket_path(where), std::move(options));
  if (!channel && channel.error().name == tmcl::client::error_name::unreachable) {
    channel.error().hint +=
        ".\n  Another socket: --socket PATH or $TMCLD_SOCKET. Without tmcld: "
        "--direct serial:/dev/ttyACM0@115200 (or can:can0, tcp:HOST:PORT)";
  }
  return channel;
}

Result<Gateway> open_gateway(const Where& where, tmcl::Duration wait, Host& host,
                             std::optional<tmcl::Duration> in_all) {
  if (!where.direct.empty()) return open_own(where, wait, host);
  tmcl::client::Options options;
  options.wait_for_socket = wait;
  options.time_in_all = in_all;
  options.cancelled = [&host] { return host.signal() != 0; };
  return open_daemon(where, std::move(options)).map([&](std::unique_ptr<Channel> channel) {
    Gateway gateway{tmcl::client::Caller(std::move(channel))};
    // That of the 'tmclctl lease run' in which this program runs.
    if (const auto lease = lease_from_environment()) gateway.caller.use_lease(*lease);
    return gateway;
  });
}

void Context::sleep(tmcl::Duration duration) {
  if (gateway.own != nullptr) return gateway.own->run_for(duration);
  host.sleep(duration);
}

Result<void> wait_for_motion_to_end(Context& context, bool tell) {
  // Those of tmcld are watched by tmcld.
  if (context.gateway.own == nullptr) return {};
  auto& local = context.gateway.own->local();
  if (tell && local.gateway().has_journeys()) {
    context.output.err << "tmclctl: watching the axes until they stand and have their settings "
                          "back; Ctrl-C stops them"
                       << std::endl;
  }
  constexpr tmcl::Duration look_interval = std::chrono::milliseconds(20);
  while (local.gateway().has_journeys() && context.host.signal() == 0) local.listen(look_interval);
  if (!local.gateway().has_journeys()) return {};
  local.end();
  return tl::unexpected(
      interrupted_error(context.host.signal(), "the axes were stopped on their way", ""));
}

}  // namespace tmclctl
