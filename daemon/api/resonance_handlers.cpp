// How the load of an axis swings: a small move, and what the encoder does after it.
#include "api/resonance_handlers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "api/beside_journeys.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/with_peer.hpp"
#include "tmcl/data_logger.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/plan/ring_down.hpp"
#include "tmcl/readings_at_rest.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace ap = tmcl::axis_parameter;
namespace plan = tmcl::plan;
using plan::RingDown;

constexpr std::int32_t usual_full_steps = 50;
constexpr std::int32_t most_full_steps = 1000;
constexpr std::chrono::milliseconds usual_listening{1000};
constexpr tmcl::Duration beyond_arrival = std::chrono::seconds(2);
constexpr tmcl::Duration longest_move = std::chrono::seconds(60);

/// What is known of the axis before it moves.
struct Start {
  std::uint8_t encoder = 0;  ///< The parameter.
  std::int32_t counted = 0;
  tmcl::Microsteps position;
  tmcl::Microsteps distance;
};

/// The encoder of the motor, or else one beside it.
Task<std::uint8_t> encoder_of(const GatewayAxis& axis) {
  for (const auto* name : {"encoder_position", "external_encoder_position"}) {
    if (const auto* row = find_parameter(axis.parameters(), name)) co_return row->number;
  }
  co_return param_error<&axis::Resonance::axis>(
      "no_encoder",
      "the module of axis " + axis.name() + " has no encoder, and nothing else tells " +
          "how its load swings",
      "measure it otherwise, and say it: 'tmclctl ramp --compare --resonance HZ'");
}

Task<tmcl::Microsteps> way_to_measure_by(GatewayAxis& axis, const axis::Resonance& params) {
  const auto resolution = co_await must(axis.get(ap::microstep_resolution, {}), axis);
  const auto full_step = 1 << std::clamp(resolution, 0, tmcl::max_microstep_resolution);
  if (!params.distance && !params.distance_microsteps)
    co_return tmcl::Microsteps{usual_full_steps * full_step};
  const auto said = co_await must(distance_of(
      axis,
      raw_or_quantity<&axis::Resonance::distance_microsteps, &axis::Resonance::distance>(params)));
  const auto most = most_full_steps * full_step;
  const auto size = std::abs(std::int64_t{said.microsteps.value});
  if (size >= 1 && size <= most) co_return said.microsteps;
  co_return param_error<&axis::Resonance::distance>(
      "out_of_range",
      fmt::format("a move to measure by is 1 to {} microsteps, {} full steps, not {}", most,
                  most_full_steps, size));
}

/// Errors: it moves.
Task<Start> start_of(GatewayAxis& axis, const axis::Resonance& params) {
  Start start;
  start.encoder = co_await must(encoder_of(axis));
  start.distance = co_await must(way_to_measure_by(axis, params));
  const auto reading = co_await must(axis.read_state(), axis);
  if (reading.state.velocity.value != 0) {
    co_await refuse(
        not_now("moving", "axis " + axis.name() + " moves; a load is measured by a move from rest",
                "axis.stop stops it"));
  }
  start.position = reading.state.position;
  start.counted = co_await must(axis.get(start.encoder, {}), axis);
  co_return start;
}

tmcl::Duration listening_of(const axis::Resonance& params) {
  return std::chrono::milliseconds(params.listen_ms.value_or(usual_listening.count()));
}

tmcl::RestReadings wanted_of(const Start& start, const StartedMove& moved,
                             const axis::Resonance& params) {
  tmcl::RestReadings wanted;
  wanted.parameter = start.encoder;
  wanted.most = plan::most_ring_down_positions;
  wanted.span = listening_of(params);
  if (moved.predicted) {
    wanted.expected = std::min(*moved.predicted, longest_move);
    wanted.timeout = wanted.expected + beyond_arrival;
  }
  return wanted;
}

std::vector<plan::PositionAt> positions_of(const std::vector<tmcl::ReadingAt>& readings) {
  std::vector<plan::PositionAt> positions;
  for (const auto& [at, value] : readings)
    positions.push_back({tmcl::seconds(at - readings.front().at), static_cast<double>(value)});
  return positions;
}

// ---- what the module records by itself

struct Recording {
  tmcl::CaptureSetup setup;
  double ticks_per_second = 0;
  std::int32_t number = 0;

  double interval_s() const { return setup.divider / ticks_per_second; }
};

/// From where the motor stands on: so many samples as are looked at, and as fast as that allows.
tmcl::Result<tmcl::CaptureSetup> setup_of(const tmcl::DataLoggerInfo& info, std::uint8_t motor,
                                          const Start& start, tmcl::Duration span) {
  const auto ticks = tmcl::seconds(span) * info.ticks_per_second;
  const double most = std::min<double>(plan::most_ring_down_positions, info.elements);
  const auto divider = std::max(std::ceil(ticks / most), 1.0);
  tmcl::CaptureRequest request;
  request.channels.push_back(tmcl::capture_channel(motor, start.encoder));
  request.rate_hz = info.ticks_per_second / divider;
  request.samples = static_cast<std::uint32_t>(ticks / divider);
  // Its speed is no longer above 0, or above what is just below.
  const bool ahead = start.distance.value > 0;
  request.trigger = tmcl::CaptureTrigger{
      tmcl::capture_channel(motor, ap::actual_velocity),
      ahead ? tmcl::ram_debug::Trigger::falling_signed : tmcl::ram_debug::Trigger::rising_signed,
      ahead ? 0 : -1};
  return plan_capture(info, request);
}

/// Nothing where the module has no data logger, or that records something.
tmcl::Script<tmcl::Result<std::optional<Recording>>> begin_recording(
    std::shared_ptr<GatewayAxis> axis, Start start, tmcl::Duration span) {
  const auto address = axis->address();
  const auto info = co_await tmcl::verbs::data_logger_info(address.module);
  if (!info) co_return std::optional<Recording>();
  const auto state = co_await tmcl::must(tmcl::verbs::capture_state(address.module));
  auto setup = setup_of(*info, address.motor, start, span);
  if (!setup || state != tmcl::ram_debug::State::idle) co_return std::optional<Recording>();
  axis->module().begin_capture();
  Recording recording;
  recording.number = axis->module().capture();
  recording.ticks_per_second = info->ticks_per_second;
  recording.setup = std::move(*setup);
  co_await tmcl::must(tmcl::verbs::start_capture(address.module, recording.setup));
  co_return std::optional<Recording>(std::move(recording));
}

/// Empty if the module records something else by now, or does not come to an end.
tmcl::Script<tmcl::Result<std::vector<std::int32_t>>> end_recording(
    std::shared_ptr<GatewayAxis> axis, Recording recording) {
  const auto module = axis->address().module;
  std::vector<std::int32_t> samples;
  if (axis->module().capture() != recording.number) co_return samples;
  const auto state = co_await tmcl::must(tmcl::verbs::capture_state(module));
  if (state == tmcl::ram_debug::State::complete) {
    samples = co_await tmcl::must(tmcl::verbs::read_samples(module, 0, recording.setup.samples));
  }
  if (axis->module().capture() != recording.number) co_return std::vector<std::int32_t>();
  co_await tmcl::must(tmcl::verbs::end_capture(module));
  co_return samples;
}

std::vector<plan::PositionAt> positions_of(const std::vector<std::int32_t>& samples,
                                           const Recording& recording) {
  std::vector<plan::PositionAt> positions;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    positions.push_back(
        {static_cast<double>(i) * recording.interval_s(), static_cast<double>(samples[i])});
  }
  return positions;
}

/// What is read by the bus comes at uneven times: a swing that is in both is none that only looks
/// so.
RingDown found_in(const std::vector<plan::PositionAt>& read,
                  const std::vector<plan::PositionAt>& recorded) {
  if (recorded.size() < plan::least_ring_down_positions) return plan::ring_down(read);
  auto found = plan::ring_down(recorded);
  if (found.verdict == RingDown::Verdict::rings && !plan::explains(found.resonance, read))
    found.verdict = RingDown::Verdict::unclear;
  return found;
}

// ---- the measurement

/// What was read is of this move, and its encoder follows the motor.
Task<void> check_end(GatewayAxis& axis, const Start& start, tmcl::Microsteps target,
                     const std::vector<tmcl::ReadingAt>& readings) {
  const auto now = co_await must(axis.read_state(), axis);
  if (now.state.velocity.value != 0 || now.state.position != target) {
    co_await refuse(failed("moved", "axis " + axis.name() + " was moved while it was measured",
                           "take a lease of it: 'tmclctl lease run'"));
  }
  const auto counted = [&](const tmcl::ReadingAt& reading) {
    return reading.value != start.counted;
  };
  if (std::ranges::none_of(readings, counted)) {
    co_await refuse(failed(
        "no_encoder",
        fmt::format("the encoder of axis {} has counted nothing while its motor went {} microsteps",
                    axis.name(), start.distance.value),
        "is there one, and is it connected? A longer move may show it"));
  }
}

/// What made the move.
Task<void> add_ramp(GatewayAxis& axis, axis::MeasuredResonance& result) {
  const auto& model = *axis.module().model();
  const auto units = co_await must(axis.module_units(), axis);
  if (!units) co_return;
  const auto velocity = co_await must(axis.get(ap::max_velocity, {}), axis);
  const auto acceleration = co_await must(axis.get(plan::acceleration_parameter(model), {}), axis);
  result.velocity_pps = to_pps(tmcl::InternalVelocity{velocity}, *units).value;
  result.acceleration_pps2 = to_pps2(tmcl::InternalAcceleration{acceleration}, *units).value;
}

std::string unclear_text(const RingDown& found) {
  return fmt::format(
      "no swing of {} to {} Hz explains what the encoder did: a longer or steeper move swings "
      "more, "
      "a quicker bus shows faster swings, and 'listen_ms' slower ones",
      tmcl::plain_number(found.lowest_hz, 3), tmcl::plain_number(found.highest_hz, 3));
}

void tell(const RingDown& found, axis::MeasuredResonance& result) {
  using Verdict = RingDown::Verdict;
  result.confidence = found.confidence;
  result.lowest_hz = found.lowest_hz;
  result.highest_hz = found.highest_hz;
  result.verdict = found.verdict == Verdict::still ? "still" : "unclear";
  if (found.verdict == Verdict::unclear) result.warnings.push_back(unclear_text(found));
  if (found.verdict == Verdict::too_few)
    result.warnings.emplace_back(
        "there were too few readings: the bus is too slow, or 'listen_ms'");
  if (found.verdict != Verdict::rings) return;
  result.verdict = "rings";
  result.resonance_hz = found.resonance.frequency_hz;
  result.damping = found.resonance.damping;
  result.swing = found.swing;
}

}  // namespace

Answer<axis::Resonance> measure_resonance(Call& call, const axis::Resonance& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  // Before the module is told to record anything.
  co_await must(axis.be_free(ready.moves), axis);
  const auto start = co_await must(start_of(axis, params));
  axis::MeasuredResonance result;
  result.axis = axis.name();
  result.distance_microsteps = start.distance.value;
  co_await must(add_ramp(axis, result));
  // Whatever comes of it: the bus tells as much, but less often.
  auto begin = begin_recording(ready.axis, start, listening_of(params));
  const auto begun = co_await axis.perform(std::move(begin), beside_journeys(call, axis));
  const auto recording = begun.value_or(std::nullopt);
  const Length distance{start.distance};
  const auto moved = co_await axis.move_by(distance, true, ready.moves);
  if (!moved) {
    if (recording)
      co_await axis.perform(tmcl::verbs::end_capture(axis.address().module),
                            beside_journeys(call, axis));
    co_return call_error(moved.error(), axis.name());
  }
  result.warnings = moved->warnings;
  auto script = tmcl::verbs::read_at_rest(axis.address(), wanted_of(start, *moved, params));
  auto until_stopped = with_peer(ready.moves, call.peer);
  until_stopped.deadline.reset();  // That of the move.
  const auto readings = co_await axis.perform(std::move(script), std::move(until_stopped));
  std::vector<plan::PositionAt> recorded;
  if (recording) {
    auto end = end_recording(ready.axis, *recording);
    const auto samples = co_await axis.perform(std::move(end), beside_journeys(call, axis));
    if (samples) recorded = positions_of(*samples, *recording);
  }
  if (!readings) co_return call_error(readings.error(), axis.name());
  co_await must(check_end(axis, start, moved->target, *readings));
  auto read = positions_of(*readings);
  result.recorded = !recorded.empty();
  const auto& used = result.recorded ? recorded : read;
  result.readings = static_cast<std::int32_t>(used.size());
  result.readings_s = used.back().time_s - used.front().time_s;
  auto find = [read = std::move(read), recorded = std::move(recorded)] {
    return found_in(read, recorded);
  };
  const auto found = co_await call.gateway->planner.plan(std::move(find));
  tell(found, result);
  co_return result;
}

}  // namespace tmcld::handlers
