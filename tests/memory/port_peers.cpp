#include "memory/port_peers.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "tmcl/can_socket.hpp"
#include "tmcl/datagram.hpp"

namespace tmcld::test {
namespace {

using tmcl::serial_datagram_size;

/// The kernel passes on what was said when it gets to it.
void wait_for_input(int descriptor, int milliseconds) {
  pollfd entry{descriptor, POLLIN, 0};
  ::poll(&entry, 1, milliseconds);
}

int master_of(const std::filesystem::path& terminal) {
  const auto name = std::filesystem::canonical(terminal).string();
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename());
    unsigned number = 0;
    const bool is_master = ::ioctl(descriptor, TIOCGPTN, &number) == 0;
    if (is_master && "/dev/pts/" + std::to_string(number) == name) return descriptor;
  }
  throw std::runtime_error(name + " is no pseudo terminal of this process");
}

}  // namespace

// ---- a pseudo terminal -------------------------------------------------------------------------

PtyPeer::PtyPeer(const std::string& path)
    : terminal_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)),
      master_(master_of(path)) {
  termios settings{};
  if (!terminal_.valid() || ::tcgetattr(terminal_.get(), &settings) != 0)
    throw std::runtime_error("cannot open " + path);
  ::cfmakeraw(&settings);
  ::tcsetattr(terminal_.get(), TCSANOW, &settings);
}

void PtyPeer::say(std::string_view bytes) {
  if (::write(terminal_.get(), bytes.data(), bytes.size()) < 0) return;
  wait_for_input(master_, 1000);
}

void PtyPeer::read() {
  char bytes[256];
  for (auto count = ::read(terminal_.get(), bytes, sizeof bytes); count > 0;
       count = ::read(terminal_.get(), bytes, sizeof bytes))
    heard_.append(bytes, static_cast<std::size_t>(count));
}

const std::string& PtyPeer::heard() {
  read();
  // Virtual time passes faster than the kernel.
  if (heard_.empty()) wait_for_input(terminal_.get(), 1);
  read();
  return heard_;
}

void PtyPeer::forget() {
  read();
  heard_.clear();
}

// ---- CAN ---------------------------------------------------------------------------------------

void CanPeer::say(std::string_view bytes) {
  for (; bytes.size() >= serial_datagram_size; bytes.remove_prefix(serial_datagram_size)) {
    tmcl::SerialBytes datagram{};
    std::copy_n(bytes.begin(), datagram.size(), datagram.begin());
    const auto request = tmcl::decode_serial_request(datagram);
    if (request) tmcl::write_can(socket_, tmcl::encode_can(*request));
  }
}

const std::string& CanPeer::heard() {
  for (auto got = tmcl::read_can(socket_); got.error == 0; got = tmcl::read_can(socket_)) {
    const auto reply = got.frame ? tmcl::decode_can_reply(*got.frame) : std::nullopt;
    if (!reply) continue;
    const auto datagram = tmcl::encode_serial(*reply);
    heard_.append(datagram.begin(), datagram.end());
  }
  return heard_;
}

void CanPeer::forget() {
  heard();
  heard_.clear();
}

}  // namespace tmcld::test
