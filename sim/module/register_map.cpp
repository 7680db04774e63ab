#include "sim/module/register_map.hpp"

#include <array>

namespace tmcl::sim {

// Addresses from the vendor's register headers, bits from the data sheets.
RegisterMap<ramp::Tmc429> register_map(const ramp::Tmc429& /*chip*/) {
  using R = ramp::Tmc429::Register;
  static constexpr std::array<RegisterField<ramp::Tmc429>, 16> fields{{
      {0x00, 0, 24, R::x_target},
      {0x02, 0, 24, R::x_actual},
      {0x04, 0, 11, R::v_min},
      {0x06, 0, 11, R::v_max},
      {0x08, 0, 12, R::v_target},
      {0x0A, 0, 12, R::v_actual},
      {0x0C, 0, 11, R::a_max},
      {0x12, 8, 7, R::pmul},
      {0x12, 0, 4, R::pdiv},
      {0x14, 8, 1, R::disable_stop_l},
      {0x14, 9, 1, R::disable_stop_r},
      {0x14, 10, 1, R::soft_stop},
      {0x14, 11, 1, R::ref_rnl},
      {0x14, 0, 2, R::mode},
      {0x18, 12, 4, R::pulse_div},
      {0x18, 8, 4, R::ramp_div},
  }};
  return {0xFF'FFFF, fields};
}

RegisterMap<ramp::Tmc457> register_map(const ramp::Tmc457& /*chip*/) {
  using R = ramp::Tmc457::Register;
  static constexpr std::array<RegisterField<ramp::Tmc457>, 10> fields{{
      {0x00, 0, 2, R::mode},
      {0x01, 0, 32, R::x_actual},
      {0x03, 0, 32, R::v_max},
      {0x04, 0, 32, R::v_target},
      {0x05, 0, 24, R::a_max},
      {0x06, 0, 24, R::d_max},
      {0x07, 0, 24, R::d_stop},
      {0x08, 0, 5, R::bow_max},
      {0x09, 0, 32, R::x_target},
      {0x0F, 0, 24, R::a_max_d_max},
  }};
  return {0xFFFF'FFFF, fields};
}

RegisterMap<ramp::SixPoint> register_map(const ramp::SixPoint& /*chip*/) {
  using R = ramp::SixPoint::Register;
  static constexpr std::array<RegisterField<ramp::SixPoint>, 13> fields{{
      {0x20, 0, 2, R::rampmode},
      {0x21, 0, 32, R::xactual},
      {0x23, 0, 18, R::vstart},
      {0x24, 0, 16, R::a1},
      {0x25, 0, 20, R::v1},
      {0x26, 0, 16, R::amax},
      {0x27, 0, 23, R::vmax},
      {0x28, 0, 16, R::dmax},
      {0x2A, 0, 16, R::d1},
      {0x2B, 0, 18, R::vstop},
      {0x2C, 0, 16, R::tzerowait},
      {0x2D, 0, 32, R::xtarget},
      {0x34, 0, 12, R::sw_mode},
  }};
  return {0xFFFF'FFFF, fields};
}

RegisterMap<ramp::Tmc4361> register_map(const ramp::Tmc4361& /*chip*/) { return {0xFFFF'FFFF, {}}; }

}  // namespace tmcl::sim
