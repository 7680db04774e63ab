/// The way to the methods of a gateway, which docs/PROTOCOL.md lists.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "errors.hpp"
#include "host.hpp"
#include "screen.hpp"
#include "tmcl/client.hpp"
#include "web_socket.hpp"

namespace tmclctl {

struct CallOptions {
  /// Counted anew from each progress report about the call. A gateway in this process sees to that
  /// itself.
  tmcl::Duration timeout = tmcl::client::Options{}.call_timeout;
  /// Called ten times a second, at least, while the call is in progress; it may make other calls.
  /// With it, a signal does not end the call: what becomes of it is decided here.
  std::function<void()> meanwhile{};
};

/// Errors: as values; no member throws. A signal ends whatever waits, with an error of the name
/// tmcl::client::error_name::cancelled.
class Door {
 public:
  using Listener = tmcl::client::Connection::Handler;

  virtual ~Door() = default;
  /// One method and its result. What comes unasked meanwhile goes to the listener.
  virtual Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                           CallOptions options = {}) = 0;
  /// The same for a method of tmcl/api.
  template <tmcl::api::IsMethod Method>
  Result<typename Method::Result> call(const Method& params, CallOptions options = {}) {
    return call(Method::method.name, tmcl::api::to_json(params), std::move(options))
        .map(tmcl::api::from_json<typename Method::Result>);
  }
  /// Hands out what comes unasked until the time has passed, or at once after the first message.
  /// Errors: there is nobody any more from whom something could come.
  virtual Result<void> listen(tmcl::Duration at_most) = 0;
  /// A connection that was lost, made anew. Errors: nobody is there; a gateway in this process is
  /// never lost.
  virtual Result<void> reopen() = 0;
  /// At most one listener; an empty one removes it.
  virtual void on_notification(Listener listener) = 0;
  /// Lets time pass; a signal ends that early.
  virtual void sleep(tmcl::Duration duration) = 0;
  /// Stays until axes that somebody has to watch stand and have their settings back; tells that
  /// first, if asked to. Errors: a signal came, and the axes were stopped.
  virtual Result<void> see_through(bool tell, Output& output) = 0;
};

/// To a running tmcld, which other programs share; `wait` is for a socket that is not there yet.
/// `in_all`: from now on so long everything may take, all calls together; nothing: no such bound.
Result<std::unique_ptr<Door>> open_socket(std::string path, tmcl::Duration wait, Host& host,
                                          std::optional<tmcl::Duration> in_all = {});

/// To a tmcld in the network; `in_all` likewise.
Result<std::unique_ptr<Door>> open_url(WebPlace place, Host& host,
                                       std::optional<tmcl::Duration> in_all = {});

/// A bus without tmcld.
struct OwnBus {
  std::string link;
  std::string config;  ///< File that says how its axes are called; empty: none.
  std::optional<tmcl::Duration> reply_timeout;  ///< Nothing: what the file says, or the usual.
  std::int32_t full_steps;  ///< Of a turn of an axis that no file says more about.
};
/// To a gateway in this process; `wait` is for a serial port that is not there yet.
Result<std::unique_ptr<Door>> open_own_gateway(const OwnBus& bus, tmcl::Duration wait, Host& host);

}  // namespace tmclctl
