// A timeout of a call is by the clock, whatever the module takes for its answers. In virtual time,
// and so to the millisecond.
#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

class DaemonTimeout : public testing::Test {
 protected:
  void when_asked(std::function<void(FakeModule&, const tmcl::Request&)> act) {
    gateway.wire.modules.at(1).before = std::move(act);
  }
  /// `late`: how much later than the timeout the answer may come.
  void expect_timeout(std::string_view method, std::chrono::milliseconds timeout,
                      tmcl::Duration late) {
    const auto began = gateway.time.now();
    const auto result = gateway.call(method, {{"axis", "x"}, {"timeout_ms", timeout.count()}});
    const auto took = gateway.time.now() - began;
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().name, "deadline_passed") << result.error().message;
    EXPECT_GE(took, timeout);
    EXPECT_LE(took, timeout + late);
  }
  static bool asks_whether_reached(const tmcl::Request& request) {
    return request.command == Command::GAP &&
           request.type == tmcl::axis_parameter::position_reached;
  }

  VirtualGateway gateway;
};

// The axis is there at the third look, for which there is no time: one look takes longer than the
// timeout.
TEST_F(DaemonTimeout, EndsAWaitHoweverLongTheLooksTake) {
  gateway.wire.delay = 60ms;
  int looks = 0;
  when_asked([&](FakeModule& self, const tmcl::Request& request) {
    if (!asks_whether_reached(request)) return;
    const bool there = ++looks >= 3;
    self.parameter(0, tmcl::axis_parameter::position_reached) = there ? 1 : 0;
    self.parameter(0, tmcl::axis_parameter::actual_velocity) = there ? 0 : 500;
  });
  expect_timeout("axis.wait", 150ms, 60ms);
  EXPECT_EQ(looks, 1);
}

// A home of 0.3 s would take silence_limit, which is 3 s, and end as another error.
/// What the commands that stop a search take, of a module that answers at once.
constexpr auto time_to_stop = 20ms;

TEST_F(DaemonTimeout, EndsASearchOfAModuleThatFallsSilent) {
  gateway.wire.loses = [](const tmcl::Request& request) {
    return request.command == Command::RFS && request.type == 2;
  };
  // The look in progress ends with the reply timeout of the bus, and then the search is stopped.
  expect_timeout("axis.home", 300ms, 200ms + time_to_stop);
}

TEST_F(DaemonTimeout, EndsASearchHoweverLongTheLooksTake) {
  gateway.wire.delay = 60ms;
  int looks = 0;
  when_asked([&](FakeModule& self, const tmcl::Request& request) {
    if (request.command != Command::RFS || request.type != 2) return;
    // Ended at the fifth look, 0.6 s after the start.
    if (++looks < 5) self.execute_quietly({request.address, Command::RFS, 0, request.motor, 0});
  });
  expect_timeout("axis.home", 250ms, 60ms + 2 * 60ms);
  EXPECT_LE(looks, 3) << "60 ms each, and pauses of 50 ms";
}

}  // namespace
}  // namespace tmcld::test
