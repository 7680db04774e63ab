#include "held_lease.hpp"

#include "command_line/lease_environment.hpp"

namespace tmclctl {

namespace api = tmcl::api;

Result<HeldLease> HeldLease::take(const std::vector<std::string>& axes, std::int64_t ttl_ms,
                                  Context& context) {
  HeldLease held;
  if (lease_from_environment()) return held;
  auto granted = context.call(api::lease::Acquire{axes, ttl_ms, {}});
  if (!granted) return tl::unexpected(granted.error());
  held.lease_ = std::move(*granted);
  held.renewed_at_ = context.host.now();
  return held;
}

Result<void> HeldLease::renew(Context& context, const tmcl::client::CallOptions& options) {
  const auto now = context.host.now();
  if (!lease_ || now - renewed_at_ < std::chrono::milliseconds(lease_->ttl_ms) / renewals_in_ttl)
    return {};
  renewed_at_ = now;
  api::lease::Renew renewal;
  renewal.lease = lease_->lease;
  renewal.epoch = lease_->epoch;
  return context.call(renewal, options).map([](const auto&) {});
}

Result<void> HeldLease::release(Context& context) const {
  if (!lease_) return {};
  clear_in_environment();
  api::lease::Release release;
  release.lease = lease_->lease;
  release.epoch = lease_->epoch;
  return context.call(release).map([](const auto&) {});
}

void HeldLease::pass_on() const {
  if (lease_) set_in_environment({lease_->lease, lease_->epoch});
}

}  // namespace tmclctl
