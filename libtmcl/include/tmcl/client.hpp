/// A connection to a running tmcld, for scripts and small tools: every call waits for its end.
///
///     auto daemon = tmcl::client::Connection::open("/run/tmcld/tmcld.sock");
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
/// docs/PROTOCOL.md says what the methods do. On the wire: JSON-RPC 2.0 on a unix socket, one
/// message a line.
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
#include "tmcl/api/parameter.hpp"
#include "tmcl/awaited_file.hpp"
#include "tmcl/client_error.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::client {

/// What a daemon may come to say at most; a longer line ends the connection.
constexpr std::size_t max_line_bytes = std::size_t{4} << 20U;
constexpr int protocol_major = 1;

struct Options {
  /// How long a socket is waited for that is not there yet, or that nobody listens on yet, in a
  /// directory that exists, and for one at which very many wait. All else is told at once.
  Duration wait_for_socket = longest_wait_for_file;
  Duration hello_timeout = std::chrono::seconds(3);
  /// How long a call may take; counted anew from each progress report that the daemon sends for it.
  Duration call_timeout = std::chrono::seconds(15);
  /// Asked at least ten times a second during a wait or a call; true ends it. For Ctrl-C.
  std::function<bool()> cancelled{};
};

/// What carries the messages of a connection, each in one line of text without its end.
class Channel {
 public:
  virtual ~Channel() = default;
  /// What it leads to, for errors.
  virtual const std::string& name() const = 0;
  virtual Result<void> write_line(std::string line, TimePoint deadline) = 0;
  /// Nothing when the deadline comes first.
  virtual Result<std::optional<std::string>> read_line(TimePoint deadline) = 0;
};

class Axis;

/// Thread safety: none. Errors: as values; no member throws.
class Connection {
 public:
  using Handler = std::function<void(std::string_view method, const boost::json::object& params)>;

  /// Connects, as soon as there is a socket, and reads the daemon's greeting.
  static Result<Connection> open(const std::string& socket_path, Options options = {});
  /// Over a channel that is open; of the options, those about the socket make no difference.
  static Result<Connection> open(std::unique_ptr<Channel> channel, Options options = {});
  Connection(Connection&&) noexcept;
  Connection& operator=(Connection&&) noexcept;
  ~Connection();

  /// One request and its answer. What comes unasked meanwhile goes to the handler.
  /// A call that was sent and not answered has Outcome::unknown.
  Result<boost::json::object> call(std::string_view method, boost::json::object params = {});
  /// The same for a method that takes longer than Options::call_timeout.
  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   Duration timeout);
  /// A method of tmcl/api. What a newer or an older daemon leaves out is as in a new result.
  template <api::IsMethod Method>
  Result<typename Method::Result> call(const Method& params) {
    return call(Method::method.name, api::to_json(params))
        .map(api::from_json<typename Method::Result>);
  }
  template <api::IsMethod Method>
  Result<typename Method::Result> call(const Method& params, Duration timeout) {
    return call(Method::method.name, api::to_json(params), timeout)
        .map(api::from_json<typename Method::Result>);
  }
  /// An axis by its name, or any motor as "BUS:ADDRESS/MOTOR". Nothing is asked yet.
  Axis axis(std::string name);
  /// Hands out what comes unasked until the time has passed, or at once after the first message.
  Result<void> listen(Duration at_most);
  /// At most one handler; an empty one removes it.
  void on_notification(Handler handler);

  /// The version that the daemon gave in its greeting.
  const std::string& daemon_version() const;

 private:
  class State;
  explicit Connection(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// The verbs of one axis. Its connection must outlive it and stay where it is. Errors: those of the
/// daemon, by Error::name; a movement that was answered by an error of Outcome::unknown may
/// have begun.
class Axis {
 public:
  Axis(Connection& daemon, std::string name) : daemon_(daemon), name_(std::move(name)) {}

  /// Starts a move. An amount is a number in the unit of the axis, such as 12.5, or a text with its
  /// unit: "12.5mm", "0.25rev".
  Result<api::axis::StartedMove> move_to(api::Amount position);
  Result<api::axis::StartedMove> move_to(Microsteps position);
  Result<api::axis::StartedMove> move_by(api::Amount distance);
  Result<api::axis::StartedMove> move_by(Microsteps distance);
  /// Turns until it is stopped, or this connection ends; a number is in the unit of the axis per
  /// second.
  Result<api::axis::Turning> rotate(api::Amount velocity);
  /// Overtakes everything; answers when the module has taken it.
  Result<void> stop();
  /// Until it stands at its target, but at most for so long, up to a day; zero: as it takes.
  Result<api::axis::Place> wait(Duration at_most = {});
  /// Searches the reference, likewise. `mode`: axis parameter 193, 1..255; as it is set if absent.
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

  Connection& daemon_;
  std::string name_;
};

inline Axis Connection::axis(std::string name) { return {*this, std::move(name)}; }

}  // namespace tmcl::client
