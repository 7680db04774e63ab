#include "gateway/authority/claim.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "tmcl/timer.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

constexpr tmcl::Duration claim_look_interval = std::chrono::milliseconds(20);

awaitable<std::optional<tmcl::Error>> look(const Axes& axes, Permit permit) {
  for (const auto& axis : axes) {
    auto movement = axis->begin_movement(permit, {});
    auto free = co_await axis->be_free(std::move(movement));
    if (!free) co_return error_of(*axis, std::move(free.error()));
  }
  co_return std::nullopt;
}

bool can_end_soon(const tmcl::Error& failure, const Axes& axes) {
  if (failure.code != tmcl::Errc::axis_claimed) return false;
  const auto axis = std::ranges::find(axes, failure.axis, &GatewayAxis::name);
  return axis != axes.end() && (*axis)->claim_kind() != ClaimKind::search;
}

bool are_free(const Axes& axes) {
  return std::ranges::all_of(
      axes, [](const auto& axis) { return axis->claim_kind() == ClaimKind::none; });
}

}  // namespace

awaitable<tmcl::Result<std::vector<Claim>>> claim_all(Axes axes, ClaimOwner claim_owner) {
  tmcl::Timer timer(co_await boost::asio::this_coro::executor);
  const auto limit = timer.now() + time_to_be_free;
  while (true) {
    auto failure = co_await look(axes, claim_owner.of);
    // While one of them was looked at, another may have been claimed.
    if (!failure && are_free(axes)) break;
    const bool waits = timer.now() < limit;
    if (failure && !(waits && can_end_soon(*failure, axes)))
      co_return tl::unexpected(std::move(*failure));
    timer.expires_after(claim_look_interval);
    co_await timer.async_wait(boost::asio::use_awaitable);
  }
  std::vector<Claim> claims;
  for (const auto& axis : axes) claims.push_back(axis->claim(claim_owner));
  co_return claims;
}

}  // namespace tmcld
