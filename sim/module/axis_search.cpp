// The reference search: what Homing orders, carried out.
#include <cstdlib>

#include "sim/module/axis.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

}  // namespace

Status Axis::start_search() {
  // A model without the parameter has the mode that all have.
  const bool has_modes = find_parameter(table_, number_of("reference_search_mode")) != nullptr;
  const auto mode =
      SearchMode::of(family_, has_modes ? values_[number_of("reference_search_mode")] : 1);
  if (!mode) return Status::invalid_value;
  begin_movement();
  homing_.abort();
  obey(homing_.start(*mode, switches_, motor_->position()));
  settle();
  return Status::ok;
}

void Axis::stop_search() {
  if (homing_.active()) stop();
}

void Axis::run_search() {
  if (!homing_.active()) return;
  obey(homing_.see(switches_, motor_->position()));
  if (!homing_.returns()) return;
  if (outlook_.arrival <= now_) obey(homing_.arrived());
}

void Axis::obey(const Homing::Order& order) {
  using Kind = Homing::Order::Kind;
  switch (order.kind) {
    case Kind::go_on: return;
    case Kind::search: drive(order.direction, number_of("reference_search_speed")); break;
    case Kind::switching: drive(order.direction, number_of("reference_switch_speed")); break;
    case Kind::drive_to: motor_->move_to(order.position); break;
    case Kind::finish: finish_search(order.position); break;
  }
  look_ahead();
}

// A speed that was never set is no wish to stand: old firmware takes 0 for the full speed.
void Axis::drive(int direction, std::uint8_t speed_parameter) {
  const auto full = in_force(*find_parameter(table_, ap::max_velocity));
  const auto wanted = values_[speed_parameter] != 0 ? values_[speed_parameter] : full;
  motor_->rotate(std::int64_t{direction} * wanted);
}

// An encoder is set as well; it would deviate for ever otherwise.
void Axis::finish_search(std::int32_t reference) {
  values_[number_of("last_reference_position")] = reference;
  if (const auto end = homing_.other_end()) {
    const auto way = way_between(reference, *end, motor_->position_bits());
    values_[number_of("reference_switch_distance")] = static_cast<std::int32_t>(std::abs(way));
  }
  motor_->set_position(0);
  coupling_.rebase();
  encoder_.set_position(0, coupling_.stage());
  external_encoder_.set_position(0, coupling_.stage());
}

}  // namespace tmcl::sim
