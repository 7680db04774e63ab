/// What was moved and set, by whom, and what came of it: a line each.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace tmcld {

struct AuditEntry {
  std::uint32_t uid = 0;
  std::int32_t pid = 0;
  std::string text;  ///< What was asked for and what came of it, without control characters.
};

/// Never blocks.
using AuditSink = std::function<void(AuditEntry entry)>;

}  // namespace tmcld
