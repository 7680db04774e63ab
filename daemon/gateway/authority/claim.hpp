/// Axes that are to move together are claimed together: all of them, or none.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "gateway/axis/axis.hpp"

namespace tmcld {

struct AxisFailure {
  tmcl::Error error;
  std::string axis;  ///< Whose fault it is.
};

/// Waits a little for axes that others move: a line or path before may still be about to set
/// settings back. The claims come in the order of the axes.
/// Errors: those of GatewayAxis::be_free(); nothing is claimed then.
boost::asio::awaitable<tl::expected<std::vector<Claim>, AxisFailure>> claim_all(
    std::vector<std::shared_ptr<GatewayAxis>> axes, ClaimOwner claim_owner);

}  // namespace tmcld
