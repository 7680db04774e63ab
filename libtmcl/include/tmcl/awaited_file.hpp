/// The socket or the pty of a program that has just been started: who opens it waits a little for
/// it.
#pragma once

#include <filesystem>
#include <string>

#include "tmcl/clock.hpp"

namespace tmcl {

/// Tenfold of what tmcld or tmclsim needs to make its socket or its pty on a small computer.
constexpr Duration longest_wait_for_file = std::chrono::seconds(2);
constexpr Duration file_look_interval = std::chrono::milliseconds(20);

/// True if such a file can appear: its directory exists.
inline bool may_appear(const std::filesystem::path& path) {
  std::error_code unreadable;
  const auto directory = path.has_parent_path() ? path.parent_path() : ".";
  return path.has_filename() && std::filesystem::is_directory(directory, unreadable);
}

/// True if nothing is there that could be opened.
inline bool is_missing(const std::filesystem::path& path) {
  std::error_code unreadable;
  return std::filesystem::status(path, unreadable).type() == std::filesystem::file_type::not_found;
}

/// What the message of a failure adds: " (waited 2.0 s for it)"; nothing without a wait.
inline std::string waited_text(Duration waited) {
  if (waited < file_look_interval) return {};
  const auto tenths = std::chrono::round<std::chrono::duration<long, std::deci>>(waited).count();
  return " (waited " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) +
         " s for it)";
}

}  // namespace tmcl
