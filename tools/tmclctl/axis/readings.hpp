/// What axes do, once, again and again, and until they stand.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "connection/gateway.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/conversion.hpp"

namespace tmclctl {

/// What an axis does, and when that was so.
struct AxisReading : tmcl::api::axis::State {
  tmcl::TimePoint taken_at{};
  /// Further parameters, where they were asked for.
  std::vector<tmcl::api::Sample> samples{};
};

Result<AxisReading> state_of(const std::string& axis, Context& context);

/// Told each reading; null when a while went by without one. False ends the watching.
using ReadingHandler = std::function<bool(const AxisReading*)>;
Result<void> watch(const std::string& axis, tmcl::Duration interval,
                   const ReadingHandler& on_reading, Context& context);

/// Warnings about moves with the settings of an axis.
using Warnings = std::vector<std::string>;

/// What is told beside a movement.
struct Beside {
  std::vector<std::string> axes{};        ///< Others; those of the daemon's names.
  std::vector<std::string> parameters{};  ///< Of all axes.
  bool every_look = false;                ///< Also readings that say nothing new.
};

/// For an axis to stand where it was sent.
struct Wait {
  std::string axis;
  tmcl::Microsteps goal;
  tmcl::Duration interval;  ///< Between two readings.
  /// At least shortest_wait; nothing: as long as it takes.
  std::optional<tmcl::Duration> at_most{};
  Beside beside{};
  /// Called four times a second, at least, and may make calls; an error ends the waiting.
  std::function<Result<void>()> meanwhile{};
};
constexpr tmcl::Duration shortest_wait = std::chrono::milliseconds(1);

/// What its settings make of moves, when it stands there and stays. The last reading is of the
/// end, also after an error.
/// Errors: of the exit code not_reached if it will not come there; deadline_passed.
Result<Warnings> wait_for(const Wait& wait,
                          const std::function<void(const AxisReading&)>& on_reading,
                          Context& context);

/// Of who watches several axes; all but `wanted` may be empty. They may make other calls.
struct AxesWatcher {
  std::function<void(const std::string& axis, const AxisReading&)> on_reading;
  /// Of an axis that does not answer when the watching begins; it is watched all the same.
  std::function<void(const std::string& axis, const Error&)> on_error;
  std::function<void(const tmcl::api::Event& event)> on_event;
  std::function<bool()> wanted;  ///< Asked ten times a second; false ends the watching.
};
struct Watched {
  std::vector<std::string> axes;  ///< Empty: those that the configuration names.
  tmcl::Duration interval;
  std::vector<std::string> parameters{};  ///< That are read beside their states.
  bool every_look = false;                ///< Also readings that say nothing new.
};
/// Modules that do not answer do not end it.
Result<void> watch_axes(const Watched& watched, const AxesWatcher& watcher, Context& context);

/// An axis that says nothing for so long while it is watched is asked whether it is still there.
constexpr tmcl::Duration doubtful_silence = std::chrono::seconds(1);
/// How often who watches gets to look at the clock and at signals when nothing changes.
constexpr auto longest_silence = std::chrono::milliseconds(100);

}  // namespace tmclctl
