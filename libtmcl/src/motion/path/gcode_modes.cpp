#include "motion/path/gcode_modes.hpp"

#include "motion/path/gcode_arc.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

std::array<std::size_t, 2> plane_of(int code) {
  if (code == 170) return {0, 1};
  return code == 180 ? std::array<std::size_t, 2>{2, 0} : std::array<std::size_t, 2>{1, 2};
}

}  // namespace

void Modes::take(const Codes& codes) {
  if (const auto plane = codes.of(Group::plane)) plane_ = plane_of(*plane);
  if (const auto unit = codes.of(Group::unit)) unit_ = *unit == 200 ? mm_of_an_inch : 1;
  if (const auto distance = codes.of(Group::distance)) absolute_ = *distance == 900;
  if (const auto centres = codes.of(Group::centres)) absolute_centres_ = *centres == 901;
  take_motion(codes);
}

void Modes::take_motion(const Codes& codes) {
  const auto motion = codes.of(Group::motion);
  if (motion || codes.of(Group::end_of_cycles) || codes.hide_motion()) {
    motion_.reset();
    motion_is_hidden_ = !motion && codes.hide_motion();
  }
  if (motion) motion_ = *motion / 10;
}

bool Modes::make_arc(const Block& block, const Codes& codes) const {
  return !codes.take_axes() && is_arc() &&
         (block.has_any(gcode_axes) || block.has_any(arc_letters));
}

}  // namespace tmcl::plan::path_file::gcode
