/// What a serial line brings where answers are expected, and what that means.
///
/// Does no I/O.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "tmcl/serial_decoder.hpp"
#include "tmcl/traffic.hpp"

namespace tmcl {

enum class HeardKind : std::uint8_t {
  nothing,
  answers,          ///< To what was asked.
  wrong_checksums,  ///< Answers, but damaged ones.
  foreign,          ///< Replies to what was not asked.
  echo,             ///< What was sent comes back.
  text,             ///< Lines that a person could read.
  other_baud_rate,  ///< Bytes without a meaning, and only after questions.
  noise,            ///< The same, and unasked.
};

/// "other_baud_rate"
std::string_view name_of(HeardKind kind);

struct HeardVerdict {
  HeardKind kind = HeardKind::nothing;
  std::uint64_t bytes = 0;  ///< How many came.
  /// The first line of it that came whole, or else the first of it; empty where it is none.
  std::string text{};
};

/// One sentence on what came.
std::string meaning_of(const HeardVerdict& heard);
/// And what to try; empty for answers. `link` is a serial port without its baud rate, such as
/// "serial:/dev/ttyUSB0"; empty for a line that is behind something else.
std::string hint_for(HeardKind kind, std::string_view link);

/// Listens to what goes over a line. How the bytes were cut into reads makes no difference. Takes
/// no memory but for 40 characters of text.
class Heard {
 public:
  explicit Heard(std::uint8_t host_address = default_host_address)
      : host_(host_address), decoder_(host_address) {}

  void note(const Traffic& traffic);
  /// What came until now counts no more. The last question does: its answer may be on its way.
  void begin_anew();
  HeardVerdict verdict() const;

 private:
  void note_byte(std::uint8_t byte);
  bool takes_whole_datagram(bool is_reply);
  void note_stray(std::uint8_t byte);
  void note_character(char character);
  HeardKind kind() const;
  bool is_text() const;
  void take_line();

  /// Bytes that can be printed, in a row.
  struct Line {
    std::string text{};
    bool has_word = false;
    bool is_whole = false;  ///< The end of another line came before it.
  };

  std::uint8_t host_;
  SerialDecoder decoder_;
  SerialBytes asked_{};  ///< The last request.
  bool has_asked_ = false;
  TimePoint asked_at_{};
  SerialBytes window_{};  ///< What may become a datagram.
  std::size_t size_ = 0;

  std::uint64_t bytes_ = 0;
  std::uint64_t unasked_ = 0;
  std::uint64_t answers_ = 0, damaged_ = 0, foreign_ = 0, echoes_ = 0;  ///< Datagrams.
  std::uint64_t stray_ = 0;                                             ///< Bytes of none of them.
  std::uint64_t printable_ = 0;                                         ///< Of those.
  Line line_;                ///< The printable ones that came last.
  std::size_t letters_ = 0;  ///< At its end.
  Line text_;                ///< The first that is whole, or the first of all.
};

}  // namespace tmcl
