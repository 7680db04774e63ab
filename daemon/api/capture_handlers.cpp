// What modules record by themselves.
#include "api/beside_journeys.hpp"
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "tmcl/data_logger.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::CaptureRequest;
using tmcl::CaptureSetup;
using tmcl::ram_debug::Trigger;

// ---- What is to be recorded

Result<ParameterChoice> choice_of(const std::string& given, const GatewayAxis& axis) {
  if (const auto number = as_number(given))
    return parameter_of(api::NameOrNumber(std::int32_t{*number}), axis);
  return parameter_of(api::NameOrNumber(given), axis);
}

Result<Trigger> edge_of(const std::string& word) {
  if (word == "rising") return Trigger::rising_signed;
  if (word == "falling") return Trigger::falling_signed;
  if (word == "both") return Trigger::both_signed;
  return tl::unexpected(param_error<&capture::Start::trigger_edge>(
      "bad_argument", "'" + word + "' is no edge", "say rising, falling or both"));
}

Result<std::optional<tmcl::CaptureTrigger>> trigger_of(const capture::Start& params,
                                                       const GatewayAxis& axis) {
  const auto& parameter = params.trigger_parameter;
  if (!parameter && !params.trigger_edge && !params.trigger_value) return std::nullopt;
  if (!parameter || !params.trigger_edge || !params.trigger_value) {
    return tl::unexpected(param_error<&capture::Start::trigger_parameter>(
        "bad_argument", "'trigger_parameter', 'trigger_edge' and 'trigger_value' go together"));
  }
  const auto choice = choice_of(*parameter, axis);
  if (!choice) return tl::unexpected(choice.error());
  const auto edge = edge_of(*params.trigger_edge);
  if (!edge) return tl::unexpected(edge.error());
  const auto channel = tmcl::capture_channel(axis.address().motor, choice->number);
  return tmcl::CaptureTrigger{channel, *edge, *params.trigger_value};
}

using Choices = std::vector<ParameterChoice>;

Result<Choices> channels_of(const capture::Start& params, const GatewayAxis& axis) {
  Choices choices;
  for (const auto& name : params.channels) {
    const auto choice = choice_of(name, axis);
    if (!choice) return tl::unexpected(choice.error());
    choices.push_back(*choice);
  }
  return choices;
}

Result<CaptureRequest> capture_request(const capture::Start& params, const Choices& channels,
                                       const GatewayAxis& axis) {
  const auto trigger = trigger_of(params, axis);
  if (!trigger) return tl::unexpected(trigger.error());
  CaptureRequest request;
  for (const auto& choice : channels)
    request.channels.push_back(tmcl::capture_channel(axis.address().motor, choice.number));
  request.rate_hz = params.rate_hz;
  if (params.samples) request.samples = static_cast<std::uint32_t>(*params.samples);
  request.trigger = *trigger;
  request.pretrigger_percent = static_cast<std::uint32_t>(params.pretrigger_percent.value_or(0));
  return request;
}

// ---- On the bus

struct Begun {
  CaptureSetup setup;
  double ticks_per_second = 0;
  std::int32_t capture = 0;  ///< Its number.
};

/// A reader of what the module recorded before learns so from when that is lost.
tmcl::Script<tmcl::Result<Begun>> begin(GatewayModule& module, CaptureRequest request,
                                        bool resumes) {
  const auto address = module.address();
  const auto info = co_await tmcl::must(tmcl::verbs::data_logger_info(address));
  auto setup = tmcl::plan_capture(info, request);
  if (!setup) co_return tl::unexpected(std::move(setup.error()));
  if (!resumes || module.capture() == 0) module.begin_capture();
  const auto capture = module.capture();
  if (resumes) {
    co_await tmcl::must(tmcl::verbs::match_capture(address, *setup));
  } else {
    co_await tmcl::must(tmcl::verbs::start_capture(address, *setup));
  }
  co_return Begun{std::move(*setup), static_cast<double>(info.ticks_per_second), capture};
}

/// The axis of a capture that is still the one of its module.
Result<std::shared_ptr<GatewayAxis>> axis_in(const Call& call, const std::string& name,
                                             std::int32_t capture) {
  auto axis = axis_of(call, name);
  if (!axis || (*axis)->module().capture() == capture) return axis;
  return tl::unexpected(failed(
      "unexpected_value", "the module of '" + name + "' records something else now, or nothing",
      "another client has begun a capture, or tmcld has started again: 'resume' finds out"));
}

capture::Started started(const Begun& begun, const Choices& channels) {
  capture::Started result;
  result.capture = begun.capture;
  for (const auto& choice : channels) {
    capture::Channel channel{{choice.name(), choice.number}, std::nullopt};
    if (choice.row != nullptr && !choice.row->unit.empty())
      channel.unit = std::string(choice.row->unit);
    result.channels.push_back(std::move(channel));
  }
  result.samples = static_cast<std::int32_t>(begun.setup.samples);
  result.pretrigger = static_cast<std::int32_t>(begun.setup.pretrigger);
  result.rate_hz = begun.ticks_per_second / begun.setup.divider;
  return result;
}

}  // namespace

Answer<capture::Start> start_capture(Call& call, const capture::Start& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto& it = *axis;
  // Which names there are depends on the model.
  co_await must(it.be_ready(), it);
  const auto channels = co_await must(channels_of(params, it));
  auto request = co_await must(capture_request(params, channels, it));
  auto script = begin(it.module(), std::move(request), params.resume.value_or(false));
  const auto begun = co_await must(it.perform(std::move(script), beside_journeys(call, it)), it);
  co_return started(begun, channels);
}

Answer<capture::GetState> capture_state(Call& call, const capture::GetState& params) {
  const auto axis = co_await must(axis_in(call, params.axis, params.capture));
  auto& it = *axis;
  auto script = tmcl::verbs::capture_state(it.address().module);
  const auto state = co_await must(it.perform(std::move(script), beside_journeys(call, it)), it);
  co_return capture::Progress{std::string(tmcl::name_of(state))};
}

Answer<capture::Read> read_capture(Call& call, const capture::Read& params) {
  const auto axis = co_await must(axis_in(call, params.axis, params.capture));
  auto& it = *axis;
  auto script =
      tmcl::verbs::read_samples(it.address().module, static_cast<std::uint32_t>(params.first),
                                static_cast<std::uint32_t>(params.count));
  auto values = co_await must(it.perform(std::move(script), beside_journeys(call, it)), it);
  co_return capture::Values{std::move(values)};
}

Answer<capture::End> end_capture(Call& call, const capture::End& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto& it = *axis;
  if (params.capture && *params.capture != it.module().capture()) co_return api::Nothing{};
  RunOptions options;
  options.permit = call.permit;
  auto script = tmcl::verbs::end_capture(it.address().module);
  co_await must(it.perform(std::move(script), std::move(options)), it);
  co_return api::Nothing{};
}

}  // namespace tmcld::handlers
