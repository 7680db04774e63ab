#include "sim/module/axis.hpp"

#include <algorithm>

#include "sim/module/driver_registers.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto closed_loop_mode = number_of("closed_loop_mode");
constexpr auto encoder_initialization = number_of("encoder_initialization");
constexpr auto closed_loop_init_flag = number_of("closed_loop_init_flag");
constexpr std::int32_t encoder_is_initialized = 2;

bool has_closed_loop(Family family) {
  return family == Family::tmc4361 || family == Family::firmware;
}

bool in_range(const ParameterInfo& row, std::int32_t value) {
  return value >= row.minimum && value <= row.maximum;
}

}  // namespace

Axis::Axis(const Model& model, Stage& stage, TimePoint power_on, const ModuleTraits& traits)
    : family_(model.family),
      traits_(traits),
      wraps_(concerns(Trait::range_check, model) &&
             traits.get<RangeCheck>(Trait::range_check, model) == RangeCheck::wrap),
      table_(axis_parameters(model)),
      keeps_errors_(find_parameter(table_, "movement_error_flags") != nullptr),
      motor_(make_motor(model, power_on, traits)),
      coupling_(*motor_, stage),
      power_on_(power_on),
      now_(power_on),
      rest_(power_on) {
  // The chip itself starts with zeros; the firmware writes what it has stored.
  for (const auto& row : table_) {
    values_[row.number] = row.initial;
    if (row.stored) motor_->write(row, in_motor(row, row.initial));
    take_note(row.number, row.initial);
  }
  encoder_.set_position(0, stage);
  external_encoder_.set_position(0, stage);
  scale_encoders();
  settle();
}

// ---- Parameters

tl::expected<std::int32_t, Status> Axis::get(std::uint8_t number) const {
  const auto* row = find_parameter(table_, number);
  if (row == nullptr) return tl::unexpected(Status::wrong_type);
  if (const auto own = reading(*row)) return *own;
  if ((wraps_ && is_remembered(*row)) || overruled(*row)) return values_[number];
  return in_force(*row);
}

std::int32_t Axis::in_force(const ParameterInfo& row) const {
  return motor_->read(row).value_or(values_[row.number]);
}

std::optional<std::int32_t> Axis::reading(const ParameterInfo& row) const {
  const auto position_of = [this](const EncoderWatch& encoder) {
    return static_cast<std::int32_t>(encoder.position(coupling_.stage()));
  };
  if (has_closed_loop(family_)) {
    if (const auto ready = closed_loop_reading(row.number)) return ready;
  }
  switch (row.number) {
    case number_of("home_switch"): return switches_.home ? 1 : 0;
    case number_of("right_limit_switch"): return switches_.right ? 1 : 0;
    case number_of("left_limit_switch"): return switches_.left ? 1 : 0;
    case number_of(Family::sixpoint, "measured_speed"):
      if (family_ != Family::sixpoint) return std::nullopt;
      return coupling_.is_held() ? 0 : get(ap::actual_velocity).value_or(0);
    case number_of(Family::tmc457, "encoder_position"):
      if (family_ != Family::tmc457) return std::nullopt;
      return position_of(encoder_);
    case number_of("smart_energy_actual_current"): return current_scale();
    case number_of("latched_encoder_position"): return latched_encoder_;
    case number_of("load_value"): return scaled_load_value(row);
    case number_of("extended_error_flags"): return error_flags();
    case number_of("driver_status_flags"): return driver_flags();
    case number_of(Family::sixpoint, "encoder_position"): return position_of(encoder_);
    case number_of("absolute_encoder_value"): return coupling_.stage().encoder_angle();
    case number_of("external_encoder_position"): return position_of(external_encoder_);
    default: return std::nullopt;
  }
}

std::optional<std::int32_t> Axis::closed_loop_reading(std::uint8_t number) const {
  if (number == closed_loop_init_flag) return closed_loop_.is_calibrated(now_);
  // A TMC4361 has a speed under that number.
  const bool initializes = family_ == Family::firmware && number == encoder_initialization;
  if (initializes && closed_loop_.is_encoder_initialized(now_)) return encoder_is_initialized;
  return std::nullopt;
}

tl::expected<std::int32_t, Status> Axis::read(std::uint8_t number) {
  const auto result = get(number);
  if (number == number_of("extended_error_flags") && !keeps_errors_) errors_ = 0;
  return result;
}

Status Axis::set(std::uint8_t number, std::int32_t value) {
  const auto* row = find_parameter(table_, number);
  if (row == nullptr || row->access == Access::read) return Status::wrong_type;
  const auto taken = accepted(*row, value);
  if (!taken) return Status::invalid_value;
  const auto status = motor_->write(*row, in_motor(*row, taken->written));
  if (status != Status::ok) return status;
  if (number == ap::target_position && goes_to_new_target()) motor_->move_to(taken->written);
  values_[number] = taken->kept;
  take_note(number, taken->kept);
  settle();
  return status;
}

std::optional<Wrapped> Axis::accepted(const ParameterInfo& row, std::int32_t value) const {
  if (row.scale != Scale::fixed || in_range(row, value)) return Wrapped{value, value};
  return wraps_ ? wrapped(row, value) : std::nullopt;
}

// The firmware keeps what was set, whatever its motors do.
std::optional<std::int32_t> Axis::overruled(const ParameterInfo& row) const {
  const auto stop = traits_.find(Trait::limit_stop);
  if (!stop || stop == index_of(LimitStop::as_set) || row.name != "soft_stop") return std::nullopt;
  return stop == index_of(LimitStop::soft) ? 1 : 0;
}

std::int32_t Axis::in_motor(const ParameterInfo& row, std::int32_t value) const {
  return overruled(row).value_or(value);
}

// A model that does not tell its mode is in no other one of which it matters.
bool Axis::goes_to_new_target() const {
  if (traits_.find(Trait::velocity_target) != index_of(VelocityTarget::goes_there)) return false;
  constexpr std::int32_t velocity_mode = 2;
  const auto row = std::ranges::find(table_, "ramp_mode", &ParameterInfo::name);
  return row == table_.end() || get(row->number) == velocity_mode;
}

std::int32_t Axis::relative_origin() const {
  const auto from = traits_.find(Trait::relative_from);
  if (!from) return motor_->relative_origin();
  return from == index_of(RelativeFrom::actual) ? motor_->position()
                                                : get(ap::target_position).value_or(0);
}

void Axis::take_note(std::uint8_t number, std::int32_t value) {
  if (has_closed_loop(family_)) {
    if (number == closed_loop_mode) closed_loop_.set_mode(value, now_);
    if (number == encoder_initialization) closed_loop_.initialize_encoder(value, now_);
  }
  switch (number) {
    case ap::microstep_resolution:
      coupling_.set_resolution(value);
      scale_encoders();
      break;
    case number_of("encoder_resolution"):
    case number_of("external_encoder_resolution"): scale_encoders(); break;
    case number_of("toff"):
      if (value == 0) protection_.reset();
      break;
    case number_of("reverse_shaft"): coupling_.reverse(value == 1); break;
    case number_of(Family::tmc457, "encoder_position"):
      if (family_ == Family::tmc457) encoder_.set_position(value, coupling_.stage());
      break;
    case number_of(Family::sixpoint, "encoder_position"):
      encoder_.set_position(value, coupling_.stage());
      break;
    case number_of("external_encoder_position"):
      external_encoder_.set_position(value, coupling_.stage());
      break;
    case number_of("max_encoder_deviation"): encoder_.set_most_deviation(value); break;
    case number_of("external_encoder_max_deviation"):
      external_encoder_.set_most_deviation(value);
      break;
    default: break;
  }
}

// ---- Registers

std::int32_t Axis::read_chip(std::uint8_t address) {
  if (family_ == Family::sixpoint && address == driver_status_address)
    return driver_status({load_value(), current_scale(), driver_flags()});
  auto word = static_cast<std::uint32_t>(motor_->read_chip(address));
  for (const auto& field : driver_fields(family_)) {
    const auto* row = find_parameter(table_, field.parameter);
    if (field.address == address && row != nullptr)
      word = with_value(field, word, values_[field.parameter], *row);
  }
  return static_cast<std::int32_t>(word);
}

// A setting that the model has not is a bit without effect.
Status Axis::write_chip(std::uint8_t address, std::int32_t value) {
  const auto status = motor_->write_chip(address, value);
  for (const auto& field : driver_fields(family_)) {
    const auto* row = find_parameter(table_, field.parameter);
    if (status != Status::ok || field.address != address || row == nullptr) continue;
    set(field.parameter, value_in(field, static_cast<std::uint32_t>(value), *row));
  }
  settle();
  return status;
}

std::int32_t Axis::read_driver(std::uint8_t address) const {
  const auto word = driver_words_.find(address);
  return word == driver_words_.end() ? 0 : word->second;
}

// ---- Motion

Status Axis::rotate(std::int64_t velocity) {
  if (wraps_) velocity = wrapped_velocity(velocity);
  const auto status = motor_->rotate(velocity);
  if (status == Status::ok) {
    begin_movement();
    homing_.abort();
  }
  settle();
  return status;
}

void Axis::stop() {
  homing_.abort();
  motor_->stop();
  settle();
}

Status Axis::move_to(std::int32_t position) {
  if (!can_move(position)) return Status::invalid_value;
  move(position);
  return Status::ok;
}

Status Axis::move_by(std::int32_t distance) {
  if (!can_move(distance)) return Status::invalid_value;
  move(std::int64_t{relative_origin()} + distance);
  return Status::ok;
}

// A model that has no groups has nothing under the number of its family.
std::int32_t Axis::group() const {
  return values_[family_ == Family::tmc4361 ? number_of(Family::tmc4361, "group_index")
                                            : number_of(Family::sixpoint, "group_index")];
}

bool Axis::is_position(std::int32_t value) const {
  return in_range(*find_parameter(table_, ap::target_position), value);
}

// By the manual of the TMCM-351 that keeps them until then.
void Axis::begin_movement() {
  if (keeps_errors_) errors_ = 0;
}

/// The bits of parameter 207: those of a TMCM-351 are the other way round.
std::int32_t Axis::error_flags() const {
  if (!keeps_errors_) return errors_;
  return (deviated() ? 1 : 0) | (stalled() ? 2 : 0);
}

void Axis::move(std::int64_t position) {
  begin_movement();
  homing_.abort();
  motor_->move_to(position);
  settle();
}

// The ramp itself is asked when it would arrive: that holds for every generator.
void Axis::arrive_by(TimePoint time) {
  std::int64_t too_slow = 0;
  auto fast_enough = motor_->top_speed();
  while (fast_enough - too_slow > 1) {
    const auto speed = too_slow + (fast_enough - too_slow) / 2;
    motor_->limit_positioning(speed);
    const bool in_time = motor_->outlook().arrival <= time;
    (in_time ? fast_enough : too_slow) = speed;
  }
  motor_->limit_positioning(fast_enough);
  settle();
}

void Axis::reverse_limit_polarity(bool reversed) {
  limits_reversed_ = reversed;
  settle();
}

void Axis::reverse_shaft(bool reversed) {
  coupling_.reverse(reversed);
  settle();
}

// ---- Time

void Axis::advance_to(TimePoint time) {
  now_ = time;
  motor_->advance_to(now_);
  coupling_.follow();
}

void Axis::run_due() {
  const bool changes = now_ >= model_tick_ && run_model_tick();
  if (changes || now_ >= due_) settle();
}

void Axis::stage_changed() {
  scale_encoders();
  settle();
}

void Axis::set_supply(std::int32_t supply) {
  supply_ = supply;
  settle();
}

void Axis::settle() {
  coupling_.rebase();
  look_ahead();
  watch_driver();
  sense();
  run_search();
  watch_encoders();
  watch_stall();
  watch_rotor();
  due_ = next_look();
}

// A motor that stood and goes on standing has done so for as long as it has.
void Axis::look_ahead() {
  outlook_ = motor_->outlook();
  if (outlook_.rest > now_ || rest_ > now_) rest_ = outlook_.rest;
}

TimePoint Axis::next_look() const {
  auto due = std::min(outlook_.look_again, next_stall_check());
  if (homing_.returns()) due = std::min(due, outlook_.arrival);
  if (!is_moving()) return due;
  auto reach = coupling_.reach();
  for (const auto* encoder : {&encoder_, &external_encoder_}) {
    if (encoder->is_on()) encoder->limit(reach, deviation(*encoder), coupling_);
  }
  const bool watched =
      !coupling_.stage().is_bare() || encoder_.is_on() || external_encoder_.is_on();
  if (watched) due = std::min(due, motor_->passing(reach.back, reach.ahead));
  if (coupling_.is_at_end()) due = std::min(due, motor_->turning());
  return due;
}

// ---- Switches

Switches Axis::sensed() const {
  const auto inputs = coupling_.stage().inputs();
  const auto wiring = motor_->wiring();
  Switches now{inputs.left != (limits_reversed_ != wiring.left_inverted),
               inputs.right != (limits_reversed_ != wiring.right_inverted), inputs.home};
  if (wiring.swapped) std::swap(now.left, now.right);
  return now;
}

void Axis::sense() {
  const auto before = std::exchange(switches_, sensed());
  const bool closes = (switches_.left && !before.left) || (switches_.right && !before.right);
  if (closes) latched_encoder_ = static_cast<std::int32_t>(encoder_.position(coupling_.stage()));
  const auto bars = homing_.ignores_ends() ? Switches{} : Switches{switches_.left, switches_.right};
  if (bars == barring_) return;
  barring_ = bars;
  motor_->set_switches(bars.left, bars.right);
  look_ahead();
}

}  // namespace tmcl::sim
