#include <algorithm>
#include <numeric>

#include "tmcl/firmware.hpp"

namespace tmcl::firmware {

std::uint32_t checksum(const Image& image) {
  return std::accumulate(image.bytes.begin(), image.bytes.end(), std::uint32_t{0});
}

std::vector<FirmwareVersion> versions_in(const Image& image) {
  std::vector<FirmwareVersion> versions;
  const std::string_view text(reinterpret_cast<const char*>(image.bytes.data()),
                              image.bytes.size());
  for (std::size_t at = 0; at + version_text_size <= text.size(); ++at) {
    const auto version = version_from_text(text.substr(at, version_text_size));
    if (!version || version->bootloader || std::ranges::count(versions, *version) != 0) continue;
    versions.push_back(*version);
    if (versions.size() == most_versions) break;
  }
  return versions;
}

std::optional<FirmwareVersion> version_for(const Image& image, std::uint16_t model) {
  const auto versions = versions_in(image);
  const auto found = std::ranges::find(versions, model, &FirmwareVersion::model);
  return found == versions.end() ? std::nullopt : std::optional(*found);
}

}  // namespace tmcl::firmware
