/// The settings of a module: what it can keep in its EEPROM, and what can be given to another
/// module of its model without moving a motor or losing the module.
///
/// A setting is a parameter that can be written and kept, and that moves nothing by the table of
/// commands (tmcl/intent.hpp). States, positions, coordinates and user variables are none. Nor is
/// what belongs to one module alone: how it is reached, its heartbeats, the protection of its
/// program and of its EEPROM, and what takes its motor away from its host.
///
/// Does no I/O.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {

/// Where a setting belongs, in the order in which files have them.
enum class SettingScope : std::uint8_t {
  global,      ///< Bank 0 of the global parameters.
  interrupts,  ///< Bank 3: what stand-alone programs listen to.
  motor,
};

/// Which setting of a module.
struct SettingKey {
  SettingScope scope = SettingScope::motor;
  std::uint8_t motor = 0;  ///< 0 where it is of no motor.
  std::uint8_t number = 0;
  auto operator<=>(const SettingKey&) const = default;
};

/// "global", "interrupts", "motor.0": how a file calls where it stands.
std::string section_of(const SettingKey& key);
/// "max_velocity of motor 0", "end_switch_polarity": for messages.
std::string describe(const SettingKey& key, std::string_view name);

struct SettingInfo {
  SettingKey key;
  std::string name;
  std::int32_t minimum = 0;  ///< As the maximum, in the unit mode that a module starts with.
  std::int32_t maximum = 0;
  std::int32_t initial = 0;  ///< Factory default.
  std::string_view unit{};
  std::string_view meaning{};
  Scale scale = Scale::fixed;
};

/// All of a model, by their keys.
std::vector<SettingInfo> settings_of(const Model& model);
/// What a module can keep as well, and what is not given to another one.
std::vector<SettingInfo> kept_apart(const Model& model);
/// Null if there is none of that key; `infos` by their keys.
const SettingInfo* find_setting(const std::vector<SettingInfo>& infos, const SettingKey& key);

struct SettingValue {
  SettingKey key;
  std::int32_t value = 0;
  bool operator==(const SettingValue&) const = default;
};

std::vector<SettingKey> keys_of(const std::vector<SettingInfo>& infos);
std::vector<SettingKey> keys_of(const std::vector<SettingValue>& values);

/// Of a module, or a part of them.
struct Settings {
  const Model* model = nullptr;        ///< Never null where settings were read.
  std::string firmware{};              ///< "1.09"; empty if it is not known.
  std::vector<SettingValue> values{};  ///< By their keys.
  std::vector<SettingValue> apart{};   ///< The same, of what is told only.

  std::optional<std::int32_t> find(const SettingKey& key) const;
};

/// In which unit its value is, with what the unit mode of its motor says; empty for codes and
/// flags.
std::string_view unit_of(const SettingInfo& info, const Settings& settings);

/// As a file: TOML, a line for each setting in the order of its number, so that two files can be
/// compared line by line.
std::string to_toml(const Settings& settings);

struct SettingDifference {
  SettingKey key;
  std::optional<std::int32_t> present;  ///< Nothing: there is no such setting.
  std::int32_t wanted = 0;
  bool operator==(const SettingDifference&) const = default;
};

/// What loading `wanted` would change, by key. What only `present` has is left as it is.
std::vector<SettingDifference> what_to_load(const Settings& present, const Settings& wanted);

/// In the order in which they are to be set: first what others are counted in, last what watches
/// the motor by what was set before.
std::vector<SettingValue> in_loading_order(const Settings& settings);

/// Whether other values are counted in it: they read otherwise once it is set.
bool is_scale(const Model& model, const SettingKey& key);

}  // namespace tmcl
