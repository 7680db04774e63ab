/// tmclctl without a process around it, on a gateway and simulated modules in the same process, in
/// virtual time. What tells and what moves is that of tmcld: a verb and its method cannot differ.
#pragma once

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/json.hpp>

#include "command_line/tmclctl.hpp"
#include "connection/host.hpp"
#include "tmcl/command.hpp"

namespace tmcl::sim {
class Module;
}

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

/// On the bus "bench"; `more` are further lines.
std::string axis_section(const std::string& name, int address, int motor = 0,
                         const std::string& more = {});

// Inline: other sources make constants of them.
/// Of the bus "bench": a serial line.
inline const std::string bench_of_ctl =
    "[[bus]]\nname = \"bench\"\nlink = \"serial:/dev/none@115200\"\n";
/// Axis "x" is the motor of module 1, without a unit.
inline const std::string plain_axis = bench_of_ctl + axis_section("x", 1);
/// The same, whose unit is a mm of 10240 microsteps.
inline const std::string axis_in_mm = plain_axis + "unit = \"mm\"\nunits_per_revolution = 5\n";

/// On its serial lines are a TMCM-1110 with address 1, and what the test adds. It is opened by the
/// first call: a verb that asks no gateway costs nothing.
class CtlBench {
  class World;
  std::shared_ptr<World> world_;

 public:
  /// `toml`: sections of a configuration, without [daemon].
  explicit CtlBench(std::string toml = plain_axis, const char* model = "TMCM-1110");
  ~CtlBench();
  CtlBench(const CtlBench&) = delete;
  CtlBench& operator=(const CtlBench&) = delete;

  FakeHost& host;
  Gateway gateway;
  Screen screen;  ///< Both streams'. A plain file, unless the test says otherwise.
  std::string out;
  std::string err;
  std::vector<std::string> calls;  ///< "METHOD PARAMS" of all that tmclctl has made.

  ExitCode run(const std::vector<std::string>& arguments);
  /// Runs with --json and reads the one document.
  boost::json::object json(std::vector<std::string> arguments, ExitCode expected = ExitCode::done);

  /// Of the calls, those that more than observe.
  std::vector<std::string> orders() const;
  /// Of the calls, those of one method.
  std::vector<std::string> calls_of(std::string_view method) const;

  // ---- the modules
  tmcl::sim::Module& module(std::uint8_t address = 1);
  tmcl::sim::Module& add(const char* model, std::uint8_t address);
  /// A command over another line, at once; what it answers. Throws if the module refuses it.
  std::int32_t execute(tmcl::Command command, std::uint8_t type, std::uint8_t motor,
                       std::int32_t value, std::uint8_t address = 1);
  /// Of an axis, the same way.
  std::int32_t get(std::string_view parameter, std::uint8_t motor = 0, std::uint8_t address = 1);
  void set(std::string_view parameter, std::int32_t value, std::uint8_t motor = 0,
           std::uint8_t address = 1);
  /// It stands, and counts from here.
  void place(std::int32_t position, std::uint8_t motor = 0);

  // ---- the gateway
  /// Opens it, unless it is open.
  void open();
  /// The wires are cut, and new ones cannot be plugged in for this reason; empty: they can. Of one
  /// bus, or of all.
  void cut_wires(std::string why, const std::string& bus = {});
  /// Serial lines that are opened from now on give back what is said on them.
  void let_lines_echo();
  /// Every call of the method ends with this error, as where its connection fails; nothing: as it
  /// is.
  void fail(std::string_view method, std::optional<Error> error);
  /// The same for every call.
  void fail_all(std::optional<Error> error) { fail("", std::move(error)); }
  /// What the gateway answers to the method is changed, to what none of these modules has.
  void amend(std::string_view method, std::function<void(boost::json::object&)> change);
  /// The connection is lost, and it is asked for so often in vain.
  void lose_connection(int away_for);

  // ---- others
  void pass(tmcl::Duration duration) { host.sleep(duration); }
  /// While tmclctl runs.
  void after(tmcl::Duration duration, std::function<void()> event);
  /// A call of another client, which waits for its end.
  Result<boost::json::object> other(std::string_view method, boost::json::object params);
  /// The same while tmclctl runs.
  void other_after(tmcl::Duration duration, std::string_view method, boost::json::object params);
};

}  // namespace tmclctl::test
