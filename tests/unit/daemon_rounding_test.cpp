// Distances in a unit: what is rounded does not add up.
#include <gmock/gmock.h>

#include "unit/daemon_scale_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

TEST_F(DaemonMechanics, AThousandTenthsOfAMillimetreAreAHundred) {
  const auto by = [&](double distance) {
    return target_of("axis.move_by",
                     {{"axis", "screw"}, {"distance", distance}, {"predict", false}});
  };
  const auto hundred = target_of("axis.move_to", {{"axis", "screw"}, {"position", 100}});
  client->result("axis.move_to", {{"axis", "screw"}, {"position", 0}});
  const auto tenth = by(0.1);
  std::int64_t there = tenth;
  for (int i = 1; i < 1000; ++i) there = by(0.1);
  EXPECT_EQ(there, hundred);
  EXPECT_NE(1000 * tenth, hundred) << "the scale is one where it matters";
  for (int i = 0; i < 1000; ++i) there = by(-0.1);
  EXPECT_EQ(there, 0);
}

TEST_F(DaemonMechanics, ADistanceCountsFromWhereTheAxisReallyIs) {
  client->result("axis.move_to", {{"axis", "free"}, {"position", 10.0003}});
  hold(2, 1, 500);  // somebody stopped it
  const auto expected = std::lround(500 + 0.1 * 3200 * 3.71 / 7.3);
  EXPECT_EQ(target_of("axis.move_by", {{"axis", "free"}, {"distance", 0.1}}), expected);
  client->result("axis.move_to", {{"axis", "free"}, {"position", 0.0003}});
  client->result("parameter.set", {{"axis", "free"}, {"parameter", 1}, {"value", 0}});
  EXPECT_EQ(target_of("axis.move_by", {{"axis", "free"}, {"distance", 1}}),
            std::lround(3200 * 3.71 / 7.3));
}

TEST_F(DaemonMechanics, ADistanceThatTheModuleCannotHoldIsRefused) {
  EXPECT_THAT(refusal("axis.move_by", {{"axis", "free"}, {"distance", 1e6}}),
              HasSubstr("1000000 mm is too far"));
  expect_nothing_sent();
}

// Those of application note AN00115, in counts of an encoder; a screw with a sixteenth of its turn
// for a mm, on which tenths of a mm end between two steps; and one that comes out at nothing even.
std::string scales() {
  return std::string(bench_bus) +
         axis_section("note", 0,
                      "unit = \"deg\"\nunits_per_revolution = 360\nfull_steps = 4000\n"
                      "microsteps = 1\nreverse = true\n") +
         axis_section("even", 1, "unit = \"mm\"\nscrew_pitch = 16\nmicrosteps = 1\n") +
         axis_section("odd", 2,
                      "unit = \"mm\"\nscrew_pitch = 7.3\ngear_ratio = 3.71\n"
                      "microsteps = 4\n");
}

class DaemonRounding : public DaemonScale {
 protected:
  explicit DaemonRounding(const std::string& axes = scales()) : DaemonScale(axes) {
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}})
      hold(motor, 1, 0);
  }
  std::int64_t move(std::string_view method, const std::string& axis, double way) {
    const auto* key = method == "axis.move_by" ? "distance" : "position";
    json::object params{{"axis", axis}, {"predict", false}};
    params[key] = way;
    return client->result(method, std::move(params)).at("target_microsteps").as_int64();
  }
  std::int64_t target_of(const std::string& axis, double position) {
    return move("axis.move_to", axis, position);
  }
  /// Ends where it began.
  void expect_no_drift(const std::string& axis) {
    constexpr int of_a_unit = 10;
    constexpr int moves = 1000;
    for (const int direction : {1, -1}) {
      target_of(axis, 0);
      std::vector<std::int64_t> there{0};
      for (int i = 0; i < moves; ++i) there.push_back(move("axis.move_by", axis, direction * 0.1));
      for (int i = of_a_unit; i <= moves; i += of_a_unit) {
        EXPECT_EQ(there.at(static_cast<std::size_t>(i)),
                  target_of(axis, direction * (i / of_a_unit)))
            << axis << ' ' << i << " moves";
      }
      target_of(axis, direction * 100);
      for (int i = 0; i < moves; ++i) there.back() = move("axis.move_by", axis, direction * -0.1);
      EXPECT_EQ(there.back(), 0) << axis;
    }
  }
};

TEST_F(DaemonRounding, TenthsThatAreNoWholeNumberOfMicrostepsDoNotAddUp) {
  for (const auto* axis : {"note", "even", "odd"}) expect_no_drift(axis);
}

TEST_F(DaemonRounding, TheScalesOfTheNoteAreExact) {
  EXPECT_EQ(target_of("note", 360), -4000);
  EXPECT_EQ(target_of("note", 90), -1000);
  EXPECT_EQ(target_of("note", 100), -1111);
  EXPECT_EQ(target_of("note", -0.09), 1);
  hold(0, 0, -4000);
  const auto state = client->result("axis.get_state", {{"axis", "note"}});
  EXPECT_EQ(state.at("target").to_number<double>(), 360);
}

// 1000 counts a mm of a linear encoder, and 1200 of one behind a gear of 3:1 and a pitch of 10 mm.
class DaemonNoteScale : public DaemonRounding {
 protected:
  DaemonNoteScale()
      : DaemonRounding(std::string(bench_bus) +
                       axis_section("linear", 0,
                                    "unit = \"mm\"\nscrew_pitch = 10\n"
                                    "full_steps = 10000\nmicrosteps = 1\n") +
                       axis_section("geared", 1,
                                    "unit = \"mm\"\nscrew_pitch = 10\n"
                                    "gear_ratio = 3\nfull_steps = 4000\n"
                                    "microsteps = 1\n") +
                       axis_section("third", 2)) {}
};

TEST_F(DaemonNoteScale, MillimetresAreWholeCounts) {
  EXPECT_EQ(target_of("linear", 1), 1000);
  EXPECT_EQ(target_of("linear", 0.0005), 1) << "ties go away from zero";
  EXPECT_EQ(target_of("linear", -123.456), -123'456);
  EXPECT_EQ(target_of("geared", 1), 1200);
  EXPECT_EQ(target_of("geared", 200), 240'000);
  EXPECT_EQ(target_of("geared", -0.1), -120);
  for (const auto* axis : {"linear", "geared"}) expect_no_drift(axis);
}

}  // namespace
}  // namespace tmcld::test
