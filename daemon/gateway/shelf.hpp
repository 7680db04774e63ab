/// Where what is longer than a line of the protocol may be is put together. There is one for each
/// kind of it: firmware images, path files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tmcld {

/// One thing, of whoever began one last: so it takes a bounded amount of memory, and nobody can
/// keep others from it.
class Shelf {
 public:
  using Owner = std::shared_ptr<const void>;

  /// How much there is of what this owner hands over.
  std::size_t size_for(const Owner& owner) const {
    return owner_.lock() == owner ? bytes_.size() : 0;
  }
  void begin(const Owner& owner) {
    owner_ = owner;
    bytes_.clear();
  }
  /// Only by the one who began it, who sees to it that there is an end.
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
