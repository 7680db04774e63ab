/// What tmclctl has around it in tests: time that passes only while it waits, and Ctrl-C.
#pragma once

#include <algorithm>
#include <csignal>
#include <deque>
#include <optional>
#include <string>

#include "connection/host.hpp"

namespace tmclctl::test {

/// Time passes only while someone sleeps. May be told to press Ctrl-C at some instant.
class FakeHost : public Host {
 public:
  tmcl::TimePoint now() const override { return now_; }
  tmcl::UtcTime utc() const override { return tmcl::UtcTime(now().time_since_epoch()); }
  void sleep(tmcl::Duration duration) override { now_ += std::max(duration, tmcl::Duration{}); }
  void catch_signals() override { caught_ = true; }
  int signal() const override { return caught_ && now() >= ctrl_c_at_ ? SIGINT : 0; }
  int take_signal() override {
    const int number = signal();
    if (number != 0) ctrl_c_at_ = never_;
    return number;
  }
  void catch_pauses() override {}
  bool pause_asked() const override { return false; }
  std::optional<std::string> take_line() override {
    if (lines.empty()) return std::nullopt;
    auto line = lines.front();
    lines.pop_front();
    return line;
  }
  bool has_input_ended() const override { return lines.empty() && ctrl_c_at_ == never_; }

  /// On standard input, which ends then, unless Ctrl-C is to come.
  std::deque<std::string> lines;

  void press_ctrl_c_after(tmcl::Duration duration) { ctrl_c_at_ = now() + duration; }

 protected:
  /// When one comes; never, if none does.
  tmcl::TimePoint signal_time() const { return caught_ ? ctrl_c_at_ : never_; }

 private:
  static constexpr tmcl::TimePoint never_ = tmcl::TimePoint::max();

  tmcl::TimePoint now_{std::chrono::hours(1)};
  tmcl::TimePoint ctrl_c_at_ = never_;
  bool caught_ = false;
};

}  // namespace tmclctl::test
