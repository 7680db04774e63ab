#include "config/load.hpp"

#include <algorithm>
#include <utility>

#include "config/build.hpp"
#include "config/build_http.hpp"
#include "config/files.hpp"
#include "config/section.hpp"

namespace tmcld {
namespace {

std::optional<HttpConfig> http_of(ConfigText& text) {
  const auto section = std::ranges::find(text.sections, SectionKind::http, &ConfigSection::kind);
  if (section == text.sections.end()) return std::nullopt;
  return build_http(*section, text.problems);
}

tl::expected<Config, tmcl::TextProblems> build(ConfigText text) {
  Config config;
  if (text.is_toml) config = build_config(text.sections, text.problems);
  (void)http_of(text);
  if (text.problems.empty()) return config;
  std::ranges::stable_sort(text.problems, {}, [](const tmcl::TextProblem& problem) {
    return std::pair(problem.line, problem.column);
  });
  return tl::unexpected(std::move(text.problems));
}

void demand_daemon_section(ConfigText& text, const std::string& file = {}) {
  if (!text.is_toml || text.names_daemon) return;
  text.problems.push_back(
      Place{1, 1, file}.problem("the section [daemon] with its key 'socket' is missing"));
}

// ---- several files -----------------------------------------------------------------------------

using Files = std::vector<ConfigFile>;

/// Sections go by their order; where they stand tells the file, too.
void append(ConfigText& all, ConfigText one, const std::string& file) {
  for (auto& section : one.sections) {
    section.place.file = file;
    for (auto& [key, value] : section.values) value.place.file = file;
    all.sections.push_back(std::move(section));
  }
  for (auto& problem : one.problems) {
    problem.file = file;
    all.problems.push_back(std::move(problem));
  }
  all.is_toml = all.is_toml && one.is_toml;
  all.names_daemon = all.names_daemon || one.names_daemon;
}

void check_single_section(ConfigText& text, SectionKind kind) {
  const ConfigSection* first = nullptr;
  for (const auto& section : text.sections) {
    if (section.kind != kind) continue;
    if (first == nullptr) {
      first = &section;
    } else {
      text.problems.push_back(section.place.problem(std::string(title_of(kind)) + " stands in " +
                                                    first->place.file +
                                                    " already: it is for one file"));
    }
  }
}

ConfigText read_all(const Files& files, DaemonSection daemon) {
  ConfigText all;
  for (const auto& file : files) append(all, read_sections(file.text, daemon), file.path);
  check_single_section(all, SectionKind::daemon);
  check_single_section(all, SectionKind::http);
  return all;
}

tl::expected<Config, std::vector<std::string>> with_lines(
    const Files& files, tl::expected<Config, tmcl::TextProblems> config) {
  if (config) return std::move(*config);
  auto& problems = config.error();
  std::ranges::stable_sort(problems, {}, [&](const tmcl::TextProblem& problem) {
    return std::ranges::find(files, problem.file, &ConfigFile::path);
  });
  std::vector<std::string> lines;
  for (const auto& problem : problems) lines.push_back(describe(problem));
  return tl::unexpected(std::move(lines));
}

// ---- one bus of several ------------------------------------------------------------------------

bool is_bus(const ConfigSection& section) { return section.kind == SectionKind::bus; }

bool has_link(const ConfigSection& bus, const tmcl::LinkName& link) {
  const auto* text = bus.get<std::string>("link");
  if (text == nullptr) return false;
  const auto name = tmcl::parse_link_name(*text);
  return name && to_string(*name) == to_string(link);
}

/// The end of the list if there is none.
auto bus_for(std::vector<ConfigSection>& sections, const tmcl::LinkName& link) {
  const bool is_only = std::ranges::count_if(sections, is_bus) == 1;
  return std::ranges::find_if(sections, [&](const ConfigSection& section) {
    return is_bus(section) && (is_only || has_link(section, link));
  });
}

std::string no_bus_for(const std::vector<ConfigSection>& sections, const tmcl::LinkName& link) {
  std::string buses;
  for (const auto& section : sections) {
    const auto* name = section.get<std::string>("name");
    const auto* text = section.get<std::string>("link");
    if (!is_bus(section) || name == nullptr || text == nullptr) continue;
    buses += (buses.empty() ? "" : ", ") + *name + " on " + *text;
  }
  if (buses.empty()) return "there is no bus";
  return "there are several buses, and none of them is on " + to_string(link) + ": " + buses;
}

void keep_only(std::vector<ConfigSection>& sections, const std::string& bus) {
  std::erase_if(sections, [&](const ConfigSection& section) {
    const auto* name = section.get<std::string>(is_bus(section) ? "name" : "bus");
    return name == nullptr || *name != bus;
  });
}

}  // namespace

tl::expected<Config, tmcl::TextProblems> parse_config(std::string_view toml) {
  auto text = read_sections(toml, DaemonSection::read);
  demand_daemon_section(text);
  return build(std::move(text));
}

tl::expected<LoadedConfig, std::vector<std::string>> load_config(const std::string& path) {
  const auto files = read_config_files(path);
  if (!files) return tl::unexpected(std::vector{files.error()});
  auto text = read_all(*files, DaemonSection::read);
  demand_daemon_section(text, files->front().path);
  auto config = with_lines(*files, build(std::move(text)));
  if (!config) return tl::unexpected(std::move(config.error()));
  return LoadedConfig{std::move(*config), files->size()};
}

tl::expected<std::optional<HttpConfig>, std::vector<std::string>> load_http_config(
    const std::string& path) {
  const auto files = read_config_files(path);
  if (!files) return tl::unexpected(std::vector{files.error()});
  auto text = read_all(*files, DaemonSection::read);
  auto http = http_of(text);
  if (text.problems.empty()) return http;
  return with_lines(*files, build(std::move(text))).map([&](const Config&) { return http; });
}

tl::expected<Config, std::vector<std::string>> load_config_for_link(const std::string& path,
                                                                    const tmcl::LinkName& link) {
  const auto files = read_config_files(path);
  if (!files) return tl::unexpected(std::vector{files.error()});
  auto text = read_all(*files, DaemonSection::ignored);
  if (!text.problems.empty()) return with_lines(*files, build(std::move(text)));
  const auto bus = bus_for(text.sections, link);
  if (bus == text.sections.end())
    return tl::unexpected(std::vector{path + ": " + no_bus_for(text.sections, link)});
  bus->values.at("link").value = to_string(link);
  keep_only(text.sections, *bus->get<std::string>("name"));
  auto config = build(std::move(text));
  // What runs for one call does not feed a module: it must not give it a deadman.
  for (auto& one : config ? config->buses : std::vector<BusConfig>{}) {
    for (auto& module : one.modules) module.deadman_ms.reset();
  }
  return with_lines(*files, std::move(config));
}

Config config_for_link(const tmcl::LinkName& link) {
  Config config;
  auto& bus = config.buses.emplace_back();
  bus.name = bus.bus_options.name = "direct";
  bus.link = link;
  return config;
}

}  // namespace tmcld
