#include "core/parameter_row.hpp"

namespace tmcl {
namespace {

using namespace row;

// clang-format off
constexpr auto global_bank0 = std::to_array<ParameterRow>({
    {{64, "eeprom_magic", {"", ""}, rw, true, 0, 255, 228, "", "anything but 228: factory defaults at the next start"}},
    {{65, "serial_baud_rate", {"rs485_baud_rate", ""}, rw, true, 0, 11, 0, "code",
     "0 9600, 1 14400, 2 19200, 3 28800, 4 38400, 5 57600, 6 76800, 7 115200, 8 230400, 9 250000, 10 500000, "
     "11 1000000 baud"}},
    {{66, "serial_address", {"module_address", ""}, rw, true, 0, 255, 1, "", "address on serial lines"}},
    {{68, "serial_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
     "without a command for so long the motors stop; 0: never"}},
    {{69, "can_bit_rate", {"", ""}, rw, true, 1, 8, 8, "code",
     "1 10k, 2 20k, 3 50k, 4 100k, 5 125k, 6 250k, 7 500k, 8 1M bit/s"}},
    {{70, "can_reply_id", {"can_send_id", ""}, rw, true, 0, 0x7FF, 2, "", "identifier of the module's replies"}},
    {{71, "can_id", {"can_receive_id", ""}, rw, true, 0, 0x7FF, 1, "", "identifier the module listens to"}},
    {{73, "eeprom_lock", {"", ""}, rw, true, 0, 4321, 0, "",
     "1234 locks the configuration EEPROM, 4321 unlocks it; reads 1 while it is locked"}},
    {{75, "telegram_pause_time", {"", ""}, rw, true, 0, 255, 0, "ms", "wait before a reply on serial lines"}},
    {{76, "serial_host_address", {"", ""}, rw, true, 0, 255, 2, "", "first byte of the module's serial replies"}},
    {{82, "can_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
     "without a command for so long the motors stop; 0: never"}},
    {{83, "can_secondary_address", {"", ""}, rw, true, 0, 0x7FF, 0, "", "second identifier it listens to; 0: none"}},
    {{84, "coordinate_storage", {"eeprom_coordinate_store", ""}, rw, true, 0, 1, 0, "",
     "coordinates: 0 in RAM only, 1 in the EEPROM as well"}},
    {{85, "zero_user_variables", {"", ""}, rw, true, 0, 1, 0, "flag", "1: user variables are 0 after a start"}},
    {{87, "serial_secondary_address", {"", ""}, rw, true, 0, 255, 0, "", "second address it listens to; 0: none"}},
    {{132, "tick_timer", {"", ""}, rw, false, 0, INT32_MAX, 0, "ms", "time since the module started"}},
    {{133, "random_number", {"", ""}, r, false, 0, INT32_MAX, 0, "", "another one at each reading"}},
    {{255, "suppress_reply", {"", ""}, rw, false, 0, 1, 0, "flag", "1: no replies to commands that set something"}},
});
// clang-format on

static_assert(is_sound(global_bank0, every_model));

}  // namespace

std::span<const ParameterRow> global_rows() { return global_bank0; }

}  // namespace tmcl
