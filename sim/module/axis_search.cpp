// The reference search: what Homing orders, carried out.
#include "sim/module/axis_search.hpp"

#include <cstdlib>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

}  // namespace

std::optional<SearchMode> AxisSearch::mode() const {
  // A model without the parameter has the mode that all have.
  constexpr auto number = number_of("reference_search_mode");
  const bool has_modes = find_parameter(axis_.table, number) != nullptr;
  return SearchMode::of(axis_.family, has_modes ? axis_.values[number] : 1);
}

void AxisSearch::start(const SearchMode& mode) {
  homing_.abort();
  obey(homing_.start(mode, axis_.switches, axis_.motor->position()));
}

void AxisSearch::run() {
  if (!homing_.active()) return;
  obey(homing_.see(axis_.switches, axis_.motor->position()));
  if (!homing_.returns()) return;
  if (axis_.outlook.arrival <= axis_.now) obey(homing_.arrived());
}

void AxisSearch::obey(const Homing::Order& order) {
  using Kind = Homing::Order::Kind;
  switch (order.kind) {
    case Kind::go_on: return;
    case Kind::search: drive(order.direction, number_of("reference_search_speed")); break;
    case Kind::switching: drive(order.direction, number_of("reference_switch_speed")); break;
    case Kind::drive_to: axis_.motor->move_to(order.position); break;
    case Kind::finish: finish(order.position); break;
  }
  axis_.look_ahead();
}

// A speed that was never set is no wish to stand: old firmware takes 0 for the full speed.
void AxisSearch::drive(int direction, std::uint8_t speed_parameter) {
  const auto full = axis_.in_force(*find_parameter(axis_.table, ap::max_velocity));
  const auto wanted = axis_.values[speed_parameter] != 0 ? axis_.values[speed_parameter] : full;
  axis_.motor->rotate(std::int64_t{direction} * wanted);
}

// An encoder is set as well; it would deviate for ever otherwise.
void AxisSearch::finish(std::int32_t reference) {
  axis_.values[number_of("last_reference_position")] = reference;
  if (const auto end = homing_.other_end()) {
    const auto way = way_between(reference, *end, axis_.motor->position_bits());
    axis_.values[number_of("reference_switch_distance")] = static_cast<std::int32_t>(std::abs(way));
  }
  axis_.motor->set_position(0);
  axis_.coupling.rebase();
  encoders_.zero();
}

}  // namespace tmcl::sim
