#include "tmcl/serial_decoder.hpp"

#include <algorithm>
#include <string_view>

namespace tmcl {

std::optional<SerialItem> SerialDecoder::push(std::uint8_t byte) {
  if (size_ == window_.size()) {
    std::ranges::copy(std::span(window_).subspan(1), window_.begin());
    --size_;
    ++dropped_;
    if (bytes_before_ > 0) --bytes_before_;
  }
  window_[size_++] = byte;
  if (size_ < window_.size()) return std::nullopt;
  auto item = recognise();
  if (item) {
    began_before_ = bytes_before_ > 0;
    size_ = bytes_before_ = 0;
  }
  return item;
}

std::optional<SerialItem> SerialDecoder::recognise() const {
  if (window_[0] != host_) return std::nullopt;
  if (version_text_expected_) {
    std::array<char, version_text_size> text{};
    std::ranges::transform(std::span(window_).subspan(1), text.begin(),
                           [](std::uint8_t byte) { return static_cast<char>(byte); });
    if (const auto version = version_from_text({text.data(), text.size()}))
      return VersionText{host_, *version};
  }
  const auto reply = decode_serial_reply(window_);
  if (!reply) return std::nullopt;
  if (!program_line_expected_ && find_status(reply->status) == nullptr) return std::nullopt;
  return *reply;
}

void SerialDecoder::reset() {
  dropped_ += size_;
  size_ = bytes_before_ = 0;
}

}  // namespace tmcl
