/// The way to the methods of a gateway, which docs/PROTOCOL.md lists.
#pragma once

#include <functional>
#include <string_view>

#include <boost/json/object.hpp>

#include "failure.hpp"
#include "tmcl/client.hpp"

namespace tmclctl {

struct CallOptions {
  /// Counted anew from each progress report about the call.
  tmcl::Duration timeout = tmcl::client::Options{}.call_timeout;
  /// Asked ten times a second while the call is in progress; it may make other calls. With it, a
  /// signal does not end the call: what becomes of it is decided here.
  std::function<void()> meanwhile{};
};

/// Errors: as values; no member throws. A signal ends whatever waits, with an error of the name
/// tmcl::client::error_name::cancelled.
class Door {
 public:
  using Listener = tmcl::client::Connection::Handler;

  virtual ~Door() = default;
  /// One method and its result. What comes unasked meanwhile goes to the listener.
  virtual Attempt<boost::json::object> call(std::string_view method, boost::json::object params,
                                            CallOptions options = {}) = 0;
  /// Hands out what comes unasked until the time has passed, or at once after the first message.
  virtual Attempt<void> listen(tmcl::Duration at_most) = 0;
  /// At most one listener; an empty one removes it.
  virtual void on_notification(Listener listener) = 0;
};

}  // namespace tmclctl
