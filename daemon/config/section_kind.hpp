/// Reading the sections of a file by kinds: of tmcld.toml, or of the file of another program.
///
///     struct MqttText {
///       std::vector<MqttSection> mqtt{};
///     };
///     constexpr std::array kinds{section_kind<MqttText, &MqttText::mqtt>()};
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/key.hpp"

namespace tmcld {

struct SectionKind {
  std::string_view title;
  std::span<const Key> keys;
  Section& (*add)(void* text);  ///< To the list of `text` that it goes into.

  constexpr bool is_single() const { return !title.starts_with("[["); }
  constexpr std::string_view name() const {
    const std::size_t brackets = is_single() ? 1 : 2;
    return title.substr(brackets, title.size() - 2 * brackets);
  }
};
using SectionKinds = std::span<const SectionKind>;

template <class S>
inline constexpr auto section_keys = tmcl::api::rows_of<S, S, Key>();

/// `list`: a member of Text, a vector of sections of this kind.
template <class Text, auto list>
constexpr SectionKind section_kind() {
  using S = typename decltype(tmcl::api::value_of(list))::value_type;
  return {S::title, section_keys<S>,
          [](void* text) -> Section& { return (static_cast<Text*>(text)->*list).emplace_back(); }};
}

struct SectionsRead {
  void* into;  ///< The Text of the kinds.
  tmcl::TextProblems& problems;
  bool is_toml = true;                      ///< If not, there is one problem.
  std::vector<std::string_view> singles{};  ///< Titles that stood there, right or wrong.
};

/// Reads TOML, checks its sections and keys, and appends them and what is wrong. Never throws.
void read_sections(std::string_view toml, const std::string& file, SectionKinds of,
                   SectionsRead& read);

}  // namespace tmcld
