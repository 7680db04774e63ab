/// Files that describe a path through several axes: tables, and the core of G-code.
///
/// Both become the same list of elements, in the units of the file's axes and in seconds. What
/// speeds the axes can really take there is for a planner to say.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/plan/text_bounds.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::plan::path_file {

constexpr std::size_t most_axes = 6;
constexpr std::size_t most_elements = 1'000'000;
constexpr std::size_t most_chords_of_an_arc = 100'000;
constexpr int most_turns_of_an_arc = 1'000;
constexpr std::size_t most_remarks = 100;

/// In the order of Path::axes; what is behind those is 0.
using Point = std::array<double, most_axes>;

/// Straight to a point, along all axes together.
struct LineTo {
  Point target{};
  /// Units/s along the path, of the axes that make its length; nothing: as fast as possible.
  std::optional<double> feed{};
  std::optional<double>
      duration{};        ///< In seconds: when it arrives is prescribed. Never with feed.
  std::size_t line = 0;  ///< Of the file.

  bool operator==(const LineTo&) const = default;
};

/// In the plane of two axes; the others go along evenly (a helix).
struct ArcTo {
  Point target{};
  std::array<double, 2> centre{};  ///< Along the two axes of the plane.
  double sweep = 0;  ///< In radians, from the first of them to the second; never 0. 2 pi is a turn.
  double feed = 0;   ///< Units/s along the arc or helix, of the axes that make its length.
  std::size_t line = 0;
  std::array<std::size_t, 2> plane{0, 1};

  bool operator==(const ArcTo&) const = default;
};

struct Dwell {
  double duration = 0;  ///< In seconds.
  std::size_t line = 0;
  /// The M word that is carried out when the axes stand, by its number: 3 to 9 switch something, 0
  /// waits until it is told to go on. The dwell has no duration then.
  std::optional<std::uint8_t> word{};

  bool operator==(const Dwell&) const = default;
};

using Element = std::variant<LineTo, ArcTo, Dwell>;

struct Path {
  std::vector<std::string> axes;  ///< 1 to most_axes.
  Point start{};
  std::vector<Element> elements{};
  /// The first so many axes make the length of a line, and its feed is about that; the others go
  /// along. Where none of the first moves, all do. mm and degrees have no common length.
  std::size_t length_axes = most_axes;
  /// What the file asks for and is not carried out, each once, where it first stands.
  TextProblems remarks{};

  bool operator==(const Path&) const = default;
};

/// A table with commas; its first row names the columns; cells may stand in quotes. Either a column
/// t, in ascending seconds (or time, time_s, t_s, in any case), and one for each axis: where the
/// axes are when. Or axes only: corners of a polyline, with a column speed for how fast the way to
/// this row is made, if it is there. The first row of numbers is the start; its speed means
/// nothing, and may be missing. Empty lines, and those that begin with #, are skipped; so are rows
/// without t that repeat the one before. Columns that seem to be of times or speeds under another
/// name are no axes, but problems.
///
/// All that is wrong, by line, up to most_text_problems.
tl::expected<Path, TextProblems> read_csv(std::string_view text);

constexpr std::string_view gcode_axes = "XYZABC";

/// What becomes of words that are not known: problems, or remarks.
enum class Unknowns : std::uint8_t { refused, skipped };

/// What a program of G-code is read for.
struct GcodeSetup {
  Unknowns unknowns = Unknowns::refused;
  /// The words of M3, M4, M5, M7, M8 and M9 that are carried out, by their numbers; others are
  /// remarks.
  std::bitset<10> words{};
  static constexpr std::size_t systems = 6;
  /// Where G54 to G59 count from at first, in mm and degrees from the zero of the axes; nothing for
  /// one that was not stored.
  std::array<std::optional<Point>, systems> origins{};
  /// How long tools are, in mm, by their numbers.
  std::map<int, double> tools{};
};

/// What CAM programs write, as LinuxCNC has it:
/// - G0, G1, G2, G3 (with I J K or R, and P turns) in the planes G17, G18, G19; G4 P; G80;
/// - G20, G21; G90, G91 for positions, G90.1, G91.1 for centres; F with G93, G94, G95;
/// - G53, G54 to G59, G10 L2 and L20, G52, G92, G92.1 to G92.3;
/// - G28, G30: by the axes' point on the line to the stored one, which is the zero of the axes
///   until G28.1 or G30.1 stores another; without axes all that the program moves go there;
/// - G61, G61.1: axes stand between movements, unless a line goes straight on after G61; G64;
/// - G43 H, by the table of tools, or without H for the tool that M6 has changed to; G43.1, which
///   says lengths itself; G49: positions of Z, or of the axes of G43.1, count from so much farther;
/// - G40, which changes nothing here;
/// - M0, where the axes stand and wait until they are told to go on; M1, where they stand and go
///   on; M2 and M30, behind which nothing is read;
/// - M3, M4, M5, M7, M8 and M9, if the setup says that they are carried out: the axes stand then,
///   before the movement of their line. What M3, M4, M7 or M8 has switched on, M5 or M9 switches
///   off at the end;
/// - N, O with a number, lines of %, of which the second ends the program, comments in ( ) or
///   behind a semicolon.
/// Axes are X Y Z A B C. Lengths become mm, X Y Z from inches after G20; A B C are degrees. F is in
/// units per minute: of X Y Z if one of them moves, and A B C arrive with them; otherwise of A B C.
/// P of G4 is in seconds. At first G17, G21, G54, G64, G90, G91.1 and G94 hold, and nothing is
/// known of F. A move that goes nowhere is left out; positions that differ by rounding are the
/// same. An arc by its centre that sweeps less than 5e-7 rad is a whole turn. Its ends may be so
/// differently far from its centre as LinuxCNC lets them: 0.0283 mm or 0.00283 inch, or 0.1 % up to
/// a hundred times that.
///
/// Stored origins hold until G10 sets others, for this program alone.
///
/// Remarks: S, T, M6, those of M3 to M9 that are not carried out, P of G64, M1, and a coordinate
/// system that was not set.
///
/// The axes are those that the program moves, in the order X Y Z A B C, both of a plane if there is
/// an arc in it. `start` is in the order X Y Z A B C, whatever the program moves.
///
/// All that is wrong, by line, up to most_text_problems; what is not known here once for each
/// letter or code. Behind a line that cannot be followed, no movement is looked at: what is wrong
/// with it may follow from that line.
///
/// With Unknowns::skipped, words that are not known become remarks. With a G code that is not
/// known the axes of its line are skipped, unless a known movement stands there, and with one for
/// movements those of the lines behind it, up to the next that is known. Expressions and what is no
/// word stay problems.
tl::expected<Path, TextProblems> read_gcode(std::string_view text, const Point& start = {},
                                            const GcodeSetup& setup = {});

/// With lines for the arcs, nowhere farther from them than this. A sentence if that takes more than
/// most_chords_of_an_arc or most_elements, or if the tolerance is none.
tl::expected<Path, std::string> flatten(const Path& path, double tolerance);

}  // namespace tmcl::plan::path_file
