/// Writes what is audited, on a thread of its own: to a file, or to the log.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include <tl/expected.hpp>

#include "log/audit.hpp"

namespace tmcld {

/// Adding a line never waits. So many lines are queued; of those that come then, it is only
/// told how many there were.
class AuditTrail {
 public:
  static constexpr std::size_t most_waiting_lines = 4096;

  /// `file` empty: the log. The file is made if it is not there, for its owner to write and its
  /// group to read; lines are added at its end.
  /// Errors: why it cannot be opened: a symbolic link, for instance.
  static tl::expected<std::unique_ptr<AuditTrail>, std::string> open(std::string file);
  AuditTrail(const AuditTrail&) = delete;
  AuditTrail& operator=(const AuditTrail&) = delete;
  /// Waits a moment until everything is written.
  ~AuditTrail();

  /// Why open() would fail; empty if it would not. Makes no file.
  static std::string problem_of(const std::string& file);

  void add(AuditEntry entry);
  /// Opens the file again by its name: the old one may have been moved away.
  void reopen();

 private:
  struct Shared;
  explicit AuditTrail(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  static void write(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  ///< With the thread, which may hang in a write.
};

}  // namespace tmcld
