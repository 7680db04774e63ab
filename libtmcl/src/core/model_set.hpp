/// The table of models, and sets of them: which models a parameter is on.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>

#include "tmcl/model.hpp"

namespace tmcl {

// Names, axes and interfaces from PyTrinamic and from those firmware manuals that were at hand:
// RS485 and CAN as the module's global parameters have it, USB and RS232 where a document names
// them. Ports from PyTrinamic's lists, those of the analogue inputs from the manuals of the
// TMCM-1021 and TMCM-3314 and from sister modules; other models may have more. The chips from
// manuals, or those that have all registers of the module's parameters.
// clang-format off
inline constexpr auto all_models = std::to_array<Model>({
    {142, "TMCM-142", 1, Family::tmc457, rs485 | can, {}, "TMC457"},
    {146, "PD-146", 1, Family::tmc457, rs485 | can, {}, "TMC457"},
    {351, "TMCM-351", 3, Family::tmc429, usb | rs232 | rs485 | can, {8, 0xFF, 8}, "TMC429, TMC249"},
    {610, "TMCM-610", 6, Family::tmc429, rs232 | rs485 | can, {8, 0xFF, 8}, "TMC428, TMC246"},
    {1021, "TMCM-1021", 1, Family::firmware, rs485, {4, 0x201, 2}, "TMC262"},
    {1110, "TMCM-1110", 1, Family::tmc429, usb | rs485 | can, {7, 0x11, 8}, "TMC429, TMC262"},
    {1111, "TMCM-1111", 1, Family::tmc4361, usb | rs485 | can, {7, 0x11, 8}, "TMC4361, TMC262"},
    {1140, "TMCM-1140", 1, Family::tmc429, usb | rs485 | can, {4, 0x01, 2}, "TMC429, TMC262"},
    {1141, "TMCM-1141", 1, Family::tmc429, usb | rs485, {4, 0x01, 2}, "TMC429, TMC262"},
    {1160, "TMCM-1160", 1, Family::tmc429, usb | rs485 | can, {2, 0x01, 2}, "TMC429, TMC262"},
    {1161, "TMCM-1161", 1, Family::tmc429, usb | rs485, {4, 0x01, 2}, "TMC429, TMC262"},
    {1210, "TMCM-1210", 1, Family::sixpoint, rs485, {1, 0x00, 0}, "TMC5160"},
    {1211, "TMCM-1211", 1, Family::sixpoint, rs485 | can, {7, 0x11, 8}, "TMC5160"},
    {1240, "TMCM-1240", 1, Family::sixpoint, rs485 | can, {2, 0x01, 2}, "TMC5160"},
    {1241, "TMCM-1241", 1, Family::sixpoint, rs485 | can, {2, 0x01, 2}, "TMC5160"},
    {1260, "TMCM-1260", 1, Family::sixpoint, rs485 | can, {2, 0x01, 2}, "TMC5160"},
    {1270, "TMCM-1270", 1, Family::sixpoint, can, {3, 0x00, 0}, "TMC5130"},
    {1276, "TMCM-1276", 1, Family::sixpoint, can, {3, 0x01, 0}, "TMC5130"},
    {1278, "TMCM-1278", 1, Family::sixpoint, can, {3, 0x01, 0}, "TMC5130"},
    {1311, "TMCM-1311", 1, Family::firmware, rs485 | can, {8, 0x11, 8}, "TMC262"},
    {1316, "TMCM-1316", 1, Family::tmc4361, rs485 | can, {7, 0x11, 8}, "TMC4361A, TMC2160"},
    {1370, "TMCM-1370", 1, Family::tmc4361, rs485, {2, 0x00, 1}, "TMC4361A, TMC262"},
    {1378, "TMCM-1378", 1, Family::tmc4361, can, {2, 0x00, 1}, "TMC4361A, TMC2160"},
    {3110, "TMCM-3110", 3, Family::tmc429, usb | rs485 | can, {8, 0x11, 8}, "TMC429, TMC262"},
    {3216, "TMCM-3216", 6, Family::sixpoint, rs485 | can, {6, 0x03, 4}, "TMC5240"},
    {3312, "TMCM-3312", 3, Family::tmc4361, rs485 | can, {4, 0x0F, 4}, "TMC4361A, TMC2130"},
    {3351, "TMCM-3351", 3, Family::tmc4361, rs485 | can, {8, 0x11, 8}, "TMC4361A, TMC2130"},
    {6110, "TMCM-6110", 6, Family::tmc429, usb | rs485 | can, {8, 0x111, 8}, "TMC429, TMC262"},
    {6212, "TMCM-6212", 6, Family::sixpoint, rs485 | can, {4, 0x01, 4}, "TMC5130"},
    {6214, "TMCM-6214", 6, Family::sixpoint, usb | rs232 | rs485 | can, {8, 0x11, 8}, "TMC5160"},
});
// clang-format on
static_assert(std::ranges::is_sorted(all_models, {}, &Model::number));

/// One bit for each model, in the order of the table.
using ModelSet = std::uint64_t;
static_assert(all_models.size() <= 64);

constexpr ModelSet set_of(std::size_t index) { return ModelSet{1} << index; }

inline constexpr ModelSet every_model = ~ModelSet{0};

consteval ModelSet only(std::initializer_list<std::uint16_t> numbers) {
  ModelSet set = 0;
  for (const auto number : numbers) {
    const auto* row = std::ranges::find(all_models, number, &Model::number);
    if (row == all_models.end()) throw std::logic_error("no such model");
    set |= set_of(static_cast<std::size_t>(row - all_models.begin()));
  }
  return set;
}

consteval ModelSet except(std::initializer_list<std::uint16_t> numbers) { return ~only(numbers); }

constexpr ModelSet models_of(Family family) {
  ModelSet set = 0;
  for (std::size_t i = 0; i < all_models.size(); ++i) {
    if (all_models[i].family == family) set |= set_of(i);
  }
  return set;
}

}  // namespace tmcl
