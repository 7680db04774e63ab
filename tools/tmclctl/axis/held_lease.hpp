/// The lease that a verb has while it moves axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "connection/gateway.hpp"
#include "tmcl/api/lease.hpp"

namespace tmclctl {

/// So that one renewal may fail to come through in time.
constexpr int renewals_in_ttl = 4;

class HeldLease {
 public:
  /// Takes none where this program runs under one: 'lease run'.
  static Result<HeldLease> take(const std::vector<std::string>& axes, std::int64_t ttl_ms,
                                Context& context);

  /// When it is due. Errors: the lease is lost.
  Result<void> renew(Context& context, const tmcl::client::CallOptions& options = {});
  /// The axes are stopped. Programs that are started from now on have no lease.
  Result<void> release(Context& context) const;
  /// The programs that this one starts move the axes under it.
  void pass_on() const;

 private:
  std::optional<tmcl::api::lease::Granted> lease_;
  tmcl::TimePoint renewed_at_{};
};

}  // namespace tmclctl
