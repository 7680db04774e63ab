// Recording in a module, and reading what it has recorded.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/data_logger.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl {
namespace {

using ram_debug::Kind;
using ram_debug::State;
using ram_debug::Trigger;
using ram_debug::Type;

constexpr unsigned motor_shift = 24;
constexpr double percent = 100;

// ---- What a module can record

constexpr int digits_of_rate = 6;
constexpr double as_written = 1e-5;

std::string in_hz(double rate) { return plain_number(rate, digits_of_rate) + " Hz"; }

Error no_such_rate(double rate_hz, double ticks_per_second) {
  const auto hint = fmt::format(
      "the module samples at {0} divided by a whole number, such as {0}, {1} or {2}",
      in_hz(ticks_per_second), in_hz(ticks_per_second / 2), in_hz(ticks_per_second / 3));
  if (!(rate_hz > 0)) return bad_argument(in_hz(rate_hz) + " is no rate", hint);
  const auto divider = ticks_per_second / rate_hz;
  if (divider < 1) {
    return bad_argument(fmt::format("{} is faster than the module can: {}", in_hz(rate_hz),
                                    in_hz(ticks_per_second)),
                        hint);
  }
  return bad_argument(
      fmt::format("the module cannot sample at {}; the nearest that it can are {} and {}",
                  in_hz(rate_hz), in_hz(ticks_per_second / std::ceil(divider)),
                  in_hz(ticks_per_second / std::floor(divider))),
      hint);
}

Result<std::uint32_t> divider_for(double rate_hz, double ticks_per_second) {
  constexpr double greatest = UINT32_MAX;
  const auto divider = ticks_per_second / rate_hz;
  const auto whole = std::round(divider);
  const bool fits = whole >= 1 && whole <= greatest;
  if (!fits || std::abs(divider - whole) > as_written * whole)
    return tl::unexpected(no_such_rate(rate_hz, ticks_per_second));
  return static_cast<std::uint32_t>(whole);
}

Result<std::uint32_t> samples_for(const DataLoggerInfo& info, const CaptureRequest& request) {
  const auto channels = static_cast<std::uint32_t>(request.channels.size());
  if (channels == 0 || channels > info.channels) {
    return tl::unexpected(bad_argument(
        fmt::format("{} channels are to be recorded, and the module can record 1 to {}", channels,
                    info.channels)));
  }
  const auto most = info.elements / channels;
  const auto samples = request.samples.value_or(most);
  if (samples >= 1 && samples <= most) return samples;
  return tl::unexpected(bad_argument(
      fmt::format("{} samples of each channel are {} values, and the buffer of the module holds "
                  "{}: 1 to {} samples of each",
                  samples, std::uint64_t{samples} * channels, info.elements, most),
      "record fewer samples, fewer channels, or at a lower rate"));
}

}  // namespace

CaptureChannel capture_channel(std::uint8_t motor, std::uint8_t parameter) {
  return {Kind::axis_parameter, std::uint32_t{motor} << motor_shift | parameter};
}

Result<CaptureSetup> plan_capture(const DataLoggerInfo& info, const CaptureRequest& request) {
  const double ticks_per_second = info.ticks_per_second;
  const auto samples = samples_for(info, request);
  if (!samples) return tl::unexpected(samples.error());
  const auto divider = divider_for(request.rate_hz.value_or(ticks_per_second), ticks_per_second);
  if (!divider) return tl::unexpected(divider.error());
  if (request.pretrigger_percent > 0 && !request.trigger)
    return tl::unexpected(bad_argument("without a trigger nothing lies before it"));
  if (request.pretrigger_percent > static_cast<std::uint32_t>(percent))
    return tl::unexpected(
        bad_argument(fmt::format("{} % is more than there is", request.pretrigger_percent)));
  // The last sample belongs to the trigger: a buffer that is full before it would begin anew.
  const auto before = std::lround(*samples * (request.pretrigger_percent / percent));
  const auto pretrigger = std::min(static_cast<std::uint32_t>(before), *samples - 1);
  return CaptureSetup{request.channels, *samples, pretrigger, *divider, request.trigger};
}

std::string_view name_of(State state) {
  switch (state) {
    case State::idle: return "idle";
    case State::trigger: return "trigger";
    case State::capture: return "capture";
    case State::complete: return "complete";
    case State::pretrigger: return "pretrigger";
    case State::error: break;
  }
  return "error";
}

namespace verbs {
namespace {

// A datagram goes out when the one before it is answered; more than a few would only keep others
// waiting.
constexpr std::uint32_t samples_at_once = 16;
constexpr unsigned most_attempts = 3;
constexpr std::uint32_t most_places = ram_debug::trigger_index;

Request request_of(ModuleAddress module, Type type, std::uint8_t index = 0,
                   std::uint32_t value = 0) {
  return {module, Command::RAM_DEBUG, static_cast<std::uint8_t>(type), index,
          static_cast<std::int32_t>(value)};
}

Error no_data_logger(ModuleAddress module, Error refusal) {
  refusal.message =
      fmt::format("module {} has no data logger: it does not know command 142", number(module));
  refusal.hint =
      "few modules have one, and no manual says which; a simulated one has it with data_logger = "
      "true in its bench file";
  return refusal;
}

Error unexpected(ModuleAddress module, std::string_view what, std::string hint = {}) {
  Error error;
  error.code = Errc::unexpected_value;
  error.outcome = Outcome::done;
  error.message = fmt::format("module {} {}", number(module), what);
  error.hint = std::move(hint);
  return error;
}

Script<Result<std::uint32_t>> ask_logger(Request request) {
  const auto value = co_await must(ask(request));
  co_return static_cast<std::uint32_t>(value);
}

Script<Result<std::uint32_t>> info(ModuleAddress module, ram_debug::Info what) {
  return ask_logger(request_of(module, Type::get_info, 0, static_cast<std::uint32_t>(what)));
}

std::vector<Request> requests_of(ModuleAddress module, const CaptureSetup& setup) {
  const auto channels = static_cast<std::uint32_t>(setup.channels.size());
  std::vector<Request> requests{request_of(module, Type::init),
                                request_of(module, Type::set_sample_count, 0, setup.values()),
                                request_of(module, Type::set_prescaler, 0, setup.divider - 1)};
  const auto add = [&](Type type, std::uint8_t index, std::uint32_t value) {
    requests.push_back(request_of(module, type, index, value));
  };
  for (const auto& channel : setup.channels)
    add(Type::set_channel, static_cast<std::uint8_t>(channel.kind), channel.select);
  add(Type::set_pretrigger_sample_count, 0, setup.pretrigger * channels);
  auto edge = Trigger::unconditional;
  std::int32_t threshold = 0;
  if (const auto& trigger = setup.trigger) {
    edge = trigger->edge;
    threshold = trigger->threshold;
    const auto kind = static_cast<std::uint8_t>(trigger->channel.kind);
    add(Type::set_trigger_channel, kind, trigger->channel.select);
  }
  add(Type::enable_trigger, static_cast<std::uint8_t>(edge), static_cast<std::uint32_t>(threshold));
  return requests;
}

// That a trigger is not enabled no status says.
Script<Result<void>> set_up(ModuleAddress module, CaptureSetup setup) {
  for (const auto& request : requests_of(module, setup)) co_await must(act(request));
  const auto state = co_await must(capture_state(module));
  if (state == State::idle) {
    co_return tl::unexpected(unexpected(module, "does not begin to record",
                                        "its firmware may not have this kind of trigger"));
  }
  co_return Result<void>{};
}

// A channel that may have been set is not set again: it would take the next place.
bool is_in_doubt(const Result<void>& result) {
  return !result && result.error().outcome == Outcome::unknown && is_silence(result.error());
}

Script<Result<CaptureChannel>> channel_at(ModuleAddress module, std::uint8_t place) {
  const auto kind = co_await must(ask_logger(request_of(module, Type::get_channel_type, place)));
  const auto select =
      co_await must(ask_logger(request_of(module, Type::get_channel_address, place)));
  co_return CaptureChannel{static_cast<Kind>(kind), select};
}

/// The channels of a module, as far as they are in use.
Script<Result<std::vector<CaptureChannel>>> channels_of(ModuleAddress module) {
  const auto most = co_await must(info(module, ram_debug::Info::channels));
  std::vector<CaptureChannel> channels;
  for (std::uint32_t i = 0; i < std::min(most, most_places); ++i) {
    const auto channel = co_await must(channel_at(module, static_cast<std::uint8_t>(i)));
    if (channel.kind == Kind::off) break;
    channels.push_back(channel);
  }
  co_return channels;
}

Error no_sample(ModuleAddress module, std::uint32_t index, Error refusal) {
  if (refusal.status != Status::maximum_exceeded) return refusal;
  refusal.message = fmt::format("module {} has no sample {}", number(module), index);
  refusal.hint =
      "it has not recorded so many yet, or what it had is gone: it has started again, or another "
      "host "
      "has begun another capture";
  return refusal;
}

}  // namespace

Script<Result<DataLoggerInfo>> data_logger_info(ModuleAddress module) {
  auto channels = co_await info(module, ram_debug::Info::channels);
  if (!channels && is_unknown_command(channels.error()))
    co_return tl::unexpected(no_data_logger(module, std::move(channels.error())));
  if (!channels) co_return tl::unexpected(std::move(channels.error()));
  const auto elements = co_await must(info(module, ram_debug::Info::elements));
  const auto ticks = co_await must(info(module, ram_debug::Info::base_frequency));
  const DataLoggerInfo found{*channels, elements, ticks};
  if (found.channels == 0 || found.elements < found.channels || found.ticks_per_second == 0)
    co_return tl::unexpected(unexpected(module, "says that it has a data logger without room"));
  co_return found;
}

Script<Result<void>> start_capture(ModuleAddress module, CaptureSetup setup) {
  auto result = co_await set_up(module, setup);
  for (unsigned attempt = 1; attempt < most_attempts && is_in_doubt(result); ++attempt)
    result = co_await set_up(module, setup);
  if (is_in_doubt(result)) co_await end_capture(module);
  co_return result;
}

Script<Result<void>> match_capture(ModuleAddress module, CaptureSetup setup) {
  const auto state = co_await must(capture_state(module));
  if (state == State::idle) co_return tl::unexpected(unexpected(module, "records nothing"));
  const auto other = [&](std::string_view what) {
    return tl::unexpected(unexpected(module, fmt::format("records something else: {}", what)));
  };
  const auto recorded = co_await must(channels_of(module));
  if (recorded != setup.channels) co_return other("other channels");
  const auto channels = static_cast<std::uint32_t>(setup.channels.size());
  const auto before =
      co_await must(ask_logger(request_of(module, Type::get_pretrigger_sample_count)));
  if (before != setup.pretrigger * channels)
    co_return other(fmt::format("{} values before the trigger", before));
  co_return Result<void>{};
}

Script<Result<State>> capture_state(ModuleAddress module) {
  const auto number = co_await must(ask_logger(request_of(module, Type::get_state)));
  co_return number > static_cast<std::uint32_t>(State::error) ? State::error
                                                              : static_cast<State>(number);
}

Script<Result<std::vector<std::int32_t>>> read_samples(ModuleAddress module, std::uint32_t first,
                                                       std::uint32_t count) {
  std::vector<std::int32_t> samples;
  while (samples.size() < count) {
    const auto done = static_cast<std::uint32_t>(samples.size());
    std::vector<step::Exchange> reads;
    for (auto i = done; i < std::min(count, done + samples_at_once); ++i)
      reads.push_back({request_of(module, Type::get_sample, 0, first + i), {}});
    const auto answers = co_await exchange_all(std::move(reads));
    for (const auto& answer : answers) {
      const auto index = first + static_cast<std::uint32_t>(samples.size());
      if (!answer) co_return tl::unexpected(no_sample(module, index, answer.error()));
      samples.push_back(answer->reply.value);
    }
  }
  co_return samples;
}

Script<Result<void>> end_capture(ModuleAddress module) {
  return act(request_of(module, Type::init));
}

}  // namespace verbs
}  // namespace tmcl
