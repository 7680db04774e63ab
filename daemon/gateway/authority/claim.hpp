/// Axes that are to move together are claimed together: all of them, or none.
#pragma once

#include <memory>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/axis/axis.hpp"

namespace tmcld {

/// Of one axis among several.
inline tmcl::Error error_of(const GatewayAxis& axis, tmcl::Error error) {
  error.axis = axis.name();
  return error;
}

/// Waits a little for axes that others move: a line or path before may still be about to set
/// settings back. The claims come in the order of the axes.
/// Errors: those of GatewayAxis::be_free(); nothing is claimed then.
boost::asio::awaitable<tmcl::Result<std::vector<Claim>>> claim_all(
    std::vector<std::shared_ptr<GatewayAxis>> axes, ClaimOwner claim_owner);

}  // namespace tmcld
