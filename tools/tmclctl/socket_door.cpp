#include "socket_door.hpp"

#include <utility>

namespace tmclctl {

using tmcl::client::Connection;

Attempt<std::unique_ptr<Door>> SocketDoor::open(std::string socket_path, tmcl::Duration wait,
                                                Patience& patience) {
  std::unique_ptr<SocketDoor> door(new SocketDoor(std::move(socket_path)));
  tmcl::client::Options options;
  options.wait_for_socket = wait;
  options.cancelled = [&patience, &meanwhile = door->meanwhile_] {
    if (!meanwhile) return patience.signal() != 0;
    meanwhile();
    return false;
  };
  auto daemon = attempt(Connection::open(door->socket_path_, std::move(options)));
  if (!daemon) {
    if (daemon.error().name == tmcl::client::error_name::unreachable) {
      daemon.error().hint +=
          ".\n  Another socket: --socket PATH or $TMCLD_SOCKET. Without tmcld: "
          "--direct serial:/dev/ttyACM0@115200 (or can:can0, tcp:HOST:PORT)";
    }
    return tl::unexpected(daemon.error());
  }
  door->daemon_ = std::move(*daemon);
  return door;
}

Attempt<boost::json::object> SocketDoor::call(std::string_view method, boost::json::object params,
                                              CallOptions options) {
  if (meanwhile_) return attempt(second_->call(method, std::move(params), options.timeout));
  if (options.meanwhile && !second_) {
    auto second = attempt(Connection::open(socket_path_));
    if (!second) return tl::unexpected(second.error());
    second_ = std::move(*second);
  }
  meanwhile_ = std::move(options.meanwhile);
  auto result = attempt(daemon_->call(method, std::move(params), options.timeout));
  meanwhile_ = {};
  return result;
}

Attempt<void> SocketDoor::listen(tmcl::Duration at_most) {
  return attempt(daemon_->listen(at_most));
}

void SocketDoor::on_notification(Listener listener) {
  daemon_->on_notification(std::move(listener));
}

}  // namespace tmclctl
