// Parameters 129, 132 and 133: a host waits until the closed loop is ready.
#include "sim/module/closed_loop.hpp"
#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t closed_loop_mode = 129;
constexpr std::uint8_t encoder_initialization = 132;
constexpr std::uint8_t closed_loop_init_flag = 133;
constexpr auto almost = ClosedLoop::calibration_time - milliseconds(1);

class SimClosedLoop : public SimTest {
 protected:
  void set(std::uint8_t parameter, std::int32_t value) {
    EXPECT_EQ(status_of(Command::SAP, parameter, 0, value), Status::ok);
  }
};

TEST_F(SimClosedLoop, InitializesTheEncoderWhenItIsToldTo) {
  add(1311);
  pass(std::chrono::seconds(10));
  EXPECT_EQ(get(encoder_initialization), 0);
  set(encoder_initialization, 1);
  pass(almost);
  EXPECT_EQ(get(encoder_initialization), 1);
  pass(milliseconds(1));
  EXPECT_EQ(get(encoder_initialization), 2);
  set(encoder_initialization, 0);
  EXPECT_EQ(get(encoder_initialization), 0);
}

TEST_F(SimClosedLoop, IsCalibratedOnceUntilItIsSwitchedOff) {
  std::uint16_t next = 1;
  for (const char* model : {"TMCM-1311", "TMCM-1378"}) {
    SCOPED_TRACE(model);
    const ModuleAddress address{next++};
    bench.add(*find_model(model), address);
    const auto write = [&](std::int32_t mode) {
      EXPECT_EQ(ask({address, Command::SAP, closed_loop_mode, 0, mode})->status, Status::ok);
    };
    const auto flag = [&] {
      return ask({address, Command::GAP, closed_loop_init_flag, 0, 0})->value;
    };
    EXPECT_EQ(flag(), 0);
    write(1);
    pass(almost);
    EXPECT_EQ(flag(), 0);
    write(1);
    pass(milliseconds(1));
    EXPECT_EQ(flag(), 1);
    write(0);
    EXPECT_EQ(flag(), 0);
  }
}

TEST_F(SimClosedLoop, ASpeedOfTheSameNumberIsNoEncoderThatGotReady) {
  add(1378);
  pass(std::chrono::seconds(10));
  EXPECT_EQ(get(encoder_initialization), 0);
}

}  // namespace
}  // namespace tmcl::sim
