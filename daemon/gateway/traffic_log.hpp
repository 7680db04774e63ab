/// The last datagrams of a bus, as they were on the wire: to find what went wrong.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tmcl/link.hpp"
#include "tmcl/serial_decoder.hpp"
#include "tmcl/traffic.hpp"

namespace tmcld {

/// Takes no memory beyond what it is made with. Thread safety: none.
class TrafficLog {
 public:
  static constexpr std::size_t most = 4096;

  /// A datagram, a frame, or up to nine bytes that belong to none.
  struct Entry {
    std::uint64_t number = 0;  ///< From 1 on.
    tmcl::TimePoint at{};
    tmcl::Traffic::Direction direction{};
    bool is_garbage = false;
    bool can_extended = false;
    std::uint8_t size = 0;
    std::array<std::uint8_t, tmcl::serial_datagram_size> bytes{};
    std::uint32_t can_id = 0;
    std::uint64_t asker = 0;  ///< Of a reply: of the request that it seems to answer.
  };

  TrafficLog(tmcl::Framing framing, std::uint8_t host_address)
      : framing_(framing), decoder_(host_address), ring_(most) {}

  void note(const tmcl::Traffic& traffic);
  /// The number of the newest; 0 if there is none.
  std::uint64_t last() const { return last_; }
  /// The number of the oldest that is still there; last() + 1 if there is none.
  std::uint64_t first() const { return last_ < most ? 1 : last_ - most + 1; }
  /// What was answered last to this asker; nothing if that is long ago, or was no reply.
  std::optional<tmcl::Reply> last_reply_to(std::uint64_t asker) const;
  /// Those that follow, the oldest first.
  std::vector<Entry> after(std::uint64_t number, std::size_t limit) const;

 private:
  struct Question {
    std::uint8_t command = 0;
    std::uint64_t asker = 0;
  };
  /// Up to nine bytes in a row.
  struct Bytes {
    std::array<std::uint8_t, tmcl::serial_datagram_size> at{};
    std::uint8_t count = 0;
    std::span<const std::uint8_t> all() const { return std::span(at).first(count); }
    bool is_full() const { return count == at.size(); }
    void push(std::uint8_t byte) { at.at(count++) = byte; }
  };
  void note_request(const tmcl::Traffic& traffic);
  void note_frame(const tmcl::Traffic& traffic);
  void note_byte(std::uint8_t byte);
  /// What has begun to come in is no datagram.
  void give_up_datagram();
  void throw_away(std::uint8_t byte);
  void end_garbage();
  std::uint64_t asker_of(std::uint8_t module, std::uint8_t command) const;
  Entry& add(tmcl::TimePoint at, tmcl::Traffic::Direction direction,
             std::span<const std::uint8_t> bytes);

  tmcl::Framing framing_;
  tmcl::SerialDecoder decoder_;
  std::vector<Entry> ring_;
  std::uint64_t last_ = 0;
  std::array<Question, 256> asked_{};  ///< Of each module, the last.
  Bytes unfinished_;                   ///< What came in and may become a datagram.
  Bytes garbage_;                      ///< What came before it.
  tmcl::TimePoint last_byte_at_{};
};

}  // namespace tmcld
