#include "api/path_request.hpp"

#include <utility>

#include "api/quantity.hpp"
#include "api/resonance_request.hpp"

namespace tmcld {
namespace {

namespace plan = tmcl::plan;
using api::path::OfPath;

Result<plan::StreamMode> mode_of(const OfPath& params) {
  const auto mode = plan::stream_mode_named(params.mode.value_or("velocity"));
  if (mode) return *mode;
  return tl::unexpected(param_error<&OfPath::mode>(
      "bad_argument", "'mode' must be 'velocity', 'segments' or 'position'"));
}

Result<double> in_range(double value, std::string_view param) {
  if (value >= plan::least_of_path && value <= plan::most_of_path) return value;
  return tl::unexpected(
      param_error("out_of_range", param, "'" + std::string(param) + "' is outside 1e-9..1e9"));
}

/// A number is in the file's units, a text has its own with it.
Result<tmcl::Quantity> quantity_of(const api::Amount& amount, std::string_view param) {
  if (const auto* number = std::get_if<double>(&amount.said))
    return in_range(*number, param).map([](double value) { return tmcl::Quantity{value, {}}; });
  const auto said = tmcl::parse_quantity(std::get<std::string>(amount.said));
  if (!said) return tl::unexpected(quantity_error(param, said.error()));
  if (!said->unit.empty()) return *said;
  return tl::unexpected(param_error("bare_number", param,
                                    "'" + std::string(param) + "' is a text without a unit",
                                    "give a number, in the units of the file, or a text with a "
                                    "unit, such as '20mm/s'"));
}

/// Reads fields one by one until one is wrong.
class Reading {
 public:
  explicit Reading(const OfPath& params) : params_(params) {}

  template <auto member, class Into>
  void number(Into& into) {
    if (!wrong_ && params_.*member)
      take(in_range(*(params_.*member), api::name_of<member>()), into);
  }
  template <auto member>
  void quantity(std::optional<tmcl::Quantity>& into) {
    if (!wrong_ && params_.*member)
      take(quantity_of(*(params_.*member), api::name_of<member>()), into);
  }
  const std::optional<Error>& wrong() const { return wrong_; }

 private:
  template <class T, class Into>
  void take(Result<T> value, Into& into) {
    if (value) {
      into = std::move(*value);
    } else {
      wrong_ = std::move(value.error());
    }
  }

  const OfPath& params_;
  std::optional<Error> wrong_;
};

}  // namespace

Result<plan::PathRequest> request_of(const OfPath& params) {
  plan::PathRequest request;
  const auto mode = mode_of(params);
  if (!mode) return tl::unexpected(mode.error());
  request.mode = *mode;
  Reading reading(params);
  reading.number<&OfPath::tolerance>(request.tolerance);
  reading.number<&OfPath::per_turn>(request.per_turn);
  reading.number<&OfPath::deviation>(request.deviation);
  reading.quantity<&OfPath::velocity>(request.velocity);
  reading.quantity<&OfPath::acceleration>(request.acceleration);
  reading.quantity<&OfPath::feed>(request.feed);
  reading.quantity<&OfPath::corner_jump>(request.corner_jump);
  reading.quantity<&OfPath::jerk>(request.jerk);
  if (reading.wrong()) return tl::unexpected(*reading.wrong());
  if (request.jerk && request.mode == plan::StreamMode::position) {
    return tl::unexpected(param_error<&OfPath::mode>(
        "bad_argument", "position mode cannot limit a jerk", "use velocity mode, or segments"));
  }
  if (params.period_ms) request.period = std::chrono::milliseconds(*params.period_ms);
  return request;
}

Task<std::optional<plan::Shaping>> shaping_of(const OfPath& params) {
  if (!params.shaper) co_return std::nullopt;
  const auto shaper = plan::shaper_named(*params.shaper);
  if (!shaper)
    co_return param_error<&OfPath::shaper>("bad_argument", "'shaper' must be 'zv', 'zvd' or 'ei'");
  const auto resonance = co_await must(resonance_of(params.resonance_hz, params.damping));
  if (!resonance) {
    co_return param_error<&OfPath::resonance_hz>(
        "bad_argument", "'shaper' needs 'resonance_hz'",
        "'tmclctl resonance AXIS' measures it where there is an encoder");
  }
  if (params.mode.value_or("") == name_of(plan::StreamMode::position)) {
    co_return param_error<&OfPath::mode>("bad_argument", "position mode cannot shape a path",
                                         "use velocity mode, or segments");
  }
  const plan::Shaping shaping{*shaper, *resonance};
  co_return shaping;
}

Result<std::optional<plan::PathFormat>> format_in(const OfPath& params) {
  if (!params.format) return std::nullopt;
  for (const auto format : {plan::PathFormat::csv, plan::PathFormat::gcode}) {
    if (*params.format == name_of(format)) return format;
  }
  return tl::unexpected(
      param_error<&OfPath::format>("bad_argument", "'format' must be 'csv' or 'gcode'"));
}

}  // namespace tmcld
