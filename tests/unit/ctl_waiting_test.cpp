// Who opens a port waits a little for a program that is about to make it, in virtual time.
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line/tmclctl.hpp"
#include "support/pty.hpp"
#include "support/temp_path.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;

/// While someone sleeps, something happens at some instant.
class EventfulHost final : public Host {
 public:
  tmcl::TimePoint now() const override { return clock_.now(); }
  tmcl::UtcTime utc() const override { return tmcl::UtcTime(clock_.now().time_since_epoch()); }
  void sleep(tmcl::Duration duration) override {
    clock_.advance(duration);
    if (event_ && passed() >= event_at_) std::exchange(event_, {})();
  }
  void catch_signals() override {}
  int signal() const override { return signal_; }
  int take_signal() override { return std::exchange(signal_, 0); }
  void catch_pauses() override {}
  bool pause_asked() const override { return false; }

  void after(tmcl::Duration at, std::function<void()> event) {
    event_at_ = at;
    event_ = std::move(event);
  }
  void press_ctrl_c() { signal_ = SIGINT; }
  tmcl::Duration passed() const { return clock_.now() - began_; }

 private:
  tmcl::VirtualClock clock_;
  tmcl::TimePoint began_ = clock_.now();
  tmcl::Duration event_at_{};
  std::function<void()> event_;
  int signal_ = 0;
};

class CtlWaiting : public testing::Test {
 protected:
  ~CtlWaiting() override { std::filesystem::remove(port); }

  /// Why it cannot be opened; empty if it can.
  std::string open(const std::string& path) {
    Where where;
    where.direct = "serial:" + path + "@115200";
    const auto gateway = open_gateway(where, usual_wait, host);
    return gateway ? std::string{} : gateway.error().message;
  }
  ExitCode run(std::vector<std::string> words) {
    words.insert(words.begin(), {"--direct", "serial:" + port + "@115200"});
    std::ostringstream text;
    Output output{text, text, {}, {}};
    return tmclctl::run(words, output, host);
  }

  EventfulHost host;
  tmcl::test::Pty pty;
  const std::string port = tmcl::test::temp_path("port");
};

TEST_F(CtlWaiting, ASerialPortThatIsMadeALittleLaterIsOpened) {
  host.after(milliseconds(500), [&] { std::filesystem::create_symlink(pty.path(), port); });
  EXPECT_EQ(open(port), "");
  EXPECT_EQ(host.passed(), milliseconds(500));
}

TEST_F(CtlWaiting, ALinkToAPtyThatIsGoneIsReplaced) {
  std::filesystem::create_symlink("/nowhere/pty", port);
  host.after(milliseconds(100), [&] {
    std::filesystem::remove(port);
    std::filesystem::create_symlink(pty.path(), port);
  });
  EXPECT_EQ(open(port), "");
}

TEST_F(CtlWaiting, APortThatStaysAwaySaysHowLongItWasWaitedFor) {
  EXPECT_THAT(open(port), HasSubstr("No such file or directory (waited 2.0 s for it)"));
  EXPECT_EQ(host.passed(), usual_wait);
}

TEST_F(CtlWaiting, WhatCannotComeRightIsToldAtOnce) {
  EXPECT_THAT(open("/nowhere/port"), Not(HasSubstr("waited")));
  std::ofstream(port) << "no terminal";
  EXPECT_THAT(open(port), Not(HasSubstr("waited")));
  EXPECT_EQ(host.passed(), tmcl::Duration{});
}

TEST_F(CtlWaiting, CtrlCEndsTheWaiting) {
  host.after(milliseconds(100), [&] { host.press_ctrl_c(); });
  EXPECT_THAT(open(port), HasSubstr("No such file or directory (waited 0.1 s for it)"));
}

TEST_F(CtlWaiting, AStopWaitsLessAndTheShellNotAtAll) {
  EXPECT_EQ(run({"__complete", "axes"}), ExitCode::not_sent);
  EXPECT_EQ(host.passed(), tmcl::Duration{});
  EXPECT_EQ(run({"stop", "1/0"}), ExitCode::not_sent);
  EXPECT_EQ(host.passed(), wait_before_stop);
  EXPECT_EQ(run({"get", "1/0", "actual_position"}), ExitCode::not_sent);
  EXPECT_EQ(host.passed(), wait_before_stop + usual_wait);
}

}  // namespace
}  // namespace tmclctl::test
