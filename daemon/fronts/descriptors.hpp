/// How many clients the descriptors of this process are enough for.
#pragma once

#include <chrono>
#include <cstddef>

namespace tmcld {

/// Before a client is accepted again after that failed: with no descriptors left it fails at once.
constexpr auto pause_after_failure = std::chrono::milliseconds(100);

/// Raises the limit of descriptors as far as clients, `buses` and `ports` need and the system
/// allows, and gives how many clients each of the fronts may have then: max_clients, or fewer. What
/// buses need to be opened again, the hosts of ports and the places for stops are kept free; if
/// that is all there is, it gives 0.
std::size_t make_room_for_clients(std::size_t buses, std::size_t ports, bool by_http);

}  // namespace tmcld
