#include "tmcl/bit_rate.hpp"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "tmcl/file_descriptor.hpp"

namespace tmcl {
namespace {

using Bytes = std::span<const std::byte>;

/// What an attribute of this type holds, of those that stand one behind the other.
Bytes attribute(Bytes all, unsigned short type) {
  while (all.size() >= sizeof(rtattr)) {
    rtattr head{};
    std::memcpy(&head, all.data(), sizeof head);
    if (head.rta_len < RTA_LENGTH(0) || head.rta_len > all.size()) return {};
    if ((head.rta_type & NLA_TYPE_MASK) == type)
      return all.subspan(RTA_LENGTH(0), head.rta_len - RTA_LENGTH(0));
    all = all.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), all.size()));
  }
  return {};
}

struct Question {
  nlmsghdr head{};
  ifinfomsg interface {};
};

/// What the kernel says of a network interface, without its heads.
Bytes description_of(unsigned interface, std::span<std::byte> buffer) {
  const FileDescriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  Question question;
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = RTM_GETLINK;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.interface.ifi_index = static_cast<int>(interface);
  if (!socket.valid() || ::send(socket.get(), &question, sizeof question, 0) < 0) return {};
  const auto size = ::recv(socket.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  nlmsghdr head{};
  if (size < static_cast<ssize_t>(sizeof question)) return {};
  std::memcpy(&head, buffer.data(), sizeof head);
  if (head.nlmsg_type != RTM_NEWLINK || head.nlmsg_len > static_cast<std::size_t>(size)) return {};
  return Bytes(buffer).first(head.nlmsg_len).subspan(sizeof question);
}

std::optional<std::uint32_t> rate_of_controller(const std::string& name) {
  const auto interface = ::if_nametoindex(name.c_str());
  if (interface == 0) return std::nullopt;
  std::array<std::byte, 32768> buffer{};
  const auto data =
      attribute(attribute(description_of(interface, buffer), IFLA_LINKINFO), IFLA_INFO_DATA);
  const auto timing = attribute(data, IFLA_CAN_BITTIMING);
  can_bittiming set{};
  if (timing.size() < sizeof set) return std::nullopt;
  std::memcpy(&set, timing.data(), sizeof set);
  return set.bitrate == 0 ? std::nullopt : std::optional(set.bitrate);
}

bool is_usb_terminal(const std::string& device) {
  std::error_code error;
  const auto path = std::filesystem::weakly_canonical(device, error);
  return !error && path.filename().string().starts_with("ttyACM");
}

}  // namespace

std::optional<std::uint32_t> bit_rate_of(const LinkName& link) {
  if (const auto* can = std::get_if<CanName>(&link)) return rate_of_controller(can->interface);
  const auto* serial = std::get_if<SerialName>(&link);
  if (serial == nullptr || is_usb_terminal(serial->device)) return std::nullopt;
  return serial->baud;
}

}  // namespace tmcl
