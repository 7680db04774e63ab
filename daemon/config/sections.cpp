// What knows the TOML library costs three seconds to compile.
#include <toml++/toml.h>

#include "config/sections.hpp"

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

template <class S>
constexpr auto keys_of = tmcl::api::rows_of<S, S, Key>();

struct Kind {
  std::string_view title;
  std::span<const Key> keys;
  Section& (*add)(ConfigText& text);

  constexpr bool is_single() const { return !title.starts_with("[["); }
  constexpr std::string_view name() const {
    const std::size_t brackets = is_single() ? 1 : 2;
    return title.substr(brackets, title.size() - 2 * brackets);
  }
};

template <auto list>
constexpr Kind kind() {
  using S = typename decltype(tmcl::api::value_of(list))::value_type;
  return {S::title, keys_of<S>,
          [](ConfigText& text) -> Section& { return (text.*list).emplace_back(); }};
}
constexpr std::array kinds{kind<&ConfigText::daemon>(),  kind<&ConfigText::http>(),
                           kind<&ConfigText::access>(),  kind<&ConfigText::buses>(),
                           kind<&ConfigText::modules>(), kind<&ConfigText::axes>(),
                           kind<&ConfigText::ports>()};

std::string_view name_of(KeyType type) {
  switch (type) {
    case KeyType::string: return "a text in quotes";
    case KeyType::strings: return "a list of texts, [\"one\", \"another\"]";
    case KeyType::integer: return "a whole number";
    case KeyType::number: return "a number";
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

std::optional<KeyValue> value_of(KeyType type, const toml::node& node) {
  switch (type) {
    case KeyType::string: return node.value_exact<std::string>();
    case KeyType::strings: return texts_of(node.as_array());
    case KeyType::integer: return node.value_exact<std::int64_t>();
    case KeyType::number: return number_of(node);
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
  Reader(ConfigText& text, const std::string& file, OfDaemon daemon)
      : text_(text), file_(file), daemon_(daemon) {}

  void read(std::string_view toml) {
    // Debian's build of the library reports errors by throwing; this is where that ends.
    try {
      read(toml::parse(toml));
    } catch (const toml::parse_error& error) {
      text_.is_toml = false;
      complain(error.source(), std::string(error.description()));
    }
  }

 private:
  Place place_of(const toml::source_region& source) const {
    return {source.begin.line, source.begin.column, file_};
  }

  void complain(const toml::source_region& source, std::string message) {
    text_.problems.push_back(place_of(source).problem(std::move(message)));
  }

  void read(const toml::table& root) {
    for (const auto& [key, node] : root) {
      const auto kind = std::ranges::find(kinds, key.str(), &Kind::name);
      if (kind == kinds.end()) {
        complain_unknown_section(key, node);
      } else if (kind->is_single()) {
        read_single(*kind, node);
      } else {
        read_list(*kind, node);
      }
    }
  }

  void complain_unknown_section(const toml::key& key, const toml::node& node) {
    if (!node.is_table() && !node.is_array_of_tables())
      return complain(key.source(), quoted(key.str()) + " stands outside of any section");
    std::array<std::string_view, kinds.size()> known;
    std::ranges::transform(kinds, known.begin(), &Kind::name);
    complain(key.source(), fmt::format("unknown section '{}'.{}", key.str(),
                                       tmcl::did_you_mean(key.str(), known)));
  }

  void read_single(const Kind& kind, const toml::node& node) {
    if (kind.title == DaemonSection::title) text_.names_daemon = true;
    if (daemon_ == OfDaemon::ignored) return;
    if (const auto* table = node.as_table()) return read_section(kind, *table);
    complain(node.source(), fmt::format("there is one such section, written {}", kind.title));
  }

  void read_list(const Kind& kind, const toml::node& node) {
    const auto* list = node.as_array();
    if (list == nullptr || !std::ranges::all_of(*list, &toml::node::is_table)) {
      return complain(node.source(), fmt::format("write a section of this kind as {}, with two "
                                                 "brackets, because there may be several",
                                                 kind.title));
    }
    for (const auto& entry : *list) read_section(kind, *entry.as_table());
  }

  void read_section(const Kind& kind, const toml::table& table) {
    auto& section = kind.add(text_);
    section.place = place_of(table.source());
    section.text = fmt::format("{}\n", kind.title);
    for (const auto& [key, node] : table) read_key(kind, section, key, node);
    for (const auto& key : kind.keys) {
      if (!key.is_required || table.contains(key.name)) continue;
      complain(table.source(),
               fmt::format("{} needs the key '{}': {}", kind.title, key.name, key.meaning));
    }
  }

  void read_key(const Kind& kind, Section& section, const toml::key& name, const toml::node& node) {
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

  void complain_unknown_key(const Kind& kind, const toml::key& key) {
    std::vector<std::string_view> known;
    for (const auto& one : kind.keys) known.push_back(one.name);
    complain(key.source(), fmt::format("unknown key '{}' in {}.{}", key.str(), kind.title,
                                       tmcl::did_you_mean(key.str(), known)));
  }

  ConfigText& text_;
  const std::string& file_;
  OfDaemon daemon_;
};

}  // namespace

void read_sections(std::string_view toml, const std::string& file, OfDaemon daemon,
                   ConfigText& text) {
  text.files.push_back(file);
  Reader(text, file, daemon).read(toml);
}

std::vector<Key> config_keys() {
  std::vector<Key> all;
  for (const auto& kind : kinds) all.insert(all.end(), kind.keys.begin(), kind.keys.end());
  return all;
}

}  // namespace tmcld
