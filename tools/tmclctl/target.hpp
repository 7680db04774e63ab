/// Axes, modules and what can be asked of them, whichever way they are reached.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "errors.hpp"
#include "host.hpp"
#include "names.hpp"
#include "screen.hpp"
#include "shown.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/awaited_file.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/link.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/quantity.hpp"
#include "tmcl/units.hpp"
#include "tmcl/verbs.hpp"
#include "web_socket.hpp"

namespace tmclctl {

using tmcl::AxisUnits;
using tmcl::Quantity;

/// What the settings of an axis make of moves that nobody may want.
using Warnings = std::vector<std::string>;

struct ModuleRow {
  std::string bus;
  std::uint16_t address = 0;
  std::string model;  ///< Empty if it is not known.
  std::uint16_t model_number = 0;
  std::string firmware;
  std::uint8_t axes = 0;
  bool duplicate_suspected = false;
  std::string state;                 ///< Empty after a scan.
  bool in_bootloader = false;        ///< It answers, but runs no firmware.
  bool address_is_reply_id = false;  ///< On CAN: it takes every reply for a command.
  std::string watched_by{};      ///< Empty after a scan; else tick, variable:N, settings or none.
  boost::json::value deadman{};  ///< Null after a scan; else as module.list has it.
};

struct AxisRow : tmcl::api::axis::Axis {
  std::string why{};  ///< It cannot be reached; empty if nothing is known to be wrong.
};

/// What an axis does, and when that was so.
struct AxisReading : tmcl::api::axis::State {
  tmcl::TimePoint taken_at{};
};

/// A position, a distance or a velocity.
struct Typed {
  std::string text;  ///< A number with its unit, as it was typed.
  /// A number without one is what the module counts, also on an axis with a unit.
  bool internal = false;
};
/// What a module counts.
inline Typed counted(std::int32_t value) { return {std::to_string(value), true}; }
/// Puts it into the parameters of a method: as `name`, or as `plain` if it is what a module counts.
void put(boost::json::object& params, std::string_view name, std::string_view plain,
         const Typed& typed);

struct ScanRange {
  std::uint16_t first = 1;
  std::uint16_t last = 255;
};
struct UnscannedBus {
  std::string bus;
  Error failure;
};
struct ScanResult {
  std::vector<ModuleRow> modules;
  std::vector<UnscannedBus> failed;
};
using Progress = std::function<void(const std::string& bus, std::size_t asked, std::size_t of)>;

struct RawCommand {
  std::string bus;  ///< Empty: the only one there is.
  tmcl::Request request;
};
struct RawAnswer {
  std::string bus;
  tmcl::Framing framing = tmcl::Framing::serial;
  tmcl::Reply reply;
  std::string text;  ///< The firmware version when it came as text.
  std::vector<std::string> warnings{};
};

/// Told what comes while a method runs: the parameters of notify_progress. False ends it.
using NewsHandler = std::function<bool(const boost::json::object& news)>;

/// Told the motors of a module that have just arrived; null when a while went by without any.
/// False ends the waiting.
using ArrivalHandler = std::function<bool(const std::vector<std::uint8_t>* motors)>;

/// Of someone who watches a method that takes long; both may be empty.
struct Watcher {
  std::function<void(const boost::json::object& news)> on_news;  ///< See NewsHandler.
  std::function<void()> meanwhile;  ///< Called ten times a second; may make other calls.
};

/// For an axis to stand where it was sent.
struct Wait {
  std::string axis;
  tmcl::Microsteps goal;
  tmcl::Duration interval;  ///< Between two readings.
  /// At least shortest_wait; nothing: as long as it takes.
  std::optional<tmcl::Duration> at_most{};
};
constexpr tmcl::Duration shortest_wait = std::chrono::milliseconds(1);

struct StoppedAxis {
  std::string axis;
  std::optional<double> milliseconds;
  std::optional<Error> failure;
};

/// Told each reading; null when a while went by without one. False ends the watching.
using ReadingHandler = std::function<bool(const AxisReading*)>;

/// Of somebody who watches several axes; all but `wanted` may be empty. They may make other calls.
struct AxesWatcher {
  std::function<void(const std::string& axis, const AxisReading&)> on_reading;
  /// Of an axis that does not answer when the watching begins; it is watched all the same.
  std::function<void(const std::string& axis, const Error&)> on_failure;
  std::function<void(const boost::json::object& event)> on_event;  ///< What notify_event tells.
  std::function<bool()> wanted;  ///< Asked ten times a second; false ends the watching.
};

/// Errors: as values; no member throws.
class Target {
 public:
  virtual ~Target() = default;

  virtual Result<ScanResult> scan(ScanRange range, const Progress& progress) = 0;
  virtual Result<std::vector<ModuleRow>> modules() = 0;
  virtual Result<std::vector<AxisRow>> axes() = 0;
  virtual Result<std::vector<tmcl::api::parameter::Parameter>> parameters(
      const std::string& axis) = 0;

  virtual Result<tmcl::api::parameter::Held> get(const std::string& axis,
                                                 const std::string& parameter) = 0;
  virtual Result<tmcl::api::parameter::Held> set(const std::string& axis,
                                                 const std::string& parameter,
                                                 const Typed& value) = 0;
  Result<tmcl::api::parameter::Held> set(const std::string& axis, const std::string& parameter,
                                         std::int32_t value) {
    return set(axis, parameter, counted(value));
  }
  virtual Result<AxisUnits> units(const std::string& axis) = 0;
  virtual Result<tmcl::api::axis::StartedMove> move_to(const std::string& axis,
                                                       const Typed& position) = 0;
  virtual Result<tmcl::api::axis::StartedMove> move_by(const std::string& axis,
                                                       const Typed& distance) = 0;
  /// `unattended`: it goes on turning when this program ends.
  virtual Result<tmcl::api::axis::Turning> rotate(const std::string& axis, const Typed& velocity,
                                                  bool unattended) = 0;
  virtual Result<void> stop(const std::string& axis) = 0;
  virtual Result<std::vector<StoppedAxis>> stop_all() = 0;
  virtual Result<AxisReading> state(const std::string& axis) = 0;
  virtual Result<void> watch(const std::string& axis, tmcl::Duration interval,
                             const ReadingHandler& on_reading) = 0;
  /// What its settings make of moves, when it stands there and stays. The last reading is of the
  /// end, whichever.
  /// Errors: of the exit code not_reached if it will not come there; deadline_passed.
  virtual Result<Warnings> wait(const Wait& wait,
                                const std::function<void(const AxisReading&)>& on_reading) = 0;
  /// Those that the configuration names if `axes` is empty. Modules that do not answer do not end
  /// it.
  virtual Result<void> watch_axes(const std::vector<std::string>& axes, tmcl::Duration interval,
                                  const AxesWatcher& watcher) = 0;
  /// After an error that is_away(): looks whether tmcld is there again.
  virtual Result<void> reopen() = 0;
  virtual Result<RawAnswer> raw(const RawCommand& command) = 0;
  virtual Result<tmcl::FirmwareMatch> match_firmware(const ModuleName& module,
                                                     const tmcl::firmware::Image& image) = 0;
  virtual Result<tmcl::FirmwareReport> upload_firmware(const ModuleName& module,
                                                       const tmcl::firmware::Image& image,
                                                       const tmcl::FirmwareOptions& options) = 0;
  /// Hears the arrivals that a module tells of: `ask` lets it do so, once they can be heard.
  virtual Result<void> hear_arrivals(const ModuleName& module,
                                     const std::function<Result<void>()>& ask,
                                     const ArrivalHandler& on_arrival) = 0;
  /// A method by its name, with the parameters and the result that docs/PROTOCOL.md has. Modules
  /// are "address" and, where there are several buses, "bus".
  virtual Result<boost::json::object> perform(const std::string& method, boost::json::object params,
                                              const NewsHandler& on_news) = 0;
  /// A method of tmcl/api.
  template <tmcl::api::IsMethod Method>
  Result<typename Method::Result> perform(const Method& method) {
    return perform(std::string(Method::method.name), tmcl::api::to_json(method), {})
        .map(tmcl::api::from_json<typename Method::Result>);
  }
  /// The same with somebody who watches it; then a signal does not end it. `text` is handed over
  /// first, for methods that take "text" or "bytes"; it may be null.
  virtual Result<boost::json::object> perform_watched(const std::string& method,
                                                      boost::json::object params,
                                                      const std::string* text,
                                                      const Watcher& watcher) = 0;

  /// Lets time pass; a signal ends that early.
  virtual void sleep(tmcl::Duration duration) = 0;
  /// See Door::see_through().
  virtual Result<void> see_through(bool tell, Output& output) = 0;
  /// The options with which another tmclctl reaches the same axes, such as " --direct can:can0";
  /// may be empty.
  virtual std::string options() const = 0;
};

constexpr std::string_view default_socket = "/run/tmcld/tmcld.sock";

/// Where the axes are, as the command line says it.
struct Where {
  std::string socket;  ///< Empty: $TMCLD_SOCKET, else default_socket.
  WebPlace web{};      ///< A daemon in the network; an empty URL: the socket.
  std::string direct;  ///< Name of a link; empty: through the daemon.
  std::string config;  ///< With a link: the file that says how its axes are called; may be empty.
  std::optional<std::int32_t> reply_timeout_ms;  ///< With a link; nothing: what the file says.
  std::int32_t full_steps = tmcl::MotorSteps{}.full_steps;  ///< Of a turn, without the daemon.
};

/// How long is waited for tmcld's socket, or for a serial port, that is not there yet.
constexpr tmcl::Duration usual_wait = tmcl::longest_wait_for_file;
/// The same before a stop: nobody starts a daemon in order to stop a motor.
constexpr tmcl::Duration wait_before_stop = std::chrono::milliseconds(300);
/// Within a second, the start of the program included, it is said what became of a stop.
constexpr tmcl::Duration time_for_stop = std::chrono::milliseconds(900);

/// `in_all`: see open_socket().
Result<std::unique_ptr<Target>> open_target(const Where& where, tmcl::Duration wait, Host& host,
                                            std::optional<tmcl::Duration> in_all = {});

}  // namespace tmclctl
