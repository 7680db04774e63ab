// What a module makes of a datagram that comes in pieces, on a real pseudo terminal.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <thread>

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>

#include "sim/ports/file_descriptor.hpp"
#include "sim/ports/pty_port.hpp"
#include "support/temp_path.hpp"
#include "tmcl/datagram.hpp"
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
  /// Lets the simulator work for so long.
  void simulate(milliseconds time) { io_.run_for(time); }
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
  simulate(milliseconds(8));
  send(rest());
  simulate(milliseconds(8));
  EXPECT_EQ(bytes_answered(), 0U);
}

TEST_F(SimPtyPort, AfterThatTheNextDatagramIsWhole) {
  send(beginning());
  simulate(milliseconds(20));
  send(beginning());
  send(rest());
  simulate(milliseconds(8));
  EXPECT_EQ(bytes_answered(), 9U);
}

// The processor was somebody else's meanwhile: what it missed was no silence on the line.
TEST_F(SimPtyPort, APieceThatOnlyTheSimulatorIsLateForBelongsToItsDatagram) {
  send(beginning());
  simulate(milliseconds(1));
  send(rest());
  std::this_thread::sleep_for(milliseconds(20));
  simulate(milliseconds(8));
  EXPECT_EQ(bytes_answered(), 9U);
}

}  // namespace
}  // namespace tmcl::sim
