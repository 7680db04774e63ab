/// Carries out what a host at a port asks for, if it may have it, and says what came of it.
#pragma once

#include <memory>
#include <optional>
#include <set>
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
  /// `only_tries`: the module may not be there, which the host finds out by this.
  Awaitable<tmcl::Answer> carry_out(tmcl::Request request, Permit permit, Deadline deadline,
                                    bool only_tries);
  /// Where a request goes that names this address, as far as that is known: a module on USB takes
  /// what is for any.
  tmcl::ModuleAddress known_meaning(tmcl::ModuleAddress address) const;
  /// The same for an address that has not answered the host: some exchanges may be needed to find
  /// out. Errors: those of the first of them.
  Awaitable<tmcl::ModuleAddress> find_meaning(tmcl::ModuleAddress address, Deadline deadline);
  /// Of the bus: those that are configured, or have said what they are.
  std::set<tmcl::ModuleAddress> known_modules() const;
  /// The module has fallen silent: another one may be there.
  void forget_meaning() { only_module_.reset(); }
  /// The host does not wait any more for what it has only tried.
  void give_up_tries(tmcl::ModuleAddress module);
  /// Whether it has said what it is and answers.
  bool is_ready(tmcl::ModuleAddress module) const;
  /// It is for a module that records what this host sends it: a stop is a line of the program.
  bool is_in_download(const tmcl::Request& request) const;
  void note_datagram() { leases_->note_datagram(); }
  /// The host goes: what it had asked for and was not sent yet moves nothing any more.
  void close();

 private:
  using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

  Awaitable<tmcl::Answer> try_once(const tmcl::Request& request, Deadline deadline);
  bool may_take_any_address(tmcl::ModuleAddress module) const;
  Awaitable<tmcl::Answer> stop(tmcl::Request request, bool only_tries);
  void revoke_movements(const tmcl::Request& stop);
  Awaitable<tmcl::Answer> act(tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> act_on_axes(tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> act_on(Axes axes, tmcl::Request request, RunOptions options);
  Awaitable<tmcl::Answer> download(tmcl::Request request, RunOptions options);
  std::optional<tmcl::Error> objection_to(const tmcl::Request& request) const;
  std::optional<tmcl::Error> objection_to_line(const tmcl::Request& line);
  /// Its axes, added if they have none; none of them if the module has no such motor.
  tmcl::Result<Axes> axes_of(const tmcl::Request& request);

  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<GatewayBus> bus_;
  Role role_;
  Client host_;
  std::shared_ptr<PortLeases> leases_;
  /// The only module of the bus, which takes what is for any address.
  std::optional<tmcl::ModuleAddress> only_module_;
  /// While it loads a program into a module.
  std::shared_ptr<const tmcl::Hold> hold_;
  /// A line of that program was refused.
  bool lacks_a_line_ = false;
  tmcl::ModuleAddress held_{};
};

}  // namespace tmcld
