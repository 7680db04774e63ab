#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "motion/path/gcode_arc.hpp"
#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_codes.hpp"
#include "motion/path/gcode_feeds.hpp"
#include "motion/path/gcode_origins.hpp"
#include "motion/path/text_cursor.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

using gcode::Block;
using gcode::Codes;
using gcode::Group;
using gcode::Part;
using gcode::Word;
using gcode::Wrong;
using gcode::wrong;

constexpr std::string_view axis_letters = gcode_axes;
constexpr std::string_view centre_letters = "IJK";
constexpr std::string_view ways_of_arcs = "IJKR";
constexpr std::size_t linear_axes = 3;
constexpr std::size_t tool_axis = 2;
constexpr int most_tool = 99'999;
constexpr std::uint8_t spindle_off = 5;
constexpr std::uint8_t coolant_off = 9;

/// Whether a line from `at` goes on as one from `before` to it did.
bool goes_straight_on(const Point& before, const Point& at, const Point& target) {
  double one = 0;
  double other = 0;
  double both = 0;
  for (std::size_t i = 0; i < most_axes; ++i) {
    const double came = at[i] - before[i];
    const double goes = target[i] - at[i];
    one += came * came;
    other += goes * goes;
    both += came * goes;
  }
  constexpr double rounding = 1e-12;
  return both > 0 && both * both >= (1 - rounding) * one * other;
}

class Interpreter {
 public:
  Interpreter(const Point& start, const GcodeSetup& setup, ProblemList& problems)
      : problems_(problems), setup_(setup), at_(start), origins_(setup.origins) {
    path_.start = start;
  }

  /// False after the end of the program.
  bool run(std::string_view line, std::size_t number) {
    line_ = number;
    hides_words_ = false;
    if (is_tape_mark(line)) return !std::exchange(has_begun_, true);
    const Block block(line);
    for (const auto& wrong : block.wrongs()) complain(wrong);
    const Codes codes(block);
    for (const auto& wrong : codes.wrongs()) complain(wrong);
    hides_words_ = codes.hide_words();
    const bool goes_on = take_m_words(block);
    take_modes(codes, block);
    complain(feeds_.take(block.find('F'), unit_));
    // Of a line that is not understood it is not said what its movement lacks.
    if (!confused_) complain(carry_out(block, codes));
    if (stands_) add(Dwell{0, line_, stop_});
    stands_ = false;
    stop_.reset();
    if (path_.elements.size() > most_elements) {
      problems_.add(line_, 1,
                    fmt::format("the path is too long; {} elements at most", most_elements));
      return false;
    }
    return goes_on;
  }

  Path finish() {
    switch_off();
    keep_only_used_axes();
    path_.remarks = remarks_.take();
    return std::move(path_);
  }

 private:
  // ---- what is told ----

  void complain(const Wrong& wrong) {
    const bool skipped = wrong.may_be_skipped && setup_.unknowns == Unknowns::skipped;
    confused_ = confused_ || (wrong.confuses && !skipped);
    if (!wrong.unknown_letter.empty()) {
      const char letter = upper(wrong.unknown_letter.front());
      if (unknown_letters_.find(letter) != std::string::npos) return;
      unknown_letters_ += letter;
    }
    if (skipped) return remarks_.add_once(line_, wrong.column, wrong.message + "; skipped");
    problems_.add_once(line_, wrong.column, wrong.message);
  }
  void complain(const Part<void>& part) {
    if (!part) complain(part.error());
  }
  void remark(std::size_t column, const std::string& message) {
    remarks_.add_once(line_, column, message);
  }

  // ---- modes ----

  void take_modes(const Codes& codes, const Block& block) {
    if (const auto plane = codes.of(Group::plane)) plane_ = plane_of(*plane);
    if (const auto unit = codes.of(Group::unit)) unit_ = *unit == 200 ? gcode::mm_of_an_inch : 1;
    if (const auto distance = codes.of(Group::distance)) absolute_ = *distance == 900;
    if (const auto centres = codes.of(Group::centres)) absolute_centres_ = *centres == 901;
    if (const auto system = codes.of(Group::system)) select(*system, codes);
    if (const auto corners = codes.of(Group::corners)) corners_ = *corners;
    if (const auto feed = codes.of(Group::feed)) feeds_.set_mode(*feed);
    if (codes.are(Group::corners, 640) && block.has('P'))
      remark(codes.column_of(Group::corners), "P of G64 is not carried out; the tolerance holds");
    if (codes.of(Group::tool_length)) complain(take_tool_length(codes, block));
    take_motion(codes);
  }

  void take_motion(const Codes& codes) {
    const auto motion = codes.of(Group::motion);
    if (motion || codes.of(Group::end_of_cycles) || codes.hide_motion()) {
      motion_.reset();
      motion_is_hidden_ = !motion && codes.hide_motion();
    }
    if (motion) motion_ = *motion / 10;
  }

  static std::array<std::size_t, 2> plane_of(int code) {
    if (code == 170) return {0, 1};
    return code == 180 ? std::array<std::size_t, 2>{2, 0} : std::array<std::size_t, 2>{1, 2};
  }

  void select(int code, const Codes& codes) {
    const auto system = static_cast<std::size_t>(code / 10 - 54);
    origins_.select(system);
    if (system == 0 || origins_.is_set(system)) return;
    remark(codes.column_of(Group::system),
           fmt::format("G{} was not set here; it counts from the zero of the axes", code / 10));
  }

  Part<void> take_tool_length(const Codes& codes, const Block& block) {
    if (codes.are(Group::tool_length, 431)) return take_lengths(codes, block);
    if (codes.are(Group::tool_length, 490)) return origins_.forget_tool(), Part<void>{};
    const auto& named = block.find('H');
    const auto column = named ? named->column : codes.column_of(Group::tool_length);
    const double number = named ? named->value : tool_in_use_.value_or(-1);
    if (!named && !tool_in_use_)
      return no_tool(column, "G43 needs H, the number of a tool, or M6 with T before it");
    const auto tool = number == 0 ? setup_.tools.end() : tool_of(number);
    if (number != 0 && tool == setup_.tools.end()) {
      return no_tool(column, fmt::format("the length of tool {} is not known: 'tools' of [path] in "
                                         "the configuration of tmcld says lengths",
                                         plain_number(number, 6)));
    }
    origins_.forget_tool();
    if (number != 0) origins_.lengthen_tool(tool_axis, tool->second);
    return {};
  }

  static Part<void> no_tool(std::size_t column, std::string message) {
    Wrong fault{column, std::move(message)};
    fault.may_be_skipped = true;
    return tl::unexpected(std::move(fault));
  }

  std::map<int, double>::const_iterator tool_of(double number) const {
    const bool may_be_one = number == std::round(number) && std::abs(number) <= most_tool;
    return may_be_one ? setup_.tools.find(static_cast<int>(number)) : setup_.tools.end();
  }

  /// G43.1.
  Part<void> take_lengths(const Codes& codes, const Block& block) {
    if (!block.has_any(axis_letters))
      return wrong(codes.column_of(Group::tool_length), "G43.1 needs an axis, and its length");
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      if (const auto& word = block.find(axis_letters[i]))
        origins_.lengthen_tool(i, in_mm(*word, i));
    }
    return {};
  }

  /// False at the end of the program.
  bool take_m_words(const Block& block) {
    bool ends = false;
    bool changes_tool = false;
    for (const auto& m : block.m()) {
      changes_tool = changes_tool || m.value == 6;
      const auto name = "M" + plain_number(m.value, 6);
      if (m.value == 2 || m.value == 30) {
        ends = true;
      } else if (m.value == 0) {
        stands_ = true;
        stop_ = 0;
      } else if (m.value == 1) {
        stands_ = true;
        remark(m.column, "M1 does not wait: the axes stand and go on");
      } else if (m.value == std::round(m.value) && m.value >= 3 && m.value <= 9) {
        take_switch(static_cast<std::uint8_t>(m.value), m.column);
      } else {
        complain(Wrong{m.column, name + " is not known here", {}, false, true});
        hides_words_ = hides_words_ || setup_.unknowns == Unknowns::skipped;
      }
    }
    for (const char letter : std::string_view("ST")) {
      if (block.has(letter))
        remark(block.find(letter)->column, fmt::format("{} is not carried out", letter));
    }
    if (block.has('T')) tool_chosen_ = block.find('T')->value;
    if (changes_tool) tool_in_use_ = tool_chosen_;
    if (block.has('S')) feeds_.set_spindle(block.find('S')->value);
    return !ends;
  }

  /// M3 to M9.
  void take_switch(std::uint8_t word, std::size_t column) {
    if (!setup_.words.test(word))
      return remark(column, fmt::format("M{} is not carried out", word));
    add(Dwell{0, line_, word});
    if (word == 3 || word == 4) spindle_is_on_ = true;
    if (word == spindle_off) spindle_is_on_ = false;
    if (word == 7 || word == 8) coolant_is_on_ = true;
    if (word == coolant_off) coolant_is_on_ = false;
  }

  /// As M2 has it.
  void switch_off() {
    if (spindle_is_on_ && setup_.words.test(spindle_off)) add(Dwell{0, line_, spindle_off});
    if (coolant_is_on_ && setup_.words.test(coolant_off)) add(Dwell{0, line_, coolant_off});
  }

  // ---- what a line does ----

  Part<void> carry_out(const Block& block, const Codes& codes) {
    if (auto found = find_stray(block, codes); !found && !hides_words_ && !codes.has_unknown())
      return found;
    switch (codes.of(Group::once).value_or(-1)) {
      case 40: return dwell(block);
      case 100: return set_system(block, codes);
      case 280: return go_to(stored_[0], block);
      case 300: return go_to(stored_[1], block);
      case 520:
      case 920: return shift(block, codes);
      case 281: stored_[0] = at_; break;
      case 301: stored_[1] = at_; break;
      case 921: origins_.forget_shift(); break;
      case 922: origins_.suspend_shift(); break;
      case 923: origins_.restore_shift(); break;
      default: break;
    }
    if (codes.are(Group::tool_length, 431)) return {};
    if (!codes.of(Group::motion) && (hides_words_ || motion_is_hidden_)) return {};
    const bool of_machine = codes.are(Group::once, 530);
    if (of_machine && makes_arc(block, codes))
      return wrong(codes.column_of(Group::once), "G53 needs G0 or G1");
    return move(block, of_machine);
  }

  bool makes_arc(const Block& block, const Codes& codes) const {
    return !codes.take_axes() && (motion_ == 2 || motion_ == 3) &&
           (block.has_any(axis_letters) || block.has_any(ways_of_arcs));
  }

  /// Words that belong to a code that the line has not.
  Part<void> find_stray(const Block& block, const Codes& codes) const {
    if (motion_is_hidden_ && !codes.of(Group::motion)) return {};
    const bool arc = makes_arc(block, codes);
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
    if (!arc && block.has_any(origins ? centre_letters : ways_of_arcs))
      return wrong(block.column_of(ways_of_arcs), "I, J, K and R belong to G2 and G3");
    if (block.has('L') && !origins) return stray(block, 'L', "G10");
    if (block.has('Q') && !corners) return stray(block, 'Q', "G64");
    if (block.has('H') && !codes.are(Group::tool_length, 430)) return stray(block, 'H', "G43");
    return {};
  }
  static Part<void> stray(const Block& block, char letter, std::string_view code) {
    return wrong(block.find(letter)->column, fmt::format("{} belongs to {}", letter, code));
  }

  Part<void> dwell(const Block& block) {
    const auto& pause = block.find('P');
    if (!pause) return wrong(1, "G4 needs P, in seconds");
    if (pause->value < 0) return wrong(pause->column, "P must not be below 0");
    add(Dwell{pause->value, line_});
    return {};
  }

  // ---- where positions count from ----

  double in_mm(const Word& word, std::size_t axis) const {
    return word.value * (axis < linear_axes ? unit_ : 1);
  }

  Part<void> set_system(const Block& block, const Codes& codes) {
    const auto column = codes.column_of(Group::once);
    const auto& kind = block.find('L');
    if (!kind || (kind->value != 2 && kind->value != 20))
      return tl::unexpected(Wrong{column, "G10 is known with L2 and L20 only", {}, true, true});
    if (block.has('R') && block.find('R')->value != 0)
      return wrong(block.find('R')->column, "coordinates that are turned are not known here");
    const auto& number = block.find('P');
    const double most = gcode::Origins::systems;
    if (!number || number->value != std::round(number->value) || number->value < 0 ||
        number->value > most) {
      return wrong(number ? number->column : column,
                   "G10 needs P: 1 to 6 for G54 to G59, or 0 for the one that holds");
    }
    const auto system =
        number->value == 0 ? origins_.selected() : static_cast<std::size_t>(number->value) - 1;
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      const auto& word = block.find(axis_letters[i]);
      if (!word) continue;
      if (kind->value == 2) {
        origins_.set(system, i, in_mm(*word, i));
      } else {
        origins_.set_by_place(system, i, at_[i], in_mm(*word, i));
      }
    }
    return {};
  }

  Part<void> shift(const Block& block, const Codes& codes) {
    const bool by_place = codes.are(Group::once, 920);
    if (!block.has_any(axis_letters)) {
      return wrong(codes.column_of(Group::once),
                   fmt::format("{} needs an axis", by_place ? "G92" : "G52"));
    }
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      const auto& word = block.find(axis_letters[i]);
      if (!word) continue;
      if (by_place) {
        origins_.shift_by_place(i, at_[i], in_mm(*word, i));
      } else {
        origins_.shift(i, in_mm(*word, i));
      }
    }
    return {};
  }

  // ---- movements ----

  Part<void> move(const Block& block, bool of_machine) {
    const bool arc = motion_ == 2 || motion_ == 3;
    if (!block.has_any(axis_letters) && !(arc && block.has_any(ways_of_arcs))) return {};
    if (!motion_) return wrong(block.column_of(axis_letters), "G0, G1, G2 or G3 must come first");
    const auto target = target_of(block, of_machine);
    if (!target) return tl::unexpected(target.error());
    auto done = arc ? arc_to(*target, block) : line_to(*target, block);
    at_ = *target;
    return done;
  }

  /// By the point that the line names to the stored one.
  Part<void> go_to(const Point& stored, const Block& block) {
    const bool all = !block.has_any(axis_letters);
    const auto by = target_of(block, false);
    if (!by) return tl::unexpected(by.error());
    rapid_to(*by);
    auto target = at_;
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      if (all || block.has(axis_letters[i])) target[i] = stored[i];
    }
    rapid_to(target);
    return {};
  }

  void rapid_to(const Point& target) {
    if (target == at_) return;
    add_line({target, {}, {}, line_});
    at_ = target;
  }

  Part<Point> target_of(const Block& block, bool of_machine) {
    auto target = at_;
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      const auto& word = block.find(axis_letters[i]);
      if (!word) continue;
      used_[i] = true;
      const double way = in_mm(*word, i);
      const bool absolute = absolute_ || of_machine;
      const double from = !absolute ? at_[i] : of_machine ? 0 : origins_.of(i);
      target[i] = from + way;
      // A way of a few last bits would have a direction of its own.
      if (absolute && are_equal(target[i], at_[i])) target[i] = at_[i];
      if (!std::isfinite(target[i]))
        return wrong(word->column, "the position is beyond all numbers");
    }
    return target;
  }

  Part<void> line_to(const Point& target, const Block& block) {
    if (target == at_) return {};
    LineTo line{target, {}, {}, line_};
    if (motion_ == 1) {
      double linear = 0;
      double angular = 0;
      for (std::size_t i = 0; i < axis_letters.size(); ++i) {
        auto& way = i < linear_axes ? linear : angular;
        way = std::hypot(way, target[i] - at_[i]);
      }
      const auto feed = feeds_.of(*motion_, block.column_of(axis_letters), linear > 0,
                                  linear > 0 ? linear : angular);
      if (!feed) return tl::unexpected(feed.error());
      line.feed = *feed;
    }
    add_line(line);
    return {};
  }

  Part<void> arc_to(const Point& target, const Block& block) {
    const auto [one, other] = plane_;
    const auto column = block.column_of("IJKRXYZ");
    used_[one] = used_[other] = true;
    gcode::PlaneArc arc{{at_[one], at_[other]}, {target[one], target[other]}, motion_ == 2, unit_};
    const auto turns = turns_of(block);
    if (!turns) return tl::unexpected(turns.error());
    const auto round = round_of(arc, block);
    if (!round) return tl::unexpected(round.error());
    const double more = (*turns - 1) * 2 * std::numbers::pi;
    const double radius = std::hypot(at_[one] - round->centre[0], at_[other] - round->centre[1]);
    double length = round->length + more * radius;
    for (std::size_t i = 0; i < linear_axes; ++i) {
      if (i != one && i != other) length = std::hypot(length, target[i] - at_[i]);
    }
    const auto feed = feeds_.of(*motion_, column, true, length);
    if (!feed) return tl::unexpected(feed.error());
    const double sweep = round->sweep + (motion_ == 3 ? more : -more);
    if (!std::isfinite(sweep) || !std::isfinite(round->centre[0]) ||
        !std::isfinite(round->centre[1]))
      return wrong(column, "the arc is beyond all numbers");
    add(ArcTo{target, round->centre, sweep, *feed, line_, plane_});
    return {};
  }

  static Part<double> turns_of(const Block& block) {
    const auto& turns = block.find('P');
    if (!turns) return 1;
    if (turns->value == std::round(turns->value) && turns->value >= 1 &&
        turns->value <= most_turns_of_an_arc)
      return turns->value;
    return wrong(turns->column, fmt::format("P of an arc is a whole number of turns, 1 to {}",
                                            most_turns_of_an_arc));
  }

  /// Its centre by two of the letters I, J, K, or its radius.
  Part<gcode::PlaneArc::Round> round_of(const gcode::PlaneArc& arc, const Block& block) const {
    const auto& radius = block.find('R');
    const auto column = block.column_of("IJKRXYZ");
    const auto at_column = [](std::size_t where) {
      return [where](std::string message) { return Wrong{where, std::move(message)}; };
    };
    if (radius && block.has_any(centre_letters))
      return wrong(radius->column, "R excludes I, J and K");
    if (radius) return arc.of_radius(radius->value * unit_).map_error(at_column(radius->column));
    const std::string letters{centre_letters[plane_[0]], centre_letters[plane_[1]]};
    const char third = centre_letters[3 - plane_[0] - plane_[1]];
    // Some programs write all three.
    if (block.has(third) && block.find(third)->value != 0) {
      return wrong(block.find(third)->column,
                   fmt::format("{} is no part of the plane of this arc", third));
    }
    const bool enough = absolute_centres_ ? block.has(letters[0]) && block.has(letters[1])
                                          : block.has_any(letters) || block.has(third);
    if (!enough) {
      const auto [least, greatest] = std::minmax(letters[0], letters[1]);
      return wrong(column, fmt::format("G{} needs {} and {}, or R", *motion_, least, greatest));
    }
    gcode::PlaneArc::Place centre{};
    for (std::size_t i = 0; i < 2; ++i) {
      const double from = absolute_centres_ ? origins_.of(plane_[i]) : arc.from[i];
      centre[i] = from + (block.has(letters[i]) ? block.find(letters[i])->value * unit_ : 0);
    }
    return arc.around(centre).map_error(at_column(block.column_of(centre_letters)));
  }

  // ---- the path ----

  void add(Element element) {
    line_from_.reset();
    if (corners_ != 640 && moves(element) && !path_.elements.empty() &&
        moves(path_.elements.back()))
      path_.elements.emplace_back(Dwell{0, line_});
    path_.elements.push_back(std::move(element));
  }
  static bool moves(const Element& element) { return !std::holds_alternative<Dwell>(element); }

  void add_line(const LineTo& line) {
    if (corners_ == 610 && line_from_ && goes_straight_on(*line_from_, at_, line.target)) {
      path_.elements.emplace_back(line);
    } else {
      add(line);
    }
    line_from_ = at_;
  }

  void keep_only_used_axes() {
    if (std::ranges::none_of(used_, [](bool used) { return used; })) used_[0] = true;
    std::array<std::size_t, most_axes> place{};
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      if (i == linear_axes && !path_.axes.empty()) path_.length_axes = path_.axes.size();
      place[i] = path_.axes.size();
      if (used_[i]) path_.axes.emplace_back(1, axis_letters[i]);
    }
    path_.start = packed(path_.start);
    auto at = path_.start;
    std::erase_if(path_.elements, [&](Element& element) {
      const auto before = at;
      auto* arc = std::get_if<ArcTo>(&element);
      if (auto* line = std::get_if<LineTo>(&element)) {
        at = line->target = packed(line->target);
        // Axes that only G28 would have moved are left out.
        return at == before;
      }
      if (arc == nullptr) return false;
      at = arc->target = packed(arc->target);
      for (auto& axis : arc->plane) axis = place[axis];
      return false;
    });
  }

  Point packed(const Point& all) const {
    Point point{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (used_[i]) point[count++] = all[i];
    }
    return point;
  }

  static bool is_tape_mark(std::string_view line) {
    TextCursor cursor(line);
    const bool mark = cursor.take('%');
    cursor.skip_blanks();
    return mark && cursor.at_end();
  }

  ProblemList& problems_;
  ProblemList remarks_{most_remarks};
  const GcodeSetup& setup_;
  std::string unknown_letters_;
  bool confused_ = false;
  bool has_begun_ = false;
  bool hides_words_ = false;
  bool stands_ = false;                 ///< Behind the movement of this line.
  std::optional<std::uint8_t> stop_{};  ///< Why: M0, which waits.
  bool spindle_is_on_ = false;          ///< Switched on by a word that is carried out.
  bool coolant_is_on_ = false;
  Path path_;
  Point at_;
  std::optional<Point> line_from_{};  ///< Where the line that ends here began.
  std::array<bool, most_axes> used_{};
  std::size_t line_ = 0;
  gcode::Origins origins_;
  std::optional<double> tool_chosen_{};  ///< By T.
  std::optional<double> tool_in_use_{};  ///< By M6.
  gcode::Feeds feeds_;
  std::array<Point, 2> stored_{};  ///< By G28.1 and G30.1.
  std::array<std::size_t, 2> plane_{0, 1};
  double unit_ = 1;
  bool absolute_ = true;
  bool absolute_centres_ = false;
  int corners_ = 640;
  std::optional<int> motion_{};
  bool motion_is_hidden_ = false;  ///< By a code that was skipped.
};

}  // namespace

tl::expected<Path, TextProblems> read_gcode(std::string_view text, const Point& start,
                                            const GcodeSetup& setup) {
  ProblemList problems;
  Interpreter interpreter(start, setup, problems);
  for_each_line(text, problems, [&](std::string_view line, std::size_t number) {
    return interpreter.run(line, number);
  });
  if (!problems.empty()) return tl::unexpected(problems.take());
  return interpreter.finish();
}

}  // namespace tmcl::plan::path_file
