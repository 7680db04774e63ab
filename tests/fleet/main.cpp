// tmcl_fleet_bench: many gateways on one broker. tests/fleet/run starts what is needed of it.
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "async/workers.hpp"
#include "fleet/client.hpp"
#include "fleet/gateway.hpp"
#include "fleet/plain.hpp"
#include "fleet/say.hpp"
#include "log/log.hpp"

namespace {

using namespace tmclfleet;

constexpr auto time_to_start = std::chrono::seconds(2);
constexpr std::size_t threads_that_connect = 4;

struct Order {
  FleetPlace place;
  int first = 0;
  int gateways = 1;
  ClientOptions client;
};

void raise_limit_of_files() {
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

template <class Gateway>
using Fleet = std::vector<std::unique_ptr<Gateway>>;

template <class Gateway>
Fleet<Gateway> make_all(boost::asio::io_context& context, tmcld::Workers& workers,
                        const Order& order) {
  Fleet<Gateway> gateways;
  for (int i = 0; i < order.gateways; ++i)
    gateways.push_back(std::make_unique<Gateway>(context, workers, order.place, order.first + i));
  say({{"event", "starting"}, {"gateways", order.gateways}});
  return gateways;
}

/// Not in the same instant, or all would look at their axes at the same time for ever.
template <class Gateway>
boost::asio::awaitable<void> start_all(const Fleet<Gateway>& gateways) {
  const auto pause = tmcl::Duration(time_to_start) / gateways.size();
  auto next = tmcl::RealClock().now();
  for (const auto& gateway : gateways) {
    gateway->start();
    next += pause;
    co_await tmcld::rest(next - tmcl::RealClock().now());
  }
}

/// Says when all axes stand again that a stop has found moving.
boost::asio::awaitable<void> say_when_all_stand(const Fleet<SimulatedGateway>& gateways) {
  const auto has_stood = [](const auto& gateway) { return gateway->stood().has_value(); };
  while (!std::ranges::all_of(gateways, has_stood))
    co_await tmcld::rest(std::chrono::milliseconds(50));
  const auto last =
      std::ranges::max_element(gateways, {}, [](const auto& gateway) { return *gateway->stood(); });
  say({{"event", "all_stand"}, {"last", seconds_of(*(*last)->stood())}});
}

void run_gateways(const Order& order) {
  boost::asio::io_context context(1);
  tmcld::Workers workers(threads_that_connect);
  const auto gateways = make_all<SimulatedGateway>(context, workers, order);
  tmcld::spawn(context.get_executor(), start_all(gateways));
  tmcld::spawn(context.get_executor(), say_when_all_stand(gateways));
  context.run();
}

void run_plain(const Order& order) {
  boost::asio::io_context context(1);
  tmcld::Workers workers(threads_that_connect);
  const auto gateways = make_all<PlainGateway>(context, workers, order);
  tmcld::spawn(context.get_executor(), start_all(gateways));
  context.run();
}

void run_client(const Order& order) {
  boost::asio::io_context context(1);
  tmcld::Workers workers(1);
  FleetClient client(context, workers, order.place, order.client);
  tmcld::spawn(context.get_executor(), client.run());
  context.run();
}

void carry_out(const std::string& what, const Order& order) {
  if (what == "gateways") return run_gateways(order);
  if (what == "plain") return run_plain(order);
  run_client(order);
}

}  // namespace

int main(int argc, char** argv) {
  Order order;
  CLI::App app("Many gateways on one broker; see tests/fleet/run.", "tmcl_fleet_bench");
  app.require_subcommand(1);
  for (const auto* name : {"gateways", "plain", "client"}) {
    auto* sub = app.add_subcommand(name);
    sub->add_option("--folder", order.place.folder);
    sub->add_option("--host", order.place.host)->required();
    sub->add_option("--port", order.place.port)->required();
    sub->add_option("--certificates", order.place.certificates);
    sub->add_option("--first", order.first);
    sub->add_option("--gateways", order.gateways);
    sub->add_option("--real", order.client.real);
    sub->add_option("--calls-per-second", order.client.calls_per_second);
    sub->add_option("--seconds", order.client.measured_s);
  }
  CLI11_PARSE(app, argc, argv);
  order.client.gateways = static_cast<std::size_t>(order.gateways);
  raise_limit_of_files();
  std::signal(SIGPIPE, SIG_IGN);
  tmcld::start_log(tmcld::LogLevel::error);
  try {
    carry_out(app.get_subcommands().front()->get_name(), order);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    std::_Exit(1);
  }
  // Gateways end with their process, as it is when the supply fails.
  std::fflush(stdout);
  std::_Exit(0);
}
