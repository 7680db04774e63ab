/// A file that a verb leaves behind.
#pragma once

#include <fstream>
#include <string>

#include "errors.hpp"

namespace tmclctl {

/// Without a path nothing is opened and nothing written.
class OutputFile {
 public:
  /// Before anything is sent.
  Result<void> open(const std::string& path);
  /// The same of one that is there, behind its first bytes; what is behind those is gone.
  Result<void> open_behind(const std::string& path, std::size_t bytes);
  bool is_open() const { return file_.is_open(); }
  /// All of its contents, once they are known.
  Result<void> write(const std::string& text);
  /// More of its contents: they are there for others at once.
  Result<void> append(const std::string& text);

 private:
  Error problem() const;

  std::string path_;
  std::ofstream file_;
};

}  // namespace tmclctl
