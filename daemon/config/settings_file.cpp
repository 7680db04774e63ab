#include "config/settings_file.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "config/module_keys.hpp"
#include "config/toml_reading.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using tmcl::SettingInfo;
using tmcl::SettingKey;

class SettingsReader {
 public:
  explicit SettingsReader(tmcl::TextProblems& problems) : problems_(problems) {}

  tmcl::Settings read(const toml::table& file) {
    if (!file.contains("model"))
      throw Wrong{file.source().begin, "there is no 'model': whose settings are these?"};
    settings_.model = &model_of(file);
    infos_ = settings_of(*settings_.model);
    for (const auto& [key, node] : file) read_key(key, node);
    std::ranges::sort(settings_.values, {}, &tmcl::SettingValue::key);
    return std::move(settings_);
  }

 private:
  void complain(toml::source_position where, std::string sentence, std::string_view word) {
    problems_.push_back({where.line, where.column, std::move(sentence), std::string(word)});
  }
  void complain_unknown(const toml::key& key, std::string_view what,
                        const std::vector<std::string_view>& known) {
    complain(key.source().begin,
             "there is no " + std::string(what) + " " + quoted(key.str()) + "." +
                 tmcl::did_you_mean(key.str(), known),
             key.str());
  }

  void read_key(const toml::key& key, const toml::node& node) {
    if (key == "model") return;
    if (key == "firmware") {
      if (const auto* text = node.as_string()) {
        settings_.firmware = text->get();
      } else {
        complain(node.source().begin, "'firmware' must be a text in quotes, such as \"1.09\"",
                 key.str());
      }
      return;
    }
    const auto* table = node.as_table();
    if (table != nullptr && key == "global")
      return read_section({tmcl::SettingScope::global}, *table);
    if (table != nullptr && key == "interrupts")
      return read_section({tmcl::SettingScope::interrupts}, *table);
    if (table != nullptr && key == "motor") return read_motors(*table);
    complain_unknown(key, table != nullptr ? "section" : "key",
                     {"model", "firmware", "global", "interrupts", "motor"});
  }

  void read_motors(const toml::table& motors) {
    for (const auto& [key, node] : motors) {
      std::uint8_t motor = 0;
      while (motor < settings_.model->axes && key != std::to_string(motor)) ++motor;
      const auto* table = node.as_table();
      if (table == nullptr || motor == settings_.model->axes) {
        complain(key.source().begin,
                 "a " + std::string(settings_.model->name) + " has no [motor." +
                     std::string(key.str()) + "]: its motors are 0 to " +
                     std::to_string(settings_.model->axes - 1),
                 key.str());
        continue;
      }
      read_section({tmcl::SettingScope::motor, motor}, *table);
    }
  }

  void read_section(SettingKey section, const toml::table& table) {
    std::vector<const SettingInfo*> infos;
    for (const auto& info : infos_)
      if (info.key.scope == section.scope && info.key.motor == section.motor)
        infos.push_back(&info);
    for (const auto& [key, node] : table) {
      const auto found = std::ranges::find(infos, key.str(), &SettingInfo::name);
      if (found == infos.end()) {
        refuse(section, key, infos);
      } else {
        read_value(**found, key, node);
      }
    }
  }

  /// A name that is there, and is no setting, is told as that.
  void refuse(SettingKey section, const toml::key& key,
              const std::vector<const SettingInfo*>& infos) {
    const auto rows = section.scope == tmcl::SettingScope::motor
                          ? axis_parameters(*settings_.model)
                          : global_parameters(*settings_.model);
    const auto* row =
        section.scope == tmcl::SettingScope::interrupts ? nullptr : find_parameter(rows, key.str());
    const auto setting =
        row == nullptr ? infos.end() : std::ranges::find(infos, row->name, &SettingInfo::name);
    if (row != nullptr && setting == infos.end())
      return complain(key.source().begin,
                      quoted(key.str()) +
                          " is no setting that is loaded: it is a state, moves the motor, "
                          "belongs to the one module, or sets others that are; leave the line out",
                      key.str());
    std::vector<std::string_view> names;
    for (const auto* info : infos) names.emplace_back(info->name);
    if (row != nullptr)
      return complain(key.source().begin,
                      quoted(key.str()) + " is called " + quoted(row->name) + " in such a file",
                      key.str());
    complain_unknown(key, "setting", names);
  }

  void read_value(const SettingInfo& info, const toml::key& key, const toml::node& node) {
    // Where the range depends on the unit mode, the module is left to judge.
    const bool is_fixed = info.scale == tmcl::Scale::fixed;
    const std::int64_t least = is_fixed ? info.minimum : std::numeric_limits<std::int32_t>::min();
    const std::int64_t most = is_fixed ? info.maximum : std::numeric_limits<std::int32_t>::max();
    const auto* number = node.as_integer();
    if (number == nullptr)
      return complain(node.source().begin, quoted(key.str()) + " must be a whole number",
                      key.str());
    if (number->get() < least || number->get() > most)
      return complain(node.source().begin,
                      quoted(key.str()) + " is " + std::to_string(number->get()) +
                          ", outside its range " + std::to_string(least) + ".." +
                          std::to_string(most),
                      key.str());
    settings_.values.push_back({info.key, static_cast<std::int32_t>(number->get())});
  }

  tmcl::TextProblems& problems_;
  tmcl::Settings settings_;
  std::vector<SettingInfo> infos_;
};

}  // namespace

tl::expected<tmcl::Settings, tmcl::TextProblems> parse_settings(std::string_view text) {
  tmcl::TextProblems problems;
  if (text.size() > max_settings_bytes) {
    problems.push_back(
        {0, 0, "it is longer than " + std::to_string(max_settings_bytes) + " bytes"});
    return tl::unexpected(std::move(problems));
  }
  try {
    auto settings = SettingsReader(problems).read(toml::parse(text));
    if (problems.empty()) return settings;
  } catch (const toml::parse_error& error) {
    const auto where = error.source().begin;
    problems.push_back({where.line, where.column, std::string(error.description())});
  } catch (const Wrong& wrong) {
    problems.push_back({wrong.where.line, wrong.where.column, wrong.sentence});
  }
  std::ranges::stable_sort(problems, {}, &tmcl::TextProblem::line);
  return tl::unexpected(std::move(problems));
}

tl::expected<tmcl::Settings, tmcl::TextProblems> read_settings_file(const std::string& path) {
  const auto text = text_of_file(path);
  if (!text) return tl::unexpected(tmcl::TextProblems{{0, 0, "it cannot be read, or is empty"}});
  return parse_settings(*text);
}

}  // namespace tmcld
