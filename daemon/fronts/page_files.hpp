/// The page that a browser is shown: its files, read once. No request reads the disk, so none can
/// name a file that is not of the page.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "log/sink.hpp"

namespace tmcld {

/// Of all files together, in all codings.
constexpr std::size_t max_page_bytes = 4U << 20U;

struct PageFile {
  std::string type{};        ///< As in Content-Type.
  std::string tag{};         ///< Changes with what is in it.
  bool is_constant = false;  ///< Its name changes with what is in it.
  std::string plain{};
  std::string gzip{};  ///< Empty: not there in this coding.
  std::string brotli{};
};

/// What of a file goes to a client, and in which coding ("br", "gzip", empty).
struct PageBody {
  std::string_view coding{};
  std::string_view bytes{};
};

class PageFiles {
 public:
  /// What is in the folder. Where that has no page: ten lines that say how to get it.
  static PageFiles load(const std::string& folder, const LogSink& log);
  /// Where the page is for this program: in the folder of its build, or where it is installed.
  static std::string usual_folder();

  /// Null if there is none; `target`: of the request, as it came.
  const PageFile* find(std::string_view target) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;  ///< By target, "/" first.
};

/// The smallest that a client with this Accept-Encoding reads.
PageBody body_for(const PageFile& file, std::string_view accepted);
/// Whether a client that has what If-None-Match says has the file.
bool is_known(const PageFile& file, std::string_view known_tags);

}  // namespace tmcld
