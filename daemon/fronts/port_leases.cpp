#include "fronts/port_leases.hpp"

#include <algorithm>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

/// Far longer than between two looks: a lease that is not renewed belongs to a daemon that hangs.
constexpr tmcl::Duration time_to_live = 60s;
/// How often an axis is looked at that did not stand yet.
constexpr tmcl::Duration look_interval = 1s;
/// An axis that turns round stands for a moment.
constexpr tmcl::Duration time_between_looks = 100ms;

awaitable<bool> stands(std::shared_ptr<GatewayAxis> axis) {
  if (axis->claim_kind() != ClaimKind::none) co_return false;
  const auto first = co_await axis->read_state();
  if (!first || first->state.velocity.value != 0) co_return false;
  co_await rest(time_between_looks);
  const auto second = co_await axis->read_state();
  co_return second && second->state.velocity.value == 0 &&
      second->state.position == first->state.position;
}

}  // namespace

PortLeases::PortLeases(std::shared_ptr<Gateway> gateway, Client host)
    : gateway_(std::move(gateway)),
      host_(std::move(host)),
      changed_(gateway_->buses().front()->executor()) {}

awaitable<tmcl::Result<void>> PortLeases::take(std::shared_ptr<GatewayAxis> axis, Permit permit) {
  forget_lost();
  if (std::ranges::count(held_, axis, &Held::axis) != 0) co_return tmcl::Result<void>{};
  LeaseTerms terms;
  terms.ttl = time_to_live;
  std::vector<std::shared_ptr<GatewayAxis>> axes(1, axis);
  auto acquiring = Leases::acquire(gateway_->leases(), host_, std::move(axes), terms, permit);
  auto lease = co_await std::move(acquiring);
  if (!lease) co_return tl::unexpected(std::move(lease.error()));
  if (closed_) {
    // The host went meanwhile.
    gateway_->leases()->release(lease->number);
    co_return tmcl::Result<void>{};
  }
  held_.push_back({lease->number, std::move(axis)});
  if (!std::exchange(is_looked_after_, true))
    spawn(gateway_->buses().front()->executor(), look_after(shared_from_this()));
  co_return tmcl::Result<void>{};
}

void PortLeases::note_datagram() { last_datagram_ = gateway_->clock().now(); }

void PortLeases::close() {
  closed_ = true;
  forget_lost();
  for (const auto& held : std::exchange(held_, {}))
    if (!held.axis->turns()) gateway_->leases()->release(held.lease);
  changed_.notify();
}

bool PortLeases::is_idle() const {
  return gateway_->clock().now() >= last_datagram_ + port_idle_time;
}

/// It may have been broken.
bool PortLeases::holds(const Held& held) const {
  const auto* lease = gateway_->leases()->of(*held.axis);
  return lease != nullptr && lease->number == held.lease;
}

void PortLeases::forget_lost() {
  std::erase_if(held_, [this](const Held& held) { return !holds(held); });
}

void PortLeases::renew() {
  for (const auto& held : held_) gateway_->leases()->renew(held.lease, time_to_live);
}

awaitable<void> PortLeases::look_after(std::shared_ptr<PortLeases> self) {
  while (true) {
    if (self->is_idle()) co_await self->give_back_what_stands();
    self->forget_lost();
    if (self->closed_ || self->held_.empty()) break;
    self->renew();
    const auto now = self->gateway_->clock().now();
    co_await self->changed_.wait_until(
        std::max(self->last_datagram_ + port_idle_time, now + look_interval));
  }
  self->is_looked_after_ = false;
}

awaitable<void> PortLeases::give_back_what_stands() {
  const auto all = held_;
  for (const auto& held : all) {
    const bool does = co_await stands(held.axis);
    // The host may have spoken or gone meanwhile.
    if (closed_ || !is_idle()) co_return;
    if (does && holds(held)) gateway_->leases()->release(held.lease);
  }
}

}  // namespace tmcld
