/// The data logger that some modules have (command 142, RAMDebug): the module records values of
/// its axes at the ticks of its own clock, much faster than a bus could ask for them, and is read
/// afterwards.
///
///     const auto info = co_await must(verbs::data_logger_info(module));
///     const auto setup = plan_capture(info, request);
///     co_await must(verbs::start_capture(module, *setup));
///     // verbs::capture_state() until that is complete, then verbs::read_samples()
///     co_await must(verbs::end_capture(module));
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/ram_debug.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

struct DataLoggerInfo {
  std::uint32_t channels = 0;
  std::uint32_t elements = 0;  ///< Values that its buffer holds, of all channels together.
  std::uint32_t ticks_per_second = 0;
};

struct CaptureChannel {
  ram_debug::Kind kind = ram_debug::Kind::off;
  std::uint32_t select = 0;
  bool operator==(const CaptureChannel&) const = default;
};
/// What GAP reads.
CaptureChannel capture_channel(std::uint8_t motor, std::uint8_t parameter);

struct CaptureTrigger {
  CaptureChannel channel;
  /// The recording begins when the value becomes greater than the threshold, or no longer is.
  ram_debug::Trigger edge = ram_debug::Trigger::rising_signed;
  std::int32_t threshold = 0;
};

/// What is to be recorded.
struct CaptureRequest {
  std::vector<CaptureChannel> channels{};
  std::optional<double> rate_hz{};          ///< As fast as the module can if it is not given.
  std::optional<std::uint32_t> samples{};   ///< Of each channel; otherwise as many as there can be.
  std::optional<CaptureTrigger> trigger{};  ///< Without one it begins at once.
  std::uint32_t pretrigger_percent = 0;     ///< 0..100: how much of it lies before the trigger.
};

struct CaptureSetup {
  std::vector<CaptureChannel> channels{};
  std::uint32_t samples = 0;     ///< Of each channel.
  std::uint32_t pretrigger = 0;  ///< So many of them lie before the trigger.
  std::uint32_t divider = 1;     ///< At every so many ticks each channel has a sample.
  std::optional<CaptureTrigger> trigger{};

  std::uint32_t values() const { return samples * static_cast<std::uint32_t>(channels.size()); }
};

/// Errc::bad_argument for what the module cannot record: the message names what it can.
Result<CaptureSetup> plan_capture(const DataLoggerInfo& info, const CaptureRequest& request);

/// snake_case; part of the stable interface.
std::string_view name_of(ram_debug::State state);

namespace verbs {

/// Errors, besides those of the exchange: Errc::refused_by_module where the module does not have
/// command 142; Errc::unexpected_value where it says that it has no buffer.
Script<Result<DataLoggerInfo>> data_logger_info(ModuleAddress module);
/// Forgets what the module has recorded, and has it record this. What is lost on the way is set up
/// anew from the beginning; that moves nothing. After an error it records nothing, if it can be
/// reached.
/// Errors: also Errc::unexpected_value where it does not begin.
Script<Result<void>> start_capture(ModuleAddress module, CaptureSetup setup);
/// Whether the module records this, or has: channels and what is before the trigger. Rate and
/// length it does not tell.
/// Errors: Errc::unexpected_value if it records nothing, or something else.
Script<Result<void>> match_capture(ModuleAddress module, CaptureSetup setup);
Script<Result<ram_debug::State>> capture_state(ModuleAddress module);
/// Values from this index on, one of each channel after the other.
/// Errors: also Errc::refused_by_module for what is not there: not yet, or no more.
Script<Result<std::vector<std::int32_t>>> read_samples(ModuleAddress module, std::uint32_t first,
                                                       std::uint32_t count);
/// The module records nothing any more, and forgets what it has.
Script<Result<void>> end_capture(ModuleAddress module);

}  // namespace verbs
}  // namespace tmcl
