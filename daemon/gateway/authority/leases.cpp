#include "gateway/authority/leases.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "async/spawn.hpp"
#include "gateway/standing_stop.hpp"
#include "gateway/store/random_bytes.hpp"
#include "tmcl/api/lease.hpp"
#include "tmcl/ensure.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

Motors& motors_of(const GatewayAxis& axis) { return axis.bus().motors(); }

/// The owner of an axis that turns may take a lease of it.
bool is_free_for(const GatewayAxis& axis, const Client& client) {
  const auto holder = motors_of(axis).holder_of(axis.address());
  return holder.client == 0 || (holder.lease == 0 && holder.client == client.number);
}

std::optional<tmcl::Error> conflict(const Axes& axes, const Client& client) {
  for (const auto& axis : axes) {
    if (!is_free_for(*axis, client)) {
      const bool is_leased = motors_of(*axis).holder_of(axis->address()).lease != 0;
      const auto because = is_leased ? Obstacle::leased : Obstacle::turns_for_other;
      return error_of(*axis, motors_of(*axis).refusal(axis->address(), because));
    }
    if (axis->claim_kind() != ClaimKind::none) return error_of(*axis, axis->claimed());
  }
  return std::nullopt;
}

/// A lease that its holder is not told of is given back.
class Granting {
 public:
  Granting(Leases& leases, std::int32_t number) : leases_(leases), number_(number) {}
  Granting(const Granting&) = delete;
  Granting& operator=(const Granting&) = delete;
  ~Granting() {
    if (!is_done_) leases_.release(number_);
  }
  void is_done() { is_done_ = true; }

 private:
  Leases& leases_;
  std::int32_t number_;
  bool is_done_ = false;
};

}  // namespace

std::int64_t random_epoch() {
  std::array<unsigned char, sizeof(std::uint64_t)> bytes{};
  fill_with_random_bytes(bytes);
  const auto number = std::bit_cast<std::uint64_t>(bytes);
  return static_cast<std::int64_t>(number & tmcl::api::lease::greatest_epoch);
}

awaitable<tmcl::Result<Lease>> Leases::acquire(std::shared_ptr<Leases> self, Client holder,
                                               Axes axes, LeaseTerms terms, Permit permit) {
  for (const auto& axis : axes) {
    auto free = co_await axis->be_free(axis->begin_movement(permit, {}));
    if (!free) co_return tl::unexpected(error_of(*axis, std::move(free.error())));
  }
  // While one of them was looked at, another may have been taken.
  if (auto taken = conflict(axes, holder)) co_return tl::unexpected(std::move(*taken));
  const auto now = self->clock_.now();
  const auto number = ++self->last_number_;
  Lease lease{number, self->new_epoch_(), std::move(holder), std::move(axes), terms,
              now,    now + terms.ttl};
  self->leases_.emplace(number, lease);
  Granting granting(*self, number);
  for (const auto& axis : lease.axes)
    motors_of(*axis).lease(axis->address(), {lease.holder.number, number, lease.holder.name});
  if (!self->watching_) spawn(self->executor_, watch(self));
  self->watching_ = true;
  self->changed_.notify();
  lease.journal_failure = co_await lease.axes.front()->enter_journal();
  granting.is_done();
  co_return lease;
}

/// One for all leases, while there are any.
awaitable<void> Leases::watch(std::shared_ptr<Leases> self) {
  while (!self->leases_.empty()) {
    const auto expires = [](const auto& one) { return one.second.expires; };
    const auto& [number, next] = *std::ranges::min_element(self->leases_, {}, expires);
    if (self->clock_.now() < next.expires) {
      co_await self->changed_.wait_until(next.expires);
    } else {
      self->lose(number, "expired", "was not renewed in time");
    }
  }
  self->watching_ = false;
}

const Lease* Leases::find(std::int32_t number) const {
  const auto found = leases_.find(number);
  return found == leases_.end() ? nullptr : &found->second;
}

Lease Leases::renew(std::int32_t number, tmcl::Duration ttl) {
  tmcl::ensure(leases_.contains(number));
  auto& lease = leases_.at(number);
  lease.terms.ttl = ttl;
  lease.expires = clock_.now() + ttl;
  changed_.notify();
  return lease;
}

void Leases::release(std::int32_t number) {
  const auto found = leases_.find(number);
  if (found == leases_.end()) return;
  for (const auto& axis : found->second.axes) motors_of(*axis).lease(axis->address(), {});
  leases_.erase(found);
  changed_.notify();
}

const Lease* Leases::of(const GatewayAxis& axis) const {
  const auto found = leases_.find(motors_of(axis).holder_of(axis.address()).lease);
  return found == leases_.end() ? nullptr : &found->second;
}

void Leases::break_lease(const GatewayAxis& axis, const std::string& by) {
  if (const auto* lease = of(axis)) lose(lease->number, "broken", "was broken by " + by);
}

void Leases::end_of(std::uint64_t client) {
  const auto is_its = [&](const auto& one) { return one.second.holder.number == client; };
  for (auto one = std::ranges::find_if(leases_, is_its); one != leases_.end();
       one = std::ranges::find_if(leases_, is_its))
    lose(one->first, "closed", "was lost: its holder has gone");
}

void Leases::put_off(tmcl::Duration duration) {
  for (auto& [number, lease] : leases_) lease.expires += duration;
}

void Leases::lose(std::int32_t number, std::string_view reason, const std::string& why) {
  // To tell of it takes memory; to lose it, and to stop its axes, must not wait for that.
  const auto lost = leases_.extract(number);
  const auto& lease = lost.mapped();
  for (const auto& axis : lease.axes) motors_of(*axis).lose_lease(axis->address());
  changed_.notify();
  if (lease.terms.stops)
    for (const auto& axis : lease.axes) stop_(axis);
  for (const auto& axis : lease.axes) {
    auto event = event_of(*axis, GatewayEvent::Kind::lease_lost,
                          "the lease of axis '" + axis->name() + "' by " + lease.holder.name + " " +
                              why + (lease.terms.stops ? ", and it is stopped" : ""));
    event.reason = reason;
    axis->bus().emit(std::move(event));
  }
}

}  // namespace tmcld
