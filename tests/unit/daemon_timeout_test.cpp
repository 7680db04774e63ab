// A timeout of a call is by the clock, whatever the module takes for its answers.
#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using tmcl::Command;

class DaemonTimeout : public DaemonTest {
 protected:
  void answer_after(tmcl::Duration delay) {
    daemon.on_reactor([&] { return daemon.wire().delay = delay, 0; });
  }
  void when_asked(std::function<void(FakeModule&, const tmcl::Request&)> act) {
    daemon.on_reactor([&] { return daemon.wire().modules.at(1).before = std::move(act), 0; });
  }
  void expect_timeout(std::string_view method, int timeout_ms) {
    const auto error = client.error(method, {{"axis", "x"}, {"timeout_ms", timeout_ms}});
    EXPECT_EQ(text(error.at("data").at("name")), "deadline_passed") << error;
  }
  static bool asks_whether_reached(const tmcl::Request& request) {
    return request.command == Command::GAP &&
           request.type == tmcl::axis_parameter::position_reached;
  }
};

// The axis is there at the third look, for which there is no time: one look takes longer than the
// timeout.
TEST_F(DaemonTimeout, EndsAWaitHoweverLongTheLooksTake) {
  answer_after(60ms);
  std::atomic<int> looks = 0;
  when_asked([&](FakeModule& self, const tmcl::Request& request) {
    if (!asks_whether_reached(request)) return;
    const bool there = ++looks >= 3;
    self.parameter(0, tmcl::axis_parameter::position_reached) = there ? 1 : 0;
    self.parameter(0, tmcl::axis_parameter::actual_velocity) = there ? 0 : 500;
  });
  expect_timeout("axis.wait", 150);
  EXPECT_EQ(looks, 1);
}

// A home of 0.3 s would take silence_limit, which is 3 s, and end as another error.
TEST_F(DaemonTimeout, EndsASearchOfAModuleThatFallsSilent) {
  daemon.on_reactor([&] {
    daemon.wire().loses = [](const tmcl::Request& request) {
      return request.command == Command::RFS && request.type == 2;
    };
    return 0;
  });
  expect_timeout("axis.home", 300);
}

TEST_F(DaemonTimeout, EndsASearchHoweverLongTheLooksTake) {
  answer_after(60ms);
  std::atomic<int> looks = 0;
  when_asked([&](FakeModule& self, const tmcl::Request& request) {
    if (request.command != Command::RFS || request.type != 2) return;
    // Ended at the fifth look, 0.6 s after the start.
    if (++looks < 5) self.execute_quietly({request.address, Command::RFS, 0, request.motor, 0});
  });
  expect_timeout("axis.home", 250);
  EXPECT_LE(looks, 3) << "60 ms each, and pauses of 50 ms";
}

}  // namespace
}  // namespace tmcld::test
