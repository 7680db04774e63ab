/// What can be wrong with the driver of a motor, and with the cable to it.
#pragma once

#include <cstdint>

namespace tmcl::sim {

/// Bits as in parameter 208, and in the status word of a TMC26x.
enum class DriverFault : std::uint8_t {
  overtemperature = 1 << 1,
  overtemperature_warning = 1 << 2,
  short_a = 1 << 3,
  short_b = 1 << 4,
  open_load_a = 1 << 5,
  open_load_b = 1 << 6,
};

/// A set of them.
class DriverFaults {
 public:
  bool has(DriverFault fault) const { return (bits_ & static_cast<unsigned>(fault)) != 0; }
  void set(DriverFault fault, bool on) {
    const auto bit = static_cast<unsigned>(fault);
    bits_ = on ? bits_ | bit : bits_ & ~bit;
  }
  std::int32_t bits() const { return static_cast<std::int32_t>(bits_); }

 private:
  unsigned bits_ = 0;
};

}  // namespace tmcl::sim
