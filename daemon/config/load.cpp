#include "config/load.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "config/build.hpp"
#include "config/section.hpp"

namespace tmcld {
namespace {

// A configuration of max_axes axes has some 20 kB; a whole disk given by mistake has more.
constexpr std::size_t max_file_bytes = 1U << 20U;

tl::expected<std::string, std::string> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return tl::unexpected(path + ": cannot be read: " + std::strerror(errno));
  std::string text(max_file_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return tl::unexpected(path + ": cannot be read: " + std::strerror(errno));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > max_file_bytes) return tl::unexpected(path + ": is larger than 1 MiB");
  return text;
}

}  // namespace

tl::expected<Config, std::vector<ConfigProblem>> parse_config(std::string_view toml) {
  auto text = read_sections(toml);
  if (!text.is_toml) return tl::unexpected(std::move(text.problems));
  auto config = build_config(text.sections, text.problems);
  if (text.problems.empty()) return config;
  std::ranges::stable_sort(text.problems, {}, [](const ConfigProblem& problem) {
    return std::pair(problem.place.line, problem.place.column);
  });
  return tl::unexpected(std::move(text.problems));
}

tl::expected<Config, std::vector<std::string>> load_config(const std::string& path) {
  const auto text = read_file(path);
  if (!text) return tl::unexpected(std::vector{text.error()});
  auto config = parse_config(*text);
  if (config) return std::move(*config);
  std::vector<std::string> lines;
  for (const auto& problem : config.error()) lines.push_back(describe(path, problem));
  return tl::unexpected(std::move(lines));
}

}  // namespace tmcld
