#include "api/dispatch.hpp"

#include <chrono>
#include <utility>

#include "api/call.hpp"

namespace tmcld {
namespace {

/// The one place that decides whether a call is let through; what it can do is in the method's
/// row. A stop always is.
std::optional<RpcError> admit(const MethodInfo& method, const Call& call) {
  if (method.effect == tmcl::Effect::stops) return std::nullopt;
  if (!call.gateway->is_closing()) return std::nullopt;
  return rpc_error(rpc_code::daemon_ending, "daemon_ending", "the daemon is ending");
}

}  // namespace

boost::asio::awaitable<RpcResult> dispatch(std::shared_ptr<Gateway> gateway,
                                           std::shared_ptr<Peer> peer, RpcRequest request) {
  const auto permit = gateway->admit();
  Call call{std::move(gateway),
            std::move(peer),
            std::move(request.id),
            Params(std::move(request.params)),
            std::chrono::steady_clock::now(),
            permit};
  auto refused = admit(*request.method, call);
  if (refused) co_return tl::unexpected(std::move(*refused));
  auto result = co_await request.method->handler(call);
  co_return result;
}

}  // namespace tmcld
