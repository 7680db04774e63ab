#include <algorithm>
#include <optional>
#include <utility>

#include "door.hpp"
#include "lease_environment.hpp"

namespace tmclctl {
namespace {

using tmcl::client::Connection;

class SocketDoor final : public Door {
 public:
  SocketDoor(std::string path, Host& host, std::optional<tmcl::Duration> in_all)
      : path_(std::move(path)), host_(host) {
    if (in_all) limit_ = host.now() + *in_all;
  }

  Attempt<void> open(tmcl::Duration wait);

  Attempt<boost::json::object> call(std::string_view method, boost::json::object params,
                                    CallOptions options) override;
  Attempt<void> listen(tmcl::Duration at_most) override {
    return attempt(daemon_->listen(at_most));
  }
  Attempt<void> reopen() override { return open({}); }
  void on_notification(Listener listener) override {
    daemon_->on_notification(std::move(listener));
  }
  void sleep(tmcl::Duration duration) override { host_.sleep(duration); }
  // tmcld does.
  Attempt<void> see_through(bool, Output&) override { return {}; }

 private:
  /// No longer than what is left until the limit.
  tmcl::Duration bounded(tmcl::Duration time) const {
    return limit_ ? std::clamp(*limit_ - host_.now(), tmcl::Duration{}, time) : time;
  }

  std::string path_;
  Host& host_;
  std::optional<tmcl::TimePoint> limit_;
  std::function<void()> meanwhile_;  ///< Of the call in progress.
  std::optional<Connection> daemon_;
  /// For calls that are made meanwhile.
  std::optional<Connection> second_;
};

Attempt<void> SocketDoor::open(tmcl::Duration wait) {
  tmcl::client::Options options;
  options.wait_for_socket = wait;
  options.hello_timeout = bounded(options.hello_timeout);
  options.cancelled = [this] {
    if (!meanwhile_) return host_.signal() != 0;
    meanwhile_();
    return false;
  };
  auto daemon = attempt(Connection::open(path_, std::move(options)));
  if (!daemon) {
    if (daemon.error().name == tmcl::client::error_name::unreachable) {
      daemon.error().hint +=
          ".\n  Another socket: --socket PATH or $TMCLD_SOCKET. Without tmcld: "
          "--direct serial:/dev/ttyACM0@115200 (or can:can0, tcp:HOST:PORT)";
    }
    return tl::unexpected(daemon.error());
  }
  daemon_ = std::move(*daemon);
  return {};
}

/// That of the 'tmclctl lease run' in which this program runs.
void add_lease(std::string_view method, boost::json::object& params) {
  if (method.starts_with("lease.")) return;
  const auto lease = lease_from_environment();
  if (!lease) return;
  params[tmcl::api::name_of<&tmcl::api::lease::OnLease::lease>()] = lease->lease;
  params[tmcl::api::name_of<&tmcl::api::lease::OnLease::epoch>()] = lease->epoch;
}

Attempt<boost::json::object> SocketDoor::call(std::string_view method, boost::json::object params,
                                              CallOptions options) {
  add_lease(method, params);
  if (meanwhile_) return attempt(second_->call(method, std::move(params), options.timeout));
  if (options.meanwhile && !second_) {
    auto second = attempt(Connection::open(path_));
    if (!second) return tl::unexpected(second.error());
    second_ = std::move(*second);
  }
  meanwhile_ = std::move(options.meanwhile);
  auto result = attempt(daemon_->call(method, std::move(params), bounded(options.timeout)));
  meanwhile_ = {};
  return result;
}

}  // namespace

Attempt<std::unique_ptr<Door>> open_socket(std::string path, tmcl::Duration wait, Host& host,
                                           std::optional<tmcl::Duration> in_all) {
  auto door = std::make_unique<SocketDoor>(std::move(path), host, in_all);
  return door->open(wait).map([&] { return std::unique_ptr<Door>(std::move(door)); });
}

}  // namespace tmclctl
