/// Puts together what a client uploads in parts, because it is longer than a line of the protocol
/// may be. There is one for each kind of upload: firmware images, path files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tmcld {

/// Holds one upload, that of the client that began one last. So the memory is bounded, and a client
/// that never ends its upload does not block another.
class UploadBuffer {
 public:
  using Owner = std::shared_ptr<const void>;

  /// How many bytes this owner has uploaded; 0 if the upload is another's.
  std::size_t size_for(const Owner& owner) const {
    return owner_.lock() == owner ? bytes_.size() : 0;
  }
  void begin(const Owner& owner) {
    owner_ = owner;
    bytes_.clear();
  }
  /// For the owner alone, who checks that the upload stays within its greatest size.
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
