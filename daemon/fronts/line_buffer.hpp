/// Cuts a stream of bytes into lines of bounded length.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tmcld {

class LineBuffer {
 public:
  explicit LineBuffer(std::size_t max_bytes) : max_(max_bytes) {
    line_.reserve(std::min(max_bytes, usual_bytes));
  }

  /// Calls `on_line(line)` for each line that is complete now, and `on_line(nullopt)` once for each
  /// that is too long; the rest of such a line is dropped as it comes.
  template <class OnLine>
  void push(std::string_view bytes, OnLine&& on_line) {
    while (!bytes.empty()) {
      const auto end = bytes.find('\n');
      const auto part = bytes.substr(0, end);
      take(part, on_line);
      if (end == std::string_view::npos) return;
      if (!dropping_) on_line(std::optional<std::string_view>(line_));
      line_.clear();
      dropping_ = false;
      bytes.remove_prefix(end + 1);
    }
  }

 private:
  template <class OnLine>
  void take(std::string_view part, OnLine&& on_line) {
    if (dropping_) return;
    if (line_.size() + part.size() <= max_) {
      line_ += part;
      return;
    }
    dropping_ = true;
    line_.clear();
    line_.shrink_to_fit();
    on_line(std::optional<std::string_view>());
  }

  /// A stop is short: it is taken even where there is no memory.
  static constexpr std::size_t usual_bytes = 512;

  std::size_t max_;
  std::string line_;
  bool dropping_ = false;
};

}  // namespace tmcld
