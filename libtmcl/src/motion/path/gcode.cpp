#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "motion/path/gcode_arc_words.hpp"
#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_codes.hpp"
#include "motion/path/gcode_feeds.hpp"
#include "motion/path/gcode_machine.hpp"
#include "motion/path/gcode_modes.hpp"
#include "motion/path/gcode_offsets.hpp"
#include "motion/path/gcode_origins.hpp"
#include "motion/path/gcode_path_writer.hpp"
#include "motion/path/gcode_report.hpp"
#include "motion/path/gcode_strays.hpp"
#include "motion/path/text_cursor.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

using gcode::Block;
using gcode::Codes;
using gcode::Group;
using gcode::Part;
using gcode::wrong;

bool is_tape_mark(std::string_view line) {
  TextCursor cursor(line);
  const bool mark = cursor.take('%');
  cursor.skip_blanks();
  return mark && cursor.at_end();
}

/// Line by line.
class Interpreter {
 public:
  Interpreter(const Point& start, const GcodeSetup& setup, ProblemList& problems)
      : setup_(setup), report_(setup.unknowns, problems), path_(start), origins_(setup.origins) {}

  /// False after the end of the program.
  bool run(std::string_view line, std::size_t number) {
    report_.begin_line(number);
    path_.begin_line(number);
    if (is_tape_mark(line)) return !std::exchange(has_begun_, true);
    const Block block(line);
    for (const auto& wrong : block.wrongs()) report_.complain(wrong);
    const Codes codes(block);
    for (const auto& wrong : codes.wrongs()) report_.complain(wrong);
    machine_.take(block);
    take_modes(codes, block);
    // Of a line that is not understood it is not said what its movement lacks.
    if (!report_.is_confused()) report_.complain(carry_out(block, codes));
    machine_.end_line();
    if (path_.is_too_long()) {
      report_.complain(
          wrong(1, "the path is too long; " + std::to_string(most_elements) + " elements at most"));
      return false;
    }
    return !machine_.has_ended();
  }

  Path finish() {
    machine_.switch_off();
    auto path = path_.finish();
    path.remarks = report_.take_remarks();
    return path;
  }

 private:
  void take_modes(const Codes& codes, const Block& block) {
    modes_.take(codes);
    gcode::select_system(codes, origins_, report_);
    if (const auto corners = codes.of(Group::corners)) path_.set_corners(*corners);
    if (codes.are(Group::corners, 640) && block.has('P')) {
      report_.remark(codes.column_of(Group::corners),
                     "P of G64 is not carried out; the tolerance holds");
    }
    const gcode::Tools tools{setup_.tools, machine_.tool_in_use()};
    report_.complain(gcode::set_tool_length(block, codes, modes_, tools, origins_));
    if (const auto feed = codes.of(Group::feed)) feeds_.set_mode(*feed);
    if (const auto& spindle = block.find('S')) feeds_.set_spindle(spindle->value);
    report_.complain(feeds_.take(block.find('F'), modes_.unit()));
  }

  Part<void> carry_out(const Block& block, const Codes& codes) {
    const bool hides_words = codes.hide_words() || machine_.hides_words();
    if (auto found = gcode::find_stray(block, codes, modes_);
        !found && !hides_words && !codes.has_unknown())
      return found;
    switch (codes.of(Group::once).value_or(-1)) {
      case 40: return dwell(block);
      case 100: return gcode::set_system(block, codes, modes_, path_.at(), origins_);
      case 280: return go_to(stored_[0], block);
      case 300: return go_to(stored_[1], block);
      case 520:
      case 920: return gcode::shift(block, codes, modes_, path_.at(), origins_);
      case 281: stored_[0] = path_.at(); break;
      case 301: stored_[1] = path_.at(); break;
      case 921: origins_.forget_shift(); break;
      case 922: origins_.suspend_shift(); break;
      case 923: origins_.restore_shift(); break;
      default: break;
    }
    if (codes.are(Group::tool_length, 431)) return {};
    if (!codes.of(Group::motion) && (hides_words || modes_.is_motion_hidden())) return {};
    const bool of_machine = codes.are(Group::once, 530);
    if (of_machine && modes_.make_arc(block, codes))
      return wrong(codes.column_of(Group::once), "G53 needs G0 or G1");
    return move(block, of_machine);
  }

  Part<void> dwell(const Block& block) {
    const auto& pause = block.find('P');
    if (!pause) return wrong(1, "G4 needs P, in seconds");
    if (pause->value < 0) return wrong(pause->column, "P must not be below 0");
    path_.dwell(pause->value);
    return {};
  }

  Part<void> move(const Block& block, bool of_machine) {
    const bool has_axes = block.has_any(gcode_axes);
    if (!has_axes && !(modes_.is_arc() && block.has_any(gcode::arc_letters))) return {};
    if (!modes_.motion())
      return wrong(block.column_of(gcode_axes), "G0, G1, G2 or G3 must come first");
    const auto target = target_of(block, of_machine);
    if (!target) return tl::unexpected(target.error());
    auto done = modes_.is_arc() ? arc_to(*target, block) : line_to(*target, block);
    path_.go_on_from(*target);
    return done;
  }

  /// By the point that the line names to the stored one.
  Part<void> go_to(const Point& stored, const Block& block) {
    const bool all = !block.has_any(gcode_axes);
    const auto by = target_of(block, false);
    if (!by) return tl::unexpected(by.error());
    path_.line_to(*by);
    auto target = path_.at();
    for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
      if (all || block.has(gcode_axes[i])) target[i] = stored[i];
    }
    path_.line_to(target);
    return {};
  }

  Part<Point> target_of(const Block& block, bool of_machine) {
    const auto& at = path_.at();
    auto target = at;
    for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
      const auto& word = block.find(gcode_axes[i]);
      if (!word) continue;
      path_.use(i);
      const bool absolute = modes_.is_absolute() || of_machine;
      const double from = !absolute ? at[i] : of_machine ? 0 : origins_.of(i);
      target[i] = from + modes_.in_mm(*word, i);
      // A way of a few last bits would have a direction of its own.
      if (absolute && are_equal(target[i], at[i])) target[i] = at[i];
      if (!std::isfinite(target[i]))
        return wrong(word->column, "the position is beyond all numbers");
    }
    return target;
  }

  Part<void> line_to(const Point& target, const Block& block) {
    if (target == path_.at()) return {};
    if (modes_.motion() == 0) return path_.line_to(target), Part<void>{};
    double linear = 0;
    double angular = 0;
    for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
      auto& way = i < gcode::linear_axes ? linear : angular;
      way = std::hypot(way, target[i] - path_.at()[i]);
    }
    const bool has_length = linear > 0;
    const auto feed = feeds_.of(*modes_.motion(), block.column_of(gcode_axes), has_length,
                                has_length ? linear : angular);
    if (!feed) return tl::unexpected(feed.error());
    path_.line_to(target, *feed);
    return {};
  }

  Part<void> arc_to(const Point& target, const Block& block) {
    auto arc = gcode::ArcWords(block, modes_, origins_).arc(path_.at(), target, feeds_);
    if (!arc) return tl::unexpected(std::move(arc.error()));
    path_.arc_to(*arc);
    return {};
  }

  const GcodeSetup& setup_;
  gcode::Report report_;
  gcode::PathWriter path_;
  gcode::Machine machine_{setup_.words, report_, path_};
  gcode::Modes modes_;
  gcode::Feeds feeds_;
  gcode::Origins origins_;
  std::array<Point, 2> stored_{};  ///< By G28.1 and G30.1.
  bool has_begun_ = false;
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
