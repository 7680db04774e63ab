#include "fronts/page_files.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "fronts/header_list.hpp"
#include "gateway/store/secret.hpp"

namespace tmcld {
namespace {

namespace fs = std::filesystem;

struct TypeOfEnding {
  std::string_view ending;
  std::string_view type;
};
constexpr auto types = std::to_array<TypeOfEnding>({
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".webmanifest", "application/manifest+json"},
});
// What the build names after its content.
constexpr std::string_view constant_folder = "/assets/";
constexpr std::size_t tag_digits = 16;

constexpr std::string_view page_that_is_missing = R"(<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><title>tmcld</title></head>
<body>
<h1>tmcld is here, its page is not</h1>
<p>It was built without the page: node, npm or what npm was to get were not there.</p>
<p>Install them, then build again: apt-get install nodejs npm; cmake --preset release; cmake --build --preset release</p>
<p>A page that was built elsewhere: page = "DIR" in [http] of tmcld.toml.</p>
</body></html>
)";

/// Empty for what no browser is to be given.
std::string_view page_type(std::string_view name) {
  for (const auto& [ending, type] : types) {
    if (name.ends_with(ending)) return type;
  }
  return {};
}

std::string contents_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

PageFile page_file(std::string_view target, std::string plain) {
  PageFile file;
  file.type = page_type(target);
  file.tag = "W/\"" + hash_of(plain).substr(0, tag_digits) + "\"";
  file.is_constant = target.starts_with(constant_folder);
  file.plain = std::move(plain);
  return file;
}

using Files = std::map<std::string, PageFile, std::less<>>;

std::size_t page_bytes_of(const PageFile& file) {
  return file.plain.size() + file.gzip.size() + file.brotli.size();
}

/// Nothing where one cannot be read, or where there are more bytes than a page has.
Files read_files(const fs::path& folder, std::error_code& error) {
  Files files;
  std::size_t bytes = 0;
  const fs::recursive_directory_iterator end;
  for (fs::recursive_directory_iterator at(folder, error); !error && at != end;
       at.increment(error)) {
    const auto target = "/" + at->path().lexically_relative(folder).string();
    if (!at->is_regular_file(error) || page_type(target).empty()) continue;
    auto file = page_file(target, contents_of(at->path()));
    file.gzip = contents_of(at->path().string() + ".gz");
    file.brotli = contents_of(at->path().string() + ".br");
    bytes += page_bytes_of(file);
    files.emplace(target, std::move(file));
    if (bytes <= max_page_bytes) continue;
    error = std::make_error_code(std::errc::file_too_large);
    break;
  }
  return error ? Files{} : files;
}

}  // namespace

std::string PageFiles::usual_folder() {
  std::error_code error;
  const auto program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share" / "tmcl" / "page";
}

PageFiles PageFiles::load(const std::string& folder, const LogSink& log) {
  PageFiles page;
  std::error_code error;
  page.files_ = read_files(folder, error);
  auto index = page.files_.extract("/index.html");
  if (index.empty()) {
    const auto why = error ? error.message() : std::string("there is no index.html");
    log(LogLevel::info, "no page for browsers in " + folder + ": " + why);
    page.files_.clear();
    auto missing = page_file("/index.html", std::string(page_that_is_missing));
    page.files_.emplace("/", std::move(missing));
    return page;
  }
  index.key() = "/";
  page.files_.insert(std::move(index));
  return page;
}

const PageFile* PageFiles::find(std::string_view target) const {
  const auto found = files_.find(target.substr(0, target.find('?')));
  return found == files_.end() ? nullptr : &found->second;
}

PageBody body_for(const PageFile& file, std::string_view accepted) {
  if (!file.brotli.empty() && lists(accepted, "br")) return {"br", file.brotli};
  if (!file.gzip.empty() && lists(accepted, "gzip")) return {"gzip", file.gzip};
  return {{}, file.plain};
}

bool is_known(const PageFile& file, std::string_view known_tags) {
  return lists(known_tags, file.tag);
}

}  // namespace tmcld
