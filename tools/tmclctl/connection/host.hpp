/// What a verb needs of the process it runs in: the time, waiting, and signals.
#pragma once

#include <optional>
#include <string>

#include "tmcl/clock.hpp"

namespace tmclctl {

class Host {
 public:
  virtual ~Host() = default;
  virtual tmcl::TimePoint now() const = 0;
  virtual tmcl::UtcTime utc() const = 0;
  /// Returns early when a signal comes.
  virtual void sleep(tmcl::Duration duration) = 0;
  /// From here on SIGINT, SIGTERM and SIGHUP are for the verb to notice; a second one ends the
  /// program all the same.
  virtual void catch_signals() = 0;
  /// The signal that asked to end; 0 if none did.
  virtual int signal() const = 0;
  /// The same, and from then on it counts as noticed: calls work again, and the next signal ends
  /// the program.
  virtual int take_signal() = 0;
  /// From here on Ctrl-Z (SIGTSTP) does not suspend the program: it asks for a pause, or for its
  /// end; SIGCONT asks for its end, too.
  virtual void catch_pauses() = 0;
  virtual bool pause_asked() const = 0;
  /// Whether a person on the terminal says yes; nothing if none is there.
  virtual std::optional<bool> confirm(const std::string& /*question*/) { return std::nullopt; }
  /// The next line of standard input without its end; nothing while it is not there. Never waits.
  virtual std::optional<std::string> take_line() { return std::nullopt; }
  /// No line comes any more.
  virtual bool has_input_ended() const { return true; }
};

/// Real time and real signals.
class RealHost final : public Host {
 public:
  tmcl::TimePoint now() const override { return clock_.now(); }
  tmcl::UtcTime utc() const override { return tmcl::RealClock::utc(); }
  void sleep(tmcl::Duration duration) override;
  void catch_signals() override;
  int signal() const override;
  int take_signal() override;
  void catch_pauses() override;
  bool pause_asked() const override;
  std::optional<bool> confirm(const std::string& question) override;
  std::optional<std::string> take_line() override;
  bool has_input_ended() const override { return input_ended_ && input_.empty(); }

 private:
  void read_input();

  tmcl::RealClock clock_;
  std::string input_;  ///< That is no line yet.
  bool input_ended_ = false;
};

}  // namespace tmclctl
