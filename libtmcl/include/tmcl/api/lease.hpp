/// Leases: the right of one client alone to move some axes.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::lease {

constexpr std::string_view lease_summary = "number of the lease";
constexpr std::string_view epoch_summary =
    "what lease.acquire gave with it; only its holder knows that";
/// What every reader of JSON takes as a whole number.
constexpr std::int64_t greatest_epoch = (std::int64_t{1} << 53) - 1;
constexpr std::int64_t shortest_ttl_ms = 200;
constexpr std::int64_t longest_ttl_ms = 60'000;
constexpr std::int64_t usual_ttl_ms = 2'000;

struct Granted {
  TMCL_STRUCT(Granted);
  TMCL_FIELD(std::int32_t, lease, lease_summary);
  TMCL_FIELD(std::int64_t, epoch, "proves that a call is made under this lease");
  TMCL_FIELD(std::vector<std::string>, axes, "its axes");
  TMCL_FIELD(std::int64_t, ttl_ms, "how soon it has to be renewed");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings,
             "that its axes are not stopped if tmcld is killed, and why; null if they are");
};
struct Acquire {
  TMCL_METHOD("lease.acquire", writes, Granted,
              "gives the client the right to move some axes alone: all of them, or none", Acquire);
  TMCL_FIELD(std::vector<std::string>, axes, "names of the axes");
  TMCL_FIELD(std::optional<std::int64_t>, ttl_ms,
             "it ends if it is not renewed so soon; 2000 if absent",
             {shortest_ttl_ms, longest_ttl_ms});
  TMCL_FIELD(std::optional<std::string>, on_loss,
             "stop: its axes are stopped when it is lost; keep: they are not; stop if absent");
};

struct OnLease {
  TMCL_STRUCT(OnLease);
  TMCL_FIELD(std::int32_t, lease, lease_summary);
  TMCL_FIELD(std::int64_t, epoch, epoch_summary, {0, greatest_epoch});
};
struct Renew : OnLease {
  TMCL_METHOD("lease.renew", writes, Granted, "says that its holder is still there", Renew,
              OnLease);
  TMCL_FIELD(std::optional<std::int64_t>, ttl_ms,
             "how soon it has to be renewed again; as before if absent",
             {shortest_ttl_ms, longest_ttl_ms});
};
struct Release : OnLease {
  TMCL_METHOD("lease.release", stops, Nothing, "ends it, once its axes have taken a stop", Release,
              OnLease);
  TMCL_FIELD(std::optional<bool>, stop, "whether its axes are stopped; true if absent");
};

struct Lease {
  TMCL_STRUCT(Lease);
  TMCL_FIELD(std::int32_t, lease, lease_summary);
  TMCL_FIELD(std::vector<std::string>, axes, "its axes");
  TMCL_FIELD(std::string, holder, "who has it");
  TMCL_FIELD(double, since_s, "for how long");
  TMCL_FIELD(std::int64_t, expires_ms, "when it ends unless it is renewed");
};
struct Leases {
  TMCL_STRUCT(Leases);
  TMCL_FIELD(std::vector<Lease>, leases, "the leases there are");
};
struct List {
  TMCL_METHOD("lease.list", reads, Leases, "who may move which axes alone", List);
};
struct Break {
  TMCL_METHOD("lease.break", writes, Nothing,
              "takes the lease of an axis away, as if its time were over", Break);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
};

}  // namespace tmcl::api::lease
