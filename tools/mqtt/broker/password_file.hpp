/// The password of a user of a broker, from a file.
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace tmclmqtt {

/// Its first line, which has 1 to 4096 bytes. Errors, in a sentence that names the file and says
/// what to do: it cannot be read, has no such line, or is a file that other users may open.
tl::expected<std::string, std::string> password_in(const std::string& path);

}  // namespace tmclmqtt
