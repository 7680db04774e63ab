/// A daemon in the test's own process, on buses in memory whose modules the test plays.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <thread>
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

namespace tmcld::test {

namespace json = boost::json;
using tmcl::test::FakeModule;
using tmcl::test::RpcClient;

/// The far end of one bus: modules, and the ways in which they do not answer. Lives on the
/// daemon's thread; a test looks at it through TestDaemon::on_reactor().
class FakeWire {
 public:
  std::map<std::uint8_t, FakeModule> modules;
  /// While set, requests are taken and kept; release() answers them.
  bool holds = false;
  /// Asked about every request that is not held: whether the answer to it gets lost.
  std::function<bool(const tmcl::Request&)> loses;
  /// How long the modules take to answer.
  tmcl::Duration delay{};
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
      if (delay > tmcl::Duration{}) {
        tmcl::Timer timer(end->get_executor());
        timer.expires_after(delay);
        co_await timer.async_wait(boost::asio::use_awaitable);
      }
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

/// Of module 1 on the bench; `more` are further lines.
inline std::string axis_section(const std::string& name, int motor, const std::string& more = {}) {
  return "[[axis]]\nname = \"" + name +
         "\"\nbus = \"bench\"\naddress = 1\nmotor = " + std::to_string(motor) + '\n' + more;
}

inline std::string two_axes() {
  return std::string(bench_bus) + axis_section("x", 0) + axis_section("y", 1);
}

class TestDaemon {
 public:
  explicit TestDaemon(const std::string& toml = two_axes()) {
    silence_log();
    // As in main().
    std::signal(SIGPIPE, SIG_IGN);
    auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    const auto config = parse_config("[daemon]\nsocket = \"" + socket() + "\"\n" + toml);
    if (!config) throw std::runtime_error(config.error().front().message);
    for (const auto& bus : config->buses) {
      wires_[bus.name].modules.emplace(std::uint8_t{1}, FakeModule(1));
    }
    auto daemon = Daemon::create(*config, [this](const BusConfig& bus) { return open(bus); });
    if (!daemon) throw std::runtime_error(daemon.error());
    daemon_ = std::move(*daemon);
  }
  ~TestDaemon() {
    if (thread_.joinable()) end();
    // Its descriptors must not outlive the reactor.
    for (auto& [name, wire] : wires_) wire.unplug();
    daemon_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// Serves; returns when its modules have been identified, unless told not to wait.
  void start(bool until_ready = true) {
    thread_ = std::thread([this] { ended_well_ = daemon_->run(); });
    while (until_ready && !on_reactor([&] { return is_ready(); })) std::this_thread::yield();
  }
  void end() {
    daemon_->stop();
    thread_.join();
  }
  /// Waits until the daemon has ended by itself; whether it says that nothing was wrong.
  bool ends_well() {
    thread_.join();
    return ended_well_;
  }

  std::string socket() const { return folder_ + "/socket"; }
  Daemon& daemon() { return *daemon_; }
  FakeWire& wire(const std::string& bus = "bench") { return wires_.at(bus); }

  /// What the function gives, run on the daemon's thread.
  template <class Function>
  std::invoke_result_t<Function> on_reactor(Function function) {
    // Shared, because the reactor is not done with it when the result is there.
    const auto task =
        std::make_shared<std::packaged_task<std::invoke_result_t<Function>()>>(std::move(function));
    auto result = task->get_future();
    boost::asio::post(daemon_->context(), [task] { (*task)(); });
    return result.get();
  }
  /// Waits until the function, run on the daemon's thread, says so; false after ten seconds.
  template <class Condition>
  bool eventually(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!on_reactor(condition)) {
      if (std::chrono::steady_clock::now() >= end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
    boost::asio::post(daemon_->context(),
                      [this, &wire, far] { wire.plug_in(daemon_->context().get_executor(), far); });
    return std::move(ends->first);
  }

  bool is_ready() {
    for (const auto& axis : daemon_->gateway().axes()) {
      if (axis->module().state() != GatewayModule::State::ready) return false;
    }
    return true;
  }

  std::string folder_;
  std::map<std::string, FakeWire> wires_;
  std::unique_ptr<Daemon> daemon_;
  std::thread thread_;
  bool ended_well_ = false;
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
