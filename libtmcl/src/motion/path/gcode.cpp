#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "motion/path/gcode_block.hpp"
#include "motion/path/text_cursor.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

constexpr std::string_view axis_letters = gcode_axes;
constexpr std::size_t linear_axes = 3;
constexpr double mm_of_an_inch = 25.4;
constexpr double seconds_of_a_minute = 60;
// An arc's ends may be so differently far from its centre; or so, as a part of the radius, up to a
// hundred times as much. As LinuxCNC has it: centre and ends are rounded to 0.01 mm or 0.001 inch.
constexpr double radius_slack_mm = 2 * 0.01 * std::numbers::sqrt2;
constexpr double radius_slack_inch = 2 * 0.001 * std::numbers::sqrt2;
constexpr double relative_radius_slack = 1e-3;
constexpr double most_radius_slacks = 100;
// An arc that sweeps less is a whole turn, as with grbl, unless its ends are farther apart than
// what a file's last digit says.
constexpr double least_sweep = 5e-7;
constexpr double least_arc_mm = 5e-4;

using gcode::Block;
using gcode::Part;
using gcode::Word;
using gcode::Wrong;
using gcode::wrong;

/// What a line's G words ask for.
struct Codes {
  std::optional<int> motion{};
  bool dwell = false;
};

class Interpreter {
 public:
  Interpreter(const Point& start, ProblemList& problems) : problems_(problems), at_(start) {
    path_.start = start;
  }

  /// False after the end of the program.
  bool run(std::string_view line, std::size_t number) {
    line_ = number;
    const Block block(line);
    for (const auto& wrong : block.wrongs()) complain(wrong);
    const auto codes = take_codes(block);
    complain(take_feed(block));
    // Of a line that is not understood it is not said what its movement lacks.
    if (codes && !confused_) complain(codes->dwell ? dwell(block) : move(block));
    if (path_.elements.size() > most_elements) {
      problems_.add(line_, 1,
                    fmt::format("the path is too long; {} elements at most", most_elements));
      return false;
    }
    return take_end(block);
  }

  Path finish() {
    keep_only_used_axes();
    return std::move(path_);
  }

 private:
  void complain(const Wrong& wrong) {
    confused_ = confused_ || wrong.confuses;
    if (!wrong.unknown_letter.empty()) {
      const char letter = upper(wrong.unknown_letter.front());
      if (unknown_letters_.find(letter) != std::string::npos) return;
      unknown_letters_ += letter;
    }
    problems_.add_once(line_, wrong.column, wrong.message);
  }
  void complain(const Part<void>& part) {
    if (!part) complain(part.error());
  }

  /// Nothing if they cannot be followed.
  std::optional<Codes> take_codes(const Block& block) {
    Codes codes;
    bool is_understood = true;
    for (const auto& word : block.g()) {
      const auto taken = take_code(word, codes);
      if (taken) continue;
      complain({word.column, taken.error().message, {}, true});
      is_understood = false;
    }
    if (!is_understood) return std::nullopt;
    if (codes.motion) motion_ = codes.motion;
    return codes;
  }

  Part<void> take_code(const Word& word, Codes& codes) {
    if (word.value == 20 || word.value == 21) {
      unit_ = word.value == 20 ? mm_of_an_inch : 1;
    } else if (word.value == 90 || word.value == 91) {
      absolute_ = word.value == 90;
    } else if (word.value == 4) {
      codes.dwell = true;
    } else if (word.value == 0 || word.value == 1 || word.value == 2 || word.value == 3) {
      if (codes.motion) return wrong(word.column, "there are two movements on this line");
      codes.motion = static_cast<int>(word.value);
    } else {
      return wrong(word.column,
                   fmt::format("G{} is not known here; known are G0, G1, G2, G3, G4, G20, G21, "
                               "G90 and G91",
                               plain_number(word.value, 6)));
    }
    if (codes.dwell && codes.motion)
      return wrong(word.column, "G4 and a movement exclude each other");
    return {};
  }

  Part<void> take_feed(const Block& block) {
    const auto& feed = block.find('F');
    if (!feed) return {};
    const double per_second = feed->value / seconds_of_a_minute;
    linear_feed_ = per_second * unit_;
    angular_feed_ = per_second;
    if (!(per_second > 0)) return wrong(feed->column, "F must be above 0");
    return {};
  }

  /// False after M2.
  bool take_end(const Block& block) {
    bool ends = false;
    for (const auto& m : block.m()) {
      ends = ends || m.value == 2;
      if (m.value != 2)
        complain({m.column,
                  fmt::format("M{} is not known here; known is M2", plain_number(m.value, 6))});
    }
    return !ends;
  }

  Part<void> dwell(const Block& block) {
    if (block.has_any("XYZABCIJR"))
      return wrong(block.column_of("XYZABCIJR"), "G4 has P, and nothing else");
    const auto& pause = block.find('P');
    if (!pause) return wrong(1, "G4 needs P, in seconds");
    if (pause->value < 0) return wrong(pause->column, "P must not be below 0");
    path_.elements.emplace_back(Dwell{pause->value, line_});
    return {};
  }

  Part<void> move(const Block& block) {
    if (block.has('P')) return wrong(block.find('P')->column, "P belongs to G4");
    const bool arc = motion_ == 2 || motion_ == 3;
    if (!arc && block.has_any("IJR"))
      return wrong(block.column_of("IJR"), "I, J and R belong to G2 and G3");
    if (!block.has_any(axis_letters) && !block.has_any("IJR")) return {};
    if (!motion_) return wrong(block.column_of(axis_letters), "G0, G1, G2 or G3 must come first");
    const auto target = target_of(block);
    if (!target) return tl::unexpected(target.error());
    auto done = arc ? arc_to(*target, block) : line_to(*target, block);
    at_ = *target;
    return done;
  }

  Part<Point> target_of(const Block& block) {
    auto target = at_;
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      const auto& word = block.find(axis_letters[i]);
      if (!word) continue;
      used_[i] = true;
      const double way = word->value * (i < linear_axes ? unit_ : 1);
      target[i] = absolute_ ? way : at_[i] + way;
      // A way of a few last bits would have a direction of its own.
      if (absolute_ && are_equal(target[i], at_[i])) target[i] = at_[i];
      if (!std::isfinite(target[i]))
        return wrong(word->column, "the position is beyond all numbers");
    }
    return target;
  }

  Part<void> line_to(const Point& target, const Block& block) {
    if (target == at_) return {};
    LineTo line{target, {}, {}, line_};
    if (motion_ == 1) {
      if (!linear_feed_)
        return wrong(block.column_of(axis_letters), "G1 needs F, which was not said yet");
      const bool linear = !std::equal(at_.begin(), at_.begin() + linear_axes, target.begin());
      line.feed = linear ? linear_feed_ : angular_feed_;
    }
    path_.elements.emplace_back(line);
    return {};
  }

  Part<void> arc_to(const Point& target, const Block& block) {
    const auto column = block.column_of("IJRXY");
    used_[0] = used_[1] = true;
    if (!linear_feed_)
      return wrong(column, fmt::format("G{} needs F, which was not said yet", *motion_));
    if (block.has('R') && block.has_any("IJ"))
      return wrong(block.find('R')->column, "R excludes I and J");
    if (!block.has_any("IJR"))
      return wrong(column, fmt::format("G{} needs I and J, or R", *motion_));
    ArcTo arc{target, 0, 0, 0, *linear_feed_, line_};
    auto centred =
        block.has('R') ? centre_by_radius(arc, *block.find('R')) : centre_by_offsets(arc, block);
    if (!centred) return centred;
    if (!std::isfinite(arc.sweep) || !std::isfinite(arc.centre_x) || !std::isfinite(arc.centre_y))
      return wrong(column, "the arc is beyond all numbers");
    path_.elements.emplace_back(arc);
    return {};
  }

  Part<void> centre_by_offsets(ArcTo& arc, const Block& block) {
    const auto offset = [&](char letter) {
      return block.has(letter) ? block.find(letter)->value * unit_ : 0;
    };
    arc.centre_x = at_[0] + offset('I');
    arc.centre_y = at_[1] + offset('J');
    const double begin = std::hypot(offset('I'), offset('J'));
    const double end = std::hypot(arc.target[0] - arc.centre_x, arc.target[1] - arc.centre_y);
    const auto column = block.column_of("IJ");
    if (!(begin > 0) || !std::isfinite(begin))
      return wrong(column, "the centre is where the arc begins");
    if (!(end > 0)) return wrong(column, "the centre is where the arc ends");
    if (!(std::abs(begin - end) <= radius_slack(std::max(begin, end)))) {
      return wrong(
          column,
          fmt::format("the arc begins {0} {2} from its centre and ends {1} {2} from it",
                      plain_number(begin / unit_, 6), plain_number(end / unit_, 6), unit_name()));
    }
    set_sweep(arc, begin);
    return {};
  }

  std::string_view unit_name() const { return unit_ == 1 ? "mm" : "inches"; }

  /// How much two radii may differ of which the greater one is this, in mm.
  double radius_slack(double radius) const {
    const double slack = unit_ == 1 ? radius_slack_mm : radius_slack_inch * unit_;
    return std::clamp(relative_radius_slack * radius, slack, most_radius_slacks * slack);
  }

  Part<void> centre_by_radius(ArcTo& arc, const Word& radius_word) {
    const double radius = std::abs(radius_word.value) * unit_;
    const double dx = arc.target[0] - at_[0];
    const double dy = arc.target[1] - at_[1];
    const double chord = std::hypot(dx, dy);
    const bool goes_nowhere = are_equal(arc.target[0], at_[0]) && are_equal(arc.target[1], at_[1]);
    if (goes_nowhere) return wrong(radius_word.column, "an arc to where it begins needs I and J");
    const double beyond = chord / 2 - radius;
    if (!(beyond <= radius_slack(radius))) {
      return wrong(radius_word.column,
                   fmt::format("the radius is too small: the ends are {} {} apart",
                               plain_number(chord / unit_, 6), unit_name()));
    }
    // Counter-clockwise, the centre of the shorter arc is on the left.
    const bool left = (motion_ == 3) == (radius_word.value > 0);
    const double height =
        std::sqrt(std::max(0.0, (radius - chord / 2) * (radius + chord / 2))) * (left ? 1 : -1);
    arc.centre_x = at_[0] + dx / 2 - dy / chord * height;
    arc.centre_y = at_[1] + dy / 2 + dx / chord * height;
    // From the chord, since the directions of both ends from a far centre are the same.
    const double shorter = 2 * std::asin(std::min(1.0, chord / 2 / radius));
    const double sweep = radius_word.value > 0 ? shorter : 2 * std::numbers::pi - shorter;
    arc.sweep = motion_ == 3 ? sweep : -sweep;
    return {};
  }

  void set_sweep(ArcTo& arc, double radius) const {
    constexpr double turn = 2 * std::numbers::pi;
    const double from_x = at_[0] - arc.centre_x;
    const double from_y = at_[1] - arc.centre_y;
    const double to_x = arc.target[0] - arc.centre_x;
    const double to_y = arc.target[1] - arc.centre_y;
    const double angle = std::atan2(from_x * to_y - from_y * to_x, from_x * to_x + from_y * to_y);
    double sweep = motion_ == 3 ? angle : -angle;
    const bool goes_nowhere = std::abs(sweep) <= std::min(least_sweep, least_arc_mm / radius);
    if (goes_nowhere) sweep = turn;
    if (sweep < 0) sweep += turn;
    arc.sweep = motion_ == 3 ? sweep : -sweep;
  }

  void keep_only_used_axes() {
    if (std::ranges::none_of(used_, [](bool used) { return used; })) used_[0] = true;
    for (std::size_t i = 0; i < axis_letters.size(); ++i) {
      if (i == linear_axes && !path_.axes.empty()) path_.length_axes = path_.axes.size();
      if (used_[i]) path_.axes.emplace_back(1, axis_letters[i]);
    }
    path_.start = packed(path_.start);
    for (auto& element : path_.elements) {
      if (auto* line = std::get_if<LineTo>(&element)) line->target = packed(line->target);
      if (auto* arc = std::get_if<ArcTo>(&element)) arc->target = packed(arc->target);
    }
  }

  Point packed(const Point& all) const {
    Point point{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (used_[i]) point[count++] = all[i];
    }
    return point;
  }

  ProblemList& problems_;
  std::string unknown_letters_;
  bool confused_ = false;
  Path path_;
  Point at_;
  std::array<bool, most_axes> used_{};
  std::size_t line_ = 0;
  double unit_ = 1;
  bool absolute_ = true;
  std::optional<int> motion_{};
  std::optional<double> linear_feed_{};
  std::optional<double> angular_feed_{};
};

bool is_tape_mark(std::string_view line) {
  TextCursor cursor(line);
  const bool mark = cursor.take('%');
  cursor.skip_blanks();
  return mark && cursor.at_end();
}

}  // namespace

tl::expected<Path, TextProblems> read_gcode(std::string_view text, const Point& start) {
  ProblemList problems;
  Interpreter interpreter(start, problems);
  for_each_line(text, problems, [&](std::string_view line, std::size_t number) {
    return is_tape_mark(line) || interpreter.run(line, number);
  });
  if (!problems.empty()) return tl::unexpected(problems.take());
  return interpreter.finish();
}

}  // namespace tmcl::plan::path_file
