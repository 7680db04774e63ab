/// Axis and global parameters: what each number means on which family of modules.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "tmcl/model.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

enum class Access : std::uint8_t { read, read_write };

/// Whether axis parameter 255, the unit mode, says what a value is counted in. Modules of these
/// families that have no such parameter count in microsteps and seconds.
enum class Scale : std::uint8_t {
  fixed,         ///< It does not.
  velocity,      ///< The chip's units, or microsteps per second.
  acceleration,  ///< The chip's units, or microsteps per second squared.
};

struct ParameterInfo {
  std::uint8_t number;
  std::string_view name;  ///< Standard name, snake_case; part of the stable interface.
  std::array<std::string_view, 2>
      aliases;  ///< Other names in use, the chip's register among them; may be empty.
  Access access;
  bool stored;           ///< Can be kept in the EEPROM.
  std::int32_t minimum;  ///< As the maximum, in the unit mode that a module starts with.
  std::int32_t maximum;
  std::int32_t initial;  ///< Factory default; 0 where it is a reading.
  std::string_view unit;
  std::string_view meaning;
  std::string_view chip_register = {};  ///< Where its value ends up; empty if in no one register.
  Scale scale = Scale::fixed;
  bool operator==(const ParameterInfo&) const = default;
};

/// Numbers the library itself uses. The same on every family of modules.
namespace axis_parameter {
constexpr std::uint8_t target_position = 0;
constexpr std::uint8_t actual_position = 1;
constexpr std::uint8_t target_velocity = 2;
constexpr std::uint8_t actual_velocity = 3;
constexpr std::uint8_t max_velocity = 4;
constexpr std::uint8_t max_acceleration = 5;
constexpr std::uint8_t position_reached = 8;
constexpr std::uint8_t microstep_resolution = 140;
constexpr std::uint8_t unit_mode = 255;
}  // namespace axis_parameter

namespace global_parameter {
constexpr std::uint8_t eeprom_magic = 64;
constexpr std::uint8_t serial_baud_rate = 65;
constexpr std::uint8_t serial_address = 66;
constexpr std::uint8_t ascii_mode = 67;
constexpr std::uint8_t serial_heartbeat = 68;
constexpr std::uint8_t can_bit_rate = 69;
constexpr std::uint8_t can_reply_id = 70;
constexpr std::uint8_t can_id = 71;
constexpr std::uint8_t eeprom_lock = 73;
constexpr std::uint8_t telegram_pause_time = 75;
constexpr std::uint8_t serial_host_address = 76;
constexpr std::uint8_t auto_start_mode = 77;
constexpr std::uint8_t end_switch_polarity = 79;
constexpr std::uint8_t shutdown_pin_function = 80;
constexpr std::uint8_t code_protection = 81;
constexpr std::uint8_t can_heartbeat = 82;
constexpr std::uint8_t can_secondary_address = 83;
constexpr std::uint8_t coordinate_storage = 84;
constexpr std::uint8_t zero_user_variables = 85;
constexpr std::uint8_t serial_secondary_address = 87;  ///< 86 on some models.
constexpr std::uint8_t reverse_shaft = 90;
constexpr std::uint8_t application_status = 128;
constexpr std::uint8_t download_mode = 129;
constexpr std::uint8_t program_counter = 130;
constexpr std::uint8_t tmcl_error = 131;
constexpr std::uint8_t tick_timer = 132;
constexpr std::uint8_t random_number = 133;
constexpr std::uint8_t suppress_reply = 255;
}  // namespace global_parameter

/// The axis parameters of a model, ascending by number. Empty for a model that is not one of
/// models().
std::span<const ParameterInfo> axis_parameters(const Model& model);
/// The global parameters of bank 0, by the same rule.
std::span<const ParameterInfo> global_parameters(const Model& model);

/// Bank 0 of the global parameters belongs to the module, bank 2 are the user variables of
/// stand-alone programs, and bank 3 says what their interrupts listen to. Bank 1 is for special
/// firmware, and empty.
namespace global_bank {
constexpr std::uint8_t parameters = 0;
constexpr std::uint8_t user_variables = 2;
constexpr std::uint8_t interrupts = 3;
}  // namespace global_bank

/// How many of the user variables can be kept in the EEPROM, beginning with 0.
constexpr std::uint8_t kept_user_variables = 56;

/// What a global parameter of any bank takes.
struct GlobalRange {
  Access access;
  bool stored;  ///< Can be kept in the EEPROM.
  std::int32_t minimum;
  std::int32_t maximum;
  std::int32_t initial;  ///< Factory default.
  bool operator==(const GlobalRange&) const = default;
};
/// Nothing for a bank or a number that the model does not have. In bank 3, 0 to 2 are the periods
/// of the timers in ms; from 27 the stop switches, left and right of each motor in turn, and from
/// 39 the inputs: the edge that counts, 0 none, 1 rising, 2 falling, 3 both.
std::optional<GlobalRange> global_range(const Model& model, std::uint8_t bank, std::uint8_t number);

/// Null if the table has no such number or name. Names compare without regard to case, '_' and '-',
/// so that "MaxVelocity", "max_velocity" and "max-velocity" are one.
const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::uint8_t number);
const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::string_view name);

}  // namespace tmcl
