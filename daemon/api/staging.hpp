/// Handing over what is longer than a line, in parts: the parameters "offset" and "data" of the
/// method that takes the parts, and "bytes" of the one that uses them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "api/lookup.hpp"
#include "tmcl/firmware.hpp"

namespace tmcld {

struct Staged {
  std::string_view what;    ///< "an image"
  std::string_view method;  ///< That takes its parts.
  std::size_t most_bytes;
  UploadBuffer Gateway::*buffer;
};

constexpr Staged staged_image{"an image", "firmware.stage", tmcl::firmware::most_image_bytes,
                              &Gateway::image_upload};
constexpr Staged staged_path{"a path", "path.stage", std::size_t{16} << 20U, &Gateway::path_upload};

/// Takes a part. Gives how many bytes there are now.
RpcResult stage_part(const Call& call, const Staged& staged);
/// All of it; the buffer is empty then.
Lookup<std::vector<std::uint8_t>> take_staged(const Call& call, const Staged& staged);

}  // namespace tmcld
