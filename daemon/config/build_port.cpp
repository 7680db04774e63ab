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

Role role_of_port(Draft& draft, const Said<ConfigTexts>& may) {
  constexpr std::array<std::string_view, 2> words{"move", "configure"};
  auto role = Role::observe;
  for (const auto& word : may.value_or(ConfigTexts{})) {
    if (word == words[0]) role = std::max(role, Role::operate);
    if (word == words[1]) role = Role::configure;
    if (std::ranges::count(words, word) != 0) continue;
    draft.complain(may, fmt::format("'may' has '{}', but can only have {}.{}", word,
                                    fmt::join(words, " and "), tmcl::did_you_mean(word, words)));
  }
  return role;
}

std::optional<PortPlace> link_of_port(Draft& draft, const Said<std::string>& said) {
  const bool is_can_port = said.key == "can";
  auto link = tmcl::parse_link_name(fmt::format("{}:{}", said.key, *said));
  if (!link) {
    draft.complain(said, fmt::format("'{}' is '{}', but must be {}", said.key, *said,
                                     is_can_port ? "the name of an interface" : "HOST:PORT"));
    return std::nullopt;
  }
  for (const auto& bus : draft.config.buses) {
    if (to_string(bus.link) != to_string(*link)) continue;
    draft.complain(said, fmt::format("bus {} is there: a port needs {} of its own",
                                     quoted(bus.name), is_can_port ? "an interface" : "a place"));
  }
  if (const auto* tcp = std::get_if<tmcl::TcpName>(&*link)) return *tcp;
  return std::get<tmcl::CanName>(*link);
}

std::optional<PortPlace> place_of_pty(Draft& draft, const Said<std::string>& path) {
  if (!path->empty()) return PtyName{*path};
  draft.complain(path, "'pty' must be a path");
  return std::nullopt;
}

/// Nothing, and a complaint, if it is not one of the three, or in use.
std::optional<PortPlace> place_of_port(Draft& draft, const PortSection& section) {
  const auto& pty = section.pty;
  const auto& tcp = section.tcp;
  const auto& can = section.can;
  if (pty.has_value() + tcp.has_value() + can.has_value() != 1) {
    draft.complain(section.place,
                   "[[port]] needs one of 'pty', 'tcp' and 'can': where its hosts find the bus");
    return std::nullopt;
  }
  const auto& given = pty ? pty : tcp ? tcp : can;
  auto place = pty ? place_of_pty(draft, pty) : link_of_port(draft, given);
  for (const auto& other : draft.config.ports) {
    if (!place || text_of(other.place) != text_of(*place)) continue;
    draft.complain(given, "port " + quoted(other.name) + " is there already");
  }
  return place;
}

}  // namespace

void add_port(Draft& draft, const PortSection& section) {
  const bool is_named = draft.has_new_name(section, draft.config.ports);
  const auto role = role_of_port(draft, section.may);
  const auto place = place_of_port(draft, section);
  const auto* bus = draft.find_bus(section.bus);
  if (bus == nullptr || !is_named || !place) return;
  draft.config.ports.push_back({*section.name, bus->name, *place, role});
}

}  // namespace tmcld
