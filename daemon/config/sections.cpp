// What knows the TOML library costs three seconds to compile.
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <vector>

#include "config/section.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

Place place_of(const toml::source_region& source) {
  return {source.begin.line, source.begin.column};
}

class Reader {
 public:
  Reader(ConfigText& text, DaemonSection daemon) : text_(text), daemon_(daemon) {}

  void read(const toml::table& root) {
    for (const auto& [key, node] : root) {
      if (key == "daemon") {
        text_.names_daemon = true;
        if (daemon_ == DaemonSection::read) read_single(SectionKind::daemon, node);
      } else if (key == "http") {
        if (daemon_ == DaemonSection::read) read_single(SectionKind::http, node);
      } else if (key == "access") {
        read_list(SectionKind::access, node);
      } else if (key == "bus") {
        read_list(SectionKind::bus, node);
      } else if (key == "module") {
        read_list(SectionKind::module, node);
      } else if (key == "axis") {
        read_list(SectionKind::axis, node);
      } else if (key == "port") {
        read_list(SectionKind::port, node);
      } else {
        complain_unknown(key, node);
      }
    }
  }

 private:
  void complain(const Place& place, std::string message) {
    text_.problems.push_back(place.problem(std::move(message)));
  }

  void complain_unknown(const toml::key& key, const toml::node& node) {
    constexpr std::array<std::string_view, 7> known{"daemon", "http", "access", "bus",
                                                    "module", "axis", "port"};
    if (!node.is_table() && !node.is_array_of_tables()) {
      return complain(place_of(key.source()), quoted(key.str()) + " stands outside of any section");
    }
    complain(place_of(key.source()),
             "unknown section " + quoted(key.str()) + "." + tmcl::did_you_mean(key.str(), known));
  }

  void read_single(SectionKind kind, const toml::node& node) {
    if (const auto* table = node.as_table()) return read_section(kind, *table);
    complain(place_of(node.source()),
             "there is one such section, written " + std::string(title_of(kind)));
  }

  void read_list(SectionKind kind, const toml::node& node) {
    const auto* list = node.as_array();
    const bool tables = list != nullptr && std::ranges::all_of(*list, &toml::node::is_table);
    if (!tables) {
      return complain(place_of(node.source()),
                      "write a section of this kind as " + std::string(title_of(kind)) +
                          ", with two brackets, because there may be several");
    }
    for (const auto& entry : *list) read_section(kind, *entry.as_table());
  }

  void read_section(SectionKind kind, const toml::table& table) {
    ConfigSection section{kind, place_of(table.source()), {}};
    for (const auto& [key, node] : table) read_key(section, key, node);
    for (const auto& row : config_keys()) {
      if (row.section != kind || !row.required || table.contains(row.name)) continue;
      complain(section.place, std::string(title_of(kind)) + " needs the key " + quoted(row.name) +
                                  ": " + std::string(row.meaning));
    }
    text_.sections.push_back(std::move(section));
  }

  void read_key(ConfigSection& section, const toml::key& key, const toml::node& node) {
    const auto* row = find_key(section.kind, key.str());
    if (row == nullptr) return complain_unknown(section.kind, key);
    const auto place = place_of(node.source());
    auto value = convert(*row, node);
    if (!value) {
      return complain(place, quoted(row->name) + " must be " + std::string(name_of(row->type)));
    }
    if (const auto* number = std::get_if<std::int64_t>(&*value)) {
      if (*number < row->minimum || *number > row->maximum) {
        return complain(place, quoted(row->name) + " is " + std::to_string(*number) + ", outside " +
                                   std::to_string(row->minimum) + ".." +
                                   std::to_string(row->maximum));
      }
    }
    section.values.emplace(row->name, ConfigValue{std::move(*value), place});
  }

  void complain_unknown(SectionKind kind, const toml::key& key) {
    std::vector<std::string_view> known;
    for (const auto& row : config_keys()) {
      if (row.section == kind) known.push_back(row.name);
    }
    complain(place_of(key.source()), "unknown key " + quoted(key.str()) + " in " +
                                         std::string(title_of(kind)) + "." +
                                         tmcl::did_you_mean(key.str(), known));
  }

  static std::optional<decltype(ConfigValue::value)> convert(const KeyInfo& row,
                                                             const toml::node& node) {
    switch (row.type) {
      case KeyType::string:
        if (const auto* text = node.as_string()) return text->get();
        break;
      case KeyType::strings:
        if (const auto* list = node.as_array()) return to_texts(*list);
        break;
      case KeyType::integer:
        if (const auto* number = node.as_integer()) return number->get();
        break;
      case KeyType::number:
        if (const auto number = node.value<double>(); number && node.is_number()) return *number;
        break;
      case KeyType::boolean:
        if (const auto* flag = node.as_boolean()) return flag->get();
        break;
      case KeyType::range:
        if (const auto* list = node.as_array()) return to_range(*list);
        break;
    }
    return std::nullopt;
  }

  static std::optional<decltype(ConfigValue::value)> to_texts(const toml::array& list) {
    ConfigTexts texts;
    for (const auto& one : list) {
      const auto* text = one.as_string();
      if (text == nullptr) return std::nullopt;
      texts.push_back(text->get());
    }
    return texts;
  }

  static std::optional<decltype(ConfigValue::value)> to_range(const toml::array& list) {
    const bool two = list.size() == 2 && list[0].is_number() && list[1].is_number();
    if (!two) return std::nullopt;
    return ConfigRange{*list[0].value<double>(), *list[1].value<double>()};
  }

  ConfigText& text_;
  DaemonSection daemon_;
};

}  // namespace

ConfigText read_sections(std::string_view toml, DaemonSection daemon) {
  ConfigText text;
  // Debian's build of the library reports errors by throwing; this is where that ends.
  try {
    Reader(text, daemon).read(toml::parse(toml));
  } catch (const toml::parse_error& error) {
    text.is_toml = false;
    text.problems.push_back(place_of(error.source()).problem(std::string(error.description())));
  }
  return text;
}

}  // namespace tmcld
