#include "api/dispatch.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "api/audit.hpp"
#include "api/call.hpp"

namespace tmcld {
namespace {

/// The one place that decides whether a call is let through; what it can do, and who may make it,
/// is in the method's row. A stop always is.
std::optional<Error> admit(const Call& call) {
  const auto& method = call.method;
  auto objection = objection_by_role(call.caller, method.role, method.name);
  if (objection) return objection;
  if (method.effect == tmcl::Effect::stops) return std::nullopt;
  if (!call.gateway->is_closing()) return std::nullopt;
  return failed("daemon_ending", "the daemon is ending");
}

/// Its sender says that it is older than the last time that the reactor stood still.
std::optional<Error> objection_by_age(const Call& call, std::optional<tmcl::TimePoint> sent) {
  const auto& gaps = call.gateway->gaps();
  const auto effect = call.method.effect;
  const bool acts = effect == tmcl::Effect::moves || effect == tmcl::Effect::writes;
  if (!acts || !sent || !gaps.is_stale(*sent)) return std::nullopt;
  return not_now(name_of(tmcl::Errc::stale_request), stale_text(gaps), std::string(stale_hint));
}

/// From any connection: a call that names a lease is one of that lease's holder.
Result<std::uint64_t> client_of(const Gateway& gateway, const Peer& peer,
                                const RpcRequest& request) {
  const auto effect = request.method->effect;
  const bool acts = effect == tmcl::Effect::moves || effect == tmcl::Effect::writes;
  if (!acts || !request.lease) return peer.client().number;
  return find_lease(*gateway.leases(), *request.lease).map([](const Lease& lease) {
    return lease.holder.number;
  });
}

Error internal_error(const MethodInfo& method, const char* what) {
  auto error = failed("internal_error", "tmcld failed in " + std::string(method.name) + ": " + what,
                      "if it is not memory that is missing, this is a bug; tmcld's log has it");
  error.outcome = tmcl::Outcome::unknown;
  return error;
}

boost::asio::awaitable<Result<boost::json::object>> carry_out(Call& call,
                                                              std::optional<tmcl::TimePoint> sent) {
  if (auto refused = admit(call)) co_return tl::unexpected(std::move(*refused));
  if (auto stale = objection_by_age(call, sent)) co_return tl::unexpected(std::move(*stale));
  std::exception_ptr failure;
  try {
    auto result = co_await call.method.handler(call);
    co_return result;
  } catch (...) {
    failure = std::current_exception();
  }
  if (call.effect == tmcl::Effect::stops) call.gateway->stop_in_need();
  call.gateway->log_failure(call.method.name, failure);
  co_return tl::unexpected(internal_error(call.method, what_of(failure)));
}

}  // namespace

boost::asio::awaitable<Result<boost::json::object>> dispatch(std::shared_ptr<Gateway> gateway,
                                                             std::shared_ptr<Peer> peer,
                                                             RpcRequest request) {
  const auto client = client_of(*gateway, *peer, request);
  if (!client) co_return tl::unexpected(client.error());
  auto caller = peer->caller();
  auto permit = gateway->admit(*client);
  permit.exceeds_limits = caller.exceeds_limits;
  permit.only_asks = request.method->effect == tmcl::Effect::reads;
  permit.needs_lease = gateway->moves_need_lease() && request.method->effect == tmcl::Effect::moves;
  // A deadline counts from there.
  const auto now = gateway->clock().now();
  const auto received = std::min(now, request.sent_at.value_or(now));
  Call call{std::move(gateway), std::move(peer), std::move(request.id), std::move(request.params),
            received,           permit,          std::move(caller),     *request.method};
  if (request.lease) call.lease = request.lease->lease;
  auto result = co_await carry_out(call, request.sent_at);
  audit_end(call, result);
  co_return result;
}

}  // namespace tmcld
