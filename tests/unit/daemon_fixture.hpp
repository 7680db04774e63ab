/// A daemon in the test's own process, on buses in memory whose modules the test plays, in virtual
/// time.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include <gtest/gtest.h>

#include "config/load.hpp"
#include "daemon.hpp"
#include "log/log.hpp"
#include "support/fake_module.hpp"
#include "support/rpc_client.hpp"
#include "tmcl/timer.hpp"
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
  /// What the modules say they are.
  std::uint16_t model = 3110;

  std::vector<tmcl::Request> seen;
  std::vector<tmcl::Request> held;

  void plug_in(const boost::asio::any_io_executor& executor, int descriptor) {
    end_ = std::make_shared<boost::asio::posix::stream_descriptor>(executor, descriptor);
    boost::asio::co_spawn(executor, serve(end_), boost::asio::detached);
  }
  void unplug() {
    if (end_) end_->close();
    end_.reset();
    held.clear();
  }
  void release() {
    holds = false;
    for (const auto& request : std::exchange(held, {})) answer(request);
  }
  std::size_t count(tmcl::Command command) const {
    return static_cast<std::size_t>(
        std::ranges::count(seen, command, [](const auto& request) { return request.command; }));
  }

 private:
  using End = std::shared_ptr<boost::asio::posix::stream_descriptor>;

  boost::asio::awaitable<void> serve(End end) {
    tmcl::SerialBytes bytes{};
    while (true) {
      boost::system::error_code error;
      co_await boost::asio::async_read(
          *end, boost::asio::buffer(bytes),
          boost::asio::redirect_error(boost::asio::use_awaitable, error));
      if (error) co_return;
      const auto request = tmcl::decode_serial_request(bytes);
      if (!request) continue;
      seen.push_back(*request);
      tmcl::Timer timer(end->get_executor());
      timer.expires_after(delay);
      co_await timer.async_wait(boost::asio::use_awaitable);
      if (holds) {
        held.push_back(*request);
      } else {
        answer(*request);
      }
    }
  }

  void answer(const tmcl::Request& request) {
    const auto module = modules.find(tmcl::reply_byte(request.address));
    if (module == modules.end() || !end_) return;
    auto reply = module->second.execute(request);
    if (request.command == tmcl::Command::GET_FIRMWARE_VERSION && !module->second.play) {
      reply.value = tmcl::to_value({model, 1, 9});
    }
    if (loses && loses(request)) return;
    const auto bytes = tmcl::encode_serial(reply);
    boost::system::error_code ignored;
    boost::asio::write(*end_, boost::asio::buffer(bytes), ignored);
  }

  End end_;
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
               WaitForSocket wait)
      : context_(std::move(context)), socket_(new_folder() + "/socket", std::move(wait)) {
    silence_log();
    // As in main().
    std::signal(SIGPIPE, SIG_IGN);
    const auto config = parse_config("[daemon]\nsocket = \"" + socket_.path + "\"\n" + toml);
    if (!config) throw std::runtime_error(config.error().front().message);
    for (const auto& bus : config->buses) {
      wires_[bus.name].modules.emplace(std::uint8_t{1}, FakeModule(1));
    }
    auto daemon = Daemon::create(*context_, *config, [this](const auto& bus) { return open(bus); });
    if (!daemon) throw std::runtime_error(daemon.error());
    daemon_ = std::move(*daemon);
  }
  PlayedDaemon(const PlayedDaemon&) = delete;
  PlayedDaemon& operator=(const PlayedDaemon&) = delete;
  /// When nothing runs the context any more.
  ~PlayedDaemon() {
    daemon_.reset();
    std::filesystem::remove_all(std::filesystem::path(socket_.path).parent_path());
  }
  /// Their descriptors must not outlive the context.
  void unplug_all() {
    for (auto& [name, wire] : wires_) wire.unplug();
  }
  bool is_ready() {
    return std::ranges::all_of(daemon_->gateway().axes(), [](const auto& axis) {
      return axis->module().state() == GatewayModule::State::ready;
    });
  }

 private:
  static std::string new_folder() {
    auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
    return ::mkdtemp(name.data());
  }

  tmcl::Result<tmcl::Link> open(const BusConfig& bus) {
    // Called on the bus' own thread, perhaps while the reactor is ending: it must not be waited
    // for.
    auto& wire = wires_.at(bus.name);
    if (wire.throws) throw std::runtime_error("injected");
    if (wire.is_absent) {
      tmcl::Error error;
      error.code = tmcl::Errc::link_open_failed;
      error.message = wire.why_absent;
      return tl::unexpected(std::move(error));
    }
    auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
    const int far = ::dup(ends->second.descriptor());
    boost::asio::post(*context_,
                      [this, &wire, far] { wire.plug_in(context_->get_executor(), far); });
    return std::move(ends->first);
  }

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
      const std::shared_ptr<VirtualReactor>& reactor = std::make_shared<VirtualReactor>())
      : PlayedDaemon({reactor, &reactor->context}, toml,
                     [this](int descriptor, short events, int wait_ms) {
                       return wait_for(descriptor, events, wait_ms);
                     }),
        time_(reactor->time) {}
  ~TestDaemon() {
    if (is_started_) end();
    unplug_all();
    run_for(std::chrono::seconds(1));
  }

  /// Serves; returns when its modules have been identified, unless told not to wait.
  void start(bool until_ready = true) {
    is_started_ = true;
    daemon().start();
    if (until_ready && !eventually([&] { return is_ready(); }))
      throw std::runtime_error("its modules do not answer");
  }
  void end() {
    daemon().stop();
    time_.run_while_not([&] { return daemon().has_ended(); }, std::chrono::hours(1));
  }

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
  bool wait_for(int descriptor, short events, int wait_ms) {
    const auto ready = [&] { return tmcl::test::wait_in_real_time(descriptor, events, 0); };
    const auto limit = now() + std::chrono::milliseconds(wait_ms);
    if (time_.run_while_not(ready, limit - now())) return true;
    time_.run_until(limit);
    return ready();
  }

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
