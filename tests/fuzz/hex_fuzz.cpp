// The bytes as an Intel HEX file, and as the contents of one that is written for them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "require.hpp"
#include "support/intel_hex.hpp"
#include "tmcl/firmware.hpp"

namespace {

namespace firmware = tmcl::firmware;
using tmcl::fuzz::require;

void as_file(std::string_view text) {
  const auto image = firmware::read_intel_hex(text);
  if (image) {
    require(!image->bytes.empty(), "an image has bytes");
    require(image->bytes.size() <= firmware::most_image_bytes, "and not too many");
    require(firmware::versions_in(*image).size() <= firmware::most_versions, "few versions");
    return;
  }
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  require(!image.error().message.empty(), "there is a reason");
  require(image.error().line <= lines, "in a line of the file");
}

void as_contents(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) return;
  const auto high = static_cast<std::uint32_t>(bytes[0] << 8 | bytes[1]);
  const auto start = (high << 8U | bytes[2]) << 4U | (bytes[3] & 0xFU);
  const auto rest = bytes.subspan(3);
  const auto image = firmware::read_intel_hex(tmcl::test::hex_file(start, rest));
  require(image.has_value(), "what was written can be read");
  require(image->start == start && std::ranges::equal(image->bytes, rest), "as it was");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  as_file({reinterpret_cast<const char*>(data), size});
  as_contents({data, size});
  return 0;
}
