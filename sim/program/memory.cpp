#include "sim/program/memory.hpp"

#include <algorithm>
#include <utility>

namespace tmcl::sim {

std::optional<program::Instruction> ProgramMemory::read(std::size_t address) const {
  if (address >= lines_.size()) return std::nullopt;
  return lines_[address];
}

void ProgramMemory::assign(std::span<const program::Instruction> lines) {
  const auto fitting = lines.first(std::min(lines.size(), lines_.size()));
  const auto end = std::ranges::copy(fitting, lines_.begin()).out;
  std::fill(end, lines_.end(), program::Instruction{});
}

void ProgramMemory::begin_download(std::size_t first) { download_ = Download{first, {}, false}; }

bool ProgramMemory::record(const program::Instruction& line) {
  if (download_->first + download_->lines.size() >= lines_.size()) {
    download_->overflowed = true;
    return false;
  }
  download_->lines.push_back(line);
  return true;
}

bool ProgramMemory::end_download() {
  const auto download = *std::exchange(download_, std::nullopt);
  if (download.overflowed) return false;
  std::ranges::copy(download.lines, lines_.begin() + static_cast<std::ptrdiff_t>(download.first));
  return true;
}

}  // namespace tmcl::sim
