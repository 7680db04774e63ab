/// Handing over what is longer than a line, in parts: the parameters "offset" and "data" of the
/// method that takes the parts, and "bytes" of the one that uses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "api/lookup.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/firmware.hpp"

namespace tmcld {

struct Staged {
  std::string_view what;    ///< "an image"
  std::string_view method;  ///< That takes its parts.
  std::size_t most_bytes;
  UploadBuffer Gateway::*buffer;
};

constexpr Staged staged_image{"an image", api::firmware::Stage::method.name,
                              tmcl::firmware::most_image_bytes, &Gateway::image_upload};
constexpr Staged staged_path{"a path", api::path::Stage::method.name, api::path::most_bytes,
                             &Gateway::path_upload};

/// The bytes from an offset on, in hexadecimal.
struct Part {
  std::int32_t offset = 0;
  const std::string& data;
};
Result<api::HandedOver> stage_part(const Call& call, const Part& part, const Staged& staged);
/// All of it, which has so many bytes; the buffer is empty then.
Result<std::vector<std::uint8_t>> take_staged(const Call& call, const Staged& staged,
                                              std::size_t bytes);

}  // namespace tmcld
