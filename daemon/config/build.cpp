#include "config/build.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/build_sections.hpp"

namespace tmcld {
namespace {

/// The same for sections that say the same, wherever they stand.
std::string text_of(const ConfigSection& section) {
  auto text = fmt::format("{}\n", title_of(section.kind));
  for (const auto& [key, entry] : section.values) {
    const auto value =
        std::visit([](const auto& said) { return fmt::format("{}", said); }, entry.value);
    text += fmt::format("{} = {}\n", key, value);
  }
  return text;
}

void note_text(Draft& draft, const ConfigSection& section) {
  if (section.kind == SectionKind::daemon || section.kind == SectionKind::access) return;
  const bool is_bus = section.kind == SectionKind::bus;
  const bool is_on_bus = section.kind == SectionKind::module || section.kind == SectionKind::axis;
  const auto* name = section.get<std::string>(is_bus ? "name" : "bus");
  const auto bus = name == nullptr || !(is_bus || is_on_bus)
                       ? draft.config.buses.end()
                       : std::ranges::find(draft.config.buses, *name, &BusConfig::name);
  (bus == draft.config.buses.end() ? draft.config.others : bus->said) += text_of(section);
}

void check_whole(Draft& draft) {
  if (draft.config.buses.size() > max_buses) {
    draft.complain({}, "more than " + std::to_string(max_buses) + " buses");
  }
  if (draft.config.axes.size() > max_axes) {
    draft.complain({}, "more than " + std::to_string(max_axes) + " axes");
  }
  if (draft.config.ports.size() > max_ports) {
    draft.complain({}, "more than " + std::to_string(max_ports) + " ports");
  }
}

struct Step {
  SectionKind kind;
  void (*add)(Draft& draft, const ConfigSection& section);
};

// What others refer to comes first.
constexpr Step steps[] = {{SectionKind::daemon, add_daemon}, {SectionKind::access, add_access},
                          {SectionKind::bus, add_bus},       {SectionKind::module, add_module},
                          {SectionKind::axis, add_axis},     {SectionKind::port, add_port}};

}  // namespace

Config build_config(std::span<const ConfigSection> sections, tmcl::TextProblems& problems) {
  Draft draft(sections, problems);
  for (const auto& step : steps) {
    for (const auto& section : sections)
      if (section.kind == step.kind) step.add(draft, section);
  }
  for (const auto& section : sections) note_text(draft, section);
  check_whole(draft);
  return std::move(draft.config);
}

}  // namespace tmcld
