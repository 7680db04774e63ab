/// Positions, velocities and accelerations of a call. A JSON number is in the unit of the axis or
/// in what the parameter's name says; a JSON text has its unit with it (tmcl/quantity.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/asio/awaitable.hpp>

#include "api/lookup.hpp"
#include "api/task.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/quantity.hpp"

namespace tmcld {

/// What the module is to hold, and what was read to know it: nothing where nothing was.
struct ModuleValue {
  std::int32_t value = 0;
  std::optional<tmcl::AxisUnits> units{};
};

/// The same of a position or a distance.
struct ParsedLength {
  tmcl::Microsteps microsteps;
  std::optional<tmcl::UserPosition> in_unit{};
  std::optional<tmcl::UserScale> scale{};

  const tmcl::UserScale* known_scale() const { return scale ? &*scale : nullptr; }
  Length length() const { return {microsteps, in_unit}; }
};

/// Two parameters that say the same, with their names: what the module counts, and a quantity.
struct RawOrQuantity {
  std::string_view plain_name;
  std::string_view amount_name;
  std::optional<double> plain;
  std::optional<api::Amount> amount;
};
template <auto plain, auto amount, class Params>
RawOrQuantity raw_or_quantity(const Params& params) {
  return {api::name_of<plain>(), api::name_of<amount>(), params.*plain, params.*amount};
}

/// `row` is what holds the position; null: any will do. Errors: neither or both are there, what
/// tmcl::to_parameter() objects to, an axis without a unit.
Task<ParsedLength> length_of(GatewayAxis& axis, RawOrQuantity said, const tmcl::ParameterInfo* row);
/// The same of how far something goes. Its `scale` is that of places.
Task<ParsedLength> distance_of(GatewayAxis& axis, RawOrQuantity said);

/// A velocity or an acceleration, the same in both directions: in microsteps, and as it was said.
template <class Value>
struct ParsedRate {
  Value in_pulses;
  std::string_view param;  ///< Where it was said.
  tmcl::Quantity quantity;
  tmcl::AxisUnits units;  ///< What was read to know it.
};
/// Errors: neither or both are there; it is not above 0; what tmcl::to_pps() objects to.
Task<ParsedRate<tmcl::PulsesPerSecond>> velocity_rate_of(GatewayAxis& axis, RawOrQuantity said);
Task<ParsedRate<tmcl::PulsesPerSecond2>> acceleration_rate_of(GatewayAxis& axis,
                                                              RawOrQuantity said);
/// A number: in the axis' unit per second cubed.
Task<ParsedRate<tmcl::PulsesPerSecond3>> jerk_of(GatewayAxis& axis, const api::Amount& said);

/// An error about the parameter `param`.
Error quantity_error(std::string_view param, const tmcl::Error& error);

/// An upper limit of a velocity or an acceleration in microsteps, or nothing if both are absent.
/// Errors: both are there; it is not above 0, or above what the axis can do.
Task<std::optional<tmcl::PulsesPerSecond>> velocity_limit_of(GatewayAxis& axis, RawOrQuantity said);
Task<std::optional<tmcl::PulsesPerSecond2>> acceleration_limit_of(GatewayAxis& axis,
                                                                  RawOrQuantity said);

Task<ModuleValue> velocity_of(GatewayAxis& axis, RawOrQuantity said);
/// As the module wants it.
Task<ModuleValue> parameter_value_of(GatewayAxis& axis, RawOrQuantity said,
                                     const ParameterChoice& choice);

// What is told in the unit of the axis, beside what its module counts: nothing for an axis without
// one, and where the conversion is not known or could not be read. What was read for this call
// before need not be read again.

struct InUnit {
  std::optional<std::string> unit{};
  std::optional<double> number{};
};
boost::asio::awaitable<InUnit> in_unit(GatewayAxis& axis, std::optional<tmcl::Microsteps> position,
                                       const tmcl::UserScale* scale = nullptr);
/// How far something goes.
boost::asio::awaitable<InUnit> distance_in_unit(GatewayAxis& axis,
                                                std::optional<tmcl::Microsteps> distance);
/// Of a parameter; nothing also for one that is neither a position nor a velocity nor an
/// acceleration. `row` may be null.
boost::asio::awaitable<InUnit> in_unit(GatewayAxis& axis, const tmcl::ParameterInfo* row,
                                       ModuleValue value);
boost::asio::awaitable<InUnit> velocity_in_unit(GatewayAxis& axis, ModuleValue velocity);
boost::asio::awaitable<api::axis::Place> place_of(GatewayAxis& axis, tmcl::Microsteps position);

}  // namespace tmcld
