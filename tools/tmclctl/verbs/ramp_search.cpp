// ramp --time, ramp --fastest: a ramp that is sought.
#include <cmath>

#include <fmt/format.h>
#include <boost/json/object.hpp>

#include "api/ramp_view.hpp"
#include "output/print.hpp"
#include "ramp_words.hpp"
#include "tmcl/api/ramp.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_search.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
namespace plan = tmcl::plan;
using api::ramp::Found;

json::object found_json(const Found& found) {
  auto document = api::to_json(found);
  if (found.axis.empty()) document.erase(api::name_of<&Found::axis>());
  document.erase(api::name_of<&Found::settings>());
  json::object parameters;
  for (const auto& setting : found.settings) parameters[setting.parameter] = setting.value;
  document["parameters"] = std::move(parameters);
  document["written"] = false;
  return document;
}

/// "the move takes 0.9999 s and gets to 20 mm/s; asks for ..."
std::string move_text(const verb::Ramp& verb, const Found& found) {
  const bool in_unit = found.top_speed && !verb.internal;
  auto text =
      fmt::format("the move takes {} s and gets to {}", tmcl::plain_number(found.move_s, 6),
                  in_unit ? shown(InUnit{*found.top_speed, *found.unit + "/s"}, found.top_speed_pps)
                          : fmt::format("{} pps", tmcl::plain_number(found.top_speed_pps, 10)));
  if (!found.torque_share) return text;
  return text + fmt::format("; it asks for {:.1f} % of the torque at most, at {} pps",
                            100 * *found.torque_share,
                            tmcl::plain_number(found.torque_share_pps.value_or(0), 6));
}

void show(const verb::Ramp& verb, const Found& found, Output& output) {
  warn(found.warnings, output);
  if (output.json) return print_json(found_json(found), output);
  for (const auto& setting : found.settings)
    output.out << fmt::format("{:<18} {}\n", setting.parameter, setting.value);
  output.out << gives_text(verb, found) << "; nothing was written\n"
             << move_text(verb, found) << '\n';
  warn(found.remarks, output);
}

Result<plan::RampSearch> search_of(const verb::Ramp& verb, const AxisUnits& units) {
  plan::RampSearch search{units};
  const auto distance = way_of(verb.distance, units);
  if (!distance) return tl::unexpected(distance.error());
  search.distance = *distance;
  auto jerk = jerk_of(verb.jerk, verb.internal);
  if (!jerk) return tl::unexpected(jerk.error());
  search.jerk = std::move(*jerk);
  search.present_bow = initial_bow(units);
  if (verb.velocity.empty()) return search;
  return rate_of(verb.velocity, units, tmcl::Dimension::velocity)
      .and_then(
          [&](const Quantity& velocity) { return attempt(to_pps(velocity, units.undirected())); })
      .map([&](tmcl::PulsesPerSecond fastest) {
        search.fastest = fastest;
        return search;
      });
}

Result<Found> found_on_model(const verb::Ramp& verb, const AxisUnits& units,
                             std::optional<double> unit) {
  const auto search = search_of(verb, units);
  if (!search) return tl::unexpected(search.error());
  std::optional<plan::MotorWish> motor;
  if (verb.fastest || has_figures(verb.torque)) {
    motor = {verb.torque, std::ldexp(1, units.scale->steps.resolution), verb.margin};
  }
  const auto found = verb.time_s ? plan::gentlest_ramp(*search, *verb.time_s)
                                 : plan::quickest_ramp(*search, *motor);
  if (!found) {
    using Kind = plan::RampSearchFault::Kind;
    if (found.error().kind == Kind::objection)
      return tl::unexpected(error_from(found.error().objection->error));
    const bool is_described = found.error().kind != Kind::not_foreseeable;
    return tl::unexpected(usage_error(is_described ? "out_of_range" : "not_foreseeable",
                                      describe(found.error(), *search)));
  }
  auto view = tmcld::view_of(*found, *search, motor, unit);
  if (unit) view.unit = units.scale->unit;
  return view;
}

}  // namespace

Result<ExitCode> find_on_axis(const verb::Ramp& verb, Context& context) {
  constexpr auto longest_search = std::chrono::seconds(120);
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  api::ramp::Find method;
  method.axis = verb.axis;
  method.distance = typed(verb.distance).amount();
  method.distance_microsteps = typed(verb.distance).counted();
  method.time_s = verb.time_s;
  method.velocity = typed(verb.velocity).amount();
  method.velocity_internal = typed(verb.velocity).counted();
  method.jerk = typed(verb.jerk).amount();
  method.bow = typed(verb.jerk).counted();
  if (verb.fastest || has_figures(verb.torque)) {
    method.load = verb.torque.load;
    method.load_per_velocity = verb.torque.load_per_velocity;
    method.inertia = verb.torque.inertia;
    method.corner_speed = verb.torque.corner_speed;
    method.margin = verb.margin;
  }
  const auto found = context.call(method, tmcl::client::CallOptions{longest_search, {}});
  if (!found) return tl::unexpected(found.error());
  show(verb, *found, context.output);
  return ExitCode::done;
}

Result<ExitCode> find_on_model(const verb::Ramp& verb, const AxisUnits& units,
                               std::optional<double> unit, Output& output) {
  const auto found = found_on_model(verb, units, unit);
  if (!found) return tl::unexpected(found.error());
  if (verb.as)
    return print_export(verb, *found, *units.model, output).map([] { return ExitCode::done; });
  show(verb, *found, output);
  return ExitCode::done;
}

}  // namespace tmclctl
