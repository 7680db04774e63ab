/// What is too long for one line of the protocol, handed over in parts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "gateway.hpp"
#include "tmcl/hex.hpp"

namespace tmclctl {

/// In bytes; a third of what a line may have.
constexpr std::size_t staged_at_once = 16'384;

/// By a method such as tmcl::api::path::Stage.
template <class Stage>
Result<void> stage(std::span<const std::uint8_t> bytes, Context& context,
                   const tmcl::client::CallOptions& options = {}) {
  for (std::size_t offset = 0; offset < bytes.size(); offset += staged_at_once) {
    const auto part = bytes.subspan(offset, std::min(staged_at_once, bytes.size() - offset));
    const auto taken =
        context.call(Stage{static_cast<std::int32_t>(offset), tmcl::to_hex(part)}, options);
    if (!taken) return tl::unexpected(taken.error());
  }
  return {};
}

}  // namespace tmclctl
