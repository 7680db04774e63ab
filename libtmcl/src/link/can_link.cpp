#include <cerrno>
#include <cstring>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "link/can_condition.hpp"
#include "link/can_lock.hpp"
#include "link/opening.hpp"

namespace tmcl {
namespace {

// What tells a person why nothing gets through; every lost arbitration would be noise.
constexpr can_err_mask_t reported_errors = CAN_ERR_TX_TIMEOUT | CAN_ERR_CRTL | CAN_ERR_ACK |
                                           CAN_ERR_BUSOFF | CAN_ERR_BUSERROR | CAN_ERR_RESTARTED;

can_filter only(std::uint32_t id, bool extended) {
  return {id | (extended ? CAN_EFF_FLAG : 0U),
          CAN_EFF_FLAG | CAN_RTR_FLAG | (extended ? CAN_EFF_MASK : CAN_SFF_MASK)};
}

bool accept_only_replies(int descriptor, const LinkOptions& options) {
  const can_filter filters[] = {only(options.can_reply_id, options.can_extended),
                                only(can_bootloader_reply_id, options.can_extended)};
  return setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters, sizeof filters) == 0 &&
         setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &reported_errors,
                    sizeof reported_errors) == 0;
}

bool is_up(int descriptor, const std::string& interface) {
  ifreq request{};
  std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
  return ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

std::string controller_state(std::uint8_t bits) {
  if ((bits & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) return "error-passive";
  if ((bits & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) return "error-warning";
  if ((bits & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) return "overflow";
  return "error-active";
}

tl::unexpected<Error> not_locked(const std::string& link, const Error& error) {
  if (error.code == Errc::link_busy) return busy(link, error.message);
  return cannot_open(link, error.message, "");
}

}  // namespace

CanCondition describe_error_frame(const can_frame& frame) {
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) return {"bus-off", true};
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0) return {"restarted after bus-off", false};
  if ((frame.can_id & CAN_ERR_CRTL) != 0) return {controller_state(frame.data[1]), false};
  if ((frame.can_id & CAN_ERR_ACK) != 0) return {"no other node acknowledges", false};
  if ((frame.can_id & CAN_ERR_TX_TIMEOUT) != 0) return {"transmit timeout", false};
  return {"bus error", false};
}

Result<Link> open_can(const CanName& name, const std::string& text, const LinkOptions& options) {
  const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor < 0) {
    return cannot_open(text, system_text(errno),
                       "this kernel has no SocketCAN: load it with `modprobe can_raw`");
  }
  Link link(descriptor, Framing::can, text);
  link.can_extended_ = options.can_extended;
  const unsigned index = if_nametoindex(name.interface.c_str());
  if (index == 0) {
    return cannot_open(text, "there is no interface " + name.interface,
                       "`ip -brief link show type can` lists controllers, and with `type vcan` "
                       "virtual ones");
  }
  if (!is_up(descriptor, name.interface)) {
    return cannot_open(text, "the interface is down",
                       "bring it up: `ip link set " + name.interface +
                           " up`; a controller needs its bit rate first: `ip link set " +
                           name.interface + " type can bitrate 1000000`");
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (!accept_only_replies(descriptor, options) ||
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return cannot_open(text, system_text(errno), "is " + name.interface + " a CAN interface?");
  }
  auto lock = lock_can_replies({index, options.can_reply_id, options.can_extended});
  if (!lock) return not_locked(text, lock.error());
  link.lock_ = std::move(*lock);
  return link;
}

}  // namespace tmcl
