/// A pair of pseudo terminals: what the simulator writes to the one, a host reads from the other.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "tmcl/file_descriptor.hpp"

namespace tmcl {

struct Pty {
  FileDescriptor master;
  /// Kept open, so that the pair survives hosts that come and go.
  FileDescriptor slave;
  /// Such as "/dev/pts/5".
  std::string slave_name;
};

/// Raw, without echo: bytes pass as they are. The error is a sentence.
tl::expected<Pty, std::string> open_pty();

}  // namespace tmcl
