/// Where a firmware image is put together: it is longer than a line of the protocol may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "tmcl/firmware.hpp"

namespace tmcld {

/// One image, of whoever began one last: so it takes a bounded amount of memory, and nobody can
/// keep others from it.
class ImageShelf {
 public:
  using Owner = std::shared_ptr<const void>;
  static constexpr std::size_t most_bytes = tmcl::firmware::most_image_bytes;

  /// How much there is of this owner's image.
  std::size_t size_for(const Owner& owner) const {
    return owner_.lock() == owner ? bytes_.size() : 0;
  }
  void begin(const Owner& owner) {
    owner_ = owner;
    bytes_.clear();
  }
  /// Together at most `most_bytes`, and only by the one who began it.
  void append(std::span<const std::uint8_t> part) {
    bytes_.insert(bytes_.end(), part.begin(), part.end());
  }
  std::vector<std::uint8_t> take() {
    owner_.reset();
    return std::exchange(bytes_, {});
  }

 private:
  std::weak_ptr<const void> owner_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace tmcld
