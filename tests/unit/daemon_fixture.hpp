/// A daemon in the test's own process, on buses in memory whose modules the test plays, in virtual
/// time.
#pragma once

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>

#include <gtest/gtest.h>

#include "config/load.hpp"
#include "daemon.hpp"
#include "support/fake_module.hpp"
#include "support/rpc_client.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {

namespace json = boost::json;
using tmcl::test::DaemonSocket;
using tmcl::test::FakeModule;
using tmcl::test::RpcClient;
using tmcl::test::WaitForSocket;

/// The far end of one bus: modules, and the ways in which they do not answer. Lives on the
/// daemon's thread; a test looks at it through on_reactor() of the daemon.
class FakeWire {
 public:
  std::map<std::uint8_t, FakeModule> modules;
  /// While set, requests are taken and kept; release() answers them.
  bool holds = false;
  /// Asked about every request that is not held: whether the answer to it gets lost.
  std::function<bool(const tmcl::Request&)> loses;
  /// How long the modules take to answer. Some time, or who asks on and on in virtual time would
  /// never end.
  tmcl::Duration delay = std::chrono::milliseconds(1);
  /// While set, opening the link fails.
  std::atomic<bool> is_absent = false;
  std::string why_absent = "no such device";
  /// While set, opening the link throws.
  std::atomic<bool> throws = false;
  /// While set, the first module takes what is for any address, as on USB.
  bool takes_any_address = false;
  /// Comes where no module has the address.
  std::vector<std::uint8_t> stray_bytes;
  /// What the modules say they are.
  std::uint16_t model = 3110;

  std::vector<tmcl::Request> seen;
  std::vector<tmcl::Request> held;

  void plug_in(const boost::asio::any_io_executor& executor, int descriptor);
  void unplug();
  void release();
  std::size_t count(tmcl::Command command) const {
    return static_cast<std::size_t>(
        std::ranges::count(seen, command, [](const auto& request) { return request.command; }));
  }

 private:
  class End;

  boost::asio::awaitable<void> serve(std::shared_ptr<End> end);
  void answer(const tmcl::Request& request);

  std::shared_ptr<End> end_;
};

constexpr std::string_view bench_bus = R"(
[[bus]]
name = "bench"
link = "serial:/dev/none@115200"
reply_timeout_ms = 500
)";

/// On the bench; `more` are further lines.
inline std::string axis_section(const std::string& name, int motor, const std::string& more = {},
                                int module = 1) {
  return "[[axis]]\nname = \"" + name + "\"\nbus = \"bench\"\naddress = " + std::to_string(module) +
         "\nmotor = " + std::to_string(motor) + '\n' + more;
}

inline std::string two_axes() {
  return std::string(bench_bus) + axis_section("x", 0) + axis_section("y", 1);
}

/// A daemon and the modules that the test plays for it. Who inherits runs its context.
class PlayedDaemon {
 public:
  DaemonSocket socket() const { return socket_; }
  Daemon& daemon() { return *daemon_; }
  FakeWire& wire(const std::string& bus = "bench") { return wires_.at(bus); }

 protected:
  PlayedDaemon(std::shared_ptr<boost::asio::io_context> context, const std::string& toml,
               WaitForSocket wait);
  PlayedDaemon(const PlayedDaemon&) = delete;
  PlayedDaemon& operator=(const PlayedDaemon&) = delete;
  /// When nothing runs the context any more.
  ~PlayedDaemon();
  /// Their descriptors must not outlive the context.
  void unplug_all() {
    for (auto& [name, wire] : wires_) wire.unplug();
  }
  bool is_ready();

 private:
  tmcl::Result<tmcl::Link> open(const BusConfig& bus);

  std::shared_ptr<boost::asio::io_context> context_;
  DaemonSocket socket_;
  std::map<std::string, FakeWire> wires_;
  std::unique_ptr<Daemon> daemon_;
};

/// What a daemon and its modules go by.
struct VirtualReactor {
  boost::asio::io_context context{1};
  tmcl::VirtualTime time{context};
  tmcl::ContextClock clock{context};
};

/// On virtual time and the thread of the test: it works while the test waits, be it for an answer
/// to a client.
class TestDaemon : public PlayedDaemon {
 public:
  explicit TestDaemon(
      const std::string& toml = two_axes(),
      const std::shared_ptr<VirtualReactor>& reactor = std::make_shared<VirtualReactor>());
  ~TestDaemon();

  /// Serves; returns when its modules have been identified, unless told not to wait.
  void start(bool until_ready = true);
  void end();

  tmcl::TimePoint now() const { return time_.now(); }
  void run_for(tmcl::Duration duration) { time_.run_for(duration); }
  /// It does nothing meanwhile.
  void freeze_for(tmcl::Duration duration) { time_.freeze_for(duration); }
  /// What the function gives when all is done that can be done now.
  template <class Function>
  std::invoke_result_t<Function> on_reactor(Function function) {
    time_.settle();
    return function();
  }
  /// Waits until the function says so; false after ten seconds.
  template <class Condition>
  bool eventually(Condition condition) {
    constexpr auto look_interval = std::chrono::milliseconds(1);
    const auto end = now() + std::chrono::seconds(10);
    while (!on_reactor(condition)) {
      if (now() >= end) return false;
      run_for(look_interval);
    }
    return true;
  }
  std::size_t requests_seen() {
    return on_reactor([&] { return wire().seen.size(); });
  }
  std::size_t requests_seen(tmcl::Command command) {
    return on_reactor([&] { return wire().count(command); });
  }

 private:
  bool wait_for(int descriptor, short events, int wait_ms);

  tmcl::VirtualTime& time_;
  bool is_started_ = false;
};

struct ServingDaemon : TestDaemon {
  ServingDaemon() { start(); }
};

/// A daemon that serves, and one client.
class DaemonTest : public testing::Test {
 protected:
  ServingDaemon daemon;
  RpcClient client{daemon.socket()};
};

inline std::string text(const json::value& value) {
  const auto& string = value.as_string();
  return {string.data(), string.size()};
}

}  // namespace tmcld::test
