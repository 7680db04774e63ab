#include "target.hpp"

#include <cstdlib>

#include <fmt/format.h>

#include "gateway_target.hpp"
#include "options/form.hpp"

namespace tmclctl {
namespace {

std::string socket_path(const Where& where) {
  if (!where.socket.empty()) return where.socket;
  const char* wished = std::getenv("TMCLD_SOCKET");
  return wished != nullptr && *wished != '\0' ? wished : std::string(default_socket);
}

// What the environment says will hold for the user's next command, too.
std::string options_of(const Where& where) {
  std::string options;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) options += fmt::format(" {} {}", name, value);
  };
  add("--socket", where.socket);
  add("--url", where.web.url);
  add("--token-file", where.web.token_file);
  add("--ca", where.web.ca_file);
  add("--direct", where.direct);
  add("--config", where.config);
  if (where.reply_timeout_ms) add("--reply-timeout", std::to_string(*where.reply_timeout_ms));
  return options;
}

OwnBus own_bus(const Where& where) {
  OwnBus bus{where.direct, where.config, {}, where.full_steps};
  if (where.reply_timeout_ms)
    bus.reply_timeout = std::chrono::milliseconds(*where.reply_timeout_ms);
  return bus;
}

}  // namespace

void put(boost::json::object& params, std::string_view name, std::string_view plain,
         const Typed& typed) {
  const auto counted = parse_number<std::int32_t>(typed.text);
  if (typed.internal && counted) {
    params[plain] = *counted;
  } else {
    params[name] = typed.text;
  }
}

Result<std::unique_ptr<Target>> open_target(const Where& where, tmcl::Duration wait, Host& host,
                                            std::optional<tmcl::Duration> in_all) {
  const bool own = !where.direct.empty();
  auto door = own                     ? open_own_gateway(own_bus(where), wait, host)
              : where.web.url.empty() ? open_socket(socket_path(where), wait, host, in_all)
                                      : open_url(where.web, host, in_all);
  return std::move(door).map([&](std::unique_ptr<Door> open) -> std::unique_ptr<Target> {
    const auto axes = own && where.config.empty() ? AxesFrom::scan : AxesFrom::configuration;
    return std::make_unique<GatewayTarget>(std::move(open), options_of(where), axes, host);
  });
}

}  // namespace tmclctl
