#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "config/build_sections.hpp"
#include "config/toml_reading.hpp"
#include "tmcl/correction.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

MotionLimits motion_limits_of(Draft& draft, const AxisSection& section) {
  MotionLimits limits;
  draft.set_positive(section.max_velocity, limits.velocity);
  draft.set_positive(section.max_acceleration, limits.acceleration);
  draft.set_positive(section.max_deceleration, limits.deceleration);
  draft.set_positive(section.max_jerk, limits.jerk);
  draft.set_positive(section.max_corner_jump, limits.corner_jump);
  set(section.max_current, limits.current);
  return limits;
}

bool reference_is_required(Draft& draft, const Said<std::string>& reference) {
  if (!reference || reference == "optional") return false;
  if (reference == "required") return true;
  draft.complain(reference,
                 "'reference' is " + quoted(*reference) + ", but must be required or optional");
  return false;
}

std::optional<InPosition> in_position_of(Draft& draft, const AxisSection& section) {
  if (section.settle_ms && !section.in_position)
    draft.complain(section.settle_ms, "'settle_ms' means nothing without 'in_position'");
  if (!section.in_position) return std::nullopt;
  InPosition wanted;
  draft.set_positive(section.in_position, wanted.window);
  if (section.settle_ms) wanted.settle = std::chrono::milliseconds(*section.settle_ms);
  return wanted;
}

std::optional<ApproachConfig> approach_of(Draft& draft, const AxisSection& section) {
  constexpr std::array<std::string_view, 2> sides{"from-below", "from-above"};
  enum class Side : std::uint8_t { below, above } side{};
  draft.set_choice(section.approach, sides, side);
  const auto& distance = section.approach_distance;
  if (section.approach && !distance)
    draft.complain(section.approach,
                   "'approach' needs 'approach_distance': how far it goes beyond a target first");
  if (distance && !section.approach)
    draft.complain(distance, "'approach_distance' means nothing without 'approach'");
  if (!section.approach) return std::nullopt;
  ApproachConfig approach{side == Side::below};
  draft.set_positive(distance, approach.distance);
  return approach;
}

void check_reply_id(Draft& draft, const AxisSection& section, const BusConfig& bus) {
  const auto address = *section.address;
  if (!is_can(bus.link) || address != bus.link_options.can_reply_id) return;
  // Its other motors have been told of it.
  const bool told = std::ranges::any_of(draft.config.axes, [&](const auto& other) {
    return other.bus == bus.name && number(other.address.module) == address;
  });
  if (told) return;
  draft.complain(
      section.address,
      fmt::format("{} has the address {}, but replies on bus '{}' come with the identifier "
                  "{}: its module would take every reply for a command, and move. Give the "
                  "module another address (global parameter 71), or all modules of the bus "
                  "another reply identifier (70) and say so with 'can_reply_id'",
                  section.name ? "axis " + quoted(*section.name) : "this axis", address, bus.name,
                  address));
}

void set_limits(Draft& draft, const Said<ConfigRange>& limits, ScaleConfig& scale) {
  if (!limits) return;
  const auto [least, greatest] = *limits;
  if (!(least < greatest) || !std::isfinite(least) || !std::isfinite(greatest)) {
    draft.complain(
        limits, fmt::format("'soft_limits' is [{}, {}], but the first must be less than the second",
                            least, greatest));
  }
  scale.limits = tmcl::SoftLimits{{least}, {greatest}};
}

void set_encoder(Draft& draft, const AxisSection& section, ScaleConfig& scale) {
  const auto& lines = section.encoder_lines;
  const auto& counts = section.encoder_counts_per_unit;
  if (counts && lines) {
    draft.complain(
        counts,
        "'encoder_counts_per_unit' is for a linear encoder and 'encoder_lines' for one on "
        "the motor's shaft: give one");
  }
  if (section.encoder_quadrature && !lines) {
    draft.complain(section.encoder_quadrature,
                   "'encoder_quadrature' means nothing without 'encoder_lines'");
  }
  draft.set_positive(counts, scale.encoder_counts_per_unit);
  scale.encoder_is_linear = counts.has_value();
  if (!lines || counts) return;
  const tmcl::ShaftEncoder encoder{*lines, section.encoder_quadrature.value_or(true)};
  scale.encoder_counts_per_unit = counts_per_unit(encoder, scale.with_resolution(0));
}

const Said<double>& distance_of(Draft& draft, const AxisSection& section) {
  if (section.screw_pitch && section.units_per_revolution) {
    draft.complain(
        section.screw_pitch,
        "'screw_pitch' and 'units_per_revolution' both say how much a turn is: give one");
  }
  return section.screw_pitch ? section.screw_pitch : section.units_per_revolution;
}

void complain_without_unit(Draft& draft, const AxisSection& section) {
  for (const Given* given : std::initializer_list<const Given*>{
           &section.gear_ratio, &section.encoder_lines, &section.encoder_quadrature,
           &section.encoder_counts_per_unit, &section.correction}) {
    if (given->key.empty()) continue;
    draft.complain(*given, quoted(given->key) + " means nothing without 'unit'");
  }
}

void set_unit(Draft& draft, const AxisSection& section, ScaleConfig& scale) {
  const auto& unit = section.unit;
  const auto& distance = distance_of(draft, section);
  if (unit.has_value() != distance.has_value()) {
    return draft.complain(
        unit ? Given(unit) : Given(distance),
        "'unit' and 'units_per_revolution' (or 'screw_pitch') belong together: what "
        "positions are measured in, and how much of it a turn is");
  }
  set_limits(draft, section.soft_limits, scale);
  if (!unit) return complain_without_unit(draft, section);
  if (const auto fault = tmcl::fault_of_unit_name(*unit); !fault.empty())
    draft.complain(unit, "the unit " + quoted(*unit) + " " + fault);
  scale.unit = *unit;
  constexpr std::string_view other_direction = "; for the other direction say reverse = true";
  draft.set_positive(distance, scale.units_per_revolution, other_direction);
  draft.set_positive(section.gear_ratio, scale.gear_ratio, other_direction);
  set_encoder(draft, section, scale);
}

/// Another text of the file is another bus, as another configuration is.
void set_correction(Draft& draft, const AxisSection& section, ScaleConfig& scale) {
  const auto& path = section.correction;
  if (!path || scale.unit.empty()) return;
  const auto text = text_of_file(*path);
  if (!text) return draft.complain(path, "'correction': " + text.error());
  auto read = tmcl::Correction::of(*text);
  if (!read) return draft.complain(path, "'correction': " + describe(read.error(), *path));
  draft.find_bus(section.bus)->said += *text;
  scale.correction = std::make_shared<const tmcl::Correction>(*std::move(read));
}

void set_microsteps(Draft& draft, const Said<std::uint32_t>& count, ScaleConfig& scale) {
  if (!count) return;
  if (!std::has_single_bit(*count)) {
    draft.complain(count, fmt::format("'microsteps' is {}, but must be a power of two", *count));
  }
  scale.microstep_resolution = std::countr_zero(*count);
}

ScaleConfig scale_of(Draft& draft, const AxisSection& section) {
  ScaleConfig scale;
  set(section.full_steps, scale.full_steps);
  set(section.reverse, scale.reverse);
  set_microsteps(draft, section.microsteps, scale);
  set_unit(draft, section, scale);
  set_correction(draft, section, scale);
  return scale;
}

void check_is_new(Draft& draft, const AxisSection& section, const AxisConfig& axis) {
  for (const auto& other : draft.config.axes) {
    if (other.bus != axis.bus || other.address != axis.address) continue;
    draft.complain(section.motor, fmt::format("axis {} already is motor {} of module {} on bus {}",
                                              quoted(other.name), *section.motor, *section.address,
                                              quoted(axis.bus)));
  }
}

}  // namespace

void add_axis(Draft& draft, const AxisSection& section) {
  const bool is_named = draft.has_new_name(section, draft.config.axes);
  const auto* bus = draft.find_bus(section.bus);
  if (bus == nullptr || !section.address || !section.motor) return;
  if (*section.address > 255 && !is_can(bus->link)) {
    return draft.complain(section.address,
                          fmt::format("'address' is {}, but bus {} is no CAN bus: modules there "
                                      "have addresses 0..255",
                                      *section.address, quoted(bus->name)));
  }
  AxisConfig axis{section.name.value_or(""),
                  bus->name,
                  {tmcl::ModuleAddress{*section.address}, *section.motor}};
  check_reply_id(draft, section, *bus);
  check_is_new(draft, section, axis);
  axis.scale = scale_of(draft, section);
  axis.needs_reference = reference_is_required(draft, section.reference);
  axis.motion_limits = motion_limits_of(draft, section);
  draft.set_positive(section.home_max_travel, axis.home_max_travel);
  axis.in_position = in_position_of(draft, section);
  axis.approach = approach_of(draft, section);
  if (is_named) draft.config.axes.push_back(std::move(axis));
}

}  // namespace tmcld
