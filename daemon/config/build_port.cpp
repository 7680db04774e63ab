#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/build_sections.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

using PortPlace = decltype(PortConfig::place);

std::string text_of(const PortPlace& place) {
  if (const auto* pty = std::get_if<PtyName>(&place)) return "pty:" + pty->path;
  if (const auto* tcp = std::get_if<tmcl::TcpName>(&place)) return to_string(tmcl::LinkName(*tcp));
  return to_string(tmcl::LinkName(std::get<tmcl::CanName>(place)));
}

Role role_of_port(Draft& draft, const ConfigSection& section) {
  constexpr std::array<std::string_view, 2> words{"move", "configure"};
  auto role = Role::observe;
  const auto* may = section.get<ConfigTexts>("may");
  if (may == nullptr) return role;
  for (const auto& word : *may) {
    if (word == words[0]) role = std::max(role, Role::operate);
    if (word == words[1]) role = Role::configure;
    if (std::ranges::count(words, word) != 0) continue;
    draft.complain(section.place_of("may"),
                   fmt::format("'may' has '{}', but can only have {}.{}", word,
                               fmt::join(words, " and "), tmcl::did_you_mean(word, words)));
  }
  return role;
}

std::optional<PortPlace> parse_place(Draft& draft, const ConfigSection& section,
                                     std::string_view key, const std::string& text) {
  if (key == "pty") {
    if (!text.empty()) return PtyName{text};
    draft.complain(section.place_of(key), "'pty' must be a path");
    return std::nullopt;
  }
  auto link = tmcl::parse_link_name(std::string(key) + ":" + text);
  if (!link) {
    const std::string form = key == "tcp" ? "HOST:PORT" : "the name of an interface";
    draft.complain(section.place_of(key),
                   fmt::format("'{}' is '{}', but must be {}", key, text, form));
    return std::nullopt;
  }
  for (const auto& bus : draft.config.buses) {
    if (to_string(bus.link) != to_string(*link)) continue;
    draft.complain(section.place_of(key), "bus " + quoted(bus.name) + " is there: a port needs " +
                                              (key == "can" ? "an interface" : "a place") +
                                              " of its own");
  }
  if (const auto* tcp = std::get_if<tmcl::TcpName>(&*link)) return *tcp;
  return std::get<tmcl::CanName>(*link);
}

/// Nothing, and a complaint, if it is not one of the three, or in use.
std::optional<PortPlace> place_of_port(Draft& draft, const ConfigSection& section) {
  std::optional<PortPlace> place;
  constexpr std::array<std::string_view, 3> keys{"pty", "tcp", "can"};
  const auto given =
      std::ranges::count_if(keys, [&](auto key) { return section.find(key) != nullptr; });
  if (given != 1) {
    draft.complain(section.place,
                   "[[port]] needs one of 'pty', 'tcp' and 'can': where its hosts find the bus");
    return place;
  }
  for (const auto key : keys)
    if (const auto* text = section.get<std::string>(key))
      place = parse_place(draft, section, key, *text);
  const auto key =
      *std::ranges::find_if(keys, [&](auto one) { return section.find(one) != nullptr; });
  for (const auto& other : draft.config.ports) {
    if (!place || text_of(other.place) != text_of(*place)) continue;
    draft.complain(section.place_of(key), "port " + quoted(other.name) + " is there already");
  }
  return place;
}

}  // namespace

void add_port(Draft& draft, const ConfigSection& section) {
  const auto* name = draft.new_name(section, draft.config.ports);
  const auto* bus_name = section.get<std::string>("bus");
  const auto role = role_of_port(draft, section);
  const auto place = place_of_port(draft, section);
  const auto* bus = bus_name == nullptr ? nullptr : draft.find_bus(section, *bus_name);
  if (bus == nullptr || name == nullptr || !place) return;
  draft.config.ports.push_back({*name, *bus_name, *place, role});
}

}  // namespace tmcld
