#include "motion/path/gcode_strays.hpp"

#include <string_view>

#include <fmt/format.h>

namespace tmcl::plan::path_file::gcode {
namespace {

Part<void> stray(const Block& block, char letter, std::string_view code) {
  return wrong(block.find(letter)->column, fmt::format("{} belongs to {}", letter, code));
}

}  // namespace

Part<void> find_stray(const Block& block, const Codes& codes, const Modes& modes) {
  if (modes.is_motion_hidden() && !codes.of(Group::motion)) return {};
  const bool arc = modes.make_arc(block, codes);
  const bool origins = codes.are(Group::once, 100);
  const bool dwells = codes.are(Group::once, 40);
  const bool corners = codes.are(Group::corners, 640);
  if (dwells && block.has_any("XYZABCIJKR"))
    return wrong(block.column_of("XYZABCIJKR"), "G4 has P, and nothing else");
  const int users = int{arc} + int{origins} + int{dwells} + int{corners};
  if (block.has('P') && users == 0)
    return wrong(block.find('P')->column, "P belongs to G2, G3, G4, G10 and G64");
  if (block.has('P') && users > 1)
    return wrong(block.find('P')->column, "it is not clear what P belongs to");
  if (!arc && block.has_any(origins ? centre_letters : arc_letters))
    return wrong(block.column_of(arc_letters), "I, J, K and R belong to G2 and G3");
  if (block.has('L') && !origins) return stray(block, 'L', "G10");
  if (block.has('Q') && !corners) return stray(block, 'Q', "G64");
  if (block.has('H') && !codes.are(Group::tool_length, 430)) return stray(block, 'H', "G43");
  return {};
}

}  // namespace tmcl::plan::path_file::gcode
