#include "api/client_handlers.hpp"

#include <algorithm>
#include <utility>

#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

std::vector<std::string> axes_leased_by(const Gateway& gateway, std::uint64_t client) {
  std::vector<std::string> names;
  for (const auto& [number, lease] : gateway.leases()->all()) {
    if (lease.holder.number != client) continue;
    for (const auto& axis : lease.axes) names.push_back(axis->name());
  }
  return names;
}

std::optional<std::string> unless_empty(std::string text) {
  return text.empty() ? std::nullopt : std::optional(std::move(text));
}

clients::Client view_of(const Gateway& gateway, std::uint64_t number, const ClientList::Row& row) {
  auto now = row.look();
  clients::Client seen{gateway.name_of_client(number), std::move(now.door)};
  seen.address = unless_empty(std::move(now.address));
  seen.uid = now.uid;
  seen.pid = now.pid;
  seen.token = unless_empty(std::move(now.token));
  seen.role = name_of(now.role);
  seen.axes = axes_leased_by(gateway, number);
  seen.since_s = tmcl::seconds(gateway.clock().now() - row.since);
  seen.requests = now.requests;
  return seen;
}

audit::Line view_of(const AuditMemory::Line& line) {
  using std::chrono::microseconds;
  const auto& [uid, pid, text] = line.entry;
  const auto utc = line.when.time_since_epoch();
  audit::Line seen{line.number, std::chrono::duration_cast<microseconds>(utc).count()};
  // As the lines of the file: see AuditTrail.
  const bool is_of_this_computer = pid != 0 || !text.starts_with("client=");
  if (is_of_this_computer) seen.uid = uid;
  if (is_of_this_computer) seen.pid = pid;
  seen.text = text;
  return seen;
}

}  // namespace

Answer<clients::List> list_clients(Call& call, const clients::List&) {
  clients::Clients result;
  for (const auto& [number, row] : call.gateway->clients()->rows())
    result.clients.push_back(view_of(*call.gateway, number, row));
  co_return result;
}

Answer<audit::Tail> tail_audit(Call& call, const audit::Tail& params) {
  constexpr std::int32_t default_lines = 100;
  const auto& memory = call.gateway->audit_memory();
  const auto limit = static_cast<std::uint64_t>(params.lines.value_or(default_lines));
  const auto newest = memory.last() - std::min(memory.last(), limit);
  // What was numbered by an earlier daemon says nothing.
  const auto after = std::min(params.after.value_or(newest), memory.last());
  // Who asks for the newest has not missed those before.
  const auto dropped = params.after ? std::max(after + 1, memory.first()) - after - 1 : 0;
  audit::Lines result{memory.last(), dropped};
  for (const auto& line : memory.after(after, limit)) result.lines.push_back(view_of(line));
  co_return result;
}

}  // namespace tmcld::handlers
