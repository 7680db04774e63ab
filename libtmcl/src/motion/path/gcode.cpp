#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

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

struct Wrong {
  std::size_t column;
  std::string message;
  std::string_view unknown_letter{};  ///< If it is about a word that begins so.
  /// Whether it is not known any more what the lines behind it would do.
  bool confuses = false;
};
template <class T>
using Part = tl::expected<T, Wrong>;

tl::unexpected<Wrong> wrong(std::size_t column, std::string message) {
  return tl::unexpected(Wrong{column, std::move(message)});
}

/// A letter and its number.
struct Word {
  double value = 0;
  std::size_t column = 0;
};

/// One line: its words by letter; of G and M there may be several. What is no word of the program
/// is left out of it.
class Block {
 public:
  explicit Block(std::string_view line) {
    TextCursor cursor(line);
    while (skip_nothings(cursor)) add(cursor);
  }

  const std::vector<Wrong>& wrongs() const { return wrongs_; }
  const std::vector<Word>& g() const { return g_; }
  const std::vector<Word>& m() const { return m_; }
  bool has(char letter) const { return find(letter).has_value(); }
  bool has_any(std::string_view letters) const {
    return std::ranges::any_of(letters, [&](char letter) { return has(letter); });
  }
  const std::optional<Word>& find(char letter) const {
    return words_[static_cast<std::size_t>(letter - 'A')];
  }
  /// Where the first of these stands.
  std::size_t column_of(std::string_view letters) const {
    for (const char letter : letters) {
      if (has(letter)) return find(letter)->column;
    }
    return 1;
  }

 private:
  static constexpr std::string_view known_letters = "GXYZABCIJRPFMN";

  /// Blanks and comments; false at the end.
  bool skip_nothings(TextCursor& cursor) {
    while (true) {
      cursor.skip_blanks();
      if (cursor.at_end() || cursor.peek() == ';') return false;
      if (cursor.peek() != '(') return true;
      const auto end = cursor.rest().find(')');
      if (end == std::string_view::npos) {
        wrongs_.push_back({cursor.column(), "')' is missing", {}, true});
        return false;
      }
      cursor.skip(end + 1);
    }
  }

  /// Also up to a comment: an expression such as #1=[2*3] is one word.
  static std::string_view up_to_blank(const TextCursor& cursor) {
    return cursor.rest().substr(0, cursor.rest().find_first_of(" \t\r\f\v;("));
  }

  void add(TextCursor& cursor) {
    const auto column = cursor.column();
    const auto text = cursor.rest();
    const auto word = up_to_blank(cursor);
    const char letter = upper(cursor.peek());
    cursor.skip();
    cursor.skip_blanks();
    const auto value = cursor.take_number(std::chars_format::fixed);
    if (known_letters.find(letter) == std::string_view::npos) {
      const bool is_word = value && is_letter(letter);
      const auto taken = is_word ? text.substr(0, cursor.column() - column) : word;
      if (!is_word) cursor.skip_to(column + word.size());
      wrongs_.push_back({column, fmt::format("'{}' is not known here", shown(taken)),
                         text.substr(0, 1), !is_word});
    } else if (!value) {
      add_missing_number(cursor, column, letter);
    } else {
      add(letter, {*value, column});
    }
  }

  void add_missing_number(TextCursor& cursor, std::size_t column, char letter) {
    auto message = fmt::format("a number is missing behind {}", letter);
    // What stands there instead may be long, such as #1 or [2*3].
    const auto instead = is_letter(cursor.peek()) ? std::string_view{} : up_to_blank(cursor);
    if (!instead.empty()) message += fmt::format("; '{}' is none", shown(instead));
    cursor.skip(instead.size());
    wrongs_.push_back({column, std::move(message), instead.substr(0, 1), true});
  }

  void add(char letter, const Word& read) {
    if (letter == 'G' || letter == 'M') return (letter == 'G' ? g_ : m_).push_back(read);
    auto& word = words_[static_cast<std::size_t>(letter - 'A')];
    if (word) {
      wrongs_.push_back(
          {read.column, fmt::format("{} stands twice on this line", letter), {}, true});
    }
    word = read;
  }

  std::vector<Wrong> wrongs_;
  std::vector<Word> g_;
  std::vector<Word> m_;
  std::array<std::optional<Word>, 26> words_{};
};

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

/// Replaces one arc after another.
class Flattener {
 public:
  Flattener(const Path& path, double tolerance)
      : path_(path), tolerance_(tolerance), at_(path.start) {}

  tl::expected<Path, std::string> run() {
    flat_.axes = path_.axes;
    flat_.start = path_.start;
    flat_.length_axes = path_.length_axes;
    for (const auto& element : path_.elements) {
      const auto* arc = std::get_if<ArcTo>(&element);
      if (arc == nullptr) {
        flat_.elements.push_back(element);
      } else if (const auto chords = chords_of(*arc)) {
        add_chords(*arc, *chords);
      } else {
        return tl::unexpected(fmt::format("line {}: an arc of so many chords; {} at most",
                                          arc->line, most_chords_of_an_arc));
      }
      if (const auto* line = std::get_if<LineTo>(&element)) at_ = line->target;
      if (arc != nullptr) at_ = arc->target;
      if (flat_.elements.size() > most_elements)
        return tl::unexpected(
            fmt::format("the path is too long; {} elements at most", most_elements));
    }
    return std::move(flat_);
  }

 private:
  // A chord of angle w is r * (1 - cos(w/2)) away from its arc.
  std::optional<std::size_t> chords_of(const ArcTo& arc) const {
    // A circle in fewer chords would be a line.
    constexpr double widest = std::numbers::pi / 2;
    const double radius =
        std::max(std::hypot(at_[0] - arc.centre_x, at_[1] - arc.centre_y),
                 std::hypot(arc.target[0] - arc.centre_x, arc.target[1] - arc.centre_y));
    // As 1 - cos(x) = 2 sin^2(x/2), which keeps its digits for small tolerances.
    const double sine = std::sqrt(std::min(1.0, tolerance_ / radius / 2));
    const double angle = std::min(widest, 4 * std::asin(sine));
    const double count = std::ceil(std::abs(arc.sweep) / angle - 1e-9);
    if (!(count <= static_cast<double>(most_chords_of_an_arc))) return std::nullopt;
    return std::max<std::size_t>(1, static_cast<std::size_t>(count));
  }

  void add_chords(const ArcTo& arc, std::size_t count) {
    const double begin = std::hypot(at_[0] - arc.centre_x, at_[1] - arc.centre_y);
    const double end = std::hypot(arc.target[0] - arc.centre_x, arc.target[1] - arc.centre_y);
    const double first = std::atan2(at_[1] - arc.centre_y, at_[0] - arc.centre_x);
    for (std::size_t i = 1; i < count; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(count);
      const double radius = begin + (end - begin) * part;
      const double angle = first + arc.sweep * part;
      LineTo chord{at_, arc.feed, {}, arc.line};
      for (std::size_t axis = 2; axis < most_axes; ++axis)
        chord.target[axis] += (arc.target[axis] - at_[axis]) * part;
      chord.target[0] = arc.centre_x + radius * std::cos(angle);
      chord.target[1] = arc.centre_y + radius * std::sin(angle);
      flat_.elements.emplace_back(chord);
    }
    flat_.elements.emplace_back(LineTo{arc.target, arc.feed, {}, arc.line});
  }

  const Path& path_;
  double tolerance_;
  Point at_;
  Path flat_;
};

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

tl::expected<Path, std::string> flatten(const Path& path, double tolerance) {
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    return tl::unexpected(
        fmt::format("the tolerance must be a finite number above 0, not {}", tolerance));
  return Flattener(path, tolerance).run();
}

}  // namespace tmcl::plan::path_file
