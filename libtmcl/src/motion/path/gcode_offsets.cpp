#include "motion/path/gcode_offsets.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

constexpr std::size_t tool_axis = 2;
constexpr int most_tool = 99'999;

Part<void> no_tool(std::size_t column, std::string message) {
  Wrong fault{column, std::move(message)};
  fault.may_be_skipped = true;
  return tl::unexpected(std::move(fault));
}

std::optional<double> length_of(double tool, const Tools& tools) {
  if (tool != std::round(tool) || std::abs(tool) > most_tool) return std::nullopt;
  const auto found = tools.lengths.find(static_cast<int>(tool));
  return found == tools.lengths.end() ? std::nullopt : std::optional(found->second);
}

/// G43. Tool 0 has no length.
Part<void> take_length_of_tool(const Block& block, const Codes& codes, const Tools& tools,
                               Origins& origins) {
  const auto& named = block.find('H');
  const auto column = named ? named->column : codes.column_of(Group::tool_length);
  if (!named && !tools.in_use)
    return no_tool(column, "G43 needs H, the number of a tool, or M6 with T before it");
  const double tool = named ? named->value : *tools.in_use;
  const auto length = tool == 0 ? std::optional(0.0) : length_of(tool, tools);
  if (!length) {
    return no_tool(column, fmt::format("the length of tool {} is not known: 'tools' of [path] in "
                                       "the configuration of tmcld says lengths",
                                       plain_number(tool, 6)));
  }
  origins.forget_tool();
  origins.lengthen_tool(tool_axis, *length);
  return {};
}

/// G43.1.
Part<void> take_lengths(const Block& block, const Codes& codes, const Modes& modes,
                        Origins& origins) {
  if (!block.has_any(gcode_axes))
    return wrong(codes.column_of(Group::tool_length), "G43.1 needs an axis, and its length");
  for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
    if (const auto& word = block.find(gcode_axes[i]))
      origins.lengthen_tool(i, modes.in_mm(*word, i));
  }
  return {};
}

/// Which one G10 is about, by P.
Part<std::size_t> system_of(const Block& block, std::size_t column, const Origins& origins) {
  const auto& number = block.find('P');
  const double most = Origins::systems;
  if (!number || number->value != std::round(number->value) || number->value < 0 ||
      number->value > most) {
    return wrong(number ? number->column : column,
                 "G10 needs P: 1 to 6 for G54 to G59, or 0 for the one that holds");
  }
  return number->value == 0 ? origins.selected() : static_cast<std::size_t>(number->value) - 1;
}

}  // namespace

void select_system(const Codes& codes, Origins& origins, Report& report) {
  const auto code = codes.of(Group::system);
  if (!code) return;
  const auto system = static_cast<std::size_t>(*code / 10 - 54);
  origins.select(system);
  if (system == 0 || origins.is_set(system)) return;
  report.remark(
      codes.column_of(Group::system),
      fmt::format("G{} was not set here; it counts from the zero of the axes", *code / 10));
}

Part<void> set_system(const Block& block, const Codes& codes, const Modes& modes, const Point& at,
                      Origins& origins) {
  const auto column = codes.column_of(Group::once);
  const auto& kind = block.find('L');
  if (!kind || (kind->value != 2 && kind->value != 20))
    return tl::unexpected(Wrong{column, "G10 is known with L2 and L20 only", {}, true, true});
  if (block.has('R') && block.find('R')->value != 0)
    return wrong(block.find('R')->column, "coordinates that are turned are not known here");
  const auto system = system_of(block, column, origins);
  if (!system) return tl::unexpected(system.error());
  for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
    const auto& word = block.find(gcode_axes[i]);
    if (!word) continue;
    if (kind->value == 2) {
      origins.set(*system, i, modes.in_mm(*word, i));
    } else {
      origins.set_by_place(*system, i, at[i], modes.in_mm(*word, i));
    }
  }
  return {};
}

Part<void> shift(const Block& block, const Codes& codes, const Modes& modes, const Point& at,
                 Origins& origins) {
  const bool by_place = codes.are(Group::once, 920);
  if (!block.has_any(gcode_axes)) {
    return wrong(codes.column_of(Group::once),
                 fmt::format("{} needs an axis", by_place ? "G92" : "G52"));
  }
  for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
    const auto& word = block.find(gcode_axes[i]);
    if (!word) continue;
    if (by_place) {
      origins.shift_by_place(i, at[i], modes.in_mm(*word, i));
    } else {
      origins.shift(i, modes.in_mm(*word, i));
    }
  }
  return {};
}

Part<void> set_tool_length(const Block& block, const Codes& codes, const Modes& modes,
                           const Tools& tools, Origins& origins) {
  if (codes.are(Group::tool_length, 431)) return take_lengths(block, codes, modes, origins);
  if (codes.are(Group::tool_length, 430)) return take_length_of_tool(block, codes, tools, origins);
  if (codes.are(Group::tool_length, 490)) origins.forget_tool();
  return {};
}

}  // namespace tmcl::plan::path_file::gcode
