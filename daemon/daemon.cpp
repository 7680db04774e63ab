#include "daemon.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

#include "async/spawn.hpp"
#include "log/log.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;
using boost::asio::redirect_error;
using boost::asio::use_awaitable;

// Whoever starts tmcld and calls it at once is to find its buses open. One that is not there does
// not keep the others.
constexpr auto time_to_open = 300ms;
// Together well below the second within which the daemon ends.
constexpr auto time_for_stops = 300ms;
constexpr auto time_for_answers = 300ms;
constexpr auto look_interval = 5ms;
// Axes on lines and paths brake as they are set up to, and then get their settings back.
constexpr auto time_for_journeys = 12s;
// An image of 240 kB takes about half of it at 115200 baud. A module whose upload is cut short has
// no firmware.
constexpr auto time_for_uploads = 300s;
// After an exception the end may fail, too: it is given all of its times and a little more.
constexpr auto time_after_failure = time_for_uploads + time_for_journeys + time_for_stops +
                                    time_for_answers + std::chrono::seconds(1);
// It goes on after so many more of them.
constexpr int most_failures_at_the_end = 16;

template <class Condition>
awaitable<void> wait_until(boost::asio::io_context& context, Condition condition,
                           std::chrono::milliseconds at_most) {
  const auto end = std::chrono::steady_clock::now() + at_most;
  boost::asio::steady_timer timer(context);
  // At least once: whoever was waiting for the buses comes to an end in the next turns.
  do {
    timer.expires_after(look_interval);
    co_await timer.async_wait(use_awaitable);
  } while (!condition() && std::chrono::steady_clock::now() < end);
}

awaitable<void> wait_for_uploads(boost::asio::io_context& context, const Gateway& gateway) {
  const auto& uploads = gateway.uploads;
  if (uploads.empty()) co_return;
  log(LogLevel::warning, fmt::format("ending later, after the firmware upload to {}: waiting for "
                                     "that for {} s at most",
                                     fmt::join(uploads, ", "), time_for_uploads.count()));
  co_await wait_until(
      context, [&] { return uploads.empty(); }, time_for_uploads);
  if (uploads.empty()) co_return;
  log(LogLevel::error,
      fmt::format("ending, although the firmware upload to {} is not complete: no firmware runs "
                  "there until it is uploaded again",
                  fmt::join(uploads, ", ")));
}

}  // namespace

tl::expected<std::unique_ptr<Daemon>, std::string> Daemon::create(const Config& config,
                                                                  const OpenLink& open_link) {
  auto file = SocketFile::claim(config.daemon.socket);
  if (!file) return tl::unexpected(std::move(file.error()));
  std::unique_ptr<Daemon> daemon(new Daemon);
  const auto executor = daemon->context_.get_executor();
  daemon->gateway_ = Gateway::create(executor, config, open_link);
  daemon->server_ = std::make_shared<UnixServer>(executor, std::move(*file), daemon->gateway_);
  return daemon;
}

Daemon::~Daemon() {
  for (const auto& bus : gateway_->buses()) bus->wait_for_opener();
  gateway_->planner.join();
}

bool Daemon::run() {
  try {
    gateway_->start();
    spawn(context_.get_executor(), begin_to_serve(*this));
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
      daemon.context_,
      [&] { return daemon.ending_ || std::ranges::all_of(daemon.gateway_->buses(), is_open); },
      time_to_open);
  if (!daemon.ending_) daemon.server_->start();
}

// Whoever threw has ended; all others go on, as long as it takes to stop what moves.
void Daemon::end_after(const std::exception_ptr& failure) noexcept {
  log_failure("the reactor, all axes are stopped", failure);
  const auto limit = std::chrono::steady_clock::now() + time_after_failure;
  bool has_begun = false;
  for (int failures = 0; failures <= most_failures_at_the_end; ++failures) {
    try {
      if (!has_begun) {
        gateway_->stop_all_axes();
        stop();
        has_begun = true;
      }
      context_.run_until(limit);
      return;
    } catch (...) {
      log_failure("the end", std::current_exception());
    }
  }
}

void Daemon::stop() {
  boost::asio::post(context_, [this] {
    if (std::exchange(ending_, true)) return;
    spawn(context_.get_executor(), end(*this));
  });
}

void Daemon::end_on_signals() { spawn(context_.get_executor(), wait_for_signal(*this)); }

awaitable<void> Daemon::wait_for_signal(Daemon& daemon) {
  boost::asio::signal_set signals(daemon.context_, SIGTERM, SIGINT);
  boost::system::error_code ignored;
  const auto number = co_await signals.async_wait(redirect_error(use_awaitable, ignored));
  log(LogLevel::info, number == SIGINT ? "ending: SIGINT" : "ending: SIGTERM");
  daemon.stop();
}

awaitable<void> Daemon::end(Daemon& daemon) {
  auto& gateway = *daemon.gateway_;
  auto& server = *daemon.server_;
  server.stop_accepting();
  gateway.refuse_new_calls();
  if (gateway.has_journeys()) {
    gateway.end_journeys();
    co_await wait_until(
        daemon.context_, [&] { return !gateway.has_journeys(); }, time_for_journeys);
    if (gateway.has_journeys())
      log(LogLevel::error,
          "ending, although an axis on a line or path did not come to rest in time");
  }
  co_await wait_for_uploads(daemon.context_, gateway);
  co_await wait_until(
      daemon.context_, [&] { return gateway.stops_in_progress == 0; }, time_for_stops);
  gateway.close();
  server.finish_sessions();
  co_await wait_until(
      daemon.context_, [&] { return server.clients() == 0; }, time_for_answers);
  server.close_sessions();
  daemon.context_.stop();
}

bool Daemon::is_opening_links() const {
  return std::ranges::any_of(gateway_->buses(),
                             [](const auto& bus) { return bus->is_opening_link(); });
}

}  // namespace tmcld
