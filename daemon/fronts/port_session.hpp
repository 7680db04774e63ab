/// One host at a port, which speaks TMCL as if it were alone with the modules of a bus. Does no I/O
/// of its own: it is told what the host says, and says what the host is told.
///
/// One request is under way at a time; the next ones wait, but for those to modules that may not be
/// there: the next request ends the wait for their answer, as on a wire. A stop waits for nothing.
/// Answers of modules that are there come in the order of the requests all the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "fronts/port_conduct.hpp"
#include "fronts/port_rules.hpp"
#include "gateway/authority/client_list.hpp"

namespace tmcld {

/// Requests of one host that wait, or are under way; of more the host hears nothing, as from a
/// module whose buffer is full. Stops have a number of their own.
constexpr std::size_t most_requests_at_port = 16;
constexpr std::size_t most_stops_at_port = 64;
/// What could not be sent in this time is not sent any more: its host has given it up.
constexpr tmcl::Duration longest_wait_at_port = std::chrono::seconds(2);

class PortSession : public std::enable_shared_from_this<PortSession> {
 public:
  /// `form`: in which the request came that this answers, or the last one.
  using Output = std::function<void(const Told& told, CanForm form)>;

  /// `name` of the host, for people: "port a". `disconnect`: this session serves no host any more,
  /// since it has failed. `address` of the host in the network; empty: it is on this computer.
  PortSession(std::shared_ptr<Gateway> gateway, const PortConfig& config, std::string name,
              Output output, std::function<void()> disconnect, std::string address = {});

  void start();
  const GatewayBus& bus() const { return *bus_; }
  void on_request(const tmcl::Request& request, CanForm form = {});
  /// A datagram for this module had a wrong checksum.
  void on_wrong_checksum(tmcl::ModuleAddress module);
  /// The host has thrown away what it had not read yet: answers to what it had asked for before
  /// that are not for it.
  void forget_answers();
  /// The host has gone. Nothing is said to it any more.
  void close();

 private:
  struct Asked {
    tmcl::Request request{};
    CanForm form{};
    Permit permit{};
    tmcl::TimePoint received{};
    bool begun = false;
    bool ended = false;
    bool only_tries = false;  ///< Perhaps no module is there: others do not wait for its answer.
    bool unwanted = false;    ///< The host does not want to know any more.
    std::optional<Told> told{};
  };
  using AskedPtr = std::shared_ptr<Asked>;

  ConnectedClient look() const;
  void take(const tmcl::Request& request, CanForm form);
  static boost::asio::awaitable<void> serve(std::shared_ptr<PortSession> self);
  static boost::asio::awaitable<void> serve_one(std::shared_ptr<PortSession> self, AskedPtr asked);
  boost::asio::awaitable<void> carry_out(AskedPtr asked);
  AskedPtr next() const;
  bool may_begin() const;
  void see_meaning(Asked& asked);
  void give_up_tries();
  boost::asio::awaitable<tmcl::Result<tmcl::Answer>> answer_to(AskedPtr asked, Deadline deadline);
  bool has_room(bool stops) const;
  void end(Asked& asked, std::optional<Told> told);
  void note(const Asked& asked, const tmcl::Result<tmcl::Answer>& answer);
  void note_arrival_events(const tmcl::Request& request);
  void on_event(const GatewayEvent& event);
  std::uint8_t host_address(tmcl::ModuleAddress module) const;
  bool is_known(tmcl::ModuleAddress module) const;
  void fail(const std::exception_ptr& failure);

  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<GatewayBus> bus_;
  std::string name_;
  Output output_;
  std::function<void()> disconnect_;
  std::string address_;
  Role role_;
  Client client_;
  PortConduct conduct_;
  Wake asked_;
  std::deque<AskedPtr> pending_;
  CanForm last_form_{};
  /// By what module has answered: how it addresses its hosts.
  std::map<tmcl::ModuleAddress, std::uint8_t> hosts_;
  /// Of these modules the host wants to be told when they arrive; once, or always.
  std::map<tmcl::ModuleAddress, bool> wants_arrivals_;
  std::uint64_t listener_ = 0;
  bool closed_ = false;
  ClientList::Entry entry_;
};

}  // namespace tmcld
