/// Leases: the right of one client alone to move some axes, for as long as it says that it is
/// there.
///
///     granted ──renewed in time──▶ granted ──released──▶ over
///                                     └──time over, connection closed, broken──▶ lost
///
/// When a lease is lost its axes are stopped, unless it says otherwise, and no call that came in
/// before has the right to move them any more. Who may move a motor is asked where a request goes
/// out: see Motors. Does no I/O but those stops. Thread safety: none.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "async/wake.hpp"
#include "gateway/authority/claim.hpp"

namespace tmcld {

/// Who makes calls.
struct Client {
  std::uint64_t number = 0;  ///< By which the gateway knows it; 0: no client.
  std::string name;          ///< For people: "process 4711".
};

struct LeaseTerms {
  tmcl::Duration ttl{};
  bool stops = true;  ///< Its axes, when it is lost.
};

struct Lease {
  std::int32_t number = 0;
  /// A random number that only its holder is told: no other client can guess it, and none
  /// remembers it from before a restart.
  std::int64_t epoch = 0;
  Client holder{};
  std::vector<std::shared_ptr<GatewayAxis>> axes{};
  LeaseTerms terms{};
  tmcl::TimePoint since{};
  tmcl::TimePoint expires{};
  std::string
      journal_failure{};  ///< Why the journal did not say that it is there; empty if it did.
};

using NewEpoch = std::function<std::int64_t()>;
/// One of 2^53, from the random numbers of the system.
std::int64_t random_epoch();

class Leases : public std::enable_shared_from_this<Leases> {
 public:
  using StopAxis = std::function<void(const std::shared_ptr<GatewayAxis>& axis)>;

  /// `stop` begins to stop an axis, and sees to it that it stands at last.
  Leases(const boost::asio::any_io_executor& executor, NewEpoch new_epoch, StopAxis stop)
      : executor_(executor),
        clock_(executor),
        changed_(executor),
        stop_(std::move(stop)),
        new_epoch_(std::move(new_epoch)) {}

  /// All of the axes, or none. Errors: Errc::leased, and those of GatewayAxis::be_free(); `axis`
  /// says which.
  static boost::asio::awaitable<tmcl::Result<Lease>> acquire(
      std::shared_ptr<Leases> self, Client holder, std::vector<std::shared_ptr<GatewayAxis>> axes,
      LeaseTerms terms, Permit permit);
  /// Null if there is none.
  const Lease* find(std::int32_t number) const;
  /// From now on for its time. The lease must be there.
  Lease renew(std::int32_t number, tmcl::Duration ttl);
  /// Its holder does not need it any more: no loss. Nothing happens if there is none.
  void release(std::int32_t number);
  /// Of an axis; null if it has none.
  const Lease* of(const GatewayAxis& axis) const;
  /// Takes the lease of an axis away from its holder; nothing happens if it has none.
  void break_lease(const GatewayAxis& axis, const std::string& by);
  /// The client has gone. Its leases are lost.
  void end_of(std::uint64_t client);
  /// Lets all of them run out so much later: for a time in which no holder can renew one.
  void put_off(tmcl::Duration duration);
  const std::map<std::int32_t, Lease>& all() const { return leases_; }

 private:
  static boost::asio::awaitable<void> watch(std::shared_ptr<Leases> self);
  void lose(std::int32_t number, std::string_view reason, const std::string& why);

  boost::asio::any_io_executor executor_;
  tmcl::ContextClock clock_;
  Wake changed_;
  StopAxis stop_;
  bool watching_ = false;
  std::map<std::int32_t, Lease> leases_;
  std::int32_t last_number_ = 0;
  NewEpoch new_epoch_;
};

}  // namespace tmcld
