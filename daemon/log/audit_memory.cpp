#include "log/audit_memory.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace tmcld {

void AuditMemory::add(tmcl::UtcTime when, const AuditEntry& entry) noexcept {
  ++last_;
  try {
    lines_.push_back({last_, when, entry});
    bytes_ += entry.text.size();
    while (lines_.size() > most_lines || (bytes_ > most_bytes && lines_.size() > 1))
      forget_oldest();
  } catch (const std::exception&) {  // what was done is done, whether a line of it is kept or not
    lines_.clear();
    bytes_ = 0;
  }
}

void AuditMemory::forget_oldest() {
  bytes_ -= lines_.front().entry.text.size();
  lines_.pop_front();
}

std::vector<AuditMemory::Line> AuditMemory::after(std::uint64_t number, std::size_t limit) const {
  const auto begin = std::ranges::upper_bound(lines_, number, {}, &Line::number);
  const auto rest = static_cast<std::size_t>(lines_.end() - begin);
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min(rest, limit))};
}

AuditSink kept_in(std::shared_ptr<AuditMemory> memory, tmcl::ContextClock clock, AuditSink sink) {
  return [memory = std::move(memory), clock, sink = std::move(sink)](AuditEntry entry) {
    memory->add(clock.utc_of(clock.now()), entry);
    if (sink) sink(std::move(entry));
  };
}

}  // namespace tmcld
