/// A key of a terminal.
#pragma once

#include <cstdint>

namespace tmclctl {

struct Key {
  enum class Kind : std::uint8_t {
    letter,  ///< What has a character: digits, a space and Tab, too.
    left,
    right,
    up,
    down,
    page_up,
    page_down,
    other,
  };
  Kind kind = Kind::other;
  char letter = '\0';       ///< Of a letter.
  bool is_release = false;  ///< Of an arrow or page key, where a terminal reports that.
  bool operator==(const Key&) const = default;
};

}  // namespace tmclctl
