#include "daemon.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "async/wait_until.hpp"
#include "fronts/descriptors.hpp"
#include "gateway/ending.hpp"
#include "gateway/reload.hpp"
#include "gateway/store/tokens.hpp"
#include "last_stop.hpp"
#include "log/log.hpp"
#include "managed_configuration.hpp"
#include "tmcl/timer.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

// A program that starts tmcld and calls it at once finds its buses open. One that is not there does
// not keep the others.
constexpr auto time_to_open = 300ms;
// With time_for_stops well below the second within which the daemon ends.
constexpr tmcl::Duration time_for_answers = 300ms;
// After an exception the end may fail, too: it is given all of its times and a little more.
constexpr tmcl::Duration time_after_failure =
    time_for_uploads + time_to_stand + time_for_stops + time_for_answers + std::chrono::seconds(1);
// Before it is tried again where there was not even memory to begin it.
constexpr tmcl::Duration time_to_find_memory = std::chrono::milliseconds(50);
// It goes on after so many more of them.
constexpr int most_failures_at_the_end = 16;

constexpr std::size_t reserved_bytes = 4 << 20;

/// Beside others of daemons with other sockets.
std::string state_file(const DaemonConfig& config, std::string_view suffix) {
  const std::filesystem::path socket(config.socket);
  const auto* given = std::getenv("STATE_DIRECTORY");
  // systemd separates several by colons.
  const std::string of_service =
      given == nullptr ? "" : std::string(given, std::strcspn(given, ":"));
  const std::filesystem::path folder = !config.state.empty() ? config.state
                                       : !of_service.empty() ? of_service
                                                             : socket.parent_path().string();
  return folder / (socket.filename().string() + std::string(suffix));
}

/// What another daemon of the same name would read and write: before anything of it is read.
/// Where no file can be made none of them can be written, which the journal tells.
tl::expected<LockFile, std::string> lock_state(const DaemonConfig& config) {
  const auto path = state_file(config, ".state.lock");
  auto lock = LockFile::take(path);
  if (!lock) {
    log(LogLevel::warning, "cannot lock the state files: " + lock.error());
    return LockFile();
  }
  if (*lock) return std::move(**lock);
  const auto holder = LockFile::holder(path);
  const auto process = holder > 0 ? "process " + std::to_string(holder) : "another process";
  return tl::unexpected("the state files " + state_file(config, ".*") + " belong to " + process +
                        ", another daemon; end it first, or choose another 'state' or a 'socket' "
                        "of another name in [daemon]");
}

void say_what_is_missing(std::size_t clients) {
  if (clients > 0) return;
  log(LogLevel::error,
      "so few files may be open (ulimit -n) that no client can be served but for stops: raise the "
      "limit (LimitNOFILE= of a service)");
}

}  // namespace

Daemon::Daemon(boost::asio::io_context& context, Service service, LockFile state_lock)
    : context_(context),
      service_(std::move(service)),
      reserve_(std::make_unique_for_overwrite<std::byte[]>(reserved_bytes)),
      state_lock_(std::move(state_lock)) {}

tl::expected<std::unique_ptr<Daemon>, std::string> Daemon::create(
    boost::asio::io_context& context, const Config& config, const OpenLink& open_link,
    Service service, const std::optional<HttpConfig>& http) {
  const auto passed = service.take_socket();
  auto file = passed ? SocketFile::passed(*passed, config.daemon.socket)
                     : SocketFile::claim(config.daemon.socket);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto state = lock_state(config.daemon);
  if (!state) return tl::unexpected(std::move(state.error()));
  auto audit = AuditTrail::open(config.daemon.audit);
  if (!audit) return tl::unexpected(std::move(audit.error()));
  std::unique_ptr<Daemon> daemon(new Daemon(context, std::move(service), std::move(*state)));
  daemon->audit_ = std::move(*audit);
  daemon->config_ = config.daemon;
  daemon->other_sections_ = config.others;
  const auto executor = context.get_executor();
  GatewayOptions options{open_link, log};
  options.on_exit = config.daemon.on_exit;
  options.journal = state_file(config.daemon, ".journal");
  options.deadmen = state_file(config.daemon, ".deadman.json");
  options.audit = [trail = daemon->audit_](AuditEntry entry) { trail->add(std::move(entry)); };
  daemon->gateway_ = Gateway::create(executor, config, std::move(options));
  const auto clients =
      make_room_for_clients(config.buses.size(), config.ports.size(), http.has_value());
  say_what_is_missing(clients);
  const auto share = std::make_shared<FrontShare>();
  share->tokens = Tokens::open(state_file(config.daemon, ".tokens.json"), log);
  share->configuration = std::make_shared<ManagedConfiguration>(*daemon);
  daemon->server_ =
      std::make_shared<UnixServer>(executor, std::move(*file), daemon->gateway_, clients, share);
  for (const auto& one : config.ports) {
    auto port = open_port(one, daemon->gateway_);
    if (!port) return tl::unexpected(std::move(port.error()));
    daemon->ports_.push_back(std::move(*port));
  }
  if (!http) return daemon;
  auto server = HttpServer::create(executor, *http, daemon->gateway_, share, clients);
  if (!server) return tl::unexpected(std::move(server.error()));
  daemon->http_ = std::move(*server);
  return daemon;
}

Daemon::~Daemon() {
  gateway_->join();
  if (http_) http_->join();
}

void Daemon::start() {
  gateway_->start();
  spawn(context_.get_executor(), begin_to_serve(*this));
}

bool Daemon::run() {
  const LastStop last_stop(*gateway_);
  try {
    start();
    context_.run();
    return true;
  } catch (...) {
    end_after(std::current_exception());
    return false;
  }
}

awaitable<void> Daemon::begin_to_serve(Daemon& daemon) {
  const auto is_open = [](const auto& bus) { return bus->state() == GatewayBus::State::open; };
  co_await wait_until(
      [&] { return daemon.ending_ || std::ranges::all_of(daemon.gateway_->buses(), is_open); },
      time_to_open);
  if (daemon.ending_) co_return;
  daemon.server_->start();
  for (const auto& port : daemon.ports_) port->start();
  if (daemon.http_) {
    daemon.http_->start();
    for (const auto& address : daemon.http_->addresses()) log(LogLevel::info, "serving " + address);
  }
  daemon.is_serving_ = true;
  if (!daemon.service_.is_watched()) co_return;
  daemon.service_.ready(daemon.status());
  spawn(daemon.context_.get_executor(), report(daemon));
}

awaitable<void> Daemon::report(Daemon& daemon) {
  auto told = daemon.status();
  while (!daemon.has_ended_) {
    daemon.service_.alive();
    auto status = daemon.status();
    if (!daemon.ending_ && status != told) {
      daemon.service_.status(status);
      told = std::move(status);
    }
    co_await rest(daemon.service_.report_interval());
  }
}

std::size_t Daemon::clients() const {
  return server_->clients() + (http_ ? http_->connections() : 0);
}

std::string Daemon::status() const {
  const auto& buses = gateway_->buses();
  if (buses.empty()) return "no bus is configured";
  const auto open = std::ranges::count_if(
      buses, [](const auto& bus) { return bus->state() == GatewayBus::State::open; });
  return "axes: " + std::to_string(gateway_->axes().size()) +
         ", buses open: " + std::to_string(open) + " of " + std::to_string(buses.size());
}

// What threw has ended; all others go on, as long as it takes to stop what moves.
void Daemon::end_after(const std::exception_ptr& failure) noexcept {
  on_failure(failure);
  const auto& clock = gateway_->clock();
  const auto limit = clock.now() + time_after_failure;
  for (int failures = 0; failures <= most_failures_at_the_end && clock.now() < limit;) {
    try {
      const bool ends = begin_to_end_after_failure();
      context_.run_until(ends ? limit : std::min(limit, clock.now() + time_to_find_memory));
      if (ends) return;
    } catch (...) {
      ++failures;
      on_failure(std::current_exception());
    }
  }
}

void Daemon::on_failure(const std::exception_ptr& failure) noexcept {
  const bool is_first = !std::exchange(has_failed_, true);
  if (is_first) {
    gateway_->stop_at_once();
    gateway_->refuse_movements();
    reserve_.reset();
  }
  log_failure(log, is_first ? "the reactor, all axes are stopped" : "the end", failure);
  (void)begin_to_end_after_failure();
}

/// False where there is no memory for that.
bool Daemon::begin_to_end_after_failure() noexcept {
  try {
    if (!has_stopped_all_) gateway_->stop_all_axes();
    has_stopped_all_ = true;
    stop();
    return true;
  } catch (...) {
    log_failure(log, "the end", std::current_exception());
    return false;
  }
}

void Daemon::stop() {
  boost::asio::post(context_, [this] {
    ending_ = true;
    spawn(context_.get_executor(), end(*this));
  });
}

void Daemon::end_on_signals() { spawn(context_.get_executor(), wait_for_signal(*this)); }

awaitable<void> Daemon::wait_for_signal(Daemon& daemon) {
  boost::asio::signal_set signals(daemon.context_, SIGTERM, SIGINT, SIGHUP);
  boost::system::error_code ignored;
  auto number = co_await signals.async_wait(redirect_error(use_awaitable, ignored));
  while (number == SIGHUP) {
    daemon.audit_->reopen();
    // A stop must not wait for it.
    if (daemon.load_) spawn(daemon.context_.get_executor(), load_again(daemon));
    number = co_await signals.async_wait(redirect_error(use_awaitable, ignored));
  }
  log(LogLevel::info, number == SIGINT ? "ending: SIGINT" : "ending: SIGTERM");
  daemon.stop();
}

// ---- another configuration ---------------------------------------------------------------------

namespace {

/// Empty if nothing does.
std::string takes_a_restart(const DaemonConfig& now, const DaemonConfig& next) {
  if (now.socket != next.socket) return "'socket' in [daemon]";
  if (now.state != next.state) return "'state' in [daemon]";
  if (now.audit != next.audit) return "'audit' in [daemon]";
  if (now.log_level != next.log_level) return "'log_level' in [daemon]";
  return {};
}

}  // namespace

awaitable<void> Daemon::load_again(Daemon& daemon) {
  daemon.loads_once_more_ = true;
  if (std::exchange(daemon.is_loading_, true)) co_return;
  while (std::exchange(daemon.loads_once_more_, false)) {
    const auto turn = co_await daemon.take_turn_to_load(0);
    auto work = [load = daemon.load_] { return load(std::nullopt); };
    auto config = co_await daemon.gateway_->planner.plan(std::move(work));
    tl::expected<std::string, std::vector<std::string>> reloaded;
    if (config) {
      reloaded = co_await reload(daemon, std::move(*config));
    } else {
      reloaded = tl::unexpected(lines_of(config.error()));
    }
    if (reloaded) {
      log(LogLevel::info, "the configuration was loaded again: " + *reloaded);
      continue;
    }
    for (const auto& line : reloaded.error()) log(LogLevel::error, line);
    log(LogLevel::error, "the configuration stays as it was");
  }
  daemon.is_loading_ = false;
}

awaitable<tl::expected<std::string, std::vector<std::string>>> Daemon::foresee(
    Daemon& daemon, const Config& config) {
  if (auto objection = daemon.objection_to(config))
    co_return tl::unexpected(std::vector{*objection});
  auto words = co_await foresee_reload(daemon.gateway_, config);
  if (!words) co_return tl::unexpected(std::vector{std::move(words.error())});
  co_return std::move(*words);
}

awaitable<tl::expected<std::string, std::vector<std::string>>> Daemon::reload(Daemon& daemon,
                                                                              Config config) {
  if (auto objection = daemon.objection_to(config))
    co_return tl::unexpected(std::vector{*objection});
  const auto next = config.daemon;
  auto words = co_await tmcld::reload(daemon.gateway_, std::move(config));
  if (!words) co_return tl::unexpected(std::vector{std::move(words.error())});
  daemon.config_ = next;
  daemon.server_->review_rights();
  if (daemon.http_) daemon.http_->review_rights();
  co_return std::move(*words);
}

std::optional<std::string> Daemon::objection_to(const Config& config) const {
  auto what = takes_a_restart(config_, config.daemon);
  if (what.empty() && config.others != other_sections_)
    what = "a section that is not of a bus, a module, an axis or access";
  if (what.empty()) return std::nullopt;
  return what + " has changed, which takes a restart: systemctl restart tmcld";
}

namespace {

/// Set for as long as it lives.
class Flag {
 public:
  explicit Flag(bool& flag) : flag_(flag) { flag_ = true; }
  Flag(const Flag&) = delete;
  Flag& operator=(const Flag&) = delete;
  ~Flag() { flag_ = false; }

 private:
  bool& flag_;
};

}  // namespace

/// Where memory is missing it may break off, and is begun again.
awaitable<void> Daemon::end(Daemon& daemon) {
  if (daemon.end_runs_ || daemon.has_ended_) co_return;
  const Flag runs(daemon.end_runs_);
  auto& server = *daemon.server_;
  daemon.service_.stopping("ending: axes that move are stopped first");
  server.stop_accepting();
  if (daemon.http_) daemon.http_->stop_accepting();
  co_await end_gateway(daemon.gateway_);
  for (const auto& port : daemon.ports_) port->close();
  server.finish_sessions();
  if (daemon.http_) daemon.http_->finish_sessions();
  co_await wait_until([&] { return daemon.clients() == 0; }, time_for_answers);
  server.close_sessions();
  if (daemon.http_) daemon.http_->close_sessions();
  daemon.has_ended_ = true;
  daemon.context_.stop();
}

bool Daemon::is_opening_links() const {
  return std::ranges::any_of(gateway_->buses(),
                             [](const auto& bus) { return bus->link().is_opening(); });
}

}  // namespace tmcld
