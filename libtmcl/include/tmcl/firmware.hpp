/// Firmware images: the Intel HEX files in which they are shipped, and which module they are for.
///
/// A file has lines of hexadecimal digits, records, each with an address and a sum. What it says is
/// an image: bytes from a first address on, to be put into the flash memory of a module by its
/// bootloader (tmcl/firmware_verbs.hpp). Somewhere among them stands what the module will answer
/// when asked for its version, such as "1110V101": from that the vendor's tools tell for which
/// model an image is, and so do we.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/text_problem.hpp"
#include "tmcl/version.hpp"

namespace tmcl::firmware {

constexpr std::size_t most_file_bytes = 16'000'000;  ///< Of a HEX file.
/// From the first byte to the last. The largest modules have 1 MiB of flash memory.
constexpr std::size_t most_image_bytes = 4U << 20U;
constexpr std::size_t most_versions = 16;  ///< That versions_in() tells.
/// What erased flash memory holds, and what stands in the gaps of an image.
constexpr std::uint8_t erased_byte = 0xFF;

struct Image {
  std::uint32_t start = 0;          ///< Address of the first byte.
  std::vector<std::uint8_t> bytes;  ///< Without gaps; those of the file are filled.
};

/// Reads an Intel HEX file: data (record type 0), end of file (1), segment (2) and linear (4) base
/// addresses; start addresses (3, 5) are checked and mean nothing here. Lines may end in CR LF.
/// The first thing that is wrong ends it: also a byte that is given twice, a record that runs over
/// the end of its segment, data farther apart than most_image_bytes, and a missing end record, for
/// then the file was cut short.
tl::expected<Image, TextProblem> read_intel_hex(std::string_view text);

/// The sum of all bytes, as bootloaders compute it.
std::uint32_t checksum(const Image& image);

/// Every version that stands in the image, such as "1110V101" or, as older firmware writes it,
/// "142V1.06"; each once, in the order of the addresses.
std::vector<FirmwareVersion> versions_in(const Image& image);
/// The first of them that belongs to this model.
std::optional<FirmwareVersion> version_for(const Image& image, std::uint16_t model);

/// "0x08004000"
std::string address_text(std::uint32_t address);

}  // namespace tmcl::firmware
