/// A way by which hosts reach the modules of a bench.
#pragma once

#include <memory>
#include <string>

#include <tl/expected.hpp>

namespace tmcl::sim {

class Port {
 public:
  virtual ~Port() = default;
  /// One line for a person, such as "tcp 127.0.0.1:4001".
  virtual std::string description() const = 0;
};

/// The error is a sentence that says what failed and what to do.
using OpenedPort = tl::expected<std::unique_ptr<Port>, std::string>;

}  // namespace tmcl::sim
