/// How a lease is passed on to the programs that run under it.
#pragma once

#include <optional>

#include "tmcl/api/lease.hpp"

namespace tmclctl {

constexpr const char* lease_variable = "TMCL_LEASE";
constexpr const char* epoch_variable = "TMCL_EPOCH";

/// Nothing unless both variables are whole numbers.
std::optional<tmcl::api::lease::OnLease> lease_from_environment();
/// For the programs that this one starts.
void set_in_environment(const tmcl::api::lease::OnLease& lease);
void clear_in_environment();

}  // namespace tmclctl
