/// Carries out requests, whichever front they came through.
#pragma once

#include <memory>

#include <boost/asio/awaitable.hpp>

#include "api/peer.hpp"
#include "api/request.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// Ends when the method has ended, perhaps after its peer has gone.
boost::asio::awaitable<Result<boost::json::object>> dispatch(std::shared_ptr<Gateway> gateway,
                                                             std::shared_ptr<Peer> peer,
                                                             RpcRequest request);

}  // namespace tmcld
