#include "screen.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

namespace tmclctl {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

// What the locale would be after setlocale; asking the environment works without the locale's
// files.
bool locale_is_utf8() {
  for (const auto* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    if (environment(name).empty()) continue;
    std::string locale(environment(name));
    std::ranges::transform(locale, locale.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    return locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
  }
  return false;
}

int columns_of(int descriptor) {
  const auto wished = environment("COLUMNS");
  int columns = 0;
  std::from_chars(wished.data(), wished.data() + wished.size(), columns);
  winsize size{};
  if (columns == 0 && ::ioctl(descriptor, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  return columns == 0 ? default_width : std::max(columns, least_width);
}

}  // namespace

Screen screen_of(int descriptor) {
  const auto term = environment("TERM");
  Screen screen;
  screen.terminal = ::isatty(descriptor) != 0 && term != "dumb";
  screen.colour = screen.terminal && environment("NO_COLOR").empty();
  screen.utf8 = locale_is_utf8();
  screen.width = columns_of(descriptor);
  return screen;
}

}  // namespace tmclctl
