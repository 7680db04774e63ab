#include "tmcl/pty.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace tmcl {
namespace {

tl::unexpected<std::string> failure(const char* what) {
  const auto reason = std::generic_category().message(errno);
  return tl::unexpected(std::string("cannot ") + what + ": " + reason);
}

bool make_raw(int terminal) {
  termios settings{};
  if (::tcgetattr(terminal, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  ::cfsetspeed(&settings, B115200);  // shown by stty; a pseudo terminal has no speed
  return ::tcsetattr(terminal, TCSANOW, &settings) == 0;
}

}  // namespace

tl::expected<Pty, std::string> open_pty() {
  Pty pty;
  pty.master = FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!pty.master.valid()) return failure("get a pseudo terminal");
  if (::grantpt(pty.master.get()) != 0 || ::unlockpt(pty.master.get()) != 0) {
    return failure("unlock a pseudo terminal");
  }
  std::array<char, 64> name{};
  if (::ptsname_r(pty.master.get(), name.data(), name.size()) != 0) {
    return failure("learn the name of a pseudo terminal");
  }
  pty.slave_name = name.data();
  pty.slave = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!pty.slave.valid()) return failure("open the far end of a pseudo terminal");
  if (!make_raw(pty.slave.get())) return failure("set up a pseudo terminal");
  return pty;
}

}  // namespace tmcl
