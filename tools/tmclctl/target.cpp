#include "target.hpp"

#include <cstdlib>

#include "gateway_target.hpp"
#include "direct_target.hpp"
#include "socket_door.hpp"
#include "options/form.hpp"

namespace tmclctl {
namespace {

std::string socket_path(const Where& where) {
  if (!where.socket.empty()) return where.socket;
  const char* wished = std::getenv("TMCLD_SOCKET");
  return wished != nullptr && *wished != '\0' ? wished : std::string(default_socket);
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

Attempt<std::unique_ptr<Target>> open_target(const Where& where, tmcl::Duration wait,
                                             Patience& patience) {
  if (!where.direct.empty())
    return DirectTarget::open(where.direct, where.full_steps, wait, patience);
  // What the environment says will hold for the user's next command, too.
  auto options = where.socket.empty() ? std::string{} : " --socket " + where.socket;
  return SocketDoor::open(socket_path(where), wait, patience)
      .map([&](std::unique_ptr<Door> door) -> std::unique_ptr<Target> {
        return std::make_unique<GatewayTarget>(std::move(door), std::move(options), patience);
      });
}

}  // namespace tmclctl
