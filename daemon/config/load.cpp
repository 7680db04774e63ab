#include "config/load.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "config/build.hpp"
#include "config/files.hpp"
#include "config/sections.hpp"

namespace tmcld {
namespace {

std::optional<HttpConfig> http_of(ConfigText& text) {
  if (text.http.empty()) return std::nullopt;
  return build_http(text.http.front(), text.problems);
}

tl::expected<Config, tmcl::TextProblems> build(ConfigText text) {
  Config config;
  if (text.is_toml) config = build_config(text);
  (void)http_of(text);
  if (text.problems.empty()) return config;
  std::ranges::stable_sort(text.problems, {}, [&](const tmcl::TextProblem& problem) {
    return std::tuple(std::ranges::find(text.files, problem.file), problem.line, problem.column);
  });
  return tl::unexpected(std::move(text.problems));
}

void demand_daemon_section(ConfigText& text) {
  if (!text.is_toml || text.names_daemon) return;
  text.problems.push_back(Place{1, 1, text.files.front()}.problem(
      "the section [daemon] with its key 'socket' is missing"));
}

// ---- several files -----------------------------------------------------------------------------

using Lines = std::vector<std::string>;

template <class S>
void check_is_single(const std::vector<S>& sections, tmcl::TextProblems& problems) {
  for (const auto& section : sections) {
    const auto& first = sections.front();
    if (&section == &first) continue;
    problems.push_back(section.place.problem(std::string(S::title) + " stands in " +
                                             first.place.file + " already: it is for one file"));
  }
}

/// Empty: [daemon] names none.
std::string managed_file(const ConfigText& text) {
  return text.daemon.empty() ? "" : text.daemon.front().managed.value_or("");
}

tl::expected<std::optional<ConfigFile>, tmcl::TextProblem> managed_of(
    const ConfigText& text, const std::optional<std::string>& in_its_place) {
  const auto path = managed_file(text);
  if (path.empty()) return std::nullopt;
  if (in_its_place) return ConfigFile{path, *in_its_place};
  return read_managed_file(path);
}

tl::expected<ConfigText, tmcl::TextProblems> read_all(
    const std::string& path, OfDaemon daemon, const std::optional<std::string>& managed = {}) {
  const auto files = read_config_files(path);
  if (!files) return tl::unexpected(tmcl::TextProblems{files.error()});
  ConfigText all;
  for (const auto& file : *files) read_sections(file.text, file.path, daemon, all);
  const auto last = managed_of(all, managed);
  if (!last) return tl::unexpected(tmcl::TextProblems{last.error()});
  if (*last) read_sections((*last)->text, (*last)->path, OfDaemon::refused, all);
  check_is_single(all.daemon, all.problems);
  check_is_single(all.http, all.problems);
  check_is_single(all.path, all.problems);
  return all;
}

// ---- one bus of several ------------------------------------------------------------------------

bool has_link(const BusSection& bus, const tmcl::LinkName& link) {
  const auto name = tmcl::parse_link_name(*bus.link);
  return name && to_string(*name) == to_string(link);
}

std::string no_bus_for(const std::vector<BusSection>& buses, const tmcl::LinkName& link) {
  std::string known;
  for (const auto& bus : buses)
    known += (known.empty() ? "" : ", ") + *bus.name + " on " + *bus.link;
  if (known.empty()) return "there is no bus";
  return "there are several buses, and none of them is on " + to_string(link) + ": " + known;
}

void keep_only(ConfigText& text, const std::string& bus) {
  std::erase_if(text.buses, [&](const auto& section) { return *section.name != bus; });
  const auto is_elsewhere = [&](const auto& section) { return *section.bus != bus; };
  std::erase_if(text.modules, is_elsewhere);
  std::erase_if(text.axes, is_elsewhere);
  std::erase_if(text.ports, is_elsewhere);
  text.access.clear();
  for (auto& section : text.path) {
    for (const auto& one : path_word_keys) {
      auto& said = section.*one.key;
      if (said && !said->starts_with(bus + ":")) said = {};
    }
  }
}

}  // namespace

tl::expected<Config, tmcl::TextProblems> parse_config(std::string_view toml) {
  ConfigText text;
  read_sections(toml, {}, OfDaemon::read, text);
  demand_daemon_section(text);
  return build(std::move(text));
}

Lines lines_of(const tmcl::TextProblems& problems) {
  Lines lines;
  for (const auto& problem : problems) lines.push_back(describe(problem));
  return lines;
}

tl::expected<LoadedConfig, Lines> load_config(const std::string& path) {
  auto text = read_all(path, OfDaemon::read);
  if (!text) return tl::unexpected(lines_of(text.error()));
  demand_daemon_section(*text);
  const auto files = text->files.size();
  return build(std::move(*text)).map_error(lines_of).map([&](Config config) {
    return LoadedConfig{std::move(config), files};
  });
}

tl::expected<Config, tmcl::TextProblems> load_config_with(
    const std::string& path, const std::optional<std::string>& managed) {
  auto text = read_all(path, OfDaemon::read, managed);
  if (!text) return tl::unexpected(std::move(text.error()));
  demand_daemon_section(*text);
  return build(std::move(*text));
}

tl::expected<std::optional<HttpConfig>, Lines> load_http_config(const std::string& path) {
  auto text = read_all(path, OfDaemon::read);
  if (!text) return tl::unexpected(lines_of(text.error()));
  auto http = http_of(*text);
  if (text->problems.empty()) return http;
  return tl::unexpected(lines_of(build(std::move(*text)).error()));
}

tl::expected<Config, Lines> load_config_for_link(const std::string& path,
                                                 const tmcl::LinkName& link) {
  auto text = read_all(path, OfDaemon::ignored);
  if (!text) return tl::unexpected(lines_of(text.error()));
  if (!text->problems.empty()) return build(std::move(*text)).map_error(lines_of);
  auto& buses = text->buses;
  const auto found = std::ranges::find_if(
      buses, [&](const BusSection& bus) { return buses.size() == 1 || has_link(bus, link); });
  if (found == buses.end()) return tl::unexpected(Lines{path + ": " + no_bus_for(buses, link)});
  *found->link = to_string(link);
  keep_only(*text, std::string(*found->name));
  auto config = build(std::move(*text)).map_error(lines_of);
  if (!config) return config;
  // What runs for one call does not feed a module: it must not give it a deadman. Nor does it
  // watch its settings.
  for (auto& one : config->buses) {
    for (auto& module : one.modules) {
      module.deadman_ms.reset();
      module.settings = {};
    }
  }
  return config;
}

Config config_for_link(const tmcl::LinkName& link) {
  Config config;
  auto& bus = config.buses.emplace_back();
  bus.name = bus.bus_options.name = "direct";
  bus.link = link;
  return config;
}

}  // namespace tmcld
