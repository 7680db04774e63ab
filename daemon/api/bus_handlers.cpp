#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/state_json.hpp"
#include "async/gather.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

using Found = std::vector<tmcl::FoundModule>;
using ScanResult = tmcl::Result<Found>;

constexpr std::uint16_t last_serial_address = 255;

tmcl::ScanOptions scan_options(const Call& call, const GatewayBus& bus) {
  tmcl::ScanOptions options;
  options.first = static_cast<std::uint16_t>(call.params.integer_or("first", 1));
  options.last = static_cast<std::uint16_t>(call.params.integer_or("last", last_serial_address));
  if (!bus.is_can()) options.last = std::min(options.last, last_serial_address);
  options.progress = [peer = call.peer, id = call.id, name = bus.name()](std::size_t asked,
                                                                         std::size_t of) {
    json::object params;
    params["id"] = id;
    params["bus"] = name;
    params["asked"] = asked;
    params["of"] = of;
    peer->notify("notify_progress", std::move(params));
  };
  return options;
}

tmcl::Error scan_in_progress(const GatewayBus& bus) {
  auto error = tmcl::bad_argument("this bus is being scanned already", "wait for its end");
  error.bus = bus.name();
  return error;
}

boost::asio::awaitable<ScanResult> scan_one(std::shared_ptr<GatewayBus> bus,
                                            tmcl::ScanOptions options, std::shared_ptr<Peer> peer) {
  if (bus->scanning) co_return tl::unexpected(scan_in_progress(*bus));
  bus->scanning = true;
  RunOptions run;
  run.objection = [peer]() -> std::optional<tmcl::Error> {
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  auto script = tmcl::verbs::scan(std::move(options));
  auto found = co_await bus->run(std::move(script), std::move(run));
  bus->scanning = false;
  co_return found;
}

RpcResult scan_result(const std::vector<std::shared_ptr<GatewayBus>>& buses,
                      std::vector<ScanResult> results, bool one_was_named) {
  json::array modules;
  json::array failed;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    if (results[i]) {
      for (const auto& module : *results[i]) modules.push_back(to_json(*buses[i], module));
      continue;
    }
    const auto error = call_error(results[i].error());
    if (one_was_named) return tl::unexpected(error);
    json::object entry;
    entry["bus"] = buses[i]->name();
    entry["error"] = to_json(error);
    failed.push_back(std::move(entry));
  }
  json::object result;
  result["modules"] = std::move(modules);
  result["failed"] = std::move(failed);
  return result;
}

std::optional<RpcError> check_addresses(const Call& call) {
  const auto first = call.params.integer_or("first", 1);
  const auto last = call.params.integer_or("last", last_serial_address);
  if (first <= last) return std::nullopt;
  return param_error("out_of_range", "first", "'first' is above 'last'");
}

}  // namespace

Answer list_buses(Call& call) {
  json::array buses;
  for (const auto& bus : call.gateway->buses()) buses.push_back(to_json(*bus));
  json::object result;
  result["buses"] = std::move(buses);
  co_return result;
}

Answer scan(Call& call) {
  auto complaint = check_addresses(call);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const bool one = call.params.has("bus");
  const auto all = call.gateway->buses();
  std::vector<std::shared_ptr<GatewayBus>> buses(all.begin(), all.end());
  if (one) {
    const auto bus = bus_of(call);
    if (!bus) co_return tl::unexpected(bus.error());
    buses.assign(1, *bus);
  }
  std::vector<boost::asio::awaitable<ScanResult>> scans;
  for (const auto& bus : buses) scans.push_back(scan_one(bus, scan_options(call, *bus), call.peer));
  auto results = co_await gather(std::move(scans));
  co_return scan_result(buses, std::move(results), one);
}

}  // namespace tmcld::handlers
