/// A raw CAN socket of the kernel.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "tmcl/datagram.hpp"
#include "tmcl/file_descriptor.hpp"

namespace tmcl {

/// Non-blocking, bound to one interface. The error is a sentence that says what to do.
tl::expected<FileDescriptor, std::string> open_can_socket(const std::string& interface);

/// False once the interface is gone, and if another one has its name now.
bool is_on(int socket, const std::string& interface);

struct CanRead {
  /// A data frame; nothing for a remote or error frame, or when there is none.
  std::optional<CanFrame> frame;
  /// errno; 0 when something was read.
  int error = 0;
};

CanRead read_can(int socket);
/// False if the kernel did not take the frame.
bool write_can(int socket, const CanFrame& frame);

}  // namespace tmcl
