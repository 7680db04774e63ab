// Programs of random shape: a path is drawn in positions of the axes, and written in whatever
// planes, units, coordinate systems, distances, centres and feeds hold at the moment. What is read
// is what was drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

constexpr double turn = 2 * std::numbers::pi;
using Place = std::array<double, 3>;

/// A movement as it was drawn.
struct Drawn {
  std::vector<Place> points;  ///< Of it, close together; the last is its end.
  double length = 0;
  double feed = 0;  ///< 0: a rapid.
};

/// How a feed is said.
enum class Feed : std::uint8_t { per_minute, inverse, per_turn };

class Writer {
 public:
  explicit Writer(tmcl::test::Random<>& random) : random_(random) {}

  const std::string& text() const { return text_; }
  const std::vector<Drawn>& drawn() const { return drawn_; }

  void step() {
    switch (random_.between(0, 11)) {
      case 0: return change_modes();
      case 1: return change_feed();
      case 2: return set_system();
      case 3: return shift();
      case 4: return store_or_go();
      case 5: return in_machine();
      case 6:
      case 7: return line();
      default: return arc();
    }
  }

 private:
  // ---- words ----

  void write(std::vector<std::string> words) {
    const bool has_speed = std::ranges::any_of(words, [](auto& word) { return word[0] == 'S'; });
    if (!has_speed && random_.one_in(3)) words.emplace_back("S1200");
    if (random_.one_in(5)) words.emplace_back("M8");
    // Words stand in any order.
    for (std::size_t i = words.size(); i > 1; --i)
      std::swap(
          words[i - 1],
          words[static_cast<std::size_t>(random_.between(0, static_cast<std::int64_t>(i) - 1))]);
    if (random_.one_in(4)) text_ += "N10 ";
    for (auto& word : words) {
      if (random_.one_in(4)) word[0] = static_cast<char>(word[0] - 'A' + 'a');
      text_ += word + (random_.one_in(3) ? "" : " ");
    }
    text_ += random_.one_in(5) ? "(and on)\n" : "\n";
  }
  std::string word(char letter, double mm) const {
    return fmt::format("{}{:.9f}", letter, mm / unit_);
  }
  /// Where an axis counts from.
  double origin(std::size_t axis) const { return systems_[system_][axis] + shift_[axis]; }
  void add_target(std::vector<std::string>& words, const Place& target, bool all) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!all && target[axis] == at_[axis]) continue;
      const double from = relative_ ? at_[axis] : origin(axis);
      words.push_back(word("XYZ"[axis], target[axis] - from));
    }
  }
  double any(double most) {
    return static_cast<double>(random_.between(-1'000'000, 1'000'000)) * most / 1e6;
  }
  Place any_place() { return {any(100), any(100), any(100)}; }

  // ---- what moves nothing ----

  void change_modes() {
    unit_ = random_.one_in(2) ? 25.4 : 1;
    relative_ = random_.one_in(2);
    absolute_centres_ = random_.one_in(2);
    plane_ = static_cast<std::size_t>(random_.between(0, 2));
    system_ = static_cast<std::size_t>(random_.between(0, 5));
    write({unit_ == 1 ? "G21" : "G20", relative_ ? "G91" : "G90",
           absolute_centres_ ? "G90.1" : "G91.1", fmt::format("G{}", 17 + plane_),
           fmt::format("G{}", 54 + system_)});
  }
  void change_feed() {
    feed_ = static_cast<Feed>(random_.between(0, 2));
    write({fmt::format("G{}", feed_ == Feed::inverse ? 93 : feed_ == Feed::per_minute ? 94 : 95)});
  }
  void set_system() {
    const auto system = static_cast<std::size_t>(random_.between(0, 5));
    const auto axis = static_cast<std::size_t>(random_.between(0, 2));
    const double value = any(50);
    const bool by_place = random_.one_in(2);
    // What is said of the system that holds may be said of P0.
    const auto number = system == system_ && random_.one_in(2) ? 0 : system + 1;
    write({"G10", by_place ? "L20" : "L2", fmt::format("P{}", number), word("XYZ"[axis], value)});
    systems_[system][axis] = by_place ? at_[axis] - shift_[axis] - value : value;
  }
  void shift() {
    const auto axis = static_cast<std::size_t>(random_.between(0, 2));
    const double value = any(50);
    switch (random_.between(0, 4)) {
      case 0:
        write({"G92.1"});
        shift_ = kept_ = {};
        return;
      case 1:
        write({"G92.2"});
        shift_ = {};
        return;
      case 2:
        write({"G92.3"});
        shift_ = kept_;
        return;
      case 3:
        write({"G52", word("XYZ"[axis], value)});
        shift_[axis] = kept_[axis] = value;
        return;
      default:
        write({"G92", word("XYZ"[axis], value)});
        shift_[axis] = kept_[axis] = at_[axis] - systems_[system_][axis] - value;
    }
  }

  // ---- what moves ----

  void go(const Place& target, double feed) {
    if (target == at_) return;
    drawn_.push_back({{target}, distance(at_, target), feed});
    at_ = target;
  }
  static double distance(const Place& one, const Place& other) {
    return std::hypot(one[0] - other[0], one[1] - other[1], one[2] - other[2]);
  }
  void store_or_go() {
    const auto which = static_cast<std::size_t>(random_.between(0, 1));
    const std::string code = which == 0 ? "G28" : "G30";
    if (random_.one_in(2)) {
      write({code + ".1"});
      stored_[which] = at_;
      return;
    }
    auto by = at_;
    const auto axis = static_cast<std::size_t>(random_.between(0, 2));
    by[axis] = any(100);
    std::vector<std::string> words{code};
    if (random_.one_in(3)) {
      write(words);
      return go(stored_[which], 0);
    }
    add_target(words, by, false);
    write(words);
    go(by, 0);
    by[axis] = stored_[which][axis];
    go(by, 0);
  }
  void in_machine() {
    auto target = at_;
    const auto axis = static_cast<std::size_t>(random_.between(0, 2));
    target[axis] = any(100);
    write({"G53", "G0", word("XYZ"[axis], target[axis])});
    go(target, 0);
  }
  void line() {
    const auto target = any_place();
    const bool rapid = random_.one_in(2);
    std::vector<std::string> words{rapid ? "G0" : "G1"};
    add_target(words, target, true);
    const double feed = rapid ? 0 : add_feed(words, distance(at_, target));
    write(words);
    go(target, feed);
  }
  double add_feed(std::vector<std::string>& words, double length) {
    const auto number = static_cast<double>(random_.between(1, 500));
    words.push_back(fmt::format("F{}", number));
    if (feed_ == Feed::inverse) return length * number / 60;
    if (feed_ == Feed::per_minute) return number * unit_ / 60;
    words.push_back("S90");
    return number * unit_ * 90 / 60;
  }
  void arc() {
    const std::array<std::size_t, 2> axes{std::array<std::size_t, 3>{0, 2, 1}[plane_],
                                          std::array<std::size_t, 3>{1, 0, 2}[plane_]};
    const std::size_t third = 3 - axes[0] - axes[1];
    const std::complex<double> from(at_[axes[0]], at_[axes[1]]);
    const double radius = 0.5 + std::abs(any(40));
    const auto centre = from + std::polar(radius, any(turn / 2));
    const bool clockwise = random_.one_in(2);
    const auto turns = random_.one_in(3) ? random_.between(1, 4) : 1;
    const bool whole = random_.one_in(4);
    const double part = whole ? turn : 0.2 + std::abs(any(turn - 0.4));
    const double sweep = (part + static_cast<double>(turns - 1) * turn) * (clockwise ? -1 : 1);
    const double rise = random_.one_in(2) ? any(20) : 0;

    Drawn drawn;
    constexpr int pieces = 4000;
    for (int i = 1; i <= pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      const auto there = centre + (from - centre) * std::polar(1.0, sweep * share);
      auto point = at_;
      point[axes[0]] = there.real();
      point[axes[1]] = there.imag();
      point[third] += rise * share;
      drawn.points.push_back(point);
    }
    auto& target = drawn.points.back();
    if (whole) target[axes[0]] = from.real(), target[axes[1]] = from.imag();
    drawn.length = std::hypot(radius * sweep, rise);

    std::vector<std::string> words{clockwise ? "G2" : "G3"};
    add_target(words, target, !whole || random_.one_in(2));
    if (turns > 1) words.push_back(fmt::format("P{}", turns));
    // Where its ends are nearly opposite, a radius hardly says where the centre is.
    const bool by_radius = !whole && random_.one_in(3) && std::abs(part - turn / 2) > 0.3;
    if (by_radius) {
      words.push_back(word('R', part < turn / 2 ? radius : -radius));
    } else {
      const std::array<double, 2> place{centre.real(), centre.imag()};
      for (std::size_t i = 0; i < 2; ++i) {
        const double base = absolute_centres_ ? origin(axes[i]) : at_[axes[i]];
        words.push_back(word("IJK"[axes[i]], place[i] - base));
      }
    }
    drawn.feed = add_feed(words, drawn.length);
    write(words);
    at_ = target;
    drawn_.push_back(std::move(drawn));
  }

  tmcl::test::Random<>& random_;
  std::string text_;
  std::vector<Drawn> drawn_;
  Place at_{};
  std::array<Place, 6> systems_{};
  std::array<Place, 2> stored_{};
  Place shift_{}, kept_{};
  std::size_t system_ = 0, plane_ = 0;
  double unit_ = 1;
  bool relative_ = false, absolute_centres_ = false;
  Feed feed_ = Feed::per_minute;
};

/// With X, Y and Z, whatever the program moves.
Place place_of(const Path& path, const Point& point) {
  Place place{};
  for (std::size_t i = 0; i < path.axes.size(); ++i)
    place[gcode_axes.find(path.axes[i].front())] = point[i];
  return place;
}

struct Bounds {
  Place least{}, greatest{};
  void take(const Place& place) {
    for (std::size_t i = 0; i < 3; ++i) {
      least[i] = std::min(least[i], place[i]);
      greatest[i] = std::max(greatest[i], place[i]);
    }
  }
};

void expect_near(const Place& one, const Place& other, double tolerance, const std::string& text) {
  for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(one[i], other[i], tolerance) << text;
}

void expect_elements(const Path& path, const std::vector<Drawn>& drawn, const std::string& text) {
  ASSERT_EQ(path.elements.size(), drawn.size()) << text;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const auto* line = std::get_if<LineTo>(&path.elements[i]);
    const auto* arc = std::get_if<ArcTo>(&path.elements[i]);
    ASSERT_TRUE(line != nullptr || arc != nullptr) << text;
    expect_near(place_of(path, line != nullptr ? line->target : arc->target),
                drawn[i].points.back(), 1e-5, text);
    const double feed = line != nullptr ? line->feed.value_or(0) : arc->feed;
    ASSERT_NEAR(feed, drawn[i].feed, 1e-4 * (1 + drawn[i].feed)) << text;
  }
}

void expect_way(const Path& path, const std::vector<Drawn>& drawn, const std::string& text) {
  const auto flat = flatten(path, 1e-4);
  ASSERT_TRUE(flat) << flat.error();
  Bounds read, expected;
  double length = 0, expected_length = 0;
  Place at{};
  for (const auto& element : flat->elements) {
    const auto place = place_of(*flat, std::get<LineTo>(element).target);
    length += std::hypot(place[0] - at[0], place[1] - at[1], place[2] - at[2]);
    at = place;
    read.take(at);
  }
  for (const auto& movement : drawn) {
    expected_length += movement.length;
    for (const auto& point : movement.points) expected.take(point);
  }
  ASSERT_NEAR(length, expected_length, 1e-4 * expected_length + 1e-4) << text;
  expect_near(read.least, expected.least, 1e-3, text);
  expect_near(read.greatest, expected.greatest, 1e-3, text);
}

TEST(GcodeProperty, WhatIsReadIsWhatWasDrawn) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 300; ++round) {
    Writer writer(random);
    for (auto n = random.between(1, 30); n > 0; --n) writer.step();
    const auto path = read_gcode(writer.text());
    ASSERT_TRUE(path) << describe(path.error().front(), "text") << '\n' << writer.text();
    expect_elements(*path, writer.drawn(), writer.text());
    if (!HasFatalFailure()) expect_way(*path, writer.drawn(), writer.text());
    if (HasFatalFailure()) return;
  }
}

// What is skipped leaves what is known as it is.
TEST(GcodeProperty, UnknownWordsChangeNothingElse) {
  tmcl::test::Random<> random(tmcl::test::seed());
  static constexpr std::array unknown{"E5",     "D1",      "M48",       "M120 P5",
                                      "G41 D2", "G131",    "G81 X5 R2", "G16 X1 Y2",
                                      "U1 V2",  "M92 X80", "G43 H3"};
  for (int round = 0; round < 100; ++round) {
    Writer writer(random);
    for (auto n = random.between(1, 20); n > 0; --n) writer.step();
    std::string text;
    for (const char c : writer.text()) {
      text += c;
      if (c != '\n' || !random.one_in(3)) continue;
      text += unknown[static_cast<std::size_t>(random.between(0, unknown.size() - 1))];
      text += '\n';
    }
    const auto path = read_gcode(text, {}, {Unknowns::skipped});
    ASSERT_TRUE(path) << describe(path.error().front(), "text") << '\n' << text;
    expect_elements(*path, writer.drawn(), text);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl::plan::path_file
