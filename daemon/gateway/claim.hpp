/// Axes that are to move together are claimed together: all of them, or none.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/axis.hpp"

namespace tmcld {

struct AxisFailure {
  tmcl::Error error;
  std::string axis;  ///< Whose fault it is.
};

/// Waits a little for axes that others move: a line or path before may still be about to set
/// settings back.
/// Errors: those of GatewayAxis::be_free(); nothing is claimed then.
boost::asio::awaitable<std::optional<AxisFailure>> claim_all(
    std::vector<std::shared_ptr<GatewayAxis>> axes, Mover by, Permit of);

}  // namespace tmcld
