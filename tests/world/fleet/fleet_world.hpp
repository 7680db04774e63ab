/// A gateway behind a broker, its users, a client of its own, two buses and their modules, in
/// virtual time: bridge, socket, session, gateway and bus are the real ones.
#pragma once

#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "fronts/unix_server.hpp"
#include "gateway/gateway.hpp"
#include "io/bridge.hpp"
#include "world/fleet/fleet_ledger.hpp"
#include "world/fleet/fleet_user.hpp"
#include "world/fleet/network.hpp"
#include "world/fleet/programs_in_time.hpp"
#include "world/trace.hpp"
#include "world/wire.hpp"

namespace tmcld::test {

/// What is broken on purpose.
enum class FleetCanary : std::uint8_t {
  none,
  same_nonce,      ///< All nonces and epochs are the same text.
  deaf_to_stops,   ///< Stops that were read are dropped.
  lease_for_long,  ///< Users ask for longer leases than the observer is told.
};

struct FleetTrouble {
  bool faults = true;
  int actions = 24;  ///< Of each user.
  FleetCanary canary = FleetCanary::none;
};

/// How often users did something while the way to the gateway was in some state.
class FleetCells {
 public:
  void note(const std::string& what, const std::string& state) { ++counts_[what][state]; }
  void add(const FleetCells& other);
  /// What was never done in a state, as often as it was done at all.
  std::size_t never() const;
  void print(std::ostream& out) const;

 private:
  std::map<std::string, std::map<std::string, std::size_t>> counts_;
};

class FleetWorld {
 public:
  FleetWorld(std::uint64_t seed, const FleetTrouble& trouble);
  ~FleetWorld();
  FleetWorld(const FleetWorld&) = delete;
  FleetWorld& operator=(const FleetWorld&) = delete;

  void run();
  const std::vector<std::string>& complaints() const { return ledger_->complaints(); }
  std::uint64_t trace() const { return trace_.value(); }
  const FleetLedger& ledger() const { return *ledger_; }
  const FleetCells& cells() const { return cells_; }
  std::size_t requests() const { return serial_->requests() + can_->requests(); }
  std::size_t answered() const;
  tmcl::TimePoint now() const { return programs_.now(); }

 private:
  using Random = tmcl::test::Random<>;
  struct LeaseHeld {
    std::int64_t lease = 0;
    std::int64_t epoch = 0;
    std::string axis{};
    std::chrono::milliseconds ttl{};
    tmcl::TimePoint said{};  ///< When it was asked for, or renewed, last.
    tmcl::Duration frozen_then{};
  };

  void start_gateway();
  void start_bridge();
  void on_read(const tmclmqtt::BrokerOptions& by, tmclmqtt::Message& message);
  void on_publish(const tmclmqtt::BrokerOptions& by, const Publication& publication);
  void on_connected(const tmclmqtt::BrokerOptions& by, std::shared_ptr<Connection> connection);

  // ---- users ----
  boost::asio::awaitable<void> act(std::shared_ptr<FleetUser> user, std::uint64_t number);
  boost::asio::awaitable<void> do_something(std::shared_ptr<FleetUser> user, Random& random);
  boost::asio::awaitable<void> do_well(std::shared_ptr<FleetUser> user, Random& random);
  void do_carelessly(FleetUser& user, Random& random);
  void do_hostile_things(FleetUser& user, Random& random);
  boost::asio::awaitable<bool> see_to_nonce(std::shared_ptr<FleetUser> user);
  boost::asio::awaitable<void> move(std::shared_ptr<FleetUser> user, Random& random);
  boost::asio::awaitable<void> lease_and_rotate(std::shared_ptr<FleetUser> user, Random& random);
  boost::asio::awaitable<void> renew(std::shared_ptr<FleetUser> user, int times);
  boost::asio::awaitable<void> stop_until_answered(std::shared_ptr<FleetUser> user, bool of_all,
                                                   tmcl::Duration patience);
  FleetCall call_of(const FleetUser& user, const std::string& method, const std::string& axis,
                    const std::optional<Nonce>& nonce, json::object& params);
  const std::string& any_axis(Random& random) const;

  // ---- faults, and who looks ----
  boost::asio::awaitable<void> break_things();
  void note_fault(const std::string& what, tmcl::Duration time);
  void break_line(std::int64_t kind, bool is_of_calls, tmcl::Duration time, Random& random);
  void break_user(std::int64_t kind, const FleetUser& user, tmcl::Duration time, Random& random);
  void break_something(Random& random);
  boost::asio::awaitable<void> look_around();
  boost::asio::awaitable<void> local_client();
  std::string state_of_way() const;
  void note_action(const std::string& what) { cells_.note(what, state_of_way()); }
  void look_at_turning();
  void look_at_end();
  void look_at_state(const std::string& axis);
  std::int32_t value_of(const WorldAxis& axis, std::uint8_t parameter);
  tmcl::Duration frozen() const { return gateway_program_.frozen() + bridge_program_.frozen(); }

  // What is used while programs end stands before them.
  std::unique_ptr<Network> network_;
  Trace trace_;
  std::unique_ptr<FleetLedger> ledger_;
  FleetCells cells_;
  FleetTrouble trouble_;
  std::uint64_t seed_;
  std::string socket_;
  ProgramInTime outside_;
  ProgramInTime gateway_program_;
  ProgramInTime bridge_program_;
  ProgramsInTime programs_{{&outside_, &gateway_program_, &bridge_program_}};
  std::unique_ptr<Wire> serial_;
  std::unique_ptr<Wire> can_;
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<UnixServer> server_;
  std::shared_ptr<tmclmqtt::Bridge> bridge_;
  std::shared_ptr<Connection> calls_;  ///< Of the bridge.
  std::shared_ptr<Connection> stops_;
  tmcl::TimePoint calls_began_{};
  std::string calls_epoch_;
  std::vector<std::shared_ptr<FleetUser>> users_;
  std::map<std::string, LeaseHeld> leases_;               ///< By user.
  std::map<std::string, std::vector<Publication>> said_;  ///< Calls that may be sent once more.
  int acting_ = 0;
  bool breaks_ = true;
  bool ends_ = false;
  std::function<void()> freeze_at_call_{};  ///< At the next one that the bridge reads.
  tmcl::TimePoint stop_noted_{};
  tmcl::TimePoint drops_noted_{};
  std::map<std::string, bool> complained_;
};

}  // namespace tmcld::test
