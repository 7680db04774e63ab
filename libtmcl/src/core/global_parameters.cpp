#include "core/parameter_row.hpp"

namespace tmcl {
namespace {

using namespace row;

constexpr auto has_serial = except({1270, 1276, 1278, 1378});
constexpr auto has_can = except({1141, 1161, 1210, 1370});
// Only parameters that their lists have; of these models no list was at hand, and they get what old
// modules have.
constexpr auto unlisted = only({142, 146, 610});
constexpr auto reads_ascii = only({351, 1110, 1140, 1141, 1160, 1161, 1311, 3110, 6110}) | unlisted;
constexpr auto has_old_switches =
    only({1021, 1110, 1140, 1141, 1160, 1161, 1311, 3110, 6110}) | unlisted;
constexpr auto two_polarities = only({6110});
constexpr auto reverses =
    only({1021, 1110, 1140, 1141, 1160, 1161, 1370, 1378, 3110, 6110}) | unlisted;
// Their secondary address has another number.
constexpr auto renumbered = only({3216, 6214});

// Numbers from PyTrinamic's lists and from the vendor's ROS driver, ranges from the firmware
// manuals of the TMCM-6110 and TMCM-1021. Some modules have parameters of an interface that they do
// not have.
// clang-format off
constexpr auto global_bank0 = std::to_array<ParameterRow>({
    {{64, "eeprom_magic", {"", ""}, rw, true, 0, 255, 228, "",
      "anything but 228: factory defaults at the next start"}},
    {{65, "serial_baud_rate", {"rs485_baud_rate", ""}, rw, true, 0, 11, 0, "code",
      "0 9600, 1 14400, 2 19200, 3 28800, 4 38400, 5 57600, 6 76800, 7 115200, 8 230400, 9 250000, 10 500000, "
      "11 1000000 baud"}, has_serial},
    {{66, "serial_address", {"module_address", ""}, rw, true, 0, 255, 1, "",
      "address on serial lines"}, has_serial},
    {{67, "ascii_mode", {"", ""}, rw, true, 0, 255, 0, "bits",
      "1: starts in ASCII mode; 16 and 32: how it echoes"}, reads_ascii},
    {{68, "serial_heartbeat", {"serial_hearbeat", ""}, rw, true, 0, 65535, 0, "ms",
      "without a command for so long the motors stop; 0: never"}, has_serial},
    {{69, "can_bit_rate", {"", ""}, rw, true, 1, 8, 8, "code",
      "1 10k, 2 20k, 3 50k, 4 100k, 5 125k, 6 250k, 7 500k, 8 1M bit/s"}, has_can},
    {{70, "can_reply_id", {"can_send_id", ""}, rw, true, 0, 0x7FF, 2, "",
      "identifier of the module's replies"}, has_can},
    {{71, "can_id", {"can_receive_id", "can_module_id"}, rw, true, 0, 0x7FF, 1, "",
      "identifier the module listens to"}, has_can},
    // No document at hand has its range.
    {{72, "io_mode", {"", ""}, rw, true, 0, 255, 0, "",
      "what the inputs and outputs are used for"}, only({1378})},
    {{73, "eeprom_lock", {"configuration_eeprom_lock", ""}, rw, true, 0, 4321, 0, "",
      "write 1234 to lock the settings in the EEPROM, 4321 to unlock them; reads 1 while they are locked"}},
    // No document at hand has its range.
    {{74, "encoder_interface", {"external_encoder", ""}, rw, true, 0, 255, 0, "",
      "what the encoder's connector is used for"}, only({351}) | unlisted},
    {{75, "telegram_pause_time", {"", ""}, rw, true, 0, 255, 0, "ms",
      "wait before a reply on serial lines"}, has_serial | only({1378})},
    {{76, "serial_host_address", {"", ""}, rw, true, 0, 255, 2, "",
      "first byte of the module's serial replies"}, has_serial | only({1378})},
    {{77, "auto_start_mode", {"", ""}, rw, true, 0, 1, 0, "flag",
      "1: the stand-alone program starts with the module"}},
    {{78, "io_mode", {"", ""}, rw, true, 0, 255, 0, "bits",
      "what the inputs and outputs are used for"}, only({1110, 1211})},
    {{78, "io_mask", {"", ""}, rw, true, 0, 255, 0, "bits",
      "which inputs and outputs are used"}, only({1111, 1316})},
    {{79, "end_switch_polarity", {"limit_switch_polarity", ""}, rw, true, 0, 1, 0, "flag",
      "1: a switch is met when its input is low"}, has_old_switches & ~two_polarities},
    // From pyLabLib and filiplindau/trinamic_control, which look at the answer.
    {{79, "end_switch_polarity", {"limit_switch_polarity", ""}, rw, true, 0, 3, 0, "bits",
      "a switch is met when its input is low: 1 of motors 0 to 2, 2 of motors 3 to 5"}, two_polarities},
    {{80, "shutdown_pin_function", {"", ""}, rw, true, 0, 2, 0, "",
      "the shutdown input: 0 does nothing, 1 and 2 stops the motors when it is high or low"},
     only({351, 1378}) | unlisted},
    {{81, "code_protection", {"tmcl_code_protection", "protection_mode"}, rw, true, 0, 3, 0, "bits",
      "the stand-alone program: 1 cannot be read, 2 cannot be overwritten; clearing it erases the program"}},
    {{82, "can_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
      "without a command for so long the motors stop; 0: never"}, except({1141, 1161, 1370})},
    {{83, "can_secondary_address", {"", ""}, rw, true, 0, 0x7FF, 0, "",
      "second identifier it listens to; 0: none"}, except({1141, 1161, 1370})},
    {{84, "coordinate_storage", {"eeprom_coordinate_store", ""}, rw, true, 0, 1, 0, "flag",
      "1: coordinates go to the EEPROM, too"}},
    {{85, "zero_user_variables", {"do_not_restore_user_variables", ""}, rw, true, 0, 1, 0, "flag",
      "user variables start: 0 as they were stored, 1 with zeros"}},
    {{86, "step_pulse_length", {"", ""}, rw, true, 0, 255, 0, "",
      "length of the pulses to the driver"}, unlisted},
    {{86, "serial_secondary_address", {"", ""}, rw, true, 0, 255, 0, "",
      "second address it listens to; 0: none"}, renumbered},
    {{87, "serial_secondary_address", {"", ""}, rw, true, 0, 255, 0, "",
      "second address it listens to; 0: none"}, has_serial & ~renumbered & except({1210})},
    {{88, "interface_selection", {"", ""}, rw, true, 0, 255, 0, "",
      "which interface is used"}, only({1311})},
    {{90, "reverse_shaft", {"reverse_shaft_direction", ""}, rw, true, 0, 1, 0, "flag",
      "1: all motors turn the other way"}, reverses},
    {{128, "application_status", {"", ""}, r, false, 0, 3, 0, "",
      "the stand-alone program: 0 stopped, 1 runs, 2 single step, 3 reset"}},
    {{129, "download_mode", {"", ""}, r, false, 0, 1, 0, "flag",
      "1 while a program is loaded"}},
    {{130, "program_counter", {"", ""}, r, false, 0, x_greatest, 0, "",
      "address of the stand-alone program's next command"}},
    {{131, "tmcl_error", {"last_tmcl_error", ""}, r, false, 0, 255, 0, "",
      "why the stand-alone program stopped; 0: no error"}},
    {{132, "tick_timer", {"", ""}, rw, false, 0, x_greatest, 0, "ms",
      "time since the module started"}},
    {{133, "random_number", {"", ""}, r, false, 0, x_greatest, 0, "",
      "another one at each reading"}},
    {{255, "suppress_reply", {"", ""}, rw, false, 0, 1, 0, "flag",
      "1: no replies to commands that set something"}},
});
// clang-format on

static_assert(is_sound(global_bank0, every_model));

}  // namespace

std::span<const ParameterRow> global_rows() { return global_bank0; }

}  // namespace tmcl
