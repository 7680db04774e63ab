/// A call that waits for what it has set off.
#pragma once

#include <memory>
#include <utility>

#include "api/call.hpp"

namespace tmcld {

/// Also ends when the client goes; the movement goes on then, like any other.
inline RunOptions with_peer(RunOptions movement, std::shared_ptr<Peer> peer) {
  movement.objection = [objection = std::move(movement.objection),
                        peer = std::move(peer)]() -> std::optional<tmcl::Error> {
    if (auto error = objection()) return error;
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  return movement;
}

}  // namespace tmcld
