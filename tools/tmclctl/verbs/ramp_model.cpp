// ramp --model: on an axis that need not be there.
#include <cmath>

#include <fmt/format.h>
#include <boost/json/object.hpp>

#include "api/ramp_view.hpp"
#include "output/print.hpp"
#include "profile/ramp_export.hpp"
#include "ramp_words.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_registers.hpp"
#include "tmcl/scale_factor.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
namespace plan = tmcl::plan;
using api::axis::Ramp;

}  // namespace

Result<tmcl::Microsteps> length_of(const std::string& text, const AxisUnits& units) {
  return typed_quantity(text, units).and_then([](const TypedQuantity& typed) {
    return attempt(to_microsteps(typed.quantity, typed.units));
  });
}

Result<tmcl::Microsteps> way_of(const std::string& text, const AxisUnits& units) {
  const auto way = length_of(text, units);
  if (way && *way == tmcl::Microsteps{}) {
    return tl::unexpected(
        usage_error("not_foreseeable", "--distance is 0: such a move has no ramp"));
  }
  return way;
}

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

std::int32_t initial_bow(const AxisUnits& units) {
  const auto* row = find_parameter(units.parameters(), tmcl::number_of("max_bow"));
  return units.model->family == tmcl::Family::tmc457 && row != nullptr ? row->initial : 0;
}

namespace {

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

}  // namespace

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
  if (verb.compare) return compare_on_model(verb, *planned, *units, unit, output);
  auto ramp = tmcld::view_of(*planned, *units->model, unit);
  if (unit) ramp.unit = units->scale->unit;
  if (verb.as)
    return print_export(verb, ramp, *units->model, output).map([] { return ExitCode::done; });
  show_offline(verb, ramp, *wish, *units, output);
  return ExitCode::done;
}

}  // namespace tmclctl
