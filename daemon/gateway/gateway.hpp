/// All buses and axes, by the names they have in the configuration and by their addresses.
#pragma once

#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/any_io_executor.hpp>

#include "config/config.hpp"
#include "gateway/authority/client_list.hpp"
#include "gateway/authority/leases.hpp"
#include "gateway/axis/axis.hpp"
#include "gateway/bus.hpp"
#include "gateway/journey/planner.hpp"
#include "gateway/journey/planning_budget.hpp"
#include "gateway/module/deadman_memory.hpp"
#include "gateway/module/upload_buffer.hpp"
#include "log/audit.hpp"
#include "log/audit_memory.hpp"
#include "log/limiter.hpp"
#include "log/sink.hpp"

namespace tmcld {

/// Opens what the configuration says.
tmcl::Result<tmcl::Link> open_configured_link(const BusConfig& config);

struct PlannedPath;

struct GatewayOptions {
  OpenLink open_link = open_configured_link;
  LogSink log = no_log;
  /// Of a turn of the motors that no axis is configured for.
  std::int32_t full_steps = 200;
  /// Of each lease that is granted.
  NewEpoch new_epoch = random_epoch;
  OnExit on_exit = OnExit::keep;
  /// What has to be put in order if the process ends is kept in this file; empty: nowhere.
  std::string journal{};
  /// What is known of the deadmen of modules; empty: that ends with the process.
  std::string deadmen{};
  AuditSink audit = [](AuditEntry) {};
};

/// Motors that no axis is configured for, and that were named all the same.
constexpr std::size_t most_added_axes = 256;

/// Object lifetimes: held by everything that is in progress, so that it outlives it.
/// Thread safety: none; its executor is one thread.
class Gateway : public std::enable_shared_from_this<Gateway> {
 public:
  static std::shared_ptr<Gateway> create(const boost::asio::any_io_executor& executor,
                                         const Config& config, GatewayOptions options = {});

  /// Begins to open the buses, to identify the modules, and to put in order what another run has
  /// left; returns at once.
  void start();
  /// Buses that this configuration has not, or says something else about.
  std::vector<std::shared_ptr<GatewayBus>> changed_by(const Config& config) const;
  /// Closes those, opens the ones that it has in their place or besides, and does from now on as it
  /// says; all other buses go on as they are. Nothing may move on those that are closed.
  void adopt(const Config& config, const std::string& words = {});
  const tmcl::ContextClock& clock() const { return clock_; }
  const std::shared_ptr<DeadmanMemory>& deadmen() const { return deadmen_; }
  const std::shared_ptr<Leases>& leases() const { return leases_; }
  /// Who is connected, as far as fronts have said so.
  const std::shared_ptr<ClientList>& clients() const { return clients_; }
  /// A client has come, which has its number until it leaves.
  Client add_client(std::string name = {});
  /// As leases that it acquires from now on, and the audit, name it.
  Client rename_client(std::uint64_t number, std::string name);
  /// Of a client that is there, or was lately: the names of the last thousand are remembered.
  std::string name_of_client(std::uint64_t number) const;
  /// What it has asked for and was not sent yet moves nothing any more. Its leases are lost, and
  /// axes that it lets turn are stopped.
  void remove_client(std::uint64_t client);
  /// Whether something turns until the client leaves, or is leased by it.
  bool is_holding(std::uint64_t client) const;
  /// As if all clients had left.
  void remove_all_clients();
  /// The right of a call that comes in now to move motors: until a stop comes behind it, or its
  /// client leaves.
  Permit admit(std::uint64_t client = 0) { return arrivals_->admit(client); }
  /// Whether the reactor has stood still, lately.
  const Gaps& gaps() const { return arrivals_->gaps; }
  /// No call that came in before has the right to move anything any more.
  void revoke_movements();
  /// From now on nothing but stops is admitted, and nothing is set in motion.
  void refuse_new_calls() { arrivals_->closing = true; }
  bool is_closing() const { return arrivals_->closing; }
  OnExit on_exit() const;
  /// What clients may do, by the configuration.
  const std::vector<AccessConfig>& access() const { return access_; }
  /// What paths of G-code are read and run with.
  const PathConfig& path() const { return path_; }
  /// A movement needs a lease of its axis, but for what the gateway leads.
  bool moves_need_lease() const { return moves_need_lease_; }
  /// Stops all axes that are on a line or path; their runs set their settings back.
  void end_journeys();
  bool has_journeys() const;
  /// Begins to stop every axis; see stops_in_progress.
  void stop_all_axes();
  /// Where something has failed that has to stop axes, or memory is missing: a stop of each motor
  /// is on its wire when this returns, past all queues, and takes no memory. What was asked for
  /// before has no right to move anything any more.
  void stop_at_once() noexcept;
  /// The same for a stop that cannot be carried out: what it was for is not known any more. Begins
  /// to stop every axis as usual besides. Throws if there is no memory for that.
  void stop_in_need();
  /// Nothing that waits anywhere moves anything any more.
  void refuse_movements() noexcept;
  /// Returns when the journal says what is left to be put in order.
  boost::asio::awaitable<void> end_journal();
  /// Ends everything in progress with Errc::link_lost.
  void close();
  /// Waits for links that are being opened, and for paths that are being planned: what comes of
  /// them still needs the reactor.
  void join();

  std::span<const std::shared_ptr<GatewayBus>> buses() const { return buses_; }
  /// Those of the configuration.
  std::span<const std::shared_ptr<GatewayAxis>> axes() const {
    return all_axes().first(configured_axes_);
  }
  /// Also those that were added; a list that may grow while a coroutine waits.
  std::span<const std::shared_ptr<GatewayAxis>> all_axes() const { return axes_; }
  /// Null if there is none of that name.
  GatewayBus* find_bus(std::string_view name) const;
  std::shared_ptr<GatewayAxis> find_axis(std::string_view name) const;
  std::shared_ptr<GatewayAxis> find_axis(const GatewayBus& bus, tmcl::AxisAddress address) const;
  /// For a motor that has none yet. Null if there are most_added_axes already.
  std::shared_ptr<GatewayAxis> add_axis(std::shared_ptr<GatewayBus> bus, tmcl::AxisAddress address);
  /// BUS:ADDRESS/MOTOR; without the bus if there is no other.
  std::string raw_name(const GatewayBus& bus, tmcl::AxisAddress address) const;

  /// Gives a number for ignore_events().
  std::uint64_t on_event(OnGatewayEvent listener);
  void ignore_events(std::uint64_t id) { listeners_.erase(id); }

  /// How many stops are on their way; the end of the daemon waits a little for them. See
  /// StopInProgress.
  int stops_in_progress = 0;
  /// The modules that are given new firmware, in words; the end of the daemon waits for them: a
  /// module with a firmware in part runs nothing.
  std::multiset<std::string> uploads;

  void log(LogLevel level, std::string_view line) const { options_.log(level, line); }
  void audit(AuditEntry entry) const { options_.audit(std::move(entry)); }
  /// The last lines of it.
  const AuditMemory& audit_memory() const { return *audit_memory_; }
  /// A line that clients may be able to bring about as often as they like: not more of one cause
  /// than a LogLimiter allows.
  void log_often(std::string_view cause, LogLevel level, std::string line);
  /// Such a line about an exception.
  void log_failure(std::string_view where, const std::exception_ptr& failure);

  UploadBuffer image_upload;
  UploadBuffer path_upload;
  /// The one that was planned last; null if there is none, or it has been run.
  std::shared_ptr<PlannedPath> planned_path;
  std::int32_t next_path_number() { return ++last_path_number_; }
  Planner planner;
  /// What takes part in planning paths and programs has a place of it.
  PlanningBudget planning;

 private:
  Gateway(const boost::asio::any_io_executor& executor, GatewayOptions options)
      : clock_(executor), options_(std::move(options)), executor_(executor), closed_(executor) {}
  void add_buses(const Config& config);
  void add_axes(const Config& config);
  void begin_to_watch_for_gaps();
  void tell(const GatewayEvent& event);
  void begin_to_stop(const std::shared_ptr<GatewayAxis>& axis, StopCause cause);
  void stop_what_has_no_end(std::string_view bus);
  Holdings holdings() const;
  void take_over_orphans();
  /// Says what of the calls is stale, for as long as the gateway is open.
  static boost::asio::awaitable<void> watch_for_gaps(std::shared_ptr<Gateway> self);

  tmcl::ContextClock clock_;
  GatewayOptions options_;
  std::vector<AccessConfig> access_;
  PathConfig path_;
  bool moves_need_lease_ = false;
  std::map<std::string, LogLimiter, std::less<>> limiters_;  ///< By cause; few.
  std::shared_ptr<Arrivals> arrivals_ = std::make_shared<Arrivals>();
  std::map<std::uint64_t, std::string> client_names_;
  std::shared_ptr<ClientList> clients_ = std::make_shared<ClientList>();
  std::shared_ptr<AuditMemory> audit_memory_ = std::make_shared<AuditMemory>();
  std::shared_ptr<Leases> leases_;
  std::shared_ptr<Journal> journal_;  ///< Null if none is kept.
  std::shared_ptr<DeadmanMemory> deadmen_;
  boost::asio::any_io_executor executor_;
  std::vector<std::shared_ptr<GatewayBus>> buses_;
  std::vector<std::shared_ptr<GatewayBus>> retired_;  ///< Whose links are still being opened.
  std::vector<std::shared_ptr<GatewayAxis>> axes_;    ///< The configured ones first.
  std::size_t configured_axes_ = 0;
  std::map<std::uint64_t, OnGatewayEvent> listeners_;
  std::uint64_t last_listener_ = 0;
  std::int32_t last_path_number_ = 0;
  bool is_closed_ = false;
  bool watches_for_gaps_ = false;
  Wake closed_;
};

/// Counts as a stop on its way for as long as it lives.
class StopInProgress {
 public:
  explicit StopInProgress(std::shared_ptr<Gateway> gateway) : gateway_(std::move(gateway)) {
    ++gateway_->stops_in_progress;
  }
  StopInProgress(const StopInProgress&) = delete;
  StopInProgress& operator=(const StopInProgress&) = delete;
  ~StopInProgress() { --gateway_->stops_in_progress; }

 private:
  std::shared_ptr<Gateway> gateway_;
};

}  // namespace tmcld
