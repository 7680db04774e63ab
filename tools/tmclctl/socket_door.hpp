/// To the gateway in a running tmcld, which other programs share.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "door.hpp"
#include "patience.hpp"

namespace tmclctl {

class SocketDoor final : public Door {
 public:
  /// Waits so long for a socket that is not there yet.
  static Attempt<std::unique_ptr<Door>> open(std::string socket_path, tmcl::Duration wait,
                                             Patience& patience);

  Attempt<boost::json::object> call(std::string_view method, boost::json::object params,
                                    CallOptions options) override;
  Attempt<void> listen(tmcl::Duration at_most) override;
  void on_notification(Listener listener) override;

 private:
  explicit SocketDoor(std::string socket_path) : socket_path_(std::move(socket_path)) {}

  std::string socket_path_;
  std::function<void()> meanwhile_;  ///< Of the call in progress.
  std::optional<tmcl::client::Connection> daemon_;
  /// For calls that are made meanwhile.
  std::optional<tmcl::client::Connection> second_;
};

}  // namespace tmclctl
