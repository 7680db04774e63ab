#include "module_lists.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "output/progress_line.hpp"
#include "tmcl/api/system.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// Of an axis whose module was not asked yet.
constexpr std::string_view unknown_state = "unknown";

std::string or_empty(const std::optional<std::string>& text) { return text.value_or(""); }

template <class Module>
ModuleRow module_from(const Module& found) {
  ModuleRow row;
  row.bus = found.bus;
  row.address = found.address;
  row.model = or_empty(found.model);
  row.model_number = found.model_number.value_or(0);
  row.firmware = or_empty(found.firmware);
  row.axes = found.axes.value_or(0);
  row.duplicate_suspected = found.duplicate_suspected;
  if constexpr (requires { found.state; }) {
    row.state = found.state;
    row.watched_by = found.watched_by;
    row.deadman = api::write_value(found.deadman);
    row.in_bootloader = found.state == "in_bootloader";
  } else {
    row.in_bootloader = found.in_bootloader;
    row.address_is_reply_id = found.address_is_reply_id;
  }
  return row;
}

template <class Module>
std::vector<ModuleRow> modules_from(const std::vector<Module>& found) {
  std::vector<ModuleRow> rows;
  for (const auto& module : found) rows.push_back(module_from(module));
  return rows;
}

std::optional<tmcl::UserScale> scale_from(const api::axis::Units& units) {
  const auto microsteps = units.microsteps_per_revolution.value_or(0);
  if (microsteps <= 0) return std::nullopt;
  // A tmcld that knows of no gears tells the second one only.
  const auto of_turn =
      units.units_per_output_revolution.value_or(units.units_per_revolution.value_or(1));
  return tmcl::UserScale{or_empty(units.unit),
                         of_turn,
                         units.reverse.value_or(false),
                         {microsteps, 0},
                         units.gear_ratio.value_or(1)};
}

std::optional<tmcl::SoftLimits> limits_from(std::optional<double> least,
                                            std::optional<double> greatest) {
  if (!least || !greatest) return std::nullopt;
  return tmcl::SoftLimits{{*least}, {*greatest}};
}

tmcl::AxisUnits units_from(const api::axis::Units& units, const std::string& axis) {
  tmcl::AxisUnits out{axis,
                      tmcl::find_model(or_empty(units.model)),
                      {},
                      scale_from(units),
                      units.unit ? limits_from(units.soft_limit_minimum, units.soft_limit_maximum)
                                 : limits_from(units.soft_limit_minimum_microsteps,
                                               units.soft_limit_maximum_microsteps),
                      units.encoder_counts_per_unit};
  if (units.velocity_unit_pps && units.acceleration_unit_pps2)
    out.module = {{*units.velocity_unit_pps}, {*units.acceleration_unit_pps2}};
  return out;
}

json::value null_if_empty(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

Result<std::vector<AxisRow>> found_axes(Context& context) {
  return modules_of(context).map([&](const std::vector<ModuleRow>& found) {
    std::vector<AxisRow> rows;
    for (const auto& module : found) {
      for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
        const auto name = axis_name({tmcl::ModuleAddress{module.address}, motor});
        auto& row = rows.emplace_back(
            AxisRow{{name, module.bus, module.address, motor, {}, "ready", {}, {}}});
        if (!module.model.empty()) row.model = module.model;
        if (const auto now = context.call(api::axis::GetState{name})) row.faults = now->faults;
      }
    }
    return rows;
  });
}

/// For axes whose bus is not open. They are listed all the same if tmcld cannot say more.
void add_reasons(std::vector<AxisRow>& axes, Context& context) {
  const auto listed = context.call(api::bus::List{});
  if (!listed) return;
  for (const auto& bus : listed->buses) {
    if (bus.state == "open") continue;
    for (auto& axis : axes) {
      if (axis.bus == bus.name && axis.state == unknown_state)
        axis.why = bus.error.value_or("it is being opened");
    }
  }
}

}  // namespace

Result<ScanResult> scan(ScanRange range, const ScanNews& news, Context& context) {
  const tmcl::client::Hearing<api::ScanProgress> hearing(
      context.gateway.caller, api::progress_notification, [&](const api::ScanProgress& now) {
        if (now.found && news.found) news.found(module_from(*now.found));
        if (news.progress) news.progress(now.bus, now.asked, now.of);
      });
  return context.call(api::bus::Scan{{}, range.first, range.last})
      .map([](const api::bus::FoundModules& all) {
        ScanResult result{modules_from(all.modules), {}, all.silent};
        for (const auto& [bus, error] : all.failed)
          result.failed.push_back({bus, tmcl::client::error_from_json(error)});
        return result;
      });
}

Result<std::vector<ModuleRow>> modules_of(Context& context) {
  if (context.gateway.axes_from == AxesFrom::scan) {
    ProgressLine line(context.output);
    ScanNews news;
    news.progress = [&line](const std::string& bus, std::size_t asked, std::size_t of) {
      line.show(fmt::format("looking for modules on {}: {} of {} addresses", bus, asked, of));
    };
    auto found = scan({}, news, context);
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().error);
    return std::move(found->modules);
  }
  return context.call(api::module::List{}).map([](const api::module::Modules& found) {
    return modules_from(found.modules);
  });
}

Result<std::vector<AxisRow>> axes_of(Context& context) {
  if (context.gateway.axes_from == AxesFrom::scan) return found_axes(context);
  const auto found = context.call(api::axis::List{});
  if (!found) return tl::unexpected(found.error());
  std::vector<AxisRow> rows;
  for (const auto& axis : found->axes) rows.push_back({axis});
  if (std::ranges::count(rows, unknown_state, &AxisRow::state) != 0) add_reasons(rows, context);
  return rows;
}

Result<tmcl::AxisUnits> units_of(const std::string& axis, Context& context) {
  return context.call(api::axis::GetUnits{axis}).map([&](const api::axis::Units& units) {
    return units_from(units, axis);
  });
}

Result<api::bus::Bus> bus_named(const std::string& name, Context& context) {
  const auto listed = context.call(api::bus::List{});
  if (!listed) return tl::unexpected(listed.error());
  std::string names;
  for (const auto& bus : listed->buses) {
    if (bus.name == name || (name.empty() && listed->buses.size() == 1)) return bus;
    names += (names.empty() ? "" : ", ") + bus.name;
  }
  if (name.empty()) {
    return tl::unexpected(
        usage_error("missing_bus", "there are several buses: which one?", "--bus " + names));
  }
  return tl::unexpected(
      usage_error("unknown_bus", fmt::format("there is no bus '{}'", name), "There is: " + names));
}

Result<api::OnModule> on_module(const ModuleName& module, Context& context) {
  return bus_named(module.bus, context).map([&](const api::bus::Bus& bus) {
    return api::OnModule{bus.name, module.address};
  });
}

Result<api::OnModule> on_module(std::string_view text, Context& context) {
  const auto module = parse_module(text);
  if (!module) return tl::unexpected(module.error());
  return on_module(*module, context);
}

std::string model_text(std::string_view name, unsigned number) {
  if (!name.empty()) return std::string(name);
  return number != 0 ? fmt::format("unknown ({})", number) : "unknown";
}

json::object to_json(const ModuleRow& row) {
  json::object object{{"bus", row.bus},
                      {"address", row.address},
                      {"model", null_if_empty(row.model)},
                      {"model_number", row.model_number},
                      {"firmware", row.firmware},
                      {"axes", row.axes},
                      {"in_bootloader", row.in_bootloader},
                      {"duplicate_suspected", row.duplicate_suspected}};
  if (row.state.empty()) {
    object["address_is_reply_id"] = row.address_is_reply_id;
  } else {
    object["state"] = row.state;
    object["watched_by"] = row.watched_by;
    object["deadman"] = row.deadman;
  }
  return object;
}

json::object to_json(const AxisRow& row) {
  auto object = tmcl::api::to_json<tmcl::api::axis::Axis>(row);
  object["why"] = null_if_empty(row.why);
  return object;
}

}  // namespace tmclctl
