// The bytes as G-code.
#include <cstddef>
#include <cstdint>

#include "path_fuzz.hpp"
#include "require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  namespace path_file = tmcl::plan::path_file;
  const auto read = path_file::read_gcode(text);
  tmcl::fuzz::look_at(read, text);
  const auto lenient = path_file::read_gcode(text, {}, {path_file::Unknowns::skipped});
  tmcl::fuzz::look_at(lenient, text);
  tmcl::fuzz::require(!read || read == lenient, "where nothing is unknown, nothing is skipped");
  return 0;
}
