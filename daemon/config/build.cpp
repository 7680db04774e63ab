#include "config/build.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "config/build_sections.hpp"

namespace tmcld {
namespace {

void note_text(Config& config, const Said<std::string>& bus, const Section& section) {
  const auto found =
      std::ranges::find_if(config.buses, [&](const auto& one) { return bus == one.name; });
  (found == config.buses.end() ? config.others : found->said) += section.text;
}

void note_texts(Config& config, const ConfigText& text) {
  for (const auto& bus : text.buses) note_text(config, bus.name, bus);
  for (const auto& module : text.modules) note_text(config, module.bus, module);
  for (const auto& axis : text.axes) note_text(config, axis.bus, axis);
  for (const auto& section : text.http) config.others += section.text;
  for (const auto& section : text.ports) config.others += section.text;
}

void check_whole(Draft& draft) {
  const auto check = [&](std::size_t count, std::size_t most, std::string_view what) {
    if (count > most) draft.complain(Place{}, fmt::format("more than {} {}", most, what));
  };
  check(draft.config.buses.size(), max_buses, "buses");
  check(draft.config.axes.size(), max_axes, "axes");
  check(draft.config.ports.size(), max_ports, "ports");
}

}  // namespace

Config build_config(ConfigText& text) {
  Draft draft(text);
  for (const auto& section : text.daemon) add_daemon(draft, section);
  for (const auto& section : text.access) add_access(draft, section);
  // What others refer to comes first.
  for (const auto& section : text.buses) add_bus(draft, section);
  for (const auto& section : text.modules) add_module(draft, section);
  for (const auto& section : text.axes) add_axis(draft, section);
  for (const auto& section : text.ports) add_port(draft, section);
  for (const auto& section : text.path) add_path(draft, section);
  note_texts(draft.config, text);
  check_whole(draft);
  return std::move(draft.config);
}

}  // namespace tmcld
