#include "settings_words.hpp"

#include <algorithm>
#include <array>

#include "tmcl/spelling.hpp"

namespace tmclsim {
namespace {

using tmcl::sim::Behaviour;
using tmcl::sim::FirmwareRelease;

// The words of an enumeration, in its order.
using TwoWords = std::array<std::string_view, 2>;
constexpr TwoWords behaviours{"manual", "lite"};

template <class Value>
tl::expected<Value, std::string> parse(std::string_view word, const TwoWords& words) {
  const auto found = std::ranges::find(words, word);
  if (found != words.end()) return static_cast<Value>(found - words.begin());
  return tl::unexpected("is " + tmcl::quoted(word) + ", but must be " + std::string(words[0]) +
                        " or " + std::string(words[1]) + "." + tmcl::did_you_mean(word, words));
}

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

tl::expected<Behaviour, std::string> parse_behaviour(std::string_view word) {
  return parse<Behaviour>(word, behaviours);
}

}  // namespace tmclsim
