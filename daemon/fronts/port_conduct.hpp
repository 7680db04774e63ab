/// Carries out what a host at a port asks for, if it may have it, and says what came of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "fronts/port_leases.hpp"

namespace tmcld {

/// One host. Every command is judged as any other client's: by its role, leases, claims, latches,
/// limits, and what an axis needs before it moves.
class PortConduct {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;

  PortConduct(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayBus> bus, Role role,
              Client host);

  /// From when the request came in.
  Permit admit() const { return gateway_->admit(host_.number); }
  /// Errors: those of the exchange; also what the gateway refuses, and what the role does not
  /// allow (Errc::not_permitted): nothing was sent then.
  Awaitable<tmcl::Answer> carry_out(tmcl::Request request, Permit permit, Deadline deadline);
  /// It is for a module that records what this host sends it: a stop is a line of the program.
  bool is_in_download(const tmcl::Request& request) const;
  void note_datagram() { leases_->note_datagram(); }
  /// The host goes: what it had asked for and was not sent yet moves nothing any more.
  void close();

 private:
  using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

  Awaitable<tmcl::Answer> stop(tmcl::Request request);
  Awaitable<tmcl::Answer> act(tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> act_on_axes(tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> act_on(Axes axes, tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> download(tmcl::Request request, RunOptions options);
  std::optional<tmcl::Error> objection_to(const tmcl::Request& request) const;
  /// Its axes, added if they have none; none of them if the module has no such motor.
  tmcl::Result<Axes> axes_of(const tmcl::Request& request);

  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<GatewayBus> bus_;
  Role role_;
  Client host_;
  std::shared_ptr<PortLeases> leases_;
  /// While it loads a program into a module.
  std::shared_ptr<const tmcl::Hold> hold_;
  tmcl::ModuleAddress held_{};
};

}  // namespace tmcld
