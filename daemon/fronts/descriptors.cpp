#include "fronts/descriptors.hpp"

#include <algorithm>

#include <sys/resource.h>

#include "fronts/http_connections.hpp"
#include "fronts/unix_server.hpp"

namespace tmcld {
namespace {

// A link, its lock, and both again while the next one is opened before the last one is closed.
constexpr std::size_t descriptors_of_a_bus = 4;
// Of TCP: what listens, its connections, and one that is too many.
constexpr std::size_t descriptors_of_a_port = 10;
// Standard input and output, the reactor, signals, the socket, a client that waits for a place, and
// some to spare for what the libraries of the system open.
constexpr std::size_t descriptors_of_the_daemon = 24;

}  // namespace

std::size_t make_room_for_clients(std::size_t buses, std::size_t ports, bool by_http) {
  const std::size_t fronts = by_http ? 2 : 1;
  const auto others = descriptors_of_the_daemon + descriptors_of_a_bus * buses +
                      descriptors_of_a_port * ports + places_for_stops;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return max_clients;
  const auto wanted =
      static_cast<rlim_t>(max_clients * fronts + others + (by_http ? most_unknown_connections : 0));
  if (limit.rlim_cur < wanted) {
    limit.rlim_cur = std::min(wanted, limit.rlim_max);
    ::setrlimit(RLIMIT_NOFILE, &limit);
    ::getrlimit(RLIMIT_NOFILE, &limit);
  }
  const auto allowed = static_cast<std::size_t>(std::min(limit.rlim_cur, wanted));
  const auto free = allowed > others ? allowed - others : 0;
  if (!by_http) return free;
  // Connections that were not let in yet take as many as clients do, at most.
  constexpr std::size_t kinds = 3;
  return allowed < wanted ? free / kinds : max_clients;
}

}  // namespace tmcld
