/// The settings of a ramp for other programs: --as sap, tmc, c or json.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmclctl::profile {

enum class ExportForm : std::uint8_t {
  sap,   ///< Lines of TMCL.
  tmc,   ///< A program of a module: the same, and its end.
  c,     ///< A table of the chip's registers.
  json,  ///< Parameters and registers.
};

/// One of the words of --as; an error names those there are.
tl::expected<ExportForm, std::string> export_form(std::string_view word);

struct RampExport {
  const tmcl::Model& model;
  std::uint8_t motor = 0;
  std::string title;  ///< What the ramp gives, in one line.
  std::vector<tmcl::plan::Setting> settings;
};

std::string text_of(const RampExport& ramp, ExportForm form);

/// What a chip holds at an address, of its first motor: the bits of `mask` are of the ramp, the
/// others stay as they are.
struct ChipWord {
  std::uint8_t address = 0;
  std::uint32_t mask = 0;
  std::uint32_t value = 0;
  std::string registers;  ///< Their names and values.
};
/// Ascending by address. Empty for a model whose firmware makes its ramps.
std::vector<ChipWord> chip_words(const RampExport& ramp);

}  // namespace tmclctl::profile
