/// The memory of stand-alone programs, and how one is loaded into it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "tmcl/program.hpp"

namespace tmcl::sim {

/// Always most_commands commands; where nothing was written they are 0.
///
/// A download takes effect as a whole when it ends. Until then the memory holds what it held: a
/// module that loses its power in the middle still has the old program, and one that was sent too
/// much keeps it.
class ProgramMemory {
 public:
  ProgramMemory() : lines_(program::most_commands) {}

  std::span<const program::Instruction> lines() const { return lines_; }
  bool has(std::int64_t address) const {
    return address >= 0 && address < static_cast<std::int64_t>(lines_.size());
  }
  /// Nothing for an address beyond the memory.
  std::optional<program::Instruction> read(std::size_t address) const;
  /// Puts these commands at the start and clears the rest; those beyond the memory are left out.
  void assign(std::span<const program::Instruction> lines);
  void erase() { assign({}); }

  bool in_download() const { return download_.has_value(); }
  /// The address must lie within the memory. Forgets a download that has not ended.
  void begin_download(std::size_t first);
  /// Within a download. False, and nothing is recorded, if the memory is full.
  bool record(const program::Instruction& line);
  /// Within a download. False, and the memory is as it was before, if there were too many lines.
  bool end_download();
  void abandon_download() { download_.reset(); }
  /// Within a download: where the next line goes.
  std::size_t next_address() const { return download_->first + download_->lines.size(); }

 private:
  struct Download {
    std::size_t first;
    program::Program lines;
    bool overflowed = false;
  };

  program::Program lines_;
  std::optional<Download> download_;
};

}  // namespace tmcl::sim
