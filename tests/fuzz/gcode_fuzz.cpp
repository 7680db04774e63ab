// The bytes as G-code.
#include <cstddef>
#include <cstdint>

#include "path_fuzz.hpp"
#include "require.hpp"

namespace {

/// On which everything is carried out.
tmcl::plan::path_file::GcodeSetup whole_machine() {
  tmcl::plan::path_file::GcodeSetup machine;
  machine.words.set();
  for (auto& origin : machine.origins) origin = {10, 0, -3, 90, 0, 0};
  machine.tools = {{1, 12.5}, {2, 30}};
  return machine;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  namespace path_file = tmcl::plan::path_file;
  const auto read = path_file::read_gcode(text);
  tmcl::fuzz::look_at(read, text);
  const auto lenient = path_file::read_gcode(text, {}, {path_file::Unknowns::skipped});
  tmcl::fuzz::look_at(lenient, text);
  tmcl::fuzz::require(!read || read == lenient, "where nothing is unknown, nothing is skipped");
  tmcl::fuzz::look_at(path_file::read_gcode(text, {}, whole_machine()), text);
  return 0;
}
