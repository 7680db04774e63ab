/// A program that speaks TMCL on a serial port or over TCP and knows nothing of tmcld: it writes
/// nine bytes, and reads nine.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "tmcl/datagram.hpp"

namespace tmcl::test {

class TmclHost {
 public:
  static TmclHost on_pty(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (descriptor < 0) throw std::runtime_error("cannot open " + path);
    termios settings{};
    ::tcgetattr(descriptor, &settings);
    ::cfmakeraw(&settings);
    ::cfsetspeed(&settings, B115200);
    ::tcsetattr(descriptor, TCSANOW, &settings);
    return TmclHost(descriptor);
  }
  static TmclHost on_tcp(std::uint16_t port) {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(port);
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto* address = reinterpret_cast<const sockaddr*>(&there);
    if (::connect(descriptor, address, sizeof there) != 0)
      throw std::runtime_error("cannot connect to port " + std::to_string(port));
    return TmclHost(descriptor);
  }
  TmclHost(TmclHost&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  TmclHost& operator=(TmclHost&&) = delete;
  ~TmclHost() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  void say(std::span<const std::uint8_t> bytes) {
    if (::write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      throw std::runtime_error("nobody takes what the host says");
  }
  /// Nothing if nine bytes have not come before so long a silence.
  std::optional<SerialBytes> hear(int silence_ms = 10'000) {
    SerialBytes bytes{};
    std::size_t size = 0;
    pollfd waiting{descriptor_, POLLIN, 0};
    while (size < bytes.size()) {
      if (::poll(&waiting, 1, silence_ms) <= 0) return std::nullopt;
      const auto count = ::read(descriptor_, bytes.data() + size, bytes.size() - size);
      if (count <= 0) return std::nullopt;
      size += static_cast<std::size_t>(count);
    }
    return bytes;
  }
  std::optional<SerialBytes> ask(const Request& request) {
    say(encode_serial(request));
    return hear();
  }
  /// The value of an answer that says that all is well.
  std::int32_t value_of(const Request& request) {
    const auto bytes = ask(request);
    const auto reply = bytes ? decode_serial_reply(*bytes) : std::nullopt;
    if (!reply) throw std::runtime_error("no answer to " + describe_bytes(encode_serial(request)));
    if (!is_success(reply->status))
      throw std::runtime_error("status " + std::to_string(static_cast<int>(reply->status)) +
                               " to " + describe_bytes(encode_serial(request)));
    return reply->value;
  }

 private:
  explicit TmclHost(int descriptor) : descriptor_(descriptor) {}
  static std::string describe_bytes(const SerialBytes& bytes) {
    std::string text;
    for (const auto byte : bytes) text += std::to_string(byte) + " ";
    return text;
  }

  int descriptor_;
};

}  // namespace tmcl::test
