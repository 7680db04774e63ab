/// Where hosts that speak TMCL find a bus, as if they were alone with its modules: a pseudo
/// terminal, a TCP port or a CAN interface.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "gateway/gateway.hpp"
#include "tmcl/can_socket.hpp"

namespace tmcld {

class Port {
 public:
  virtual ~Port() = default;
  /// Lets hosts speak; returns at once.
  virtual void start() = 0;
  /// Its hosts go.
  virtual void close() = 0;
};

/// The error is a sentence that says what to try. A CAN interface may be missing: it is looked for
/// again and again.
tl::expected<std::shared_ptr<Port>, std::string> open_port(const PortConfig& config,
                                                           std::shared_ptr<Gateway> gateway);

// Each of its kind.
tl::expected<std::shared_ptr<Port>, std::string> open_pty_port(const PortConfig& config,
                                                               const PtyName& name,
                                                               std::shared_ptr<Gateway> gateway);
tl::expected<std::shared_ptr<Port>, std::string> open_tcp_port(const PortConfig& config,
                                                               const tmcl::TcpName& name,
                                                               std::shared_ptr<Gateway> gateway);
/// How a CAN interface is reached.
struct CanSockets {
  std::function<tl::expected<tmcl::FileDescriptor, std::string>(const std::string& interface)>
      open = tmcl::open_can_socket;
  std::function<bool(int socket, const std::string& interface)> is_on = tmcl::is_on;
};
tl::expected<std::shared_ptr<Port>, std::string> open_can_port(const PortConfig& config,
                                                               const tmcl::CanName& name,
                                                               std::shared_ptr<Gateway> gateway,
                                                               CanSockets sockets = {});

}  // namespace tmcld
