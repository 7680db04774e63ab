/// What a module says of itself when asked for its firmware version (command 136).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tmcl/datagram.hpp"

namespace tmcl {

enum class VersionForm : std::uint8_t {
  text = 0,
  binary = 1
};  ///< Values of the type field of command 136.

constexpr std::size_t version_text_size = 8;

struct FirmwareVersion {
  std::uint16_t model = 0;  ///< Module number, such as 1110 of a TMCM-1110.
  std::uint8_t major = 0;
  std::uint8_t minor = 0;  ///< 0..99
  /// It is the version of the module's bootloader, which answers while there is no firmware to run
  /// or while it is exchanged. Only the text says so.
  bool bootloader = false;
  auto operator<=>(const FirmwareVersion&) const = default;
};

/// The value of a reply to the binary form: model in the two high bytes, then major, then minor.
constexpr std::int32_t to_value(FirmwareVersion version) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(version.model) << 16U |
                                   static_cast<std::uint32_t>(version.major) << 8U | version.minor);
}

constexpr FirmwareVersion version_from_value(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return {static_cast<std::uint16_t>(bits >> 16U), static_cast<std::uint8_t>(bits >> 8U & 0xFFU),
          static_cast<std::uint8_t>(bits & 0xFFU)};
}

/// Eight characters such as "1110V101": four of the model, 'V' (or 'B' for a bootloader), one of
/// major, two of minor.
std::array<char, version_text_size> to_text(FirmwareVersion version);

/// Reads "1110V101" and "1110B101", and "142V1.06" as models with three digits may write it; or
/// "1110V10" as seven-byte CAN frames carry it (the last digit is then taken as 0). Nothing if the
/// text has another form.
std::optional<FirmwareVersion> version_from_text(std::string_view text);

/// "1.01"
std::string to_string(FirmwareVersion version);

}  // namespace tmcl
