#include "tmcl/status_flags.hpp"

#include <array>

namespace tmcl {
namespace {

// Parameter 207 of most models; reading clears them.
constexpr auto extended_error_flags =
    std::to_array<StatusFlag>({{1, status_flag::stall}, {2, status_flag::deviation}});

// The same of the TMCM-351, by its manual (V4.45, p. 69); the next movement clears them.
constexpr auto movement_error_flags =
    std::to_array<StatusFlag>({{1, status_flag::deviation}, {2, status_flag::stall}});

// Parameter 208, as the drivers TMC260 to TMC262, TMC2130 and TMC5xxx have them. The load that
// stallGuard sees (1) and standstill (128) are no faults. Open coils can be told only of a motor
// that moves slowly.
constexpr auto driver_status_flags = std::to_array<StatusFlag>({{2, "overtemperature"},
                                                                {4, "overtemperature_warning"},
                                                                {8, "short_to_ground_a"},
                                                                {16, "short_to_ground_b"},
                                                                {32, "open_load_a"},
                                                                {64, "open_load_b"}});

// Parameter 18 of the TMCM-1311.
constexpr auto status_word = std::to_array<StatusFlag>({{512, "undervoltage"},
                                                        {1024, "overvoltage"},
                                                        {2048, "overtemperature"},
                                                        {8192, "i2t_exceeded"}});

}  // namespace

std::span<const StatusFlag> status_flags(std::string_view parameter) {
  if (parameter == "extended_error_flags") return extended_error_flags;
  if (parameter == "movement_error_flags") return movement_error_flags;
  if (parameter == "driver_status_flags") return driver_status_flags;
  if (parameter == "status_word") return status_word;
  return {};
}

}  // namespace tmcl
