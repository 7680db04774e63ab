#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "config/build_sections.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::string_view output_word = " output ";

/// The whole of a text; nothing if it is no number up to `most`.
template <class Integer>
std::optional<Integer> whole_number(std::string_view text, Integer most) {
  Integer number{};
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  const bool is_good = read.ec == std::errc() && read.ptr == end && number <= most;
  return is_good ? std::optional(number) : std::nullopt;
}

/// What stands before the mark, and `text` behind it; all of it without one.
std::string_view take_until(std::string_view mark, std::string_view& text) {
  const auto place = text.find(mark);
  const auto before = text.substr(0, place);
  text.remove_prefix(std::min(text.size(), before.size() + mark.size()));
  return before;
}

/// Nothing if it is none; whether there is such a bus is not looked at.
std::optional<OutputSetting> output_of(std::string_view text) {
  OutputSetting output;
  output.bus = take_until(":", text);
  const auto address = whole_number<std::uint16_t>(take_until(output_word, text), max_can_address);
  const auto port = whole_number<std::uint8_t>(take_until(" ", text), 255);
  const auto value = whole_number<std::uint8_t>(text, 1);
  if (output.bus.empty() || !address || !port || !value) return std::nullopt;
  output.module = tmcl::ModuleAddress{*address};
  output.port = *port;
  output.value = *value;
  return output;
}

void add_word(Draft& draft, std::uint8_t word, const Said<std::string>& said) {
  if (!said) return;
  auto output = output_of(*said);
  if (!output) {
    return draft.complain(
        said, fmt::format("'{}' is {}, but must be BUS:ADDRESS output PORT VALUE with 0 or 1 as "
                          "VALUE, such as \"bench:1 output 0 1\"",
                          said.key, quoted(*said)));
  }
  Said<std::string> bus{{said.key, said.place}, output->bus};
  if (draft.find_bus(bus, fmt::format("'{}': ", said.key)) == nullptr) return;
  draft.config.path.words.emplace(word, std::move(*output));
}

bool is_finite(Draft& draft, const Given& key, const std::string& name, double number) {
  if (std::isfinite(number)) return true;
  draft.complain(
      key, fmt::format("{} of '{}' is {}, and no finite number", quoted(name), key.key, number));
  return false;
}

void add_origin(Draft& draft, const Said<ConfigNumbers>& said,
                std::optional<std::array<double, 6>>& origin) {
  if (!said) return;
  constexpr std::string_view letters = "xyzabc";
  origin.emplace();
  for (const auto& [name, number] : *said) {
    const auto axis = name.size() == 1 ? letters.find(name.front()) : std::string_view::npos;
    if (axis == std::string_view::npos) {
      draft.complain(said, fmt::format("'{}' has {}, but its names are x, y, z, a, b and c",
                                       said.key, quoted(name)));
    } else if (is_finite(draft, said, name, number)) {
      (*origin)[axis] = number;
    }
  }
}

void add_tools(Draft& draft, const Said<ConfigNumbers>& said) {
  constexpr int most_tool = 99'999;
  for (const auto& [name, length] : said.value_or(ConfigNumbers{})) {
    const auto tool = whole_number<std::uint32_t>(name, most_tool);
    if (!tool || *tool == 0) {
      draft.complain(said, fmt::format("'{}' has {}, but its names are numbers of tools, 1 to {}",
                                       said.key, quoted(name), most_tool));
    } else if (is_finite(draft, said, name, length)) {
      draft.config.path.tools[static_cast<int>(*tool)] = length;
    }
  }
}

}  // namespace

void add_path(Draft& draft, const PathSection& section) {
  for (const auto& [word, key] : path_word_keys) add_word(draft, word, section.*key);
  for (std::size_t i = 0; i < path_origin_keys.size(); ++i)
    add_origin(draft, section.*path_origin_keys[i], draft.config.path.origins[i]);
  add_tools(draft, section.tools);
}

}  // namespace tmcld
