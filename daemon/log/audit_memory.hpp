/// The last lines that were audited, for clients that ask for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "log/audit.hpp"
#include "tmcl/context_clock.hpp"

namespace tmcld {

/// Thread safety: none.
class AuditMemory {
 public:
  static constexpr std::size_t most_lines = 1000;
  /// Of their texts: a line may name very many axes.
  static constexpr std::size_t most_bytes = 256U * 1024U;

  struct Line {
    std::uint64_t number = 0;  ///< From 1 on.
    tmcl::UtcTime when{};
    AuditEntry entry{};
  };

  /// Forgets the oldest lines where there is no room; all of them where memory is missing.
  void add(tmcl::UtcTime when, const AuditEntry& entry) noexcept;
  /// The number of the newest; 0 if there was none yet.
  std::uint64_t last() const { return last_; }
  /// The number of the oldest that is still there; last() + 1 if there is none.
  std::uint64_t first() const { return lines_.empty() ? last_ + 1 : lines_.front().number; }
  /// Those that follow, the oldest first.
  std::vector<Line> after(std::uint64_t number, std::size_t limit) const;

 private:
  void forget_oldest();

  std::deque<Line> lines_;  ///< Their numbers have no gaps.
  std::size_t bytes_ = 0;
  std::uint64_t last_ = 0;
};

/// What is given to it goes into the memory, and on to the other one.
AuditSink kept_in(std::shared_ptr<AuditMemory> memory, tmcl::ContextClock clock, AuditSink sink);

}  // namespace tmcld
