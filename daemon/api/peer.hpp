/// Who makes a call, as far as methods need to know: each front has a way to be one.
#pragma once

#include <cstdint>
#include <string_view>

#include <boost/json/object.hpp>

#include "api/caller.hpp"
#include "gateway/authority/leases.hpp"

namespace tmcld {

class Subscriptions;

class Peer {
 public:
  virtual ~Peer() = default;
  /// Sends a notification; never blocks, and drops it rather than keep many for a slow reader.
  virtual void notify(std::string_view method, boost::json::object params) = 0;
  /// An answer will not be read any more.
  virtual bool is_gone() const = 0;
  virtual Subscriptions& subscriptions() = 0;
  /// What moves for it stops when it leaves the gateway: see Gateway::enter().
  virtual Client client() const { return {}; }
  virtual Caller caller() const { return {}; }
};

}  // namespace tmcld
