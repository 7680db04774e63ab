#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "config/build_sections.hpp"
#include "config/feeding.hpp"
#include "config/module_file.hpp"
#include "config/settings_file.hpp"
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

void check_links(Draft& draft, const BusSection& section, const tmcl::LinkName& link) {
  const bool is_tcp = std::holds_alternative<tmcl::TcpName>(link);
  const auto check = [&](const Given& key, bool means_something, std::string_view links) {
    if (means_something || key.key.empty()) return;
    draft.complain(key, fmt::format("'{}' means nothing here: it is for {} links", key.key, links));
  };
  check(section.telegram_pause_ms, !is_can(link), "serial: and tcp:");
  check(section.host_address, !is_can(link), "serial: and tcp:");
  check(section.can_reply_id, is_can(link), "can:");
  check(section.can_extended, is_can(link), "can:");
  check(section.connect_timeout_ms, is_tcp, "tcp:");
}

tmcl::LinkOptions link_options(const BusSection& section) {
  tmcl::LinkOptions options;
  set(section.can_reply_id, options.can_reply_id);
  set(section.can_extended, options.can_extended);
  set(section.connect_timeout_ms, options.connect_timeout);
  return options;
}

tmcl::BusOptions bus_options(const BusSection& section) {
  tmcl::BusOptions options;
  options.name = *section.name;
  set(section.reply_timeout_ms, options.reply_timeout);
  set(section.telegram_pause_ms, options.telegram_pause);
  set(section.quiet_time_ms, options.quiet_time);
  set(section.silence_time_ms, options.silence_time);
  set(section.attempts, options.attempts);
  set(section.host_address, options.host_address);
  return options;
}

void set_measured(Draft& draft, const Said<std::string>& path, ModuleConfig& module) {
  if (!path) return;
  auto measured = read_measured_module(*path);
  if (!measured) return draft.complain(path, "'as': " + measured.error());
  module.as = *measured;
}

/// By SettingsConfig::Drift.
constexpr std::array<std::string_view, 2> drift_words{"report", "restore"};

/// Of the module that was added last. Another text of the file is another bus, as another
/// configuration is.
void set_settings(Draft& draft, const ModuleSection& section, BusConfig& bus) {
  auto& settings = bus.modules.back().settings;
  draft.set_choice(section.settings_at_reset, drift_words, settings.at_reset);
  if (section.settings_at_reset && !section.settings)
    draft.complain(section.settings_at_reset, "'settings_at_reset' needs 'settings', a file");
  if (!section.settings) return;
  settings.file = *section.settings;
  auto read = read_settings_file(settings.file);
  if (!read) {
    for (const auto& problem : read.error())
      draft.complain(section.settings, "'settings': " + describe(problem, settings.file));
    return;
  }
  bus.said += to_toml(*read);
  settings.wanted = std::make_shared<const tmcl::Settings>(*std::move(read));
}

/// Of the module that was added last.
void set_deadman(Draft& draft, const Said<std::uint16_t>& ms, BusConfig& bus) {
  if (!ms) return;
  bus.modules.back().deadman_ms = *ms;
  auto fault = fault_of_deadman(*ms);
  if (fault.empty()) fault = fault_of_feeding(bus);
  if (!fault.empty()) draft.complain(ms, "'deadman_ms' " + fault);
}

void set_sentinel(Draft& draft, const Said<std::string>& text, ModuleConfig& module) {
  if (!text) return;
  const auto sentinel = sentinel_of(*text);
  if (sentinel) module.sentinel = *sentinel;
  if (sentinel) return;
  draft.complain(
      text, "'sentinel' is " + quoted(*text) +
                ", but must be auto, tick, settings, none or variable:N with N from 56 to 255");
}

}  // namespace

void add_bus(Draft& draft, const BusSection& section) {
  const bool is_named = draft.has_new_name(section, draft.config.buses);
  if (!section.link) return;
  auto link = tmcl::parse_link_name(*section.link);
  if (!link) {
    const auto& error = link.error();
    return draft.complain(section.link,
                          error.message + (error.hint.empty() ? "" : ": " + error.hint));
  }
  check_links(draft, section, *link);
  for (const auto& other : draft.config.buses) {
    if (to_string(other.link) != to_string(*link)) continue;
    draft.complain(section.link, "bus " + quoted(other.name) + " already uses this link");
  }
  if (!is_named) return;
  draft.config.buses.push_back(
      {*section.name, std::move(*link), link_options(section), bus_options(section)});
}

void add_module(Draft& draft, const ModuleSection& section) {
  auto* bus = draft.find_bus(section.bus);
  if (bus == nullptr || !section.address) return;
  auto& modules = bus->modules;
  const tmcl::ModuleAddress address{*section.address};
  if (std::ranges::count(modules, address, &ModuleConfig::address) != 0) {
    draft.complain(section.address, fmt::format("module {} on bus {} is given twice",
                                                *section.address, quoted(bus->name)));
  }
  modules.push_back({address});
  set_deadman(draft, section.deadman_ms, *bus);
  set_measured(draft, section.as, modules.back());
  set_settings(draft, section, *bus);
  set_sentinel(draft, section.sentinel, modules.back());
}

}  // namespace tmcld
