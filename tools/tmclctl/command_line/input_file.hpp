/// A file that a verb reads.
#pragma once

#include <cstddef>
#include <string>

#include <tl/expected.hpp>

namespace tmclctl {

/// Its contents, or as many bytes of it; why it cannot be read, in the system's words.
tl::expected<std::string, std::string> read_file(const std::string& path, std::size_t most_bytes);

}  // namespace tmclctl
