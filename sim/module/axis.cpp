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

}  // namespace

Axis::Axis(const Model& model, Stage& stage, TimePoint power_on, const ModuleTraits& traits)
    : state_(model, stage, power_on, traits),
      keeps_errors_(find_parameter(state_.table, "movement_error_flags") != nullptr) {
  // The chip itself starts with zeros; the firmware writes what it has stored.
  for (const auto& row : state_.table) {
    state_.values[row.number] = row.initial;
    if (row.stored) state_.motor->write(row, state_.in_motor(row, row.initial));
    take_note(row.number, row.initial);
  }
  encoders_.zero();
  encoders_.rescale();
  settle();
}

// ---- Parameters

tl::expected<std::int32_t, Status> Axis::get(std::uint8_t number) const {
  const auto* row = find_parameter(state_.table, number);
  if (row == nullptr) return tl::unexpected(Status::wrong_type);
  if (const auto own = reading(*row)) return *own;
  return state_.kept(*row);
}

std::optional<std::int32_t> Axis::reading(const ParameterInfo& row) const {
  if (has_closed_loop(state_.family)) {
    if (const auto ready = closed_loop_reading(row.number)) return ready;
  }
  switch (row.number) {
    case number_of("home_switch"): return state_.switches.home ? 1 : 0;
    case number_of("right_limit_switch"): return state_.switches.right ? 1 : 0;
    case number_of("left_limit_switch"): return state_.switches.left ? 1 : 0;
    case number_of(Family::sixpoint, "measured_speed"):
      if (state_.family != Family::sixpoint) return std::nullopt;
      return state_.coupling.is_held() ? 0 : get(ap::actual_velocity).value_or(0);
    case number_of(Family::tmc457, "encoder_position"):
      if (state_.family != Family::tmc457) return std::nullopt;
      return encoders_.own_position();
    case number_of("smart_energy_actual_current"): return driver_.current_scale();
    case number_of("latched_encoder_position"): return latched_encoder_;
    case number_of("load_value"): return driver_.scaled_load_value(row);
    case number_of("extended_error_flags"): return error_flags();
    case number_of("driver_status_flags"): return driver_.flags();
    case number_of(Family::sixpoint, "encoder_position"): return encoders_.own_position();
    case number_of("absolute_encoder_value"): return state_.coupling.stage().encoder_angle();
    case number_of("external_encoder_position"): return encoders_.external_position();
    default: return std::nullopt;
  }
}

std::optional<std::int32_t> Axis::closed_loop_reading(std::uint8_t number) const {
  if (number == closed_loop_init_flag) return closed_loop_.is_calibrated(state_.now);
  // A TMC4361 has a speed under that number.
  const bool initializes = state_.family == Family::firmware && number == encoder_initialization;
  if (initializes && closed_loop_.is_encoder_initialized(state_.now)) return encoder_is_initialized;
  return std::nullopt;
}

tl::expected<std::int32_t, Status> Axis::read(std::uint8_t number) {
  const auto result = get(number);
  if (number == number_of("extended_error_flags") && !keeps_errors_) errors_ = 0;
  return result;
}

Status Axis::set(std::uint8_t number, std::int32_t value) {
  const auto* row = find_parameter(state_.table, number);
  if (row == nullptr || row->access == Access::read) return Status::wrong_type;
  const auto taken = state_.accepted(*row, value);
  if (!taken) return Status::invalid_value;
  const auto status = state_.motor->write(*row, state_.in_motor(*row, taken->written));
  if (status != Status::ok) return status;
  if (number == ap::target_position && state_.goes_to_new_target())
    state_.motor->move_to(taken->written);
  state_.values[number] = taken->kept;
  take_note(number, taken->kept);
  settle();
  return status;
}

void Axis::take_note(std::uint8_t number, std::int32_t value) {
  if (has_closed_loop(state_.family)) {
    if (number == closed_loop_mode) closed_loop_.set_mode(value, state_.now);
    if (number == encoder_initialization) closed_loop_.initialize_encoder(value, state_.now);
  }
  switch (number) {
    case ap::microstep_resolution:
      state_.coupling.set_resolution(value);
      encoders_.rescale();
      break;
    case number_of("encoder_resolution"):
    case number_of("external_encoder_resolution"): encoders_.rescale(); break;
    case number_of("toff"):
      if (value == 0) driver_.reset();
      break;
    case number_of("reverse_shaft"): state_.coupling.reverse(value == 1); break;
    case number_of(Family::tmc457, "encoder_position"):
      if (state_.family == Family::tmc457)
        encoders_.own().set_position(value, state_.coupling.stage());
      break;
    case number_of(Family::sixpoint, "encoder_position"):
      encoders_.own().set_position(value, state_.coupling.stage());
      break;
    case number_of("external_encoder_position"):
      encoders_.external().set_position(value, state_.coupling.stage());
      break;
    case number_of("max_encoder_deviation"): encoders_.own().set_most_deviation(value); break;
    case number_of("external_encoder_max_deviation"):
      encoders_.external().set_most_deviation(value);
      break;
    default: break;
  }
}

// ---- Registers

std::int32_t Axis::read_chip(std::uint8_t address) {
  if (state_.family == Family::sixpoint && address == driver_status_address)
    return driver_status({driver_.load_value(), driver_.current_scale(), driver_.flags()});
  auto word = static_cast<std::uint32_t>(state_.motor->read_chip(address));
  for (const auto& field : driver_fields(state_.family)) {
    const auto* row = find_parameter(state_.table, field.parameter);
    if (field.address == address && row != nullptr)
      word = with_value(field, word, state_.values[field.parameter], *row);
  }
  return static_cast<std::int32_t>(word);
}

// A setting that the model has not is a bit without effect.
Status Axis::write_chip(std::uint8_t address, std::int32_t value) {
  const auto status = state_.motor->write_chip(address, value);
  for (const auto& field : driver_fields(state_.family)) {
    const auto* row = find_parameter(state_.table, field.parameter);
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
  if (state_.wraps) velocity = wrapped_velocity(velocity);
  const auto status = state_.motor->rotate(velocity);
  if (status == Status::ok) {
    begin_movement();
    search_.abort();
  }
  settle();
  return status;
}

void Axis::stop() {
  search_.abort();
  state_.motor->stop();
  settle();
}

Status Axis::move_to(std::int32_t position) {
  if (!can_move(position)) return Status::invalid_value;
  move(position);
  return Status::ok;
}

Status Axis::move_by(std::int32_t distance) {
  if (!can_move(distance)) return Status::invalid_value;
  move(std::int64_t{state_.relative_origin()} + distance);
  return Status::ok;
}

// A model that has no groups has nothing under the number of its family.
std::int32_t Axis::group() const {
  return state_
      .values[state_.family == Family::tmc4361 ? number_of(Family::tmc4361, "group_index")
                                               : number_of(Family::sixpoint, "group_index")];
}

bool Axis::is_position(std::int32_t value) const {
  return is_in_range(*find_parameter(state_.table, ap::target_position), value);
}

// By the manual of the TMCM-351 that keeps them until then.
void Axis::begin_movement() {
  if (keeps_errors_) errors_ = 0;
}

std::int32_t Axis::error_flags() const {
  if (!keeps_errors_) return errors_;
  return (deviated() ? 1 : 0) | (stalled() ? 2 : 0);
}

void Axis::move(std::int64_t position) {
  begin_movement();
  search_.abort();
  state_.motor->move_to(position);
  settle();
}

// The ramp itself is asked when it would arrive: that holds for every generator.
void Axis::arrive_by(TimePoint time) {
  std::int64_t too_slow = 0;
  auto fast_enough = state_.motor->top_speed();
  while (fast_enough - too_slow > 1) {
    const auto speed = too_slow + (fast_enough - too_slow) / 2;
    state_.motor->limit_positioning(speed);
    const bool in_time = state_.motor->outlook().arrival <= time;
    (in_time ? fast_enough : too_slow) = speed;
  }
  state_.motor->limit_positioning(fast_enough);
  settle();
}

void Axis::reverse_limit_polarity(bool reversed) {
  limits_reversed_ = reversed;
  settle();
}

void Axis::reverse_shaft(bool reversed) {
  state_.coupling.reverse(reversed);
  settle();
}

// ---- Time

void Axis::advance_to(TimePoint time) {
  state_.now = time;
  state_.motor->advance_to(state_.now);
  state_.coupling.follow(state_.now);
}

void Axis::run_due() {
  const bool changes = state_.now >= driver_.tick() && driver_.run_tick();
  const bool swings = state_.now >= swing_due_;
  if (changes || state_.now >= due_ || (swings && encoders_.are_watched())) {
    settle();
  } else if (swings) {
    keep_swing();
  }
}

// In pieces, however often it is looked at: so looking changes nothing.
void Axis::keep_swing() {
  swing_due_ = never;
  if (!state_.coupling.swings()) return;
  const auto piece = state_.coupling.keep_swing();
  if (state_.is_moving()) swing_due_ = std::min(state_.motor->next_change(), state_.now + piece);
}

void Axis::stage_changed() {
  encoders_.rescale();
  settle();
}

void Axis::set_supply(std::int32_t supply) {
  driver_.set_supply(supply);
  settle();
}

void Axis::settle() {
  state_.coupling.rebase();
  state_.look_ahead();
  driver_.look();
  sense();
  search_.run();
  watch_encoders();
  if (driver_.stalls()) emergency_stop(stall_error);
  driver_.watch_rotor();
  keep_swing();
  due_ = next_look();
}

TimePoint Axis::next_look() const {
  auto due = std::min(state_.outlook.look_again, driver_.next_stall_check());
  if (search_.homing().returns()) due = std::min(due, state_.outlook.arrival);
  if (!state_.is_moving()) return due;
  auto reach = state_.coupling.reach();
  encoders_.limit(reach);
  if (!state_.coupling.stage().is_bare() || encoders_.are_watched())
    due = std::min(due, state_.motor->passing(reach.back, reach.ahead));
  if (state_.coupling.is_at_end()) due = std::min(due, state_.motor->turning());
  return due;
}

// ---- Switches

Switches Axis::sensed() const {
  const auto inputs = state_.coupling.stage().inputs();
  const auto wiring = state_.motor->wiring();
  Switches now{inputs.left != (limits_reversed_ != wiring.left_inverted),
               inputs.right != (limits_reversed_ != wiring.right_inverted), inputs.home};
  if (wiring.swapped) std::swap(now.left, now.right);
  return now;
}

void Axis::sense() {
  const auto before = std::exchange(state_.switches, sensed());
  const bool closes =
      (state_.switches.left && !before.left) || (state_.switches.right && !before.right);
  if (closes) latched_encoder_ = encoders_.own_position();
  const auto bars = search_.homing().ignores_ends()
                        ? Switches{}
                        : Switches{state_.switches.left, state_.switches.right};
  if (bars == barring_) return;
  barring_ = bars;
  state_.motor->set_switches(bars.left, bars.right);
  state_.look_ahead();
}

// ---- Watching, searching

void Axis::watch_encoders() {
  const bool deviated = std::exchange(deviates_, encoders_.are_exceeded());
  if (!deviates_ || (deviated && !state_.is_moving())) return;
  emergency_stop(deviation_error);
}

void Axis::emergency_stop(std::int32_t error) {
  errors_ |= error;
  search_.abort();
  state_.motor->halt();
  state_.look_ahead();
}

Status Axis::start_search() {
  const auto mode = search_.mode();
  if (!mode) return Status::invalid_value;
  begin_movement();
  search_.start(*mode);
  settle();
  return Status::ok;
}

void Axis::stop_search() {
  if (search_step() != 0) stop();
}

}  // namespace tmcl::sim
