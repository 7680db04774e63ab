// A person in a serial terminal drives a simulated module.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include "support/program.hpp"
#include "support/temp_path.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::test {
namespace {

class TmclsimAscii : public testing::Test {
 protected:
  TmclsimAscii() {
    path_ = temp_path("ascii");
    simulator_ = std::make_unique<Program>(
        std::vector<std::string>{"tmclsim", "--module", "TMCM-1110", "--pty", path_});
    EXPECT_TRUE(simulator_->wait_for("ready")) << simulator_->output();
    terminal_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    tcgetattr(terminal_, &settings);
    cfmakeraw(&settings);
    tcsetattr(terminal_, TCSANOW, &settings);
  }
  ~TmclsimAscii() override { close(terminal_); }

  void write_bytes(const void* bytes, std::size_t count) const {
    ASSERT_EQ(write(terminal_, bytes, count), static_cast<ssize_t>(count));
  }
  void type(const std::string& text) const { write_bytes(text.data(), text.size()); }
  /// What comes, up to so many characters or a second of silence.
  std::string read_back(std::size_t count) const {
    std::string text;
    while (text.size() < count) {
      pollfd waiting{terminal_, POLLIN, 0};
      char buffer[256];
      if (poll(&waiting, 1, 1000) <= 0) break;
      const auto got = read(terminal_, buffer, sizeof buffer);
      if (got <= 0) break;
      text.append(buffer, static_cast<std::size_t>(got));
    }
    return text;
  }
  std::string said(const std::string& line, const std::string& reply) const {
    type(line + '\r');
    return read_back(line.size() + reply.size() + 2);
  }

  std::string path_;
  std::unique_ptr<Program> simulator_;
  int terminal_ = -1;
};

TEST_F(TmclsimAscii, ReadsMovesAndGoesBackToDatagrams) {
  const auto enter = encode_serial(Request{ModuleAddress{1}, Command::ENTER_ASCII_MODE});
  write_bytes(enter.data(), enter.size());
  EXPECT_EQ(read_back(serial_datagram_size).size(), serial_datagram_size);
  EXPECT_EQ(said("AGAP 1, 0", "BA 100 0"), "AGAP 1, 0\rBA 100 0\r");
  EXPECT_EQ(said("AMVP ABS, 0, 20", "BA 100 20"), "AMVP ABS, 0, 20\rBA 100 20\r");
  usleep(1'500'000);
  EXPECT_EQ(said("a gap 1, 0", "BA 100 20"), "a gap 1, 0\rBA 100 20\r");
  EXPECT_EQ(said("AMVQ", "BA 2 0"), "AMVQ\rBA 2 0\r");
  EXPECT_EQ(said("ABIN", "BA 100 0"), "ABIN\rBA 100 0\r");
  const auto ask = encode_serial(Request{ModuleAddress{1}, Command::GAP, 1});
  write_bytes(ask.data(), ask.size());
  EXPECT_EQ(read_back(serial_datagram_size).size(), serial_datagram_size);
}

}  // namespace
}  // namespace tmcl::test
