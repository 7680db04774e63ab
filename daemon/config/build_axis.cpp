#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "config/build_sections.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

MotionLimits motion_limits_of(Draft& draft, const ConfigSection& section) {
  MotionLimits limits;
  const auto set_limit = [&](std::string_view key, std::optional<double>& limit) {
    if (section.find(key) != nullptr) draft.set_positive(section, key, "", limit.emplace());
  };
  set_limit("max_velocity", limits.velocity);
  set_limit("max_acceleration", limits.acceleration);
  set_limit("max_deceleration", limits.deceleration);
  set_limit("max_jerk", limits.jerk);
  set_limit("max_corner_jump", limits.corner_jump);
  if (const auto* current = section.get<std::int64_t>("max_current"))
    limits.current = static_cast<std::int32_t>(*current);
  return limits;
}

bool reference_is_required(Draft& draft, const ConfigSection& section) {
  const auto* text = section.get<std::string>("reference");
  if (text == nullptr || *text == "optional") return false;
  if (*text == "required") return true;
  draft.complain(section.place_of("reference"),
                 "'reference' is " + quoted(*text) + ", but must be required or optional");
  return false;
}

void check_reply_id(Draft& draft, const ConfigSection& section, const BusConfig& bus,
                    std::int64_t address) {
  const auto reply_id = bus.link_options.can_reply_id;
  if (scope_of(bus.link) != LinkScope::can || address != reply_id) return;
  // Its other motors have been told of it.
  const bool told = std::ranges::any_of(draft.config.axes, [&](const auto& other) {
    return other.bus == bus.name && number(other.address.module) == address;
  });
  if (told) return;
  const auto* name = section.get<std::string>("name");
  draft.complain(
      section.place_of("address"),
      fmt::format("{} has the address {}, but replies on bus '{}' come with the identifier "
                  "{}: its module would take every reply for a command, and move. Give the "
                  "module another address (global parameter 71), or all modules of the bus "
                  "another reply identifier (70) and say so with 'can_reply_id'",
                  name == nullptr ? "this axis" : "axis " + quoted(*name), address, bus.name,
                  reply_id));
}

void add_limits(Draft& draft, const ConfigSection& section, ScaleConfig& scale) {
  const auto* limits = section.get<ConfigRange>("soft_limits");
  if (limits == nullptr) return;
  const auto [least, greatest] = *limits;
  if (!(least < greatest) || !std::isfinite(least) || !std::isfinite(greatest)) {
    draft.complain(
        section.place_of("soft_limits"),
        fmt::format("'soft_limits' is [{}, {}], but the first must be less than the second", least,
                    greatest));
  }
  scale.limits = tmcl::SoftLimits{{least}, {greatest}};
}

void add_encoder(Draft& draft, const ConfigSection& section, ScaleConfig& scale) {
  const auto* lines = section.get<std::int64_t>("encoder_lines");
  const auto* quadrature = section.get<bool>("encoder_quadrature");
  const bool linear = section.find("encoder_counts_per_unit") != nullptr;
  if (linear && lines != nullptr) {
    draft.complain(
        section.place_of("encoder_counts_per_unit"),
        "'encoder_counts_per_unit' is for a linear encoder and 'encoder_lines' for one on "
        "the motor's shaft: give one");
  }
  if (quadrature != nullptr && lines == nullptr) {
    draft.complain(section.place_of("encoder_quadrature"),
                   "'encoder_quadrature' means nothing without 'encoder_lines'");
  }
  if (linear)
    draft.set_positive(section, "encoder_counts_per_unit", "",
                       scale.encoder_counts_per_unit.emplace());
  if (lines == nullptr || linear) return;
  const tmcl::ShaftEncoder encoder{static_cast<std::int32_t>(*lines),
                                   quadrature == nullptr || *quadrature};
  scale.encoder_counts_per_unit = counts_per_unit(encoder, scale.with_resolution(0));
}

std::string_view distance_key_of(Draft& draft, const ConfigSection& section) {
  const bool pitch = section.find("screw_pitch") != nullptr;
  if (pitch && section.find("units_per_revolution") != nullptr) {
    draft.complain(
        section.place_of("screw_pitch"),
        "'screw_pitch' and 'units_per_revolution' both say how much a turn is: give one");
  }
  return pitch ? "screw_pitch" : "units_per_revolution";
}

void complain_without_unit(Draft& draft, const ConfigSection& section) {
  for (const std::string_view key :
       {"gear_ratio", "encoder_lines", "encoder_quadrature", "encoder_counts_per_unit"}) {
    if (section.find(key) == nullptr) continue;
    draft.complain(section.place_of(key), quoted(key) + " means nothing without 'unit'");
  }
}

void add_unit(Draft& draft, const ConfigSection& section, ScaleConfig& scale) {
  const auto* unit = section.get<std::string>("unit");
  const auto distance_key = distance_key_of(draft, section);
  const bool has_distance = section.find(distance_key) != nullptr;
  if ((unit == nullptr) == has_distance) {
    return draft.complain(
        section.place_of(has_distance ? distance_key : "unit"),
        "'unit' and 'units_per_revolution' (or 'screw_pitch') belong together: what "
        "positions are measured in, and how much of it a turn is");
  }
  add_limits(draft, section, scale);
  if (unit == nullptr) return complain_without_unit(draft, section);
  if (const auto fault = tmcl::fault_of_unit_name(*unit); !fault.empty())
    draft.complain(section.place_of("unit"), "the unit " + quoted(*unit) + " " + fault);
  scale.unit = *unit;
  constexpr std::string_view other_direction = "; for the other direction say reverse = true";
  draft.set_positive(section, distance_key, other_direction, scale.units_per_revolution);
  draft.set_positive(section, "gear_ratio", other_direction, scale.gear_ratio);
  add_encoder(draft, section, scale);
}

ScaleConfig scale_of(Draft& draft, const ConfigSection& section) {
  ScaleConfig scale;
  set(section, "full_steps", scale.full_steps);
  if (const auto* flag = section.get<bool>("reverse")) scale.reverse = *flag;
  if (const auto* microsteps = section.get<std::int64_t>("microsteps")) {
    const auto count = static_cast<std::uint64_t>(*microsteps);
    if (!std::has_single_bit(count)) {
      draft.complain(section.place_of("microsteps"),
                     "'microsteps' is " + std::to_string(count) + ", but must be a power of two");
    }
    scale.microstep_resolution = std::countr_zero(count);
  }
  add_unit(draft, section, scale);
  return scale;
}

}  // namespace

void add_axis(Draft& draft, const ConfigSection& section) {
  const auto* name = draft.new_name(section, draft.config.axes);
  const auto* bus_name = section.get<std::string>("bus");
  const auto* address = section.get<std::int64_t>("address");
  const auto* motor = section.get<std::int64_t>("motor");
  const auto* bus = bus_name == nullptr ? nullptr : draft.find_bus(section, *bus_name);
  if (bus == nullptr || address == nullptr || motor == nullptr) return;
  if (*address > 255 && scope_of(bus->link) != LinkScope::can) {
    return draft.complain(section.place_of("address"),
                          "'address' is " + std::to_string(*address) + ", but bus " +
                              quoted(bus->name) +
                              " is no CAN bus: modules there have addresses 0..255");
  }
  check_reply_id(draft, section, *bus, *address);
  const tmcl::AxisAddress where{tmcl::ModuleAddress{static_cast<std::uint16_t>(*address)},
                                static_cast<std::uint8_t>(*motor)};
  for (const auto& other : draft.config.axes) {
    if (other.bus != *bus_name || other.address != where) continue;
    draft.complain(section.place_of("motor"),
                   "axis " + quoted(other.name) + " already is motor " + std::to_string(*motor) +
                       " of module " + std::to_string(*address) + " on bus " + quoted(*bus_name));
  }
  auto scale = scale_of(draft, section);
  const bool needs_reference = reference_is_required(draft, section);
  const auto limits = motion_limits_of(draft, section);
  std::optional<double> home_max_travel;
  if (section.find("home_max_travel") != nullptr)
    draft.set_positive(section, "home_max_travel", "", home_max_travel.emplace());
  if (name != nullptr)
    draft.config.axes.push_back(
        {*name, *bus_name, where, std::move(scale), needs_reference, limits, home_max_travel});
}

}  // namespace tmcld
