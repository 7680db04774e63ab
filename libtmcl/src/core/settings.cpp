#include "tmcl/settings.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tmcl/command.hpp"

namespace tmcl {
namespace {

// ---- which parameters are settings --------------------------------------------------------------

/// By which name a parameter is kept apart on every model that has it.
constexpr auto of_one_module = std::to_array<std::string_view>({
    // How the module is reached, and whether it is.
    "eeprom_magic",
    "serial_baud_rate",
    "serial_address",
    "ascii_mode",
    "can_bit_rate",
    "can_reply_id",
    "can_id",
    "telegram_pause_time",
    "serial_host_address",
    "can_secondary_address",
    "serial_secondary_address",
    "interface_selection",
    // The gateway has its own say in these.
    "serial_heartbeat",
    "can_heartbeat",
    // Of the EEPROM and of the stand-alone program, which may move motors once it starts.
    "eeprom_lock",
    "code_protection",
    "auto_start_mode",
    // Pulses at its inputs move the motor.
    "step_direction_mode",
    // A count of what has happened.
    "iit_exceed_counter",
});

bool is_of_one_module(std::string_view name) {
  return std::ranges::find(of_one_module, name) != of_one_module.end();
}

bool is_kept(const ParameterInfo& row) { return row.access == Access::read_write && row.stored; }

/// On a TMC457 it sets acceleration and max_deceleration, which are settings.
bool sets_others(const Model& model, const ParameterInfo& row) {
  return model.family == Family::tmc457 && row.number == axis_parameter::max_acceleration;
}

/// Setting it moves nothing, whatever the value.
bool moves_nothing(std::uint8_t parameter) {
  return effect_of(Command::SAP, parameter) == Effect::writes;
}

enum class Which : std::uint8_t { settings, kept_apart };

bool is_chosen(const ParameterInfo& row, bool moves_nothing, Which which) {
  const bool is_setting = moves_nothing && !is_of_one_module(row.name);
  return is_kept(row) && is_setting == (which == Which::settings);
}

SettingInfo to_info(const ParameterInfo& row, SettingScope scope, std::uint8_t motor = 0) {
  return {{scope, motor, row.number},
          std::string(row.name),
          row.minimum,
          row.maximum,
          row.initial,
          row.unit,
          row.meaning,
          row.scale};
}

/// Bank 3 has no names of its own.
struct InterruptNames {
  std::uint8_t first;
  std::uint8_t count;
  std::array<std::string_view, 2> names;  ///< In turn; the second may be empty.
  std::string_view unit;
  std::string_view meaning;
};
constexpr auto interrupt_names = std::to_array<InterruptNames>({
    {0, 3, {"timer_", ""}, "ms", "period of the timer"},
    {27,
     12,
     {"left_stop_", "right_stop_"},
     "",
     "edge of the stop switch that interrupts: 0 none, 1 rising, 2 falling, 3 both"},
    {39, 8, {"input_", ""}, "", "edge of the input that interrupts: as of a stop switch"},
});

void add_interrupts(const Model& model, std::vector<SettingInfo>& infos) {
  for (const auto& [first, count, names, unit, meaning] : interrupt_names) {
    const std::size_t in_turn = names[1].empty() ? 1 : 2;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = static_cast<std::uint8_t>(first + i);
      const auto range = global_range(model, global_bank::interrupts, number);
      if (!range || !range->stored) continue;
      infos.push_back({{SettingScope::interrupts, 0, number},
                       std::string(names.at(i % in_turn)) + std::to_string(i / in_turn),
                       range->minimum,
                       range->maximum,
                       range->initial,
                       unit,
                       meaning});
    }
  }
}

std::vector<SettingInfo> choose(const Model& model, Which which) {
  std::vector<SettingInfo> infos;
  for (const auto& row : global_parameters(model))
    if (is_chosen(row, true, which)) infos.push_back(to_info(row, SettingScope::global));
  if (which == Which::settings) add_interrupts(model, infos);
  for (std::uint8_t motor = 0; motor < model.axes; ++motor)
    for (const auto& row : axis_parameters(model))
      if (!sets_others(model, row) && is_chosen(row, moves_nothing(row.number), which))
        infos.push_back(to_info(row, SettingScope::motor, motor));
  return infos;
}

}  // namespace

std::vector<SettingInfo> settings_of(const Model& model) { return choose(model, Which::settings); }

std::vector<SettingInfo> kept_apart(const Model& model) { return choose(model, Which::kept_apart); }

const SettingInfo* find_setting(const std::vector<SettingInfo>& infos, const SettingKey& key) {
  const auto found = std::ranges::lower_bound(infos, key, {}, &SettingInfo::key);
  return found != infos.end() && found->key == key ? &*found : nullptr;
}

std::vector<SettingKey> keys_of(const std::vector<SettingInfo>& infos) {
  std::vector<SettingKey> keys;
  for (const auto& info : infos) keys.push_back(info.key);
  return keys;
}

std::vector<SettingKey> keys_of(const std::vector<SettingValue>& values) {
  std::vector<SettingKey> keys;
  for (const auto& value : values) keys.push_back(value.key);
  return keys;
}

std::string section_of(const SettingKey& key) {
  switch (key.scope) {
    case SettingScope::global: return "global";
    case SettingScope::interrupts: return "interrupts";
    case SettingScope::motor: break;
  }
  return "motor." + std::to_string(key.motor);
}

std::string describe(const SettingKey& key, std::string_view name) {
  auto text = std::string(name);
  if (key.scope == SettingScope::motor) text += " of motor " + std::to_string(key.motor);
  return text;
}

std::optional<std::int32_t> Settings::find(const SettingKey& key) const {
  const auto found = std::ranges::lower_bound(values, key, {}, &SettingValue::key);
  if (found == values.end() || found->key != key) return std::nullopt;
  return found->value;
}

// ---- as text ------------------------------------------------------------------------------------

std::string_view unit_of(const SettingInfo& info, const Settings& settings) {
  if (info.scale != Scale::fixed) {
    const auto mode = settings.find({info.key.scope, info.key.motor, axis_parameter::unit_mode});
    if (mode == 0) return "internal";
    if (mode == 1) return info.scale == Scale::velocity ? "pps" : "pps/s";
  }
  const bool says_nothing = info.unit == "flag" || info.unit == "code" || info.unit == "bits";
  return says_nothing ? std::string_view{} : info.unit;
}

namespace {

/// Where comments begin: the same for all, so that a longer value changes its own line alone.
constexpr std::size_t comment_column = 44;

std::string line_of(std::string text, std::string_view comment) {
  if (!comment.empty()) {
    text.resize(std::max(text.size() + 1, comment_column), ' ');
    text.append("# ").append(comment);
  }
  return text + '\n';
}

std::string assignment(const SettingInfo& info, std::int32_t value) {
  return info.name + " = " + std::to_string(value);
}

void add_apart(const Settings& settings, std::string& text) {
  if (settings.apart.empty()) return;
  const auto infos = kept_apart(*settings.model);
  text += "\n# Of the module alone, and never loaded:\n";
  for (const auto& [key, value] : settings.apart)
    if (const auto* info = find_setting(infos, key))
      text += "# " + section_of(key) + ": " + assignment(*info, value) + '\n';
}

}  // namespace

std::string to_toml(const Settings& settings) {
  std::string text = "# Settings of a module: tmclctl settings load FILE MODULE\n";
  text += "model = \"" + std::string(settings.model->name) + "\"\n";
  if (!settings.firmware.empty()) text += "firmware = \"" + settings.firmware + "\"\n";
  const auto infos = settings_of(*settings.model);
  std::string section;
  for (const auto& [key, value] : settings.values) {
    const auto* info = find_setting(infos, key);
    if (info == nullptr) continue;
    if (const auto its = section_of(key); its != section) text += "\n[" + (section = its) + "]\n";
    text += line_of(assignment(*info, value), unit_of(*info, settings));
  }
  add_apart(settings, text);
  return text;
}

// ---- two of them --------------------------------------------------------------------------------

std::vector<SettingDifference> what_to_load(const Settings& present, const Settings& wanted) {
  std::vector<SettingDifference> all;
  for (const auto& [key, value] : wanted.values) {
    const auto is = present.find(key);
    if (is != value) all.push_back({key, is, value});
  }
  return all;
}

namespace {

/// Velocities, accelerations and positions are counted in these.
constexpr auto scales = std::to_array<std::string_view>({
    "unit_mode",
    "microstep_resolution",
    "pulse_divisor",
    "ramp_divisor",
    "acceleration_divisor",
    "full_step_resolution",
    "bow_scaling_factor",
});
/// These stop the motor by what others say.
constexpr auto watchers = std::to_array<std::string_view>({
    "max_encoder_deviation",
    "external_encoder_max_deviation",
    "max_velocity_encoder_deviation",
    "virtual_stop_enable",
    "stop_on_error_mode",
    "deviation_action",
});

enum class Rank : std::uint8_t { scale, other, watcher };

Rank rank_of(std::string_view name) {
  if (std::ranges::find(scales, name) != scales.end()) return Rank::scale;
  if (std::ranges::find(watchers, name) != watchers.end()) return Rank::watcher;
  return Rank::other;
}

Rank rank_of(const Model& model, const SettingKey& key) {
  if (key.scope != SettingScope::motor) return Rank::other;
  const auto* row = find_parameter(axis_parameters(model), key.number);
  return row == nullptr ? Rank::other : rank_of(row->name);
}

}  // namespace

bool is_scale(const Model& model, const SettingKey& key) {
  return rank_of(model, key) == Rank::scale;
}

std::vector<SettingValue> in_loading_order(const Settings& settings) {
  auto values = settings.values;
  std::ranges::stable_sort(
      values, {}, [&](const SettingValue& value) { return rank_of(*settings.model, value.key); });
  return values;
}

}  // namespace tmcl
