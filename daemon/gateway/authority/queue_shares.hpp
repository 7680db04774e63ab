/// How much of the room in the queue of a bus one client has: no more than it leaves free.
///
/// One that floods the bus can so fill a half, two a third each, and so on; who has nothing waiting
/// there is always let in. What reads and what acts is counted apart, as the queue has room for
/// each. Stops need no place.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "tmcl/bus_options.hpp"
#include "tmcl/command.hpp"

namespace tmcld {

class QueueShares {
  struct Leave {
    bool reads = false;
    std::uint64_t client = 0;
    std::size_t places = 0;
    void operator()(QueueShares* shares) const { shares->leave(*this); }
  };

 public:
  /// Taken while it lives. Must not outlive the shares it is of.
  using Place = std::unique_ptr<QueueShares, Leave>;

  /// Null if the client has its share already. What the gateway itself asks, as client 0, is not
  /// counted: it asks one thing at a time. What it reads for a call is its client's.
  Place take(std::uint64_t client, tmcl::Effect effect, std::size_t places = 1) {
    const bool reads = effect == tmcl::Effect::reads;
    if (client == 0 || effect == tmcl::Effect::stops) return {this, Leave{}};
    auto& kind = kinds_[reads];
    const auto mine = kind.by_client[client];
    const auto free = tmcl::max_queued_calls - std::min(kind.taken, tmcl::max_queued_calls);
    if (mine > 0 && mine >= free) return {nullptr, Leave{}};
    kind.by_client[client] += places;
    kind.taken += places;
    return {this, Leave{reads, client, places}};
  }

 private:
  struct Kind {
    std::size_t taken = 0;
    std::map<std::uint64_t, std::size_t> by_client;
  };

  void leave(const Leave& left) {
    if (left.places == 0) return;
    auto& kind = kinds_[left.reads];
    kind.taken -= left.places;
    const auto found = kind.by_client.find(left.client);
    if ((found->second -= left.places) == 0) kind.by_client.erase(found);
  }

  std::array<Kind, 2> kinds_;
};

}  // namespace tmcld
