// The bytes as G-code.
#include <cstddef>
#include <cstdint>

#include "path_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  tmcl::fuzz::look_at(tmcl::plan::path_file::read_gcode(text), text);
  return 0;
}
