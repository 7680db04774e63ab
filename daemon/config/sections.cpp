// What knows the TOML library costs three seconds to compile.
#include <toml++/toml.h>

#include "config/sections.hpp"

#include "config/section_kind.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::array kinds{section_kind<ConfigText, &ConfigText::daemon>(),
                           section_kind<ConfigText, &ConfigText::http>(),
                           section_kind<ConfigText, &ConfigText::access>(),
                           section_kind<ConfigText, &ConfigText::buses>(),
                           section_kind<ConfigText, &ConfigText::modules>(),
                           section_kind<ConfigText, &ConfigText::axes>(),
                           section_kind<ConfigText, &ConfigText::ports>(),
                           section_kind<ConfigText, &ConfigText::path>()};

/// Rights stay with who writes the other files. A port is a right, too: who reaches it needs none.
constexpr std::array of_administrator{DaemonSection::title, HttpSection::title,
                                      AccessSection::title, PortSection::title};

std::string_view name_of(KeyType type) {
  switch (type) {
    case KeyType::string: return "a text in quotes";
    case KeyType::strings: return "a list of texts, [\"one\", \"another\"]";
    case KeyType::integer: return "a whole number";
    case KeyType::number: return "a number";
    case KeyType::numbers: return "numbers with names, {x = 1.5, y = 2}";
    case KeyType::boolean: return "true or false";
    case KeyType::range: return "two numbers in brackets, [least, greatest]";
  }
  return {};
}

// ---- values ------------------------------------------------------------------------------------

std::optional<ConfigTexts> texts_of(const toml::array* list) {
  if (list == nullptr || !std::ranges::all_of(*list, &toml::node::is_string)) return std::nullopt;
  ConfigTexts texts;
  for (const auto& text : *list) texts.push_back(text.as_string()->get());
  return texts;
}

/// Nothing, too, for a whole number that no double is.
std::optional<double> number_of(const toml::node& node) {
  return node.is_number() ? node.value<double>() : std::nullopt;
}

std::optional<ConfigRange> range_of(const toml::array* list) {
  if (list == nullptr || list->size() != 2) return std::nullopt;
  const auto least = number_of((*list)[0]);
  const auto greatest = number_of((*list)[1]);
  return least && greatest ? std::optional(ConfigRange{*least, *greatest}) : std::nullopt;
}

std::optional<ConfigNumbers> numbers_of(const toml::table* table) {
  if (table == nullptr) return std::nullopt;
  ConfigNumbers numbers;
  for (const auto& [name, node] : *table) {
    const auto number = number_of(node);
    if (!number) return std::nullopt;
    numbers.emplace(name.str(), *number);
  }
  return numbers;
}

std::optional<KeyValue> value_of(KeyType type, const toml::node& node) {
  switch (type) {
    case KeyType::string: return node.value_exact<std::string>();
    case KeyType::strings: return texts_of(node.as_array());
    case KeyType::integer: return node.value_exact<std::int64_t>();
    case KeyType::number: return number_of(node);
    case KeyType::numbers: return numbers_of(node.as_table());
    case KeyType::boolean: return node.value_exact<bool>();
    case KeyType::range: return range_of(node.as_array());
  }
  return std::nullopt;
}

bool is_outside(const KeyValue& value, const tmcl::api::Bounds& bounds) {
  const auto* number = std::get_if<std::int64_t>(&value);
  return number != nullptr && (*number < bounds.minimum || *number > bounds.maximum);
}

// ---- sections ----------------------------------------------------------------------------------

class Reader {
 public:
  Reader(SectionKinds of, const std::string& file, OfDaemon daemon, SectionsRead& read)
      : kinds_(of), file_(file), daemon_(daemon), read_(read) {}

  void read(std::string_view toml) {
    // Debian's build of the library reports errors by throwing; this is where that ends.
    try {
      read(toml::parse(toml));
    } catch (const toml::parse_error& error) {
      read_.is_toml = false;
      complain(error.source(), std::string(error.description()));
    }
  }

 private:
  Place place_of(const toml::source_region& source) const {
    return {source.begin.line, source.begin.column, file_};
  }

  void complain(const toml::source_region& source, std::string message) {
    read_.problems.push_back(place_of(source).problem(std::move(message)));
  }

  void read(const toml::table& root) {
    for (const auto& [key, node] : root) {
      const auto kind = std::ranges::find(kinds_, key.str(), &SectionKind::name);
      if (kind == kinds_.end()) {
        complain_unknown_section(key, node);
      } else if (is_refused(*kind)) {
        complain(key.source(), fmt::format("{} cannot stand in the file that clients may set: it "
                                           "is for tmcld.toml and the files beside it",
                                           kind->title));
      } else if (kind->is_single()) {
        read_single(*kind, node);
      } else {
        read_list(*kind, node);
      }
    }
  }

  bool is_refused(const SectionKind& kind) const {
    return daemon_ == OfDaemon::refused &&
           std::ranges::find(of_administrator, kind.title) != of_administrator.end();
  }

  void complain_unknown_section(const toml::key& key, const toml::node& node) {
    if (!node.is_table() && !node.is_array_of_tables())
      return complain(key.source(), quoted(key.str()) + " stands outside of any section");
    std::vector<std::string_view> known;
    for (const auto& kind : kinds_) known.push_back(kind.name());
    complain(key.source(), fmt::format("unknown section '{}'.{}", key.str(),
                                       tmcl::did_you_mean(key.str(), known)));
  }

  void read_single(const SectionKind& kind, const toml::node& node) {
    read_.singles.push_back(kind.title);
    const bool is_for_all = kind.title == PathSection::title;
    if (daemon_ == OfDaemon::ignored && !is_for_all) return;
    if (const auto* table = node.as_table()) return read_section(kind, *table);
    complain(node.source(), fmt::format("there is one such section, written {}", kind.title));
  }

  void read_list(const SectionKind& kind, const toml::node& node) {
    const auto* list = node.as_array();
    if (list == nullptr || !std::ranges::all_of(*list, &toml::node::is_table)) {
      return complain(node.source(), fmt::format("write a section of this kind as {}, with two "
                                                 "brackets, because there may be several",
                                                 kind.title));
    }
    for (const auto& entry : *list) read_section(kind, *entry.as_table());
  }

  void read_section(const SectionKind& kind, const toml::table& table) {
    auto& section = kind.add(read_.into);
    section.place = place_of(table.source());
    section.text = fmt::format("{}\n", kind.title);
    for (const auto& [key, node] : table) read_key(kind, section, key, node);
    for (const auto& key : kind.keys) {
      if (!key.is_required || table.contains(key.name)) continue;
      complain(table.source(),
               fmt::format("{} needs the key '{}': {}", kind.title, key.name, key.meaning));
    }
  }

  void read_key(const SectionKind& kind, Section& section, const toml::key& name,
                const toml::node& node) {
    const auto key = std::ranges::find(kind.keys, name.str(), &Key::name);
    if (key == kind.keys.end()) return complain_unknown_key(kind, name);
    auto value = value_of(key->type, node);
    if (!value)
      return complain(node.source(), fmt::format("'{}' must be {}", key->name, name_of(key->type)));
    const auto text = std::visit([](const auto& of) { return fmt::format("{}", of); }, *value);
    if (is_outside(*value, key->bounds)) {
      return complain(node.source(), fmt::format("'{}' is {}, outside {}..{}", key->name, text,
                                                 key->bounds.minimum, key->bounds.maximum));
    }
    section.text += fmt::format("{} = {}\n", key->name, text);
    key->put(section, std::move(*value)) = {key->name, place_of(node.source())};
  }

  void complain_unknown_key(const SectionKind& kind, const toml::key& key) {
    std::vector<std::string_view> known;
    for (const auto& one : kind.keys) known.push_back(one.name);
    complain(key.source(), fmt::format("unknown key '{}' in {}.{}", key.str(), kind.title,
                                       tmcl::did_you_mean(key.str(), known)));
  }

  SectionKinds kinds_;
  const std::string& file_;
  OfDaemon daemon_;
  SectionsRead& read_;
};

}  // namespace

void read_sections(std::string_view toml, const std::string& file, OfDaemon daemon,
                   ConfigText& text) {
  text.files.push_back(file);
  SectionsRead read{&text, text.problems};
  Reader(kinds, file, daemon, read).read(toml);
  text.is_toml = text.is_toml && read.is_toml;
  if (std::ranges::count(read.singles, DaemonSection::title) != 0) text.names_daemon = true;
}

void read_sections(std::string_view toml, const std::string& file, SectionKinds of,
                   SectionsRead& read) {
  Reader(of, file, OfDaemon::read, read).read(toml);
}

std::vector<Key> config_keys() {
  std::vector<Key> all;
  for (const auto& kind : kinds) all.insert(all.end(), kind.keys.begin(), kind.keys.end());
  return all;
}

}  // namespace tmcld
