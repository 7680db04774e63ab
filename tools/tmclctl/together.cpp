#include "together.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <boost/json/array.hpp>

#include "names.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr int scratch_coordinate = 0;

struct Start {
  std::string axis;
  tmcl::Microsteps position;
  std::uint8_t motor = 0;
};
using Modules = std::map<std::pair<std::string, std::uint16_t>, std::vector<Start>>;

/// Where the name says it, nothing has to be listed: with --direct that would be a scan.
Attempt<AxisRow> row_of(const std::string& axis, Target& target) {
  if (const auto place = parse_axis_place(axis))
    return AxisRow{axis, place->module.bus, place->module.address, place->motor, "", ""};
  return target.axes().and_then([&](const std::vector<AxisRow>& all) -> Attempt<AxisRow> {
    const auto row = std::ranges::find(all, axis, &AxisRow::name);
    if (row != all.end()) return *row;
    return tl::unexpected(usage_failure("unknown_axis", "there is no axis " + axis));
  });
}

Attempt<Modules> by_module(const std::vector<std::string>& axes,
                           const std::vector<tmcl::Microsteps>& positions, Target& target) {
  Modules modules;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto row = row_of(axes[i], target);
    if (!row) return tl::unexpected(row.error());
    modules[{row->bus, row->address}].push_back({axes[i], positions[i], row->motor});
  }
  return modules;
}

Attempt<bool> load(const std::vector<Start>& starts, Target& target) {
  for (const auto& start : starts) {
    const auto loaded = target.perform("coordinate.set",
                                       {{"axis", start.axis},
                                        {"number", scratch_coordinate},
                                        {"position_microsteps", start.position.value}},
                                       {});
    if (!loaded && loaded.error().outcome == tmcl::Outcome::refused) return false;
    if (!loaded) return tl::unexpected(loaded.error());
  }
  return true;
}

Attempt<void> start_each(const std::vector<Start>& starts, Target& target) {
  for (const auto& start : starts) {
    const auto moved = target.move_to(start.axis, counted(start.position.value));
    if (!moved) return tl::unexpected(moved.error());
  }
  return {};
}

Attempt<void> start_loaded(const std::string& bus, std::uint16_t address,
                           const std::vector<Start>& starts, Target& target) {
  const auto done = [](const json::object&) {};
  if (starts.size() == 1) {
    return target
        .perform("coordinate.move", {{"axis", starts.front().axis}, {"number", scratch_coordinate}},
                 {})
        .map(done);
  }
  json::object params{{"address", address}, {"number", scratch_coordinate}};
  if (!bus.empty()) params["bus"] = bus;
  json::array motors;
  for (const auto& start : starts) motors.emplace_back(start.motor);
  params["motors"] = std::move(motors);
  return target.perform("coordinate.start", std::move(params), {}).map(done);
}

}  // namespace

Attempt<void> start_together(const std::vector<std::string>& axes,
                             const std::vector<tmcl::Microsteps>& positions, Target& target) {
  const auto modules = by_module(axes, positions, target);
  if (!modules) return tl::unexpected(modules.error());
  std::vector<bool> loaded;
  for (const auto& [module, starts] : *modules) {
    const auto done = load(starts, target);
    if (!done) return tl::unexpected(done.error());
    loaded.push_back(*done);
  }
  std::size_t i = 0;
  for (const auto& [module, starts] : *modules) {
    const auto started = loaded[i++] ? start_loaded(module.first, module.second, starts, target)
                                     : start_each(starts, target);
    if (!started) return started;
  }
  return {};
}

}  // namespace tmclctl
