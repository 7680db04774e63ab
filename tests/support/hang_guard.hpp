/// Ends a program of tests when one of them takes too long, and names that.
#pragma once

#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace tmcl::test {

class HangGuard : public testing::EmptyTestEventListener {
 public:
  /// `most`: what each test may take.
  explicit HangGuard(std::chrono::milliseconds most) : most_(most) {}

  void OnTestStart(const testing::TestInfo& test) override {
    last_words() =
        std::string("hangs: ") + test.test_suite_name() + '.' + test.name() + ", ended\n";
    std::signal(SIGALRM, end);
    set_alarm(most_);
  }
  void OnTestEnd(const testing::TestInfo&) override { set_alarm(std::chrono::milliseconds(0)); }

 private:
  static std::string& last_words() {
    static std::string words;
    return words;
  }
  static void end(int) {
    const auto& words = last_words();
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, words.data(), words.size());
    ::_exit(EXIT_FAILURE);
  }
  static void set_alarm(std::chrono::milliseconds when) {
    const auto s = std::chrono::floor<std::chrono::seconds>(when);
    const itimerval timer{{}, {s.count(), std::chrono::microseconds(when - s).count()}};
    ::setitimer(ITIMER_REAL, &timer, nullptr);
  }

  std::chrono::milliseconds most_;
};

}  // namespace tmcl::test
