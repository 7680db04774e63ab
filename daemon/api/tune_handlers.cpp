// What an axis bears, and setting that.
#include "api/tune_handlers.hpp"

#include "api/lookup.hpp"
#include "api/travel.hpp"
#include "gateway/journey/tuning.hpp"

namespace tmcld::handlers {
namespace {

constexpr double usual_tune_margin = 0.2;
constexpr double greatest_tune_margin = 10;

axis::TunedValue tuned_view(const tmcl::TunedValue& value) {
  return {value.limit, value.proposed, std::string(name_of(value.limited_by))};
}

axis::TuneTrial tuned_view(const tmcl::TuneTrial& trial) {
  return {std::string(name_of(trial.sought)),
          trial.velocity.value,
          trial.acceleration.value,
          trial.current,
          trial.held,
          trial.deviation,
          trial.load_value,
          trial.threshold,
          trial.trouble,
          trial.swing};
}

axis::TunedBow tuned_view(const tmcl::TunedBow& bow) {
  axis::TunedBow view;
  view.value = bow.value;
  if (bow.resonance) {
    view.resonance_hz = bow.resonance->frequency_hz;
    view.damping = bow.resonance->damping;
  }
  view.swing = bow.swing;
  view.swing_before = bow.swing_before;
  return view;
}

axis::Tuned tuned_view(const TunedAxis& tuned, const GatewayAxis& axis) {
  const auto& found = tuned.found;
  axis::Tuned view;
  view.axis = axis.name();
  view.velocity = tuned_view(found.velocity);
  view.acceleration = tuned_view(found.acceleration);
  view.current = tuned_view(found.current);
  view.threshold = found.threshold;
  view.backlash = found.backlash;
  view.counts_per_microstep = found.counts_per_microstep;
  view.lost_steps = found.lost_steps;
  view.warnings = found.warnings;
  if (found.hold_current) view.hold_current = tuned_view(*found.hold_current);
  if (found.bow) view.bow = tuned_view(*found.bow);
  for (const auto& trial : found.trials) view.trials.push_back(tuned_view(trial));
  for (const auto& setting : found.settings) {
    const auto* row = find_parameter(axis.parameters(), setting.parameter);
    const auto had =
        std::ranges::find(tuned.before, setting.parameter, &tmcl::plan::Setting::parameter);
    view.settings.push_back({setting.parameter,
                             row == nullptr ? std::string() : std::string(row->name), setting.value,
                             had == tuned.before.end() ? 0 : had->value});
  }
  return view;
}

/// What the EEPROM keeps of it is there as well.
Task<api::Nothing> keep_tuned(GatewayAxis& axis, const std::vector<axis::TunedSetting>& settings,
                              RunOptions moves) {
  for (const auto& setting : settings) {
    const auto parameter = static_cast<std::uint8_t>(setting.parameter);
    co_await must(axis.set(parameter, setting.value, moves), axis);
  }
  for (const auto& setting : settings) {
    const auto parameter = static_cast<std::uint8_t>(setting.parameter);
    const auto* row = find_parameter(axis.parameters(), parameter);
    const bool is_kept = row != nullptr && row->stored;
    if (is_kept) co_await must(axis.store(parameter, moves), axis);
  }
  co_return api::Nothing{};
}

Task<std::optional<tmcl::LimitSwitch>> switch_of(const axis::Tune& params) {
  using tmcl::LimitSwitch;
  std::optional<LimitSwitch> by_switch;
  if (!params.by_switch) co_return by_switch;
  if (*params.by_switch == "left") by_switch = LimitSwitch::left;
  if (*params.by_switch == "right") by_switch = LimitSwitch::right;
  if (by_switch) co_return by_switch;
  co_return param_error<&axis::Tune::by_switch>("bad_argument", "'by_switch' is left or right");
}

}  // namespace

Answer<axis::Tune> tune(Call& call, const axis::Tune& params) {
  const auto ready = co_await must(ready_to_move(call, params.axis, {}));
  auto& axis = *ready.axis;
  const auto travel = co_await must(travel_of(axis, params));
  if (!travel && !axis.soft_limits()) {
    co_return param_error("bad_argument", "from", "axis '" + axis.name() + "' has no soft limits",
                          "say how far it may go from where it stands, such as --travel -2mm..2mm");
  }
  const auto margin = params.margin.value_or(usual_tune_margin);
  if (!(margin >= 0 && margin <= greatest_tune_margin))
    co_return param_error<&axis::Tune::margin>("out_of_range", "'margin' is 0 to 10");
  const auto by_switch = co_await must(switch_of(params));
  TuningRequest request;
  request.by_switch = by_switch;
  request.max_current = params.max_current;
  request.travel = travel;
  request.margin = margin;
  request.client = call.peer->client();
  request.permit = call.permit;
  request.tell = [reporter = call.progress_reporter(),
                  name = axis.name()](const std::string& what) {
    reporter(axis::TuneProgress{name, what});
  };
  const auto tuned = co_await must(tune_axis(call.gateway, ready.axis, std::move(request)), axis);
  auto view = tuned_view(tuned, axis);
  view.stored = params.store.value_or(false);
  if (view.stored) co_await must(keep_tuned(axis, view.settings, ready.moves));
  co_return view;
}

}  // namespace tmcld::handlers
