#include "link/can_lock.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "link/holder.hpp"
#include "link/opening.hpp"

namespace tmcl {
namespace {

/// A name among the abstract unix sockets, which are no files: nothing is left behind, everybody
/// may look, and they are as far apart from other networks (containers) as CAN interfaces are.
class Name {
 public:
  explicit Name(const std::string& text)
      : descriptor_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (descriptor_ < 0) {
      error_ = errno;
      return;
    }
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    // A zero before the name makes it abstract.
    const auto length = std::min(text.size(), sizeof address.sun_path - 1);
    std::memcpy(address.sun_path + 1, text.data(), length);
    const auto size = offsetof(sockaddr_un, sun_path) + 1 + length;
    if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address),
             static_cast<socklen_t>(size)) != 0)
      error_ = errno;
  }
  Name(const Name&) = delete;
  Name& operator=(const Name&) = delete;
  ~Name() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  /// errno; 0 if the name is this process' now.
  int error() const { return error_; }

 private:
  int descriptor_;
  int error_ = 0;
};

struct Lock {
  explicit Lock(const std::string& name) : replies(name) {}
  Name replies;
  /// Tells those who find it taken by whom.
  std::optional<Name> holder;
};

std::string name_of(const CanReplies& replies) {
  return fmt::format("tmcl/can/{}/{}{}", replies.interface_index, replies.extended ? "x" : "",
                     replies.id);
}

std::string holder_with(const std::string& prefix) {
  std::ifstream names("/proc/net/unix");
  const auto mark = "@" + prefix + "/";
  for (std::string line; std::getline(names, line);) {
    const auto at = line.find(mark);
    if (at != std::string::npos) return line.substr(at + mark.size());
  }
  return {};
}

}  // namespace

Result<std::shared_ptr<void>> lock_can_replies(const CanReplies& replies) {
  const auto name = name_of(replies);
  const auto lock = std::make_shared<Lock>(name);
  const int error = lock->replies.error();
  if (error == EADDRINUSE) return because(Errc::link_busy, holder_with(name));
  if (error != 0)
    return because(Errc::link_open_failed, "it cannot be locked: " + system_text(error));
  lock->holder.emplace(name + "/" + this_process());
  return lock;
}

}  // namespace tmcl
