/// What a module says of itself when it is plugged in: the USB descriptors of both generations.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl::sim {

/// The controller on the module, after which the two are called. Both are CDC-ACM devices of full
/// speed, as in the vendor's open firmware TMCL-LITE-1110: lib_gd/src/usb/cdc_acm_core.c and
/// lib_mk/src/usb/usb_descriptor.c.
enum class UsbLayout : std::uint8_t {
  gd32,  ///< Newer modules. All have the same serial number.
  mk20,  ///< Older ones: packets of 16 bytes, no serial number.
};

struct UsbDescriptors {
  std::span<const std::uint8_t> device;
  std::span<const std::uint8_t> configuration;
  std::span<const std::string_view> strings;  ///< From index 1 on.
  std::uint8_t data_in;                       ///< Number of an endpoint, without its direction.
  std::uint8_t data_out;
  std::size_t packet_size;  ///< Of both, in bytes.
};

const UsbDescriptors& descriptors_of(UsbLayout layout);

/// Index 0 says which language the others are in. Empty if there is none of this index.
std::vector<std::uint8_t> string_descriptor(UsbLayout layout, std::uint8_t index);

}  // namespace tmcl::sim
