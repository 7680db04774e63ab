#include <algorithm>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/views.hpp"
#include "async/gather.hpp"
#include "async/rest.hpp"
#include "tmcl/hex.hpp"

namespace tmcld::handlers {
namespace {

using Found = std::vector<tmcl::FoundModule>;

constexpr std::uint16_t last_serial_address = 255;
// A scan waits for this part of it at each address: most have no module.
constexpr int scan_share_of_reply_timeout = 4;
// What comes in this time after the last question comes unasked.
constexpr tmcl::Duration listening_time = std::chrono::milliseconds(300);

struct Addresses {
  std::uint16_t first;
  std::uint16_t last;
};
Addresses addresses_of(const bus::Scan& params) {
  return {params.first.value_or(1), params.last.value_or(last_serial_address)};
}

tmcl::ScanOptions scan_options(const Call& call, const bus::Scan& params,
                               const std::shared_ptr<GatewayBus>& scanned) {
  const auto& bus = *scanned;
  tmcl::ScanOptions options;
  const auto [first, last] = addresses_of(params);
  options.first = first;
  options.last = bus.is_can() ? last : std::min(last, last_serial_address);
  // A bus whose answers take long has been given a long reply timeout.
  options.reply_timeout = std::max(
      options.reply_timeout, bus.config().bus_options.reply_timeout / scan_share_of_reply_timeout);
  options.progress = [tell = call.progress_reporter(), name = bus.name()](std::size_t asked,
                                                                          std::size_t of) {
    tell(ScanProgress{name, asked, of, {}});
  };
  const std::size_t total = options.last - first + 1U;
  options.found = [tell = call.progress_reporter(), scanned, first = first,
                   total](const tmcl::FoundModule& module) {
    const std::size_t asked = number(module.address) - first + 1U;
    tell(ScanProgress{scanned->name(), asked, total, view_of(*scanned, module)});
  };
  return options;
}

tmcl::Error scan_in_progress(const GatewayBus& bus) {
  auto error = tmcl::bad_argument("this bus is being scanned already", "wait for its end");
  error.bus = bus.name();
  return error;
}

class ScanInProgress {
 public:
  explicit ScanInProgress(std::shared_ptr<GatewayBus> bus) : bus_(std::move(bus)) {
    bus_->link().scanning = true;
  }
  ScanInProgress(const ScanInProgress&) = delete;
  ScanInProgress& operator=(const ScanInProgress&) = delete;
  ~ScanInProgress() { bus_->link().scanning = false; }

 private:
  std::shared_ptr<GatewayBus> bus_;
};

bool heard_what_may_be_noise(const GatewayBus& bus) {
  return !bus.is_can() && bus.link().heard().verdict().kind == tmcl::HeardKind::other_baud_rate;
}

boost::asio::awaitable<tmcl::Result<Found>> scan_one(std::shared_ptr<GatewayBus> bus,
                                                     tmcl::ScanOptions options,
                                                     std::shared_ptr<Peer> peer) {
  if (bus->link().scanning) co_return tl::unexpected(scan_in_progress(*bus));
  const ScanInProgress in_progress(bus);
  RunOptions run;
  run.objection = [peer]() -> std::optional<tmcl::Error> {
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  auto script = tmcl::verbs::scan(std::move(options));
  bus->link().hear_anew();
  auto found = co_await bus->run(std::move(script), std::move(run));
  if (found && found->empty() && heard_what_may_be_noise(*bus)) co_await rest(listening_time);
  co_return found;
}

Result<bus::FoundModules> found_by(const std::vector<std::shared_ptr<GatewayBus>>& buses,
                                   const std::vector<tmcl::Result<Found>>& results,
                                   bool one_was_named) {
  bus::FoundModules all;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    if (results[i]) {
      for (const auto& module : *results[i]) all.modules.push_back(view_of(*buses[i], module));
      if (results[i]->empty()) all.silent.push_back({buses[i]->name(), heard_on(*buses[i])});
      continue;
    }
    auto error = call_error(results[i].error());
    if (one_was_named) return tl::unexpected(std::move(error));
    all.failed.push_back({buses[i]->name(), to_json(error)});
  }
  return all;
}

bus::Datagram view_of(const TrafficLog::Entry& entry, bool is_can, const Gateway& gateway) {
  using std::chrono::microseconds;
  bus::Datagram out{entry.number};
  const auto utc = gateway.clock().utc_of(entry.at).time_since_epoch();
  out.utc_us = std::chrono::duration_cast<microseconds>(utc).count();
  out.direction = entry.direction == tmcl::Traffic::Direction::out ? "out" : "in";
  out.bytes = tmcl::to_hex(std::span(entry.bytes).first(entry.size));
  if (is_can) out.can_id = entry.can_id;
  if (entry.can_extended) out.can_extended = true;
  if (entry.is_garbage) out.garbage = true;
  if (entry.asker != 0) out.client = gateway.name_of_client(entry.asker);
  return out;
}

}  // namespace

Answer<bus::List> list_buses(Call& call, const bus::List&) {
  bus::Buses result;
  for (const auto& bus : call.gateway->buses()) result.buses.push_back(view_of(*bus));
  co_return result;
}

Answer<bus::Trace> trace(Call& call, const bus::Trace& params) {
  constexpr std::int32_t default_limit = 256;
  const auto bus = co_await must(bus_of(call, params.bus));
  const auto& log = bus->link().traffic();
  const auto limit = static_cast<std::uint64_t>(params.limit.value_or(default_limit));
  const auto newest = log.last() - std::min(log.last(), limit);
  // What was numbered by an earlier daemon says nothing.
  const auto after = std::min(params.after.value_or(newest), log.last());
  bus::Traffic traffic{bus->name(), log.last(), std::max(after + 1, log.first()) - after - 1};
  for (const auto& entry : log.after(after, limit))
    traffic.datagrams.push_back(view_of(entry, bus->is_can(), *call.gateway));
  co_return traffic;
}

Answer<bus::Scan> scan(Call& call, const bus::Scan& params) {
  const auto [first, last] = addresses_of(params);
  if (first > last) {
    co_return param_error<&bus::Scan::first>("out_of_range", "'first' is above 'last'");
  }
  const auto all = call.gateway->buses();
  std::vector<std::shared_ptr<GatewayBus>> buses(all.begin(), all.end());
  if (params.bus) {
    const auto bus = co_await must(bus_of(call, *params.bus));
    buses.assign(1, bus);
  }
  std::vector<boost::asio::awaitable<tmcl::Result<Found>>> scans;
  for (const auto& bus : buses)
    scans.push_back(scan_one(bus, scan_options(call, params, bus), call.peer));
  const auto results = co_await gather(std::move(scans));
  co_return found_by(buses, results, params.bus.has_value());
}

}  // namespace tmcld::handlers
