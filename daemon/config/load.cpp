#include "config/load.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "config/build.hpp"
#include "config/section.hpp"

namespace tmcld {
namespace {

// A configuration of max_axes axes has some 20 kB; a whole disk given by mistake has more.
constexpr std::size_t max_file_bytes = 1U << 20U;

tl::unexpected<std::string> cannot_be_read(const std::string& path) {
  return tl::unexpected(path + ": cannot be read: " + std::strerror(errno));
}

/// Whoever writes the configuration decides where motors may go.
std::optional<std::string> objection_to_writers(const std::string& path,
                                                const struct stat& status) {
  const bool is_ours = status.st_uid == 0 || status.st_uid == ::geteuid();
  if (!is_ours) {
    return path + ": belongs to another user (uid " + std::to_string(status.st_uid) +
           "), who could change limits of axes; make it root's or your own: `chown`";
  }
  if (S_ISREG(status.st_mode) && (status.st_mode & S_IWOTH) != 0) {
    return path + ": everybody may write to it, and so change limits of axes; try `chmod o-w " +
           path + "`";
  }
  return std::nullopt;
}

tl::expected<std::string, std::string> read_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"),
                                                             &std::fclose);
  struct stat status {};
  if (!file || ::fstat(::fileno(file.get()), &status) != 0) return cannot_be_read(path);
  if (auto objection = objection_to_writers(path, status)) return tl::unexpected(*objection);
  std::string text(max_file_bytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0) return cannot_be_read(path);
  if (text.size() > max_file_bytes) return tl::unexpected(path + ": is larger than 1 MiB");
  return text;
}

using Problems = std::vector<ConfigProblem>;

tl::expected<Config, Problems> build(ConfigText text) {
  if (!text.is_toml) return tl::unexpected(std::move(text.problems));
  auto config = build_config(text.sections, text.problems);
  if (text.problems.empty()) return config;
  std::ranges::stable_sort(text.problems, {}, [](const ConfigProblem& problem) {
    return std::pair(problem.place.line, problem.place.column);
  });
  return tl::unexpected(std::move(text.problems));
}

tl::expected<Config, std::vector<std::string>> with_lines(const std::string& path,
                                                          tl::expected<Config, Problems> config) {
  if (config) return std::move(*config);
  std::vector<std::string> lines;
  for (const auto& problem : config.error()) lines.push_back(describe(path, problem));
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

tl::expected<Config, std::vector<ConfigProblem>> parse_config(std::string_view toml) {
  return build(read_sections(toml, DaemonSection::required));
}

tl::expected<Config, std::vector<std::string>> load_config(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(std::vector{text.error()});
  return with_lines(path, parse_config(*text));
}

tl::expected<Config, std::vector<std::string>> load_config_for_link(const std::string& path,
                                                                    const tmcl::LinkName& link) {
  const auto file = read_file(path);
  if (!file) return tl::unexpected(std::vector{file.error()});
  auto text = read_sections(*file, DaemonSection::ignored);
  if (!text.problems.empty()) return with_lines(path, build(std::move(text)));
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
  return with_lines(path, std::move(config));
}

Config config_for_link(const tmcl::LinkName& link) {
  Config config;
  auto& bus = config.buses.emplace_back();
  bus.name = bus.bus_options.name = "direct";
  bus.link = link;
  return config;
}

}  // namespace tmcld
