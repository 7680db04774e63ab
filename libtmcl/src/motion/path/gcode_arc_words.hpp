/// An arc of G-code, by its words.
#pragma once

#include <cstddef>

#include "motion/path/gcode_arc.hpp"
#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_feeds.hpp"
#include "motion/path/gcode_modes.hpp"
#include "motion/path/gcode_origins.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {

/// Of a line that G2 or G3 takes.
class ArcWords {
 public:
  ArcWords(const Block& block, const Modes& modes, const Origins& origins)
      : block_(block), modes_(modes), origins_(origins) {}

  /// In mm and degrees. Of which line of the file it is, is not said.
  Part<ArcTo> arc(const Point& from, const Point& target, const Feeds& feeds) const;

 private:
  Part<double> turns() const;
  Part<PlaneArc::Round> round_of(const PlaneArc& arc) const;
  Part<PlaneArc::Round> around_centre(const PlaneArc& arc) const;
  std::size_t column() const { return block_.column_of("IJKRXYZ"); }

  const Block& block_;
  const Modes& modes_;
  const Origins& origins_;
};

}  // namespace tmcl::plan::path_file::gcode
