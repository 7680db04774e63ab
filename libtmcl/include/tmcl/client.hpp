/// A gateway's methods, for scripts and small tools: every call waits for its end.
///
///     auto daemon = tmcl::client::Caller::open("/run/tmcld/tmcld.sock");
///     if (!daemon) return complain(daemon.error().message);
///     auto x = daemon->axis("x");
///     auto moved = x.move_to("12.5mm");
///     if (moved) std::cout << "there in " << moved->predicted_s.value_or(0) << " s\n";
///     auto stands = x.wait();
///
/// Every other method is a struct of tmcl/api/*.hpp, and its result is another:
///
///     auto buses = daemon->call(tmcl::api::bus::List{});
///
/// docs/PROTOCOL.md says what the methods do. A Caller works over a Channel: a unix socket, a
/// WebSocket, or a gateway in the same process. On sockets: JSON-RPC 2.0, one message a line.
#pragma once

#include "tmcl/language.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/json/object.hpp>

#include "tmcl/api/axis.hpp"
#include "tmcl/api/lease.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/awaited_file.hpp"
#include "tmcl/client_error.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::client {

/// What a daemon may come to say at most; a longer line ends the connection.
constexpr std::size_t max_line_bytes = std::size_t{4} << 20U;
constexpr int protocol_major = 1;

struct Options {
  /// How long a socket is waited for that is not there yet, or that no process listens on yet, in a
  /// directory that exists, and for one at which very many wait. All else is told at once.
  Duration wait_for_socket = longest_wait_for_file;
  Duration hello_timeout = std::chrono::seconds(3);
  /// How long a call may take; counted anew from each progress report that the daemon sends for it.
  Duration call_timeout = std::chrono::seconds(15);
  /// How long opening and all calls may take together; nothing: no such bound.
  std::optional<Duration> time_in_all{};
  /// Asked at least ten times a second during a wait or a call; true ends it. For Ctrl-C.
  std::function<bool()> cancelled{};
};

struct CallOptions {
  /// Instead of Options::call_timeout. A gateway in this process sees to that itself.
  std::optional<Duration> timeout{};
  /// Called ten times a second, at least, while the call is in progress; it may make other calls.
  /// With it, Options::cancelled does not end the call.
  std::function<void()> meanwhile{};
};

/// A way to the methods of a gateway. Thread safety: none. Errors: as values; no member throws.
class Channel {
 public:
  using Listener = std::function<void(std::string_view method, const boost::json::object& params)>;

  virtual ~Channel() = default;
  /// One request and its answer. What comes unasked meanwhile goes to the listener. A call that
  /// was sent and not answered has Outcome::unknown.
  virtual Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                           const CallOptions& options) = 0;
  /// Hands out what comes unasked until the time has passed, or at once after the first message.
  virtual Result<void> listen(Duration at_most) = 0;
  /// At most one listener; an empty one removes it.
  virtual void on_notification(Listener listener) = 0;
  /// A connection that was lost, made anew; a gateway in this process is never lost.
  virtual Result<void> reopen() = 0;
  /// The version of the gateway.
  virtual std::string version() const = 0;
};

/// What carries the messages of a socket, each in one line of text without its end.
class LineChannel {
 public:
  virtual ~LineChannel() = default;
  /// What it leads to, for errors.
  virtual const std::string& name() const = 0;
  virtual Result<void> write_line(std::string line, TimePoint deadline) = 0;
  /// Nothing when the deadline comes first.
  virtual Result<std::optional<std::string>> read_line(TimePoint deadline) = 0;
};

/// How a line channel is opened: at first, after a loss, and for calls meanwhile.
using OpenLines = std::function<Result<std::unique_ptr<LineChannel>>(const Options& options)>;
/// JSON-RPC over it, once the daemon has greeted.
Result<std::unique_ptr<Channel>> open_channel(OpenLines open, Options options = {});
/// The same over a unix socket.
Result<std::unique_ptr<Channel>> open_channel(std::string socket_path, Options options = {});

class Axis;

/// Makes calls over a channel. Thread safety: none. Errors: as values; no member throws.
class Caller {
 public:
  explicit Caller(std::unique_ptr<Channel> channel) : channel_(std::move(channel)) {}
  /// Connects to a unix socket, as soon as there is one, and reads the daemon's greeting.
  static Result<Caller> open(std::string socket_path, Options options = {});

  Result<boost::json::object> call(std::string_view method, boost::json::object params = {},
                                   const CallOptions& options = {});
  /// A method of tmcl/api. What a newer or an older daemon leaves out is as in a new result.
  template <api::IsMethod Method>
  Result<typename Method::Result> call(const Method& params, const CallOptions& options = {}) {
    return call(Method::method.name, api::to_json(params), options)
        .map(api::from_json<typename Method::Result>);
  }
  /// An axis by its name, or any motor as "BUS:ADDRESS/MOTOR". Nothing is asked yet.
  Axis axis(std::string name);
  /// From now on all calls are made under this lease.
  void use_lease(const api::lease::OnLease& lease) { lease_ = lease; }

  /// As of Channel.
  Result<void> listen(Duration at_most) { return channel_->listen(at_most); }
  void on_notification(Channel::Listener listener) {
    channel_->on_notification(std::move(listener));
  }
  Result<void> reopen() { return channel_->reopen(); }
  std::string version() const { return channel_->version(); }

 private:
  std::unique_ptr<Channel> channel_;
  std::optional<api::lease::OnLease> lease_;
};

/// Hears one kind of notification, a struct of tmcl/api, for as long as it lives.
template <api::Described News>
class Hearing {
 public:
  Hearing(Caller& caller, std::string_view notification, std::function<void(const News&)> handler)
      : caller_(caller) {
    caller_.on_notification([notification, handler = std::move(handler)](
                                std::string_view method, const boost::json::object& params) {
      if (method == notification) handler(api::from_json<News>(params));
    });
  }
  ~Hearing() { caller_.on_notification({}); }
  Hearing(const Hearing&) = delete;
  Hearing& operator=(const Hearing&) = delete;

 private:
  Caller& caller_;
};

/// The verbs of one axis. Its caller must outlive it and stay where it is. Errors: those of the
/// daemon, by Error::name; a movement that was answered by an error of Outcome::unknown may
/// have begun.
class Axis {
 public:
  Axis(Caller& caller, std::string name) : caller_(caller), name_(std::move(name)) {}

  /// Starts a move. An amount is a number in the unit of the axis, such as 12.5, or a text with its
  /// unit: "12.5mm", "0.25rev".
  Result<api::axis::StartedMove> move_to(api::Amount position);
  Result<api::axis::StartedMove> move_to(Microsteps position);
  Result<api::axis::StartedMove> move_by(api::Amount distance);
  Result<api::axis::StartedMove> move_by(Microsteps distance);
  /// Turns until it is stopped, or its connection ends; a number is in the unit of the axis per
  /// second.
  Result<api::axis::Turning> rotate(api::Amount velocity);
  /// Overtakes everything; answers when the module has taken it.
  Result<void> stop();
  /// Until it stands at its target, but at most for so long, up to a day; zero: as it takes.
  Result<api::axis::Place> wait(Duration at_most = {});
  /// Searches the reference. `mode`: axis parameter 193, 1..255; as it is set if absent.
  Result<api::axis::HomedAxis> home(std::optional<std::uint8_t> mode = {}, Duration at_most = {});
  Result<api::axis::State> state();
  Result<api::axis::Units> units();
  /// A parameter by its standard name or its number.
  Result<api::parameter::Value> get(api::NameOrNumber parameter);
  Result<api::parameter::Value> set(api::NameOrNumber parameter, std::int32_t value);
  Result<api::parameter::Value> set(api::NameOrNumber parameter, api::Amount value);

 private:
  template <class Method>
  Result<typename Method::Result> call_in_time(Method params, Duration at_most);

  Caller& caller_;
  std::string name_;
};

inline Axis Caller::axis(std::string name) { return {*this, std::move(name)}; }

}  // namespace tmcl::client
