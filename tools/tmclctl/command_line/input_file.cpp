#include "input_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace tmclctl {

tl::expected<std::string, std::string> read_file(const std::string& path, std::size_t most_bytes) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string contents;
  std::array<char, 16384> part;
  while (file && contents.size() < most_bytes) {
    const auto wanted = std::min(part.size(), most_bytes - contents.size());
    file.read(part.data(), static_cast<std::streamsize>(wanted));
    contents.append(part.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.is_open() || file.bad()) return tl::unexpected(std::string(std::strerror(errno)));
  return contents;
}

}  // namespace tmclctl
