// The bytes as what a host hears on a serial line, as what modules hear there, and as CAN frames.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bench.hpp"
#include "tmcl/serial_decoder.hpp"

namespace {

using tmcl::fuzz::require;
using Bytes = std::span<const std::uint8_t>;

void as_replies(Bytes bytes, bool version_expected) {
  tmcl::SerialDecoder decoder;
  decoder.expect_version_text(version_expected);
  std::size_t used = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto item = decoder.push(bytes[i]);
    if (!item) continue;
    used += tmcl::serial_datagram_size;
    const auto* reply = std::get_if<tmcl::Reply>(&*item);
    require(reply != nullptr || version_expected, "texts come only when they are expected");
    if (reply == nullptr) continue;
    const auto last = bytes.subspan(i + 1 - tmcl::serial_datagram_size, tmcl::serial_datagram_size);
    require(std::ranges::equal(encode_serial(*reply), last), "a reply is what stands there");
  }
  decoder.reset();
  require(used + decoder.dropped_bytes() == bytes.size(), "every byte is used or dropped");
}

/// 255 is a silence that begins a new datagram.
void to_modules(Bytes bytes, tmcl::fuzz::Bench& bench) {
  for (const auto byte : bytes) {
    if (byte == 255) bench.pass(std::chrono::milliseconds(6));
    bench.line.receive({&byte, 1});
  }
}

void as_frames(Bytes bytes, tmcl::fuzz::Bench& bench) {
  for (; bytes.size() >= 10; bytes = bytes.subspan(10)) {
    tmcl::CanFrame frame{
        bytes[0] % 4U, (bytes[0] & 0x80U) != 0, static_cast<std::uint8_t>(bytes[1] % 9), {}};
    std::ranges::copy(bytes.subspan(2, 8), frame.data.begin());
    bench.can.receive(frame);
    (void)decode_can_reply(frame);
  }
  for (const auto& frame : bench.frames)
    require(frame.length == 7 || frame.length == 8, "replies have seven bytes or eight");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, size);
  as_replies(bytes, false);
  as_replies(bytes, true);
  tmcl::fuzz::Bench bench{1110};  // one small module: it is about frames, and many of them
  to_modules(bytes, bench);
  as_frames(bytes, bench);
  return 0;
}
