#include "sim/ports/rate_of_terminal.hpp"

// Not <termios.h>, which has no numbers but those of old; the two do not go together.
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <algorithm>

namespace tmcl::sim {

std::uint32_t rate_of_terminal(int descriptor) {
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) return 1;
  return std::max<std::uint32_t>(settings.c_ospeed, 1);
}

}  // namespace tmcl::sim
