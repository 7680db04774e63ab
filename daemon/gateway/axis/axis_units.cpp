#include "gateway/axis/axis_units.hpp"

#include <algorithm>
#include <utility>

#include "tmcl/parameter_number.hpp"
#include "tmcl/prediction.hpp"
#include "tmcl/scale_factor.hpp"
#include "tmcl/tuning.hpp"
#include "tmcl/units.hpp"

namespace tmcld {
namespace {

namespace ap = tmcl::axis_parameter;

/// Not a failure of this one exchange: the module does not have what it was asked for.
bool has_no_such_value(const tmcl::Error& error) {
  return error.code == tmcl::Errc::refused_by_module &&
         error.status != tmcl::Status::wrong_checksum &&
         error.status != tmcl::Status::command_loaded;
}

/// Nothing where the module does not have it.
template <class T>
tmcl::Result<std::optional<T>> if_it_tells(tmcl::Result<T> told) {
  if (told) return std::optional(std::move(*told));
  if (has_no_such_value(told.error())) return std::optional<T>();
  return tl::unexpected(std::move(told.error()));
}

}  // namespace

AxisUnits::Script<std::optional<tmcl::ModuleUnits>> AxisUnits::module_units() {
  using Units = std::optional<tmcl::ModuleUnits>;
  const auto* model = axis_.module().model();
  if (model == nullptr) co_return Units{};
  const auto now = epoch();
  if (module_units_ && module_units_->epoch == now) co_return Units{module_units_->value};
  const auto parameters = tmcl::unit_parameters(*model);
  auto read = co_await tmcl::verbs::get_all(axis_.address(), parameters);
  auto values = if_it_tells(std::move(read));
  if (!values) co_return tl::unexpected(std::move(values.error()));
  if (!*values) co_return Units{};
  const auto units = tmcl::module_units(*model, **values);
  if (units) module_units_ = Known<tmcl::ModuleUnits>{now, *units};
  co_return units;
}

AxisUnits::Script<std::optional<tmcl::UserScale>> AxisUnits::scale() {
  using Scale = std::optional<tmcl::UserScale>;
  const auto& config = axis_.config().scale;
  if (config.microstep_resolution)
    co_return Scale{config.with_resolution(*config.microstep_resolution)};
  const auto now = epoch();
  if (!microstep_resolution_ || microstep_resolution_->epoch != now) {
    std::vector<std::uint8_t> resolution{ap::microstep_resolution};
    auto read = co_await tmcl::verbs::get_all(axis_.address(), std::move(resolution));
    auto told = if_it_tells(std::move(read));
    if (!told) co_return tl::unexpected(std::move(told.error()));
    if (!*told) co_return Scale{};
    const auto value = (*told)->front();
    if (value < 0 || value > tmcl::max_microstep_resolution) co_return Scale{};
    microstep_resolution_ = Known<std::int32_t>{now, value};
  }
  co_return Scale{config.with_resolution(microstep_resolution_->value)};
}

AxisUnits::Script<tmcl::UserScale> AxisUnits::known_scale() {
  if (axis_.config().scale.unit.empty()) co_return tmcl::microsteps_scale();
  auto scale = co_await this->scale();
  if (!scale) co_return tl::unexpected(std::move(scale.error()));
  if (*scale) co_return std::move(**scale);
  co_return tl::unexpected(axis_.on_bus(tmcl::bad_argument(
      "the module of axis '" + axis_.name() + "' does not tell its microstep resolution",
      "the configuration can: 'microsteps'")));
}

AxisUnits::Script<bool> AxisUnits::know_ramp(const tmcl::Model& model) {
  const auto now = ramp_epoch();
  if (ramp_ && ramp_->epoch == now) co_return true;
  auto read = co_await tmcl::verbs::read_ramp(axis_.address(), model);
  auto ramp = if_it_tells(std::move(read));
  if (!ramp) co_return tl::unexpected(std::move(ramp.error()));
  if (!*ramp) co_return false;
  ramp_ = Known<std::vector<tmcl::plan::Setting>>{now, std::move(**ramp)};
  if (written_ && written_->epoch == now) hold_in_ramp(written_->value);
  co_return true;
}

AxisUnits::Script<std::vector<std::string>> AxisUnits::warnings(RampKnowledge from) {
  const auto* model = axis_.module().model();
  auto twin = model == nullptr ? std::nullopt : tmcl::plan::AxisTwin::of(*model);
  const bool is_known = ramp_ && ramp_->epoch == ramp_epoch();
  if (!twin || (from == RampKnowledge::as_it_is && !is_known)) co_return {};
  const auto known = co_await know_ramp(*model);
  if (!known) co_return tl::unexpected(known.error());
  if (!*known || !twin->set(ramp_->value)) co_return {};
  twin->take_traits(axis_.module().traits());
  twin->move_to({});
  co_return warnings_of(*twin);
}

std::vector<std::string> AxisUnits::warnings_of(const tmcl::plan::AxisTwin& twin) const {
  const auto& config = axis_.config().scale;
  std::optional<tmcl::UserScale> scale;
  if (config.microstep_resolution) {
    scale = config.with_resolution(*config.microstep_resolution);
  } else if (microstep_resolution_ && microstep_resolution_->epoch == epoch()) {
    scale = config.with_resolution(microstep_resolution_->value);
  }
  const bool is_known = ramp_ && ramp_->epoch == ramp_epoch();
  return twin.warnings(is_known ? ramp_->value : std::vector<tmcl::plan::Setting>{}, scale);
}

AxisUnits::Script<std::optional<tmcl::plan::AxisTwin>> AxisUnits::twin(tmcl::Proof proof) {
  using Twin = std::optional<tmcl::plan::AxisTwin>;
  const auto* model = axis_.module().model();
  if (model == nullptr) co_return Twin{};
  const auto known = co_await know_ramp(*model);
  if (!known) co_return tl::unexpected(known.error());
  if (!*known) co_return Twin{};
  auto twin = co_await tmcl::verbs::read_twin(axis_.address(), *model, ramp_->value, proof);
  // Its ramps are not described.
  if (!twin && twin.error().code == tmcl::Errc::bad_argument) co_return Twin{};
  if (twin) twin->take_traits(axis_.module().traits());
  co_return if_it_tells(std::move(twin));
}

AxisUnits::Script<AxisReading> AxisUnits::reading(std::optional<tmcl::Microsteps> bound_for) {
  AxisReading reading;
  reading.taken = co_await tmcl::current_time();
  const auto state = co_await tmcl::verbs::state(axis_.address());
  if (!state) co_return tl::unexpected(state.error());
  reading.state = *state;
  reading.is_bound = bound_for.has_value();
  if (bound_for) reading.state.target = *bound_for;
  if (bound_for) reading.state.position_reached = false;
  std::optional<tmcl::PulsesPerSecond> velocity;
  const auto units = co_await module_units();
  if (!units) co_return tl::unexpected(units.error());
  if (*units) {
    velocity = tmcl::to_pps(state->velocity, **units);
    reading.velocity_pps = velocity->value;
  }
  if (axis_.config().scale.unit.empty()) co_return reading;
  const auto scale = co_await this->scale();
  if (!scale) co_return tl::unexpected(scale.error());
  if (!*scale) co_return reading;
  reading.user = {
      tmcl::to_user(state->position, **scale), tmcl::to_user(reading.state.target, **scale), {}};
  if (velocity) reading.user->velocity = tmcl::to_user(*velocity, **scale);
  co_return reading;
}

AxisUnits::Script<std::optional<EncoderWindow>> AxisUnits::encoder_window(tmcl::Microsteps there,
                                                                          double width) {
  using Window = std::optional<EncoderWindow>;
  const auto* model = axis_.module().model();
  const auto parameter = model == nullptr ? std::nullopt : tmcl::tune_encoder(*model);
  if (!parameter) co_return Window{};
  const auto& config = axis_.config().scale;
  auto scale = co_await tmcl::must(known_scale());
  if (!config.encoder_counts_per_unit) {
    const double unit = microsteps_per_unit(scale);
    co_return Window{{*parameter, static_cast<double>(there.value), width * unit, unit}};
  }
  // An encoder on the shaft of the motor knows nothing of the screw behind it.
  if (!config.encoder_is_linear) scale.correction = nullptr;
  const double counts = *config.encoder_counts_per_unit;
  const double wanted = tmcl::to_user(there, scale).value * counts;
  co_return Window{{*parameter, scale.reverse ? -wanted : wanted, width * counts, counts}};
}

AxisUnits::Script<ParameterSample> AxisUnits::sample(std::uint8_t parameter) {
  ParameterSample sample{parameter};
  sample.taken = co_await tmcl::current_time();
  const auto value = co_await tmcl::verbs::get(axis_.address(), parameter);
  if (!value) co_return tl::unexpected(value.error());
  sample.value = *value;
  const auto* row = find_parameter(axis_.parameters(), parameter);
  const bool has_unit = row != nullptr && dimension_of(*row) != tmcl::Dimension::other;
  if (!has_unit || axis_.config().scale.unit.empty()) co_return sample;
  const auto scale = co_await this->scale();
  if (!scale) co_return tl::unexpected(scale.error());
  const auto module = co_await module_units();
  if (!module) co_return tl::unexpected(module.error());
  if (!*scale) co_return sample;
  const tmcl::AxisUnits units{axis_.name(), axis_.module().model(),
                              *module,      *scale,
                              {},           axis_.config().scale.encoder_counts_per_unit};
  if (auto in_unit = from_parameter(*value, units, *row)) sample.in_unit = std::move(*in_unit);
  co_return sample;
}

void AxisUnits::note_set(std::uint8_t parameter, std::optional<std::int32_t> held) {
  const Epoch before{axis_.module().settings_epoch(), changes_ - 1};
  const bool was_known = held && ramp_ && ramp_->epoch == before;
  ++changes_;
  bool counts = parameter == ap::microstep_resolution;
  if (const auto* model = axis_.module().model()) {
    const auto units = tmcl::unit_parameters(*model);
    counts = counts || std::ranges::count(units, parameter) != 0;
  }
  if (counts) ++unit_changes_;
  if (was_known) hold_in_ramp({parameter, *held});
  written_.reset();
  if (held) written_ = Known<tmcl::plan::Setting>{ramp_epoch(), {parameter, *held}};
}

void AxisUnits::hold_in_ramp(tmcl::plan::Setting setting) {
  const auto row =
      std::ranges::find(ramp_->value, setting.parameter, &tmcl::plan::Setting::parameter);
  const bool is_in_ramp = row != ramp_->value.end();
  if (setting.parameter == ap::unit_mode) return;  // which says what the others mean
  if (setting.parameter == ap::max_acceleration && !is_in_ramp) {
    // On a TMC457 it is two of them at once.
    hold_in_ramp({tmcl::number_of("acceleration"), setting.value});
    hold_in_ramp({tmcl::number_of("max_deceleration"), setting.value});
    return;
  }
  if (is_in_ramp) row->value = setting.value;
  ramp_->epoch = ramp_epoch();
}

}  // namespace tmcld
