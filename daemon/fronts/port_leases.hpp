/// The leases of axes that one host at a port holds, which knows of none: taken for it, kept while
/// it speaks or an axis moves, and given back.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// An axis that stands is given back when its host has said nothing for so long.
constexpr tmcl::Duration port_idle_time = std::chrono::seconds(5);

/// At most one for each axis. Thread safety: none.
class PortLeases : public std::enable_shared_from_this<PortLeases> {
 public:
  PortLeases(std::shared_ptr<Gateway> gateway, Client host);

  /// From now on the host alone moves the axis; nothing happens if it does already.
  /// Errors: those of Leases::acquire().
  boost::asio::awaitable<tmcl::Result<void>> take(std::shared_ptr<GatewayAxis> axis, Permit permit);
  /// The host has said something.
  void note_datagram();
  /// The host goes. Axes that are on their way to somewhere go on; what turns is left with its
  /// lease, for Gateway::leave() to stop it.
  void close();

 private:
  struct Held {
    std::int32_t lease = 0;
    std::shared_ptr<GatewayAxis> axis;
  };

  static boost::asio::awaitable<void> look_after(std::shared_ptr<PortLeases> self);
  boost::asio::awaitable<void> give_back_what_stands();
  bool is_idle() const;
  bool holds(const Held& held) const;
  void forget_lost();
  void renew();

  std::shared_ptr<Gateway> gateway_;
  Client host_;
  Wake changed_;
  std::vector<Held> held_;
  tmcl::TimePoint last_datagram_{};
  bool is_looked_after_ = false;
  bool closed_ = false;
};

}  // namespace tmcld
