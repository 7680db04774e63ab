/// The keys of the configuration file: the one table that the reader, its errors and the tests of
/// the example file use.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace tmcld {

enum class SectionKind : std::uint8_t { daemon, http, access, bus, module, axis, port };
enum class KeyType : std::uint8_t { string, strings, integer, number, boolean, range };
/// On which links a key of [[bus]] means something.
enum class LinkScope : std::uint8_t { any, can, tcp, serial_framing };

struct KeyInfo {
  SectionKind section;
  std::string_view name;
  KeyType type;
  bool required;
  std::int64_t minimum;  ///< Integers only.
  std::int64_t maximum;
  LinkScope scope;
  std::string_view meaning;
};

/// "[daemon]", "[http]", "[[access]]", "[[bus]]", "[[module]]", "[[axis]]", "[[port]]"
std::string_view title_of(SectionKind section);
std::string_view name_of(KeyType type);
std::string_view name_of(LinkScope scope);

std::span<const KeyInfo> config_keys();
/// Null if the section has no such key.
const KeyInfo* find_key(SectionKind section, std::string_view name);

}  // namespace tmcld
