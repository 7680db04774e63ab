// The kernel's own termios2 instead of the C library's termios: only it takes any baud rate. Both
// headers define the same names, so the C library's must stay out of this file.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <linux/tty_flags.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include <fmt/format.h>

#include "link/file_owner.hpp"
#include "link/holder.hpp"
#include "link/opening.hpp"
#include "link/processes.hpp"

namespace tmcl {
namespace {

constexpr std::size_t bits_per_byte_on_wire = 10;  // 8N1
constexpr std::size_t bytes_per_exchange = 2 * serial_datagram_size;

/// Eight bits, no parity, one stop bit, nothing translated, nothing echoed, no flow control.
bool make_raw(int descriptor, std::uint32_t baud) {
  termios2 settings{};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return false;
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = baud;
  settings.c_ospeed = baud;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return ioctl(descriptor, TCSETS2, &settings) == 0;
}

/// USB adapters hold received bytes back for up to 16 ms otherwise. Not every driver has this mode:
/// no error then.
void prefer_low_latency(int descriptor) {
  serial_struct settings{};
  if (ioctl(descriptor, TIOCGSERIAL, &settings) != 0) return;
  settings.flags = static_cast<int>(static_cast<unsigned>(settings.flags) | ASYNC_LOW_LATENCY);
  ioctl(descriptor, TIOCSSERIAL, &settings);
}

/// Lets no program open the terminal that is not root's. That stays with the terminal, not with the
/// descriptor, for as long as anybody has it open: it must be undone.
std::shared_ptr<void> keep_others_out(int descriptor) {
  ioctl(descriptor, TIOCEXCL);
  return {nullptr, [descriptor](std::nullptr_t) { ioctl(descriptor, TIOCNXCL); }};
}

/// A pty is its maker's alone, as a rule; a serial port is for the group dialout, on Debian.
std::string access_hint(const std::string& device) {
  const auto owner = owner_of(device);
  if (!owner) return "your user may not look into the directory of the port";
  if (!owner->group_may_use || owner->group_id == 0)
    return fmt::format("it is for user '{}' alone: open it as that user", owner->user);
  return fmt::format("it is for group '{0}': `sudo usermod -aG {0} $USER`, then log in again",
                     owner->group);
}

std::string hint_for(int error, const std::string& device) {
  if (error == EACCES) return access_hint(device);
  if (error == ENOENT) return "is the module plugged in? `ls /dev/serial/by-id` lists ports";
  return "is it a serial port?";
}

tl::unexpected<Error> refused(const std::string& text, const std::string& device, int error) {
  return cannot_open(text, system_text(error), hint_for(error, device));
}

/// What a shell reads and shows must get no datagrams. A link that was left behind by a
/// program that was killed leads there, as soon as another terminal gets the number of its own.
tl::unexpected<Error> is_terminal(const std::string& text, const std::string& device,
                                  const std::string& program) {
  std::error_code error;
  const auto target = std::filesystem::canonical(device, error);
  const bool is_link = std::filesystem::is_symlink(device, error);
  if (!is_link)
    return cannot_open(text, fmt::format("{} is the terminal of {}", device, program),
                       "no module is there: is it another port? `ls /dev/serial/by-id` lists them");
  return cannot_open(
      text,
      fmt::format("the link {} is stale: it leads to {}, which is the terminal of {} now", device,
                  target.string(), program),
      fmt::format("who made the link is gone: start that again, and remove the link: rm {}",
                  device));
}

}  // namespace

Result<Link> open_serial(const SerialName& name, const std::string& text) {
  const int descriptor = ::open(name.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && errno == EBUSY) return busy(text, holder_of(name.device));
  if (descriptor < 0) return refused(text, name.device, errno);
  Link link(descriptor, Framing::serial, text);
  // By the descriptor: what the name leads to may change at any time.
  struct stat status {};
  if (fstat(descriptor, &status) == 0) {
    const auto program = program_at_terminal(status.st_rdev);
    if (!program.empty()) return is_terminal(text, name.device, program);
  }
  // The lock stops programs of all users that look for it; TIOCEXCL stops all that are not
  // root's.
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    // Closed first, so that the search for the holder does not find this very program.
    { const Link closed = std::move(link); }
    return busy(text, holder_of(name.device));
  }
  if (!make_raw(descriptor, name.baud)) return refused(text, name.device, errno);
  link.lock_ = keep_others_out(descriptor);
  prefer_low_latency(descriptor);
  ioctl(descriptor, TCFLSH, TCIOFLUSH);
  link.wire_time_ = std::chrono::nanoseconds(std::chrono::seconds(1)) *
                    static_cast<long>(bits_per_byte_on_wire * bytes_per_exchange) / name.baud;
  return link;
}

}  // namespace tmcl
