// A path and a line end well with the limits of their axes, and never send what is beyond them.
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

// What the modules' own settings are, so that nothing is left to make up for deviations.
constexpr auto limits = "max_velocity = 23.4375\nmax_acceleration = 488.2736\n";

class LimitedPath : public DaemonPath {
 protected:
  LimitedPath() : DaemonPath(std::string(in_mm) + limits) {}

  /// Of all that y was told, and that is less.
  std::int32_t greatest_sent(Command command, std::uint8_t type,
                             std::int32_t below = std::numeric_limits<std::int32_t>::max()) {
    return daemon.on_reactor([&] {
      std::int32_t greatest = 0;
      for (const auto& request : daemon.wire().seen) {
        const bool is_one =
            request.command == command && request.type == type && request.motor == 1;
        if (is_one && std::abs(request.value) < below)
          greatest = std::max(greatest, std::abs(request.value));
      }
      return greatest;
    });
  }
  void expect_within() {
    EXPECT_LE(greatest_sent(Command::SAP, ap::max_velocity), own_velocity);
    EXPECT_LE(greatest_sent(Command::SAP, ap::max_acceleration), own_acceleration);
    EXPECT_LE(greatest_sent(Command::SAP, 17), own_acceleration);
  }
};

TEST_F(LimitedPath, EndsWellByVelocity) {
  client->result("path.run", order("G1 X4 Y20 F1400\nG1 X9 Y2\n"));
  EXPECT_NEAR(mm(1), 2, 0.01);
  EXPECT_GT(greatest_sent(Command::SAP, ap::max_velocity, own_velocity), own_velocity * 9 / 10);
  expect_within();
}

TEST_F(LimitedPath, EndsWellByPositions) {
  client->result("path.run", order("G1 X4 Y20 F1400\nG1 X9 Y2\n", {{"mode", "position"}}));
  EXPECT_NEAR(mm(1), 2, 0.01);
  expect_within();
}

// Legs are planned a little slower; axes that are behind are told up to the limit.
TEST_F(LimitedPath, GoesNoFasterThanWhatWasAskedFor) {
  constexpr auto asked = static_cast<std::int32_t>(12 * microsteps_per_mm);
  for (const auto* mode : {"velocity", "segments", "position"}) {
    client->result("path.run", order("G1 X4 Y20 F1400\nG1 X9 Y2\nG1 X0 Y0\n",
                                     {{"mode", mode}, {"velocity", "12mm/s"}}));
    const auto greatest = greatest_sent(Command::SAP, ap::max_velocity, own_velocity);
    EXPECT_LE(greatest, asked) << mode;
    EXPECT_GT(greatest, asked * 95 / 100) << mode;
  }
}

TEST_F(LimitedPath, IsRefusedWhileASettingIsBeyondThem) {
  on_module([](Played& played) { return played.set(1, ap::max_velocity, own_velocity + 1000), 0; });
  const auto error = error_of(client->send("path.run", order(short_way)));
  EXPECT_EQ(name_in(error), "not_permitted");
  EXPECT_FALSE(on_module([](Played& played) { return played.moves(); }));
}

TEST_F(LimitedPath, OfALineTheSettingsComeBack) {
  client->result("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{4, 1}}});
  client->result("axis.wait", {{"axis", "x"}});
  client->result("axis.wait", {{"axis", "y"}});
  daemon.run_for(std::chrono::seconds(2));
  expect_rest_and_own_settings();
  expect_within();
}

}  // namespace
}  // namespace tmcld::test
