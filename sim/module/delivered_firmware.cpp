#include "sim/module/delivered_firmware.hpp"

#include <algorithm>
#include <array>

namespace tmcl::sim {
namespace {

// What the vendor's example firmware, TMCL-LITE, says on three of the four boards that it is for.
constexpr FirmwareRelease unknown{1, 1};

struct Row {
  std::uint16_t model;
  FirmwareRelease release;
};

// "Manual" is the TMCL firmware manual of the model; its title names the version.
constexpr auto rows = std::to_array<Row>({
    {142, unknown},   // none found: the manual has a version of its own only, V1.06
    {146, unknown},   // none found
    {351, {4, 45}},   // manual rev. 1.06, 2014
    {610, unknown},   // none found
    {1021, {1, 42}},  // manual rev. 1.10, 2018
    {1110, {1, 13}},  // manual
    {1111, unknown},  // TMCL-LITE-1111 says 1111V101; no manual found
    {1140, {1, 47}},  // manual
    {1141, {1, 19}},  // manual rev. 1.01, 2012
    {1160, {1, 42}},  // manual of the PD-1160, rev. 1.06, 2018
    {1161, {1, 46}},  // manual rev. 1.11
    {1210, unknown},  // none found
    {1211, {1, 10}},  // manual
    {1240, {1, 45}},  // manual rev. 1.02
    {1241, {1, 44}},  // manual of the PD42-1241, rev. 1.01, 2019
    {1260, {1, 44}},  // manual rev. 1.02, 2018
    {1270, {1, 13}},  // manual rev. 1.02, 2019
    {1276, {1, 13}},  // manual
    {1278, {1, 15}},  // manual rev. 1.01, 2019
    {1311, unknown},  // none found
    {1316, {1, 2}},   // TMCL-LITE-1316 says 1316V102; no manual found
    {1370, unknown},  // none found
    {1378, unknown},  // none found
    {3110, {1, 14}},  // manual
    {3216, unknown},  // none found
    {3312, unknown},  // none found
    {3351, unknown},  // none found
    {6110, {1, 46}},  // manual rev. 1.22, 2021
    {6212, unknown},  // none found
    {6214, {1, 17}},  // manual rev. 1.06, 2021
});
static_assert(std::ranges::is_sorted(rows, {}, &Row::model));

}  // namespace

FirmwareRelease delivered_firmware(const Model& model) {
  const auto* row = std::ranges::lower_bound(rows, model.number, {}, &Row::model);
  return row != rows.end() && row->model == model.number ? row->release : unknown;
}

}  // namespace tmcl::sim
