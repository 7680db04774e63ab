// The simulator's ports on real descriptors: a datagram that comes in pieces on a pseudo terminal,
// and TCP where there are no descriptors left.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <thread>

#include <fcntl.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "sim/ports/pty_port.hpp"
#include "sim/ports/tcp_port.hpp"
#include "support/temp_path.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/file_descriptor.hpp"
#include "tmcl/model.hpp"

namespace tmcl::sim {
namespace {

using std::chrono::milliseconds;

class SimPtyPort : public testing::Test {
 protected:
  static constexpr std::size_t first_piece = 4;

  void SetUp() override {
    bench_.add(*find_model(1110), ModuleAddress{1});
    auto port = open_pty_port(io_, scheduler_, path_);
    ASSERT_TRUE(port) << port.error();
    port_ = std::move(*port);
    host_ = FileDescriptor(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    ASSERT_TRUE(host_.valid());
  }
  void send(std::span<const std::uint8_t> bytes) {
    ASSERT_EQ(::write(host_.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  std::span<const std::uint8_t> beginning() const { return std::span(request_).first(first_piece); }
  std::span<const std::uint8_t> rest() const { return std::span(request_).subspan(first_piece); }
  /// Lets the simulator work until it has nothing more to do, however late it gets to it.
  void simulate() {
    constexpr auto longer_than_it_listens = milliseconds(20);
    while (io_.run_one_for(longer_than_it_listens) > 0) {
    }
  }
  /// Lets it do one thing: to read what has come.
  void simulate_reading() { io_.run_one(); }
  std::size_t bytes_answered() {
    std::array<std::uint8_t, 64> answer{};
    return static_cast<std::size_t>(
        std::max<ssize_t>(::read(host_.get(), answer.data(), answer.size()), 0));
  }

 private:
  const SerialBytes request_ =
      encode_serial(Request{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 1, 0, 0});
  RealClock clock_;
  Bench bench_{clock_};
  boost::asio::io_context io_;
  Scheduler scheduler_{io_, bench_};
  const std::string path_ = test::temp_path("line");
  std::unique_ptr<Port> port_;
  FileDescriptor host_;
};

TEST_F(SimPtyPort, APieceThatComesAfterSilenceBeginsADatagram) {
  send(beginning());
  simulate();
  send(rest());
  simulate();
  EXPECT_EQ(bytes_answered(), 0U);
}

TEST_F(SimPtyPort, AfterThatTheNextDatagramIsWhole) {
  send(beginning());
  simulate();
  send(beginning());
  send(rest());
  simulate();
  EXPECT_EQ(bytes_answered(), 9U);
}

// The processor was somebody else's meanwhile: what it missed was no silence on the line.
TEST_F(SimPtyPort, APieceThatOnlyTheSimulatorIsLateForBelongsToItsDatagram) {
  send(beginning());
  simulate_reading();
  send(rest());
  std::this_thread::sleep_for(milliseconds(20));
  simulate();
  EXPECT_EQ(bytes_answered(), 9U);
}

// Sanitizers need descriptors themselves, to look at memory.
#if !defined(__SANITIZE_ADDRESS__)

/// While it lives, no descriptor can be opened.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int lowest_free = dup(STDERR_FILENO);
    ::close(lowest_free);
    auto none = before_;
    none.rlim_cur = static_cast<rlim_t>(lowest_free);
    setrlimit(RLIMIT_NOFILE, &none);
  }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

TEST(SimTcpPort, WaitsForADescriptorWithoutTryingAllTheTime) {
  const RealClock clock;
  Bench bench(clock);
  bench.add(*find_model(1110), ModuleAddress{1});
  boost::asio::io_context io;
  Scheduler scheduler(io, bench);
  const auto port = open_tcp_port(io, scheduler, {"127.0.0.1", "0"});
  ASSERT_TRUE(port) << port.error();
  const auto shown = (*port)->description();
  const auto number = std::stoi(shown.substr(shown.rfind(':') + 1));
  using boost::asio::ip::tcp;
  tcp::socket host(io);
  host.connect({boost::asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(number)});
  {
    const NoDescriptors full;
    EXPECT_LT(io.run_for(milliseconds(250)), 20U);
  }
  const auto request =
      encode_serial(Request{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 1, 0, 0});
  boost::asio::write(host, boost::asio::buffer(request));
  SerialBytes reply{};
  bool answered = false;
  boost::asio::async_read(host, boost::asio::buffer(reply), [&](const auto& error, std::size_t) {
    answered = !error;
    io.stop();
  });
  io.run_for(std::chrono::seconds(10));
  EXPECT_TRUE(answered);
}

#endif

}  // namespace
}  // namespace tmcl::sim
