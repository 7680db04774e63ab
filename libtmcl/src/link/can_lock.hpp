/// Who may ask on a CAN interface of this computer and take the replies: one program for each reply
/// identifier. Two of them would take each other's replies for their own, and nothing in a reply
/// tells them apart.
#pragma once

#include <cstdint>
#include <memory>

#include "tmcl/error.hpp"

namespace tmcl {

struct CanReplies {
  unsigned interface_index = 0;
  std::uint32_t id = 0;
  bool extended = false;
};

/// Held until the last copy of the pointer is gone, at the latest until the process ends. Programs
/// of every user see it, in the network that the interface is in.
/// Errors: link_busy, with the program that has it as message, "tmcld (process 4711)", which is
/// empty if it cannot be told; link_open_failed.
Result<std::shared_ptr<void>> lock_can_replies(const CanReplies& replies);

}  // namespace tmcl
