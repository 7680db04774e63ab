#include "settings_words.hpp"

namespace tmclsim {
namespace {

using tmcl::sim::FirmwareRelease;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::optional<FirmwareRelease> parse_release(std::string_view text) {
  constexpr std::string_view form = "1.09";
  if (text.size() != form.size() || text[1] != '.') return std::nullopt;
  if (!is_digit(text[0]) || !is_digit(text[2]) || !is_digit(text[3])) return std::nullopt;
  const auto digit = [text](std::size_t at) { return static_cast<unsigned>(text[at] - '0'); };
  return FirmwareRelease{static_cast<std::uint8_t>(digit(0)),
                         static_cast<std::uint8_t>(10 * digit(2) + digit(3))};
}

}  // namespace tmclsim
