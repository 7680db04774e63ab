/// The gateway that a command line names, and what its verb works with.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "fleet/fleet_place.hpp"
#include "host.hpp"
#include "output/errors.hpp"
#include "output/screen.hpp"
#include "tmcl/awaited_file.hpp"
#include "tmcl/client.hpp"
#include "tmcl/units.hpp"
#include "web_socket.hpp"

namespace tmcld {
class LocalChannel;
}

namespace tmclctl {

constexpr std::string_view default_socket = "/run/tmcld/tmcld.sock";

/// Where the axes are, as the command line says it.
struct Where {
  std::string socket;  ///< Empty: $TMCLD_SOCKET, else default_socket.
  WebPlace web{};      ///< A daemon in the network; an empty URL: the socket.
  FleetPlace fleet{};  ///< Many gateways, on a broker; an empty URL: one gateway.
  std::string direct;  ///< Name of a link; empty: through the daemon.
  std::string config;  ///< With a link: the file that says how its axes are called; may be empty.
  std::optional<std::int32_t> reply_timeout_ms;  ///< With a link; nothing: what the file says.
  std::int32_t full_steps = tmcl::MotorSteps{}.full_steps;  ///< Of a turn, without the daemon.
};

/// With which another tmclctl reaches the same axes, such as " --direct can:can0"; may be empty.
std::string options_of(const Where& where);

/// How long is waited for tmcld's socket, or for a serial port, that is not there yet.
constexpr tmcl::Duration usual_wait = tmcl::longest_wait_for_file;
/// The same before a stop: a daemon is not started in order to stop a motor.
constexpr tmcl::Duration wait_before_stop = std::chrono::milliseconds(300);
/// Within a second, the start of the program included, it is said what became of a stop.
constexpr tmcl::Duration time_for_stop = std::chrono::milliseconds(900);

/// Where it is said which axes there are.
enum class AxesFrom : std::uint8_t {
  configuration,
  scan,  ///< Of the one bus: nothing is configured.
};

struct Gateway {
  tmcl::client::Caller caller;
  AxesFrom axes_from = AxesFrom::configuration;
  tmcld::LocalChannel* own = nullptr;  ///< That of the caller, for a gateway in this process.
};

/// `in_all`: how long opening and all calls may take together; nothing: no such bound.
Result<Gateway> open_gateway(const Where& where, tmcl::Duration wait, Host& host,
                             std::optional<tmcl::Duration> in_all = {});

/// What a verb works with.
struct Context {
  Gateway& gateway;
  Output& output;
  Host& host;

  template <tmcl::api::IsMethod Method>
  Result<typename Method::Result> call(const Method& method,
                                       const tmcl::client::CallOptions& options = {}) {
    return gateway.caller.call(method, options);
  }
  /// Lets time pass; a signal ends that early.
  void sleep(tmcl::Duration duration);
};

/// Stays until axes that this process has to watch stand and have their settings back; tells that
/// first, if asked to. Errors: a signal came, and the axes were stopped.
Result<void> wait_for_motion_to_end(Context& context, bool tell);

// ---- the two ways ----

/// A bus without tmcld.
struct OwnBus {
  std::string link;
  std::string config;  ///< File that says how its axes are called; empty: none.
  std::optional<tmcl::Duration> reply_timeout;  ///< Nothing: what the file says, or the usual.
  std::int32_t full_steps;  ///< Of a turn of an axis that no file says more about.
};
/// A gateway in this process; `wait` is for a serial port that is not there yet.
Result<std::unique_ptr<tmcld::LocalChannel>> open_own_gateway(const OwnBus& bus,
                                                              tmcl::Duration wait, Host& host);
/// A running tmcld, which other programs share.
Result<std::unique_ptr<tmcl::client::Channel>> open_daemon(const Where& where,
                                                           tmcl::client::Options options);

}  // namespace tmclctl
