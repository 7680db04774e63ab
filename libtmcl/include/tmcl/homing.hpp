/// Reference searches: how an axis finds its zero.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "tmcl/address.hpp"
#include "tmcl/script.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

struct HomeOptions {
  /// Axis parameter 193, written before the search: 1..8, with 64 or 128 added as the firmware
  /// manuals say; nothing: as it is set. If the module refuses the search, it is set back.
  std::optional<std::int32_t> mode{};
  Duration poll_interval = std::chrono::milliseconds(50);
  /// Gives up with Errc::deadline_passed, and the search goes on; zero: waits as long as it takes.
  /// By the clock, from the beginning of the verb: what has not been asked by then is not asked any
  /// more, and a search that has not been started by then is not started. One that has ended in
  /// time is told, although what it found is read after that.
  Duration timeout{};
  /// Some modules do not answer now and then while they search (TMCM-6110): for so long silence is
  /// no error.
  Duration silence_limit = std::chrono::seconds(3);
  /// Told after each look: what RFS STATUS gave, which is the step of the search, counted from 1.
  /// False ends the waiting, as the timeout does.
  std::function<bool(std::int32_t step)> progress{};
};

struct Homed {
  /// Axis parameter 197: where the axis believed to be at what is zero now. Nothing if the module
  /// does not have it, or the axis does not stand at zero: then the search was stopped.
  std::optional<Microsteps> correction{};
  /// Axis parameter 196: from one end switch to the other, of a search that has visited both (modes
  /// 2, 3, 66 and 67). Nothing of any other, where the module does not have it, or as above.
  std::optional<Microsteps> switch_distance{};
};

namespace verbs {

/// Starts a reference search (RFS START). When the answer is lost, RFS STATUS may settle that it
/// runs; otherwise the error is Outcome::unknown. With a mode, that is set before (HomeOptions).
Script<Result<void>> start_reference_search(AxisAddress axis,
                                            std::optional<std::int32_t> mode = {});
/// Ends a reference search (RFS STOP): the axis ramps down.
Script<Result<void>> stop_reference_search(AxisAddress axis);
/// RFS STATUS: 0 when no search runs, else the step it is in.
Script<Result<std::int32_t>> reference_search_status(AxisAddress axis);

/// Sets the mode, starts a search and waits until the module says that none runs any more. It does
/// not say whether the search was ended by a stop: programs that share the axis must see to that.
/// Errors: those of the exchanges; Errc::deadline_passed after the timeout. With any error that
/// comes after the start, the search goes on.
Script<Result<Homed>> home(AxisAddress axis, HomeOptions options = {});

}  // namespace verbs
}  // namespace tmcl
