// ramp.
#include <cmath>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "api/ramp_view.hpp"
#include "axis/offline_axis.hpp"
#include "output/print.hpp"
#include "profile/ramp_export.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/api/ramp.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ramp_registers.hpp"
#include "tmcl/plan/ramp_search.hpp"
#include "tmcl/plan/ramp_wish.hpp"
#include "tmcl/scale_factor.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
namespace plan = tmcl::plan;
using api::axis::Ramp;

template <class Method>
Method method_of(const verb::Ramp& verb) {
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  Method method;
  method.axis = verb.axis;
  method.velocity = typed(verb.velocity).amount();
  method.velocity_internal = typed(verb.velocity).counted();
  method.acceleration = typed(verb.acceleration).amount();
  method.acceleration_internal = typed(verb.acceleration).counted();
  method.deceleration = typed(verb.deceleration).amount();
  method.deceleration_internal = typed(verb.deceleration).counted();
  method.jerk = typed(verb.jerk).amount();
  method.bow = typed(verb.jerk).counted();
  return method;
}

json::object to_json(const verb::Ramp& verb, const Ramp& ramp) {
  auto document = api::to_json(ramp);
  document["axis"] = verb.axis;
  document.erase(api::name_of<&Ramp::settings>());
  json::object parameters;
  for (const auto& setting : ramp.settings) parameters[setting.parameter] = setting.value;
  document["parameters"] = std::move(parameters);
  document["written"] = !verb.dry_run;
  return document;
}

/// One quantity of the ramp, in microsteps and in the unit of the axis.
struct Rate {
  double pulses;
  std::optional<double> in_unit;
  std::string_view in_pulses;
  std::string_view per_seconds;
};

std::vector<Rate> rates_of(const Ramp& ramp) {
  constexpr double noticeable = 1e-3;
  const auto difference = ramp.deceleration_pps2 / ramp.acceleration_pps2 - 1;
  std::vector<Rate> rates{{ramp.velocity_pps, ramp.velocity, "pps", "/s"},
                          {ramp.acceleration_pps2, ramp.acceleration, "pps/s", "/s^2"}};
  if (std::abs(difference) >= noticeable)
    rates.push_back({ramp.deceleration_pps2, ramp.deceleration, "pps/s", "/s^2"});
  if (ramp.jerk_pps3) rates.push_back({*ramp.jerk_pps3, ramp.jerk, "pps/s^2", "/s^3"});
  return rates;
}

std::string gives_text(const verb::Ramp& verb, const Ramp& ramp) {
  std::string text;
  for (const auto& rate : rates_of(ramp)) {
    text += text.empty() ? "gives " : ", ";
    text +=
        rate.in_unit && !verb.internal
            ? shown(InUnit{*rate.in_unit, *ramp.unit + std::string(rate.per_seconds)}, rate.pulses)
            : fmt::format("{} {}", tmcl::plain_number(rate.pulses, 10), rate.in_pulses);
  }
  return text + fmt::format("; up to speed in {} s and {:.0f} microsteps",
                            tmcl::plain_number(ramp.ramp_s, 4), ramp.ramp_microsteps);
}

void show(const verb::Ramp& verb, const Ramp& ramp, Output& output) {
  warn(ramp.warnings, output);
  if (output.json) return print_json(to_json(verb, ramp), output);
  for (const auto& setting : ramp.settings)
    output.out << fmt::format("{:<18} {}\n", setting.parameter, setting.value);
  output.out << gives_text(verb, ramp) << (verb.dry_run ? "; nothing was written" : "") << '\n';
  warn(ramp.remarks, output);
}

// ---- all ramps of a model beside each other

using api::ramp::ComparedRamp;
using api::ramp::Comparison;

/// "max_bow 8"
std::string settings_text(const ComparedRamp& ramp) {
  std::string text;
  for (const auto& setting : ramp.settings)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", setting.parameter, setting.value);
  return text.empty() ? "as it is" : text;
}

void show(const Comparison& comparison, Output& output) {
  if (output.json) return print_json(api::to_json(comparison), output);
  const bool has_load = comparison.tolerance_microsteps.has_value();
  const auto unit = comparison.unit.value_or("microsteps");
  std::vector<std::string> headings{"RAMP", "TIME [s]", "LONGEST PHASE [s]"};
  if (has_load) headings.insert(headings.end(), {fmt::format("SWINGS [{}]", unit), "SETTLED [s]"});
  Table table(headings);
  const auto number = [](std::optional<double> value, const char* none) {
    return value ? tmcl::plain_number(*value, 5) : std::string(none);
  };
  for (const auto& ramp : comparison.ramps) {
    std::vector<std::string> cells{settings_text(ramp), number(ramp.move_s, "swings for ever"),
                                   number(ramp.longest_phase_s, "")};
    if (has_load) {
      cells.push_back(number(comparison.unit ? ramp.swing : ramp.swing_microsteps, "-"));
      cells.push_back(number(ramp.settled_s, ramp.move_s ? "never" : "-"));
    }
    table.add(std::move(cells));
  }
  table.print(output);
  if (!comparison.proposed) {
    if (has_load) output.out << "with none of them does the load come to rest\n";
    return;
  }
  const auto& best = comparison.ramps.at(static_cast<std::size_t>(*comparison.proposed));
  output.out << fmt::format("the load stands first with {}, after {} s\n", settings_text(best),
                            tmcl::plain_number(*best.settled_s, 4));
}

Result<ExitCode> compare_on_axis(const verb::Ramp& verb, Context& context) {
  auto method = method_of<api::ramp::Compare>(verb);
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  method.distance = typed(verb.distance).amount();
  method.distance_microsteps = typed(verb.distance).counted();
  method.resonance_hz = verb.resonance_hz;
  method.damping = verb.damping;
  method.tolerance = typed(verb.tolerance).amount();
  method.tolerance_microsteps = typed(verb.tolerance).counted();
  const auto comparison = context.call(method);
  if (!comparison) return tl::unexpected(comparison.error());
  show(*comparison, context.output);
  return ExitCode::done;
}

Result<tmcl::Microsteps> length_of(const std::string& text, const AxisUnits& units) {
  return typed_quantity(text, units).and_then([](const TypedQuantity& typed) {
    return attempt(to_microsteps(typed.quantity, typed.units));
  });
}

/// Of the move that a ramp is for.
Result<tmcl::Microsteps> way_of(const std::string& text, const AxisUnits& units) {
  const auto way = length_of(text, units);
  if (way && *way == tmcl::Microsteps{}) {
    return tl::unexpected(
        usage_error("not_foreseeable", "--distance is 0: such a move has no ramp"));
  }
  return way;
}

/// `unit`: how many of it a microstep is.
Result<Comparison> compared(const verb::Ramp& verb, const plan::PlannedRamp& planned,
                            const AxisUnits& units, std::optional<double> unit) {
  const auto distance = way_of(verb.distance, units);
  if (!distance) return tl::unexpected(distance.error());
  std::optional<plan::LoadWish> load;
  if (verb.resonance_hz) {
    load = {{*verb.resonance_hz, verb.damping.value_or(tmcl::ramp::usual_load_damping)},
            plan::usual_load_tolerance * std::abs(static_cast<double>(distance->value))};
  }
  if (load && !verb.tolerance.empty()) {
    const auto tolerance = length_of(verb.tolerance, units);
    if (!tolerance) return tl::unexpected(tolerance.error());
    load->tolerance = std::abs(static_cast<double>(tolerance->value));
  }
  const auto& model = *units.model;
  const auto& settings = planned.choice.settings;
  Comparison comparison{{}, std::string(model.name)};
  if (unit) comparison.unit = units.scale->unit;
  comparison.distance_microsteps = distance->value;
  if (load) comparison.tolerance_microsteps = load->tolerance;
  std::vector<plan::RampVerdict> verdicts;
  for (const auto& variant : plan::ramp_variants(model, settings)) {
    const auto verdict = plan::judge_variant(model, settings, variant, *distance, load);
    if (!verdict) {
      return tl::unexpected(usage_error(
          "not_foreseeable", fmt::format("how a {} makes a move by {} microsteps is not described",
                                         model.name, distance->value)));
    }
    verdicts.push_back(*verdict);
    comparison.ramps.push_back(tmcld::view_of(variant, verdicts.back(), model, unit));
  }
  if (const auto first = plan::first_settled(verdicts))
    comparison.proposed = static_cast<std::int32_t>(*first);
  return comparison;
}

// ---- on an axis that need not be there

/// What is typed without a unit is what the module counts; it is told in microsteps.
Result<Quantity> rate_of(const std::string& text, const AxisUnits& units,
                         tmcl::Dimension dimension) {
  const auto typed = typed_quantity(text, units);
  if (!typed) return tl::unexpected(typed.error());
  if (!typed->quantity.unit.empty()) return typed->quantity;
  if (dimension == tmcl::Dimension::velocity) {
    return attempt(to_pps(typed->quantity, typed->units)).map([](tmcl::PulsesPerSecond velocity) {
      return Quantity{velocity.value, "microsteps/s"};
    });
  }
  return attempt(to_pps2(typed->quantity, typed->units)).map([](tmcl::PulsesPerSecond2 change) {
    return Quantity{change.value, "microsteps/s^2"};
  });
}

Result<std::optional<plan::JerkWish>> jerk_of(const std::string& text, bool internal) {
  using Jerk = std::optional<plan::JerkWish>;
  if (text.empty()) return Jerk();
  if (text == "max") return Jerk(plan::JerkWish{.highest = true});
  if (const auto bow = Typed{text, internal}.counted()) {
    if (*bow >= 1 && *bow <= tmcl::greatest_bow) return Jerk(plan::JerkWish{.bow = *bow});
    return tl::unexpected(usage_error(
        "out_of_range", fmt::format("--jerk: a bow is 1 to {}, not {}", tmcl::greatest_bow, *bow)));
  }
  return attempt(tmcl::parse_quantity(text)).map([](Quantity quantity) {
    return Jerk(plan::JerkWish{.quantity = std::move(quantity)});
  });
}

Result<plan::RampWish> wish_of(const verb::Ramp& verb, const AxisUnits& units) {
  const auto velocity = rate_of(verb.velocity, units, tmcl::Dimension::velocity);
  if (!velocity) return tl::unexpected(velocity.error());
  const auto acceleration = rate_of(verb.acceleration, units, tmcl::Dimension::acceleration);
  if (!acceleration) return tl::unexpected(acceleration.error());
  plan::RampWish wish{*velocity, *acceleration};
  if (!verb.deceleration.empty()) {
    const auto deceleration = rate_of(verb.deceleration, units, tmcl::Dimension::acceleration);
    if (!deceleration) return tl::unexpected(deceleration.error());
    wish.deceleration = *deceleration;
  }
  return jerk_of(verb.jerk, verb.internal).map([&](std::optional<plan::JerkWish> jerk) {
    wish.jerk = std::move(jerk);
    return wish;
  });
}

std::int32_t initial_bow(const AxisUnits& units) {
  const auto* row = find_parameter(units.parameters(), tmcl::number_of("max_bow"));
  return units.model->family == tmcl::Family::tmc457 && row != nullptr ? row->initial : 0;
}

/// Parameters and the registers that they end up in, beside each other.
struct SettingRow {
  std::string parameter;
  int number;
  std::int32_t value;
  std::string chip_register;  // Empty: in no one register.
  std::optional<std::int64_t> held;
};

std::vector<SettingRow> rows_of(const Ramp& ramp, const AxisUnits& units) {
  const auto registers = plan::RampRegisters::of(*units.model);
  std::vector<SettingRow> rows;
  for (const auto& setting : ramp.settings) {
    SettingRow row{setting.parameter, setting.number, setting.value, {}, {}};
    const auto& info =
        *find_parameter(units.parameters(), static_cast<std::uint8_t>(setting.number));
    const auto writes =
        registers ? registers->writes_of(info, setting.value) : std::vector<plan::RegisterWrite>{};
    if (!writes.empty()) {
      row.chip_register = registers->registers()[writes.front().index].name;
      row.held = writes.front().value;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// By how much of the wish the ramp is off, in parts of it.
struct Deviation {
  std::string_view of;
  double share;
};
std::vector<Deviation> deviations(const Ramp& ramp, const plan::RampWish& wish,
                                  const AxisUnits& units) {
  std::vector<Deviation> all;
  const auto add = [&](std::string_view what, double got, const auto& wished) {
    if (wished) all.push_back({what, got / wished->value - 1});
  };
  const auto undirected = units.undirected();
  add("velocity", ramp.velocity_pps, to_pps(wish.velocity, undirected));
  add("acceleration", ramp.acceleration_pps2, to_pps2(wish.acceleration, undirected));
  add("deceleration", ramp.deceleration_pps2,
      to_pps2(wish.deceleration.value_or(wish.acceleration), undirected));
  if (ramp.jerk_pps3 && wish.jerk && wish.jerk->quantity)
    add("jerk", *ramp.jerk_pps3, to_pps3(*wish.jerk->quantity, undirected));
  return all;
}

json::object offline_json(const Ramp& ramp, const std::vector<SettingRow>& rows,
                          const std::vector<Deviation>& off) {
  auto document = api::to_json(ramp);
  document.erase(api::name_of<&Ramp::axis>());
  document.erase(api::name_of<&Ramp::settings>());
  json::object parameters;
  json::object registers;
  for (const auto& row : rows) {
    parameters[row.parameter] = row.value;
    if (row.held) registers[row.chip_register] = *row.held;
  }
  document["parameters"] = std::move(parameters);
  document["registers"] = std::move(registers);
  json::object deviation;
  for (const auto& [of, share] : off) deviation[of] = share;
  document["deviation"] = std::move(deviation);
  document["written"] = false;
  return document;
}

void show_offline(const verb::Ramp& verb, const Ramp& ramp, const plan::RampWish& wish,
                  const AxisUnits& units, Output& output) {
  warn(ramp.warnings, output);
  const auto rows = rows_of(ramp, units);
  const auto off = deviations(ramp, wish, units);
  if (output.json) return print_json(offline_json(ramp, rows, off), output);
  Table table({"PARAMETER", "NUMBER", "VALUE", "REGISTER", "HOLDS"});
  for (const auto& row : rows) {
    table.add({row.parameter, std::to_string(row.number), std::to_string(row.value),
               row.held ? row.chip_register : "-", row.held ? std::to_string(*row.held) : "-"});
  }
  table.print(output);
  output.out << gives_text(verb, ramp) << "; nothing was written\n";
  std::string text;
  for (const auto& [of, share] : off)
    text += fmt::format("{}{} {:+.3f} %", text.empty() ? "off the wish: " : ", ", of, share * 100);
  output.out << text << '\n';
  warn(ramp.remarks, output);
}

/// Of one motor of the model, for other programs.
Result<void> print_export(const verb::Ramp& verb, const Ramp& ramp, const tmcl::Model& model,
                          Output& output) {
  if (verb.motor >= model.axes) {
    return tl::unexpected(
        usage_error("out_of_range", fmt::format("a {} has no motor {}", model.name, verb.motor)));
  }
  profile::RampExport to_export{model, verb.motor, gives_text(verb, ramp), {}};
  for (const auto& setting : ramp.settings)
    to_export.settings.push_back({static_cast<std::uint8_t>(setting.number), setting.value});
  warn(ramp.warnings, output);
  if (*verb.as == profile::ExportForm::c && chip_words(to_export).empty()) {
    return tl::unexpected(usage_error(
        "not_foreseeable",
        fmt::format("a {} makes its ramps with no registers whose addresses are known here",
                    model.name),
        "--as sap is of its parameters"));
  }
  output.out << text_of(to_export, *verb.as);
  return {};
}

// ---- a ramp that is sought

using api::ramp::Found;

bool is_sought(const verb::Ramp& verb) { return verb.time_s || verb.fastest; }
bool has_figures(const plan::MotorTorque& motor) { return motor != plan::MotorTorque{}; }

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

Reading read_form(const std::string& text, std::optional<profile::ExportForm>& into) {
  return profile::export_form(text).map([&](profile::ExportForm form) { into = form; });
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

Result<ExitCode> run_on_model(const verb::Ramp& verb, Output& output) {
  const auto units = axis_units_of(verb.offline);
  if (!units) return tl::unexpected(units.error());
  std::optional<double> unit;
  if (units->has_unit()) unit = 1 / std::abs(tmcl::microsteps_per_unit(*units->scale));
  if (is_sought(verb)) return find_on_model(verb, *units, unit, output);
  const auto wish = wish_of(verb, *units);
  if (!wish) return tl::unexpected(wish.error());
  const auto planned = plan::plan_ramp(*wish, *units, initial_bow(*units));
  if (!planned) return tl::unexpected(error_from(planned.error().error));
  if (verb.compare) {
    const auto comparison = compared(verb, *planned, *units, unit);
    if (!comparison) return tl::unexpected(comparison.error());
    show(*comparison, output);
    return ExitCode::done;
  }
  auto ramp = tmcld::view_of(*planned, *units->model, unit);
  if (unit) ramp.unit = units->scale->unit;
  if (verb.as)
    return print_export(verb, ramp, *units->model, output).map([] { return ExitCode::done; });
  show_offline(verb, ramp, *wish, *units, output);
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Ramp& verb, Context& context) {
  if (verb.compare) return compare_on_axis(verb, context);
  if (is_sought(verb)) return find_on_axis(verb, context);
  auto set = method_of<api::axis::SetRamp>(verb);
  if (verb.store) set.store = true;
  const auto ramp =
      verb.dry_run ? context.call(method_of<api::axis::PlanRamp>(verb)) : context.call(set);
  if (!ramp) return tl::unexpected(ramp.error());
  show(verb, *ramp, context.output);
  if (!verb.dry_run && !context.output.json)
    context.output.out << (verb.store
                               ? "it is stored: the module starts with it\n"
                               : "it holds until the module loses power: --store keeps it\n");
  return ExitCode::done;
}

Reading read_move_time(const std::string& text, std::optional<double>& seconds) {
  constexpr double least_s = 1e-6;
  constexpr double greatest_s = 86'400;
  double said_s = 0;
  return read_time(text, least_s, greatest_s, said_s).map([&] { seconds = said_s; });
}

/// 30%, or 0.3. A 30 alone is hardly meant as 3000%.
Reading read_margin(std::string text, double& margin) {
  constexpr double greatest_percent = 10'000;
  const bool in_percent = text.ends_with('%');
  if (in_percent) text.pop_back();
  const auto value = parse_number<double>(text, 0, greatest_percent);
  if (!value) return tl::unexpected(value.error());
  if (!in_percent && *value > 1)
    return tl::unexpected(fmt::format("{0} is a part above 1: give {0}%, or a part", text));
  margin = in_percent ? *value / 100 : *value;
  return {};
}

bool asks_for_torque(const plan::MotorTorque& motor) {
  return motor.load > 0 || motor.load_per_velocity > 0 || motor.inertia > 0;
}

std::string conflict_of_search(const verb::Ramp& said) {
  if (said.time_s && said.fastest) return "--time and --fastest exclude each other";
  if (!is_sought(said)) {
    if (has_figures(said.torque)) return "the figures of a motor need --fastest or --time";
    if (said.velocity.empty() || said.acceleration.empty())
      return "give --velocity and --acceleration, or --time or --fastest";
    return "";
  }
  if (said.compare) return "--compare and --time or --fastest exclude each other";
  if (said.distance.empty()) return "--time and --fastest need --distance";
  if (said.fastest && !asks_for_torque(said.torque))
    return "--fastest needs --load, --friction or --inertia: without a load only the chip bounds "
           "it";
  if (!said.acceleration.empty() || !said.deceleration.empty())
    return "--time and --fastest find the acceleration";
  return said.store ? "--store needs an axis that is set" : "";
}

std::string conflict_in(const verb::Ramp& said, bool json) {
  if (said.as && !said.offline.is_meant()) return "--as needs --model";
  if (said.as && json) return "--as and --json exclude each other";
  if (said.store && (said.offline.is_meant() || said.compare || said.dry_run))
    return "--store needs an axis that is set";
  if (said.as && said.compare) return "--as and --compare exclude each other";
  if (said.compare && said.distance.empty()) return "--compare needs --distance";
  if (!said.distance.empty() && !said.compare && !is_sought(said))
    return "--distance needs --compare, --time or --fastest";
  if (said.resonance_hz && !said.compare) return "--resonance needs --compare";
  if (said.damping && !said.resonance_hz) return "--damping needs --resonance";
  if (!said.tolerance.empty() && !said.resonance_hz) return "--tolerance needs --resonance";
  if (said.axis.empty() == !said.offline.is_meant()) return "name an axis, or say --model MODEL";
  if (auto conflict = conflict_of_search(said); !conflict.empty()) return conflict;
  return objection_to(said.offline);
}

constexpr const char* ramp_help = R"(
On a module with a TMC429 it chooses pulse divider, ramp divider, max_velocity and max_acceleration so
that they come as near to the wish as the chip can, and a minimum_velocity with which the last
microstep takes no longer than the others; on other modules it sets max_velocity and all
accelerations of a ramp. It shows what they give, and refuses while the axis moves. A wish that
cannot be met is refused with the nearest value that can.
The dividers scale the other speeds of the axis, too, such as those of the reference search.

On a TMC457 --jerk makes S-shaped ramps: the greatest bow that does not exceed it and with which the
motor does not swing around its target; max is the greatest of these. A jerk below that of the
smallest bow, 909495pps/s^2, is refused, and so is any jerk but max on a module without bows. Without
--jerk the bow is left as it is, and 'tmclctl set x max_bow 0' switches it off. The last line says how long it takes to come
up to speed, and how far that is.

  tmclctl ramp x --velocity 50000pps --acceleration 200000pps/s
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --deceleration 50mm/s^2
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --jerk max --dry-run

With --model instead of AXIS it computes the same of an axis that need not be there: a module as it is
when it starts, with the screw or what else it drives. It shows the registers of the chip beside the
parameters, and how far what they give is off the wish. --as prints them for other programs: sap and tmc
are lines and a program that 'tmclctl program' assembles, c is a table of the chip's registers at 16 MHz.

  tmclctl ramp --model TMCM-142 --screw-pitch 5 --velocity 20mm/s --acceleration 500mm/s^2 --jerk max
  tmclctl ramp --model TMCM-142 --velocity 20rps --acceleration 50rps/s --as sap --motor 0
  tmclctl ramp --model TMCM-6212 --units-per-revolution 360 --unit deg --velocity 90deg/s --acceleration 2rps/s

--compare sets nothing: it shows what all bows of a TMC457 or a TMC4361, or sets of A1, V1 and D1 on a
sixPoint chip, make of a move: its time and its longest phase. With --resonance a load swings behind
the motor; then it shows how far that still swings when the motor has arrived, when it swings by no
more than --tolerance, and with which ramp that is first.

  tmclctl ramp --model TMCM-142 --screw-pitch 5 --velocity 20mm/s --acceleration 200mm/s^2 --compare --distance 10mm --resonance 12Hz --tolerance 0.01mm

--time and --fastest find the velocity and the acceleration, and set nothing. --time: the least
acceleration with which a move by --distance takes no longer, and the least velocity with that. --fastest:
the ramp with which it takes the shortest time, and asks at each speed for no more torque than the motor
has by --load, --friction, --inertia and --corner-speed; --margin of what is asked is left. The figures are those
of a motor under load in the simulator, in 1/1000 of the torque that the motor holds, for full steps
and seconds. Both let the ramp generator make the move, to the tick; no velocity is above --velocity.

  tmclctl ramp x --time 1s --distance 10mm
  tmclctl ramp --model TMCM-6212 --screw-pitch 5 --time 800ms --distance 20mm --as tmc
  tmclctl ramp --model TMCM-6212 --screw-pitch 5 --fastest --distance 20mm --inertia 20000 --friction 50 --corner-speed 600 --margin 30%
)";

void add_search(VerbForm<verb::Ramp>& ramp) {
  constexpr double greatest_figure = 1e9;
  auto& typed = *ramp.operator->();
  ramp.option("--time", "TIME", "Find the gentlest ramp with which the move takes no longer",
              [&typed](const std::string& text) { return read_move_time(text, typed.time_s); });
  ramp.flag("--fastest", "Find the quickest ramp for which the motor has the torque",
            ramp->fastest);
  ramp.option("--load", "TORQUE", "What the motor drives, in 1/1000 of the torque that it holds",
              number(ramp->torque.load, 0, greatest_figure));
  ramp.option("--friction", "TORQUE",
              "More of it for each full step a second, in 1/1000: load_per_velocity",
              number(ramp->torque.load_per_velocity, 0, greatest_figure));
  ramp.option("--inertia", "TORQUE", "More of it for each full step a second squared, in 1/1000000",
              number(ramp->torque.inertia, 0, greatest_figure));
  ramp.option("--corner-speed", "SPEED",
              "Full steps a second above which the torque of the motor falls",
              number(ramp->torque.corner_speed, 1, greatest_figure));
  ramp.option("--margin", "PART", "Torque to leave, of what is asked (default 30%)",
              [&typed](const std::string& text) { return read_margin(text, typed.margin); });
}

}  // namespace

void add_ramp(Grammar& grammar) {
  auto ramp = grammar.verb<verb::Ramp>(
      "ramp", access::acts, "Choose and set registers for a velocity and an acceleration",
      ramp_help, run);
  ramp.optional_word("AXIS", axis_meaning, text(ramp->axis));
  add_offline_axis(ramp, ramp->offline);
  ramp.option("--velocity", "VELOCITY",
              "Of positioning moves, such as 50000pps; with --time and --fastest no more than this",
              text(ramp->velocity));
  ramp.option("--acceleration", "ACCELERATION", "Of every ramp, such as 100mm/s^2",
              text(ramp->acceleration));
  ramp.option("--deceleration", "ACCELERATION", "To brake with, where the module has it apart",
              text(ramp->deceleration));
  ramp.option("--jerk", "JERK",
              "How fast the acceleration changes, such as 500mm/s^3, or max; as it is without",
              text(ramp->jerk));
  auto& typed = *ramp.operator->();
  ramp.option("--as", "FORM", "With --model: print it for other programs: sap, tmc, c or json",
              [&typed](const std::string& text) { return read_form(text, typed.as); });
  ramp.option("--motor", "N", "With --as sap and tmc: of the module (default 0)",
              number(ramp->motor, 0, 255));
  ramp.flag("--compare", "Show all bows, or sets of A1, V1 and D1, for a move; nothing is set",
            ramp->compare);
  ramp.option("--distance", "DISTANCE",
              "With --compare, --time and --fastest: of the move, such as 10mm",
              text(ramp->distance));
  add_search(ramp);
  ramp.option("--resonance", "HZ", "With --compare: follow a load that swings so behind the motor",
              resonance(typed.resonance_hz));
  ramp.option("--damping", "D", "Of its swings: 0 to less than 1 (default 0.05)",
              number(ramp->damping, 0, 0.999));
  ramp.option("--tolerance", "DISTANCE",
              "Within which the load is to stand (default: a thousandth of the move)",
              text(ramp->tolerance));
  ramp.flag("--dry-run", "Only show what would be set", ramp->dry_run);
  ramp.flag("--store", "Keep it in the module's EEPROM, too", ramp->store);
  ramp.internal(ramp->internal);
  ramp.alone([](const verb::Ramp& said) { return said.offline.is_meant(); }, run_on_model);
  ramp.object(conflict_in);
}

}  // namespace tmclctl
