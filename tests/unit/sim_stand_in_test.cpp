// Modules whose ramps a sixPoint generator makes in place of a TMC4361 or of the firmware.
#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::milliseconds;
using std::chrono::seconds;

class SimStandIn : public SimTest {
 protected:
  Status set(std::uint8_t parameter, std::int32_t value) {
    return status_of(Command::SAP, parameter, 0, value);
  }
};

TEST_F(SimStandIn, MovesWithTheEdgesOfATmc4361) {
  add(1111);
  set(ap::max_velocity, 100'000);
  set(ap::max_acceleration, 100'000);
  set(17, 200'000);
  ask(Command::MVP, 0, 0, 1'000'000);
  pass(seconds(1));
  EXPECT_NEAR(get(ap::actual_position), 50'000, 100);
  EXPECT_NEAR(get(ap::actual_velocity), 100'000, 200);
  pass(seconds(10));
  EXPECT_EQ(get(ap::actual_position), 1'000'000);
}

TEST_F(SimStandIn, StartsSlowlyUpToTheBreakVelocity) {
  add(1111);
  set(ap::max_acceleration, 100'000);
  set(16, 10'000);  // start acceleration
  set(18, 5'000);   // break velocity
  set(ap::max_velocity, 50'000);
  ask(Command::MVP, 0, 0, 1'000'000);
  pass(milliseconds(500));
  // Its accelerations are multiples of 116 pps/s, not above what was set: the velocity is up to 58
  // behind, which the first ramp makes up for in 6 ms, in which the second one makes 600.
  EXPECT_NEAR(get(ap::actual_velocity), 5'000, 60);
  pass(milliseconds(100));
  EXPECT_NEAR(get(ap::actual_velocity), 15'000, 600);
}

TEST_F(SimStandIn, ReadsWhatWasWrittenEvenWhereTheStandInGoesLessFar) {
  add(1111);
  EXPECT_EQ(set(15, 4'000'000), Status::ok);
  EXPECT_EQ(get(15), 4'000'000);
  EXPECT_EQ(set(15, -1), Status::invalid_value);
  EXPECT_EQ(set(ap::max_velocity, 8'388'607), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 8'388'607);
  EXPECT_EQ(set(ap::max_velocity, 8'388'608), Status::invalid_value);
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 8'388'607), Status::ok);
  EXPECT_EQ(status_of(Command::ROL, 0, 0, 8'388'608), Status::invalid_value);
}

TEST_F(SimStandIn, FirmwareSlowsDownAsItAccelerates) {
  add(1021);
  set(ap::max_velocity, 20'000);
  set(ap::max_acceleration, 20'000);
  ask(Command::MVP, 0, 0, 40'000);
  pass(seconds(2));
  EXPECT_NEAR(get(ap::actual_velocity), 20'000, 100);
  pass(milliseconds(500));
  EXPECT_NEAR(get(ap::actual_velocity), 10'000, 200);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_position), 40'000);
  EXPECT_EQ(get(ap::position_reached), 1);
}

TEST_F(SimStandIn, CountsInMicrostepsPerSecondAlways) {
  add(1021);
  EXPECT_EQ(set(255, 0), Status::wrong_type);
  ask(Command::ROL, 0, 0, 5'000);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -5'000);
  EXPECT_EQ(get(ap::target_velocity), -5'000);
  ask(Command::MST, 0, 0);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

}  // namespace
}  // namespace tmcl::sim
