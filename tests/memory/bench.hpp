/// A daemon with three modules, in virtual time and on the thread of the test, whose memory fails.
///
/// Only what the daemon does is watched: the modules and the clients are no part of its reactor.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/json.hpp>

#include "daemon.hpp"
#include "fronts/port.hpp"
#include "sim/bench.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/file_descriptor.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {

namespace json = boost::json;

class MemoryBench;

/// Says lines, and keeps those that it hears.
class MemoryClient {
 public:
  explicit MemoryClient(MemoryBench& bench);
  MemoryClient(const MemoryClient&) = delete;
  MemoryClient& operator=(const MemoryClient&) = delete;
  ~MemoryClient();

  void send(std::string_view method, std::string_view params);
  /// The answer to what was sent last; nothing if it has not come.
  std::optional<json::object> answer();
  /// tmcld has ended the connection.
  bool is_cut_off() const { return is_cut_off_; }
  json::object call(std::string_view method, std::string_view params);

 private:
  void read();

  MemoryBench& bench_;
  int descriptor_;
  int last_id_ = 0;
  std::string input_;
  std::optional<json::object> answer_;
  bool is_cut_off_ = false;
};

class MemoryBench {
 public:
  MemoryBench();
  MemoryBench(const MemoryBench&) = delete;
  MemoryBench& operator=(const MemoryBench&) = delete;
  ~MemoryBench();

  /// False if it does not hold in time.
  template <class Condition>
  bool run_until(Condition condition, tmcl::Duration at_most) {
    const auto limit = time_.now() + at_most;
    while (!condition()) {
      if (time_.now() >= limit) return false;
      go_on(limit);
    }
    return true;
  }
  void run_for(tmcl::Duration duration) {
    (void)run_until([] { return false; }, duration);
  }
  /// What has been sent, while nothing else runs.
  void listen() { (void)serve_modules(); }
  void let_work_take(tmcl::Duration duration) {
    time_.set_time_for_work([duration] { return duration; });
  }
  /// An exception comes out of the reactor's next turn.
  void let_reactor_throw();
  /// Something was thrown out of the reactor: the daemon ends.
  bool has_failed() const { return has_failed_; }

  Daemon& daemon() { return *daemon_; }
  const std::string& socket() const { return socket_; }
  /// On which it speaks HTTP, and is a serial device server.
  std::uint16_t http_port() const { return http_port_; }
  std::uint16_t serial_port() const { return serial_port_; }
  /// Of a port on a pseudo terminal, and the hosts' end of one on CAN: frames of SocketCAN go
  /// between two sockets of this process, as few kernels have an interface for them.
  std::string terminal() const { return folder_ + "/terminal"; }
  int can_socket() const { return can_hosts_.get(); }
  std::int32_t get(std::size_t motor, std::uint8_t parameter);
  /// Where each motor is: x, y, z, and those that are no axes.
  std::vector<std::int32_t> positions();
  bool moves();
  /// What has come over the wire, in order.
  std::vector<tmcl::Request> requests;
  static constexpr std::size_t motors = 5;

 private:
  void go_on(tmcl::TimePoint limit);
  /// The daemon has its turn, in which its memory may fail.
  template <class Turn>
  void in_daemon(Turn turn);
  bool serve_modules();
  tmcl::Result<tmcl::Link> open();
  /// Empty, or why it cannot be.
  std::string create_daemon();
  void open_can_port();

  std::string folder_;
  std::string socket_;
  std::uint16_t http_port_ = 0;
  std::uint16_t serial_port_ = 0;
  boost::asio::io_context context_{1};
  tmcl::VirtualTime time_{context_};
  tmcl::ContextClock clock_{context_};
  tmcl::sim::Bench modules_{clock_};
  std::unique_ptr<tmcl::Link> far_;
  tmcl::sim::SerialLine line_;
  std::unique_ptr<Daemon> daemon_;
  tmcl::FileDescriptor can_hosts_;
  std::shared_ptr<Port> can_port_;
  bool has_failed_ = false;
};

}  // namespace tmcld::test
