#include <algorithm>
#include <optional>
#include <utility>

#include "door.hpp"
#include "lease_environment.hpp"

namespace tmclctl {
namespace {

using tmcl::client::Connection;

/// A connection that is made with these options.
using Connect = std::function<Result<Connection>(tmcl::client::Options)>;

class SocketDoor final : public Door {
 public:
  SocketDoor(Connect connect, Host& host, std::optional<tmcl::Duration> in_all)
      : connect_(std::move(connect)), host_(host) {
    if (in_all) limit_ = host.now() + *in_all;
  }

  Result<void> open(tmcl::Duration wait);

  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   CallOptions options) override;
  Result<void> listen(tmcl::Duration at_most) override { return daemon_->listen(at_most); }
  Result<void> reopen() override { return open({}); }
  void on_notification(Listener listener) override {
    daemon_->on_notification(std::move(listener));
  }
  void sleep(tmcl::Duration duration) override { host_.sleep(duration); }
  // tmcld does.
  Result<void> see_through(bool, Output&) override { return {}; }

 private:
  /// No longer than what is left until the limit.
  tmcl::Duration bounded(tmcl::Duration time) const {
    return limit_ ? std::clamp(*limit_ - host_.now(), tmcl::Duration{}, time) : time;
  }

  Connect connect_;
  Host& host_;
  std::optional<tmcl::TimePoint> limit_;
  std::function<void()> meanwhile_;  ///< Of the call in progress.
  std::optional<Connection> daemon_;
  /// For calls that are made meanwhile.
  std::optional<Connection> second_;
};

Result<void> SocketDoor::open(tmcl::Duration wait) {
  tmcl::client::Options options;
  options.wait_for_socket = wait;
  options.hello_timeout = bounded(options.hello_timeout);
  options.cancelled = [this] {
    if (!meanwhile_) return host_.signal() != 0;
    meanwhile_();
    return false;
  };
  auto daemon = connect_(std::move(options));
  if (!daemon) return tl::unexpected(daemon.error());
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

Result<boost::json::object> SocketDoor::call(std::string_view method, boost::json::object params,
                                             CallOptions options) {
  add_lease(method, params);
  if (meanwhile_) return second_->call(method, std::move(params), options.timeout);
  if (options.meanwhile && !second_) {
    auto second = connect_({});
    if (!second) return tl::unexpected(second.error());
    second_ = std::move(*second);
  }
  meanwhile_ = std::move(options.meanwhile);
  auto result = daemon_->call(method, std::move(params), bounded(options.timeout));
  meanwhile_ = {};
  return result;
}

}  // namespace

Result<std::unique_ptr<Door>> open_socket(std::string path, tmcl::Duration wait, Host& host,
                                          std::optional<tmcl::Duration> in_all) {
  const auto connect = [path = std::move(path)](tmcl::client::Options options) {
    auto daemon = Connection::open(path, std::move(options));
    if (!daemon && daemon.error().name == tmcl::client::error_name::unreachable) {
      daemon.error().hint +=
          ".\n  Another socket: --socket PATH or $TMCLD_SOCKET. Without tmcld: "
          "--direct serial:/dev/ttyACM0@115200 (or can:can0, tcp:HOST:PORT)";
    }
    return daemon;
  };
  auto door = std::make_unique<SocketDoor>(connect, host, in_all);
  return door->open(wait).map([&] { return std::unique_ptr<Door>(std::move(door)); });
}

Result<std::unique_ptr<Door>> open_url(WebPlace place, Host& host,
                                       std::optional<tmcl::Duration> in_all) {
  const auto connect = [place = std::move(place)](tmcl::client::Options options) {
    return open_web_socket(place, options.hello_timeout, options.cancelled)
        .and_then([&](std::unique_ptr<tmcl::client::Channel> channel) {
          return Connection::open(std::move(channel), std::move(options));
        });
  };
  auto door = std::make_unique<SocketDoor>(connect, host, in_all);
  return door->open({}).map([&] { return std::unique_ptr<Door>(std::move(door)); });
}

}  // namespace tmclctl
