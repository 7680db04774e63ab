#include "sim/wire/usb_layout.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t string_type = 3;
constexpr std::array<std::uint8_t, 4> english{4, string_type, 0x09, 0x04};

// clang-format off
namespace gd32 {

constexpr std::array<std::uint8_t, 18> device{
    18, 1, 0x00, 0x02,           // device, USB 2.0
    2, 0, 0, 64,                 // communication device; packets of endpoint 0
    0x3C, 0x2A, 0x00, 0x01,      // vendor 2A3C, product 0100
    0x00, 0x01, 1, 2, 3, 1};     // version 1.00; strings; configurations

constexpr std::array<std::uint8_t, 67> configuration{
    9, 2, 67, 0, 2, 1, 0, 0x80, 50,   // configuration: two interfaces, 100 mA from the bus
    9, 4, 0, 0, 1, 2, 2, 1, 0,        // interface 0: abstract control model, AT commands
    5, 0x24, 0, 0x10, 0x01,           // header: CDC 1.10
    5, 0x24, 1, 0, 1,                 // call management: none, data interface 1
    4, 0x24, 2, 2,                    // line coding and control lines
    5, 0x24, 6, 0, 1,                 // union of interfaces 0 and 1
    7, 5, 0x82, 3, 8, 0, 10,          // interrupt in, every 10 ms
    9, 4, 1, 0, 2, 0x0A, 0, 0, 0,     // interface 1: data
    7, 5, 0x03, 2, 64, 0, 0,          // bulk out
    7, 5, 0x81, 2, 64, 0, 0};         // bulk in

constexpr std::array<std::string_view, 3> strings{"Trinamic Motion Control", "Stepper Device",
                                                  "TMCSTEP"};

}  // namespace gd32

namespace mk20 {

constexpr std::array<std::uint8_t, 18> device{
    18, 1, 0x00, 0x02,
    2, 0, 0, 16,
    0x3C, 0x2A, 0x00, 0x01,
    0x02, 0x00, 1, 2, 0, 1};          // version 0.02; no serial number

constexpr std::array<std::uint8_t, 67> configuration{
    9, 2, 67, 0, 2, 1, 0, 0xC0, 50,   // has a supply of its own
    9, 4, 0, 0, 1, 2, 2, 0, 0,        // interface 0: no protocol
    5, 0x24, 0, 0x10, 0x01,
    5, 0x24, 1, 1, 1,                 // manages calls itself
    4, 0x24, 2, 6,                    // and sends breaks
    5, 0x24, 6, 0, 1,
    7, 5, 0x83, 3, 16, 0, 10,
    9, 4, 1, 0, 2, 0x0A, 0, 0, 0,
    7, 5, 0x81, 2, 16, 0, 0,          // bulk in
    7, 5, 0x02, 2, 16, 0, 0};         // bulk out

constexpr std::array<std::string_view, 2> strings{"TRINAMIC Motion Control     ",
                                                  "Stepper Motor Dev "};

}  // namespace mk20
// clang-format on

constexpr UsbDescriptors of_gd32{gd32::device, gd32::configuration, gd32::strings, 1, 3, 64};
constexpr UsbDescriptors of_mk20{mk20::device, mk20::configuration, mk20::strings, 1, 2, 16};

}  // namespace

const UsbDescriptors& descriptors_of(UsbLayout layout) {
  return layout == UsbLayout::gd32 ? of_gd32 : of_mk20;
}

std::vector<std::uint8_t> string_descriptor(UsbLayout layout, std::uint8_t index) {
  if (index == 0) return {english.begin(), english.end()};
  const auto strings = descriptors_of(layout).strings;
  if (index > strings.size()) return {};
  const auto text = strings[index - 1];
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), string_type};
  for (const char letter : text) {
    bytes.push_back(static_cast<std::uint8_t>(letter));
    bytes.push_back(0);
  }
  return bytes;
}

}  // namespace tmcl::sim
