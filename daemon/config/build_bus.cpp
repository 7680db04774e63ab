#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "config/build_sections.hpp"
#include "config/feeding.hpp"
#include "config/module_file.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

/// Nothing if it is none.
std::optional<SentinelConfig> sentinel_of(std::string_view text) {
  using Kind = SentinelConfig::Kind;
  constexpr std::string_view variable = "variable:";
  if (text == "auto" || text == "tick") return SentinelConfig{Kind::tick};
  if (text == "settings") return SentinelConfig{Kind::settings};
  if (text == "none") return SentinelConfig{Kind::none};
  if (!text.starts_with(variable)) return std::nullopt;
  SentinelConfig sentinel{Kind::variable};
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + variable.size(), end, sentinel.variable);
  // The others can be kept in the EEPROM: they would be as they were after a restart.
  const bool is_good =
      read.ec == std::errc() && read.ptr == end && sentinel.variable >= tmcl::kept_user_variables;
  return is_good ? std::optional(sentinel) : std::nullopt;
}

bool applies(LinkScope key, LinkScope link) {
  return key == LinkScope::any || key == link ||
         (key == LinkScope::serial_framing && link == LinkScope::tcp);
}

void check_scopes(Draft& draft, const ConfigSection& section, const tmcl::LinkName& link) {
  for (const auto& [key, value] : section.values) {
    const auto* row = find_key(section.kind, key);
    if (applies(row->scope, scope_of(link))) continue;
    draft.complain(value.place, quoted(key) + " means nothing here: it is for " +
                                    std::string(name_of(row->scope)) + " links");
  }
}

tmcl::LinkOptions link_options(const ConfigSection& section) {
  tmcl::LinkOptions options;
  set(section, "can_reply_id", options.can_reply_id);
  set(section, "connect_timeout_ms", options.connect_timeout);
  if (const auto* flag = section.get<bool>("can_extended")) options.can_extended = *flag;
  return options;
}

tmcl::BusOptions bus_options(const ConfigSection& section) {
  tmcl::BusOptions options;
  set(section, "reply_timeout_ms", options.reply_timeout);
  set(section, "telegram_pause_ms", options.telegram_pause);
  set(section, "quiet_time_ms", options.quiet_time);
  set(section, "silence_time_ms", options.silence_time);
  set(section, "attempts", options.attempts);
  set(section, "host_address", options.host_address);
  return options;
}

void add_measured(Draft& draft, const ConfigSection& section, ModuleConfig& module) {
  const auto* path = section.get<std::string>("as");
  if (path == nullptr) return;
  auto measured = read_measured_module(*path);
  if (!measured) return draft.complain(section.place_of("as"), "'as': " + measured.error());
  module.as = *measured;
}

/// Of the module that was added last.
void add_deadman(Draft& draft, const ConfigSection& section, BusConfig& bus) {
  const auto* ms = section.get<std::int64_t>("deadman_ms");
  if (ms == nullptr) return;
  bus.modules.back().deadman_ms = static_cast<std::int32_t>(*ms);
  auto fault = fault_of_deadman(*bus.modules.back().deadman_ms);
  if (fault.empty()) fault = fault_of_feeding(bus);
  if (!fault.empty()) draft.complain(section.place_of("deadman_ms"), "'deadman_ms' " + fault);
}

}  // namespace

void add_bus(Draft& draft, const ConfigSection& section) {
  const auto* name = draft.new_name(section, draft.config.buses);
  const auto* text = section.get<std::string>("link");
  if (text == nullptr) return;
  auto link = tmcl::parse_link_name(*text);
  if (!link) {
    const auto& error = link.error();
    return draft.complain(section.place_of("link"),
                          error.message + (error.hint.empty() ? "" : ": " + error.hint));
  }
  check_scopes(draft, section, *link);
  for (const auto& other : draft.config.buses) {
    if (to_string(other.link) != to_string(*link)) continue;
    draft.complain(section.place_of("link"),
                   "bus " + quoted(other.name) + " already uses this link");
  }
  if (name == nullptr) return;
  draft.config.buses.push_back(
      {*name, std::move(*link), link_options(section), bus_options(section)});
  draft.config.buses.back().bus_options.name = *name;
}

void add_module(Draft& draft, const ConfigSection& section) {
  const auto* bus_name = section.get<std::string>("bus");
  const auto* number = section.get<std::int64_t>("address");
  auto* bus = bus_name == nullptr ? nullptr : draft.find_bus(section, *bus_name);
  if (bus == nullptr || number == nullptr) return;
  auto& modules = bus->modules;
  const tmcl::ModuleAddress address{static_cast<std::uint16_t>(*number)};
  if (std::ranges::count(modules, address, &ModuleConfig::address) != 0) {
    draft.complain(section.place_of("address"), "module " + std::to_string(*number) + " on bus " +
                                                    quoted(*bus_name) + " is given twice");
  }
  modules.push_back({address});
  add_deadman(draft, section, *bus);
  add_measured(draft, section, modules.back());
  const auto* text = section.get<std::string>("sentinel");
  if (text == nullptr) return;
  const auto sentinel = sentinel_of(*text);
  if (sentinel) modules.back().sentinel = *sentinel;
  if (sentinel) return;
  draft.complain(
      section.place_of("sentinel"),
      "'sentinel' is " + quoted(*text) +
          ", but must be auto, tick, settings, none or variable:N with N from 56 to 255");
}

}  // namespace tmcld
