#include "tmcl/heard.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace tmcl {
namespace {

// A module may take so long to answer, and an adapter to hand that on.
constexpr Duration longest_answer = std::chrono::milliseconds(100);
// One byte alone may come of a plug that is put in.
constexpr std::uint64_t least_noise = 2;

// What damages bytes hits those by which a datagram is known, too.
constexpr std::uint64_t weight_of_damaged = 4;

constexpr std::size_t most_text = 40;
// Of bytes without a meaning one in five is a letter, and one in three can be printed.
constexpr std::size_t letters_of_word = 4;
constexpr std::uint64_t least_text = 6;
constexpr std::uint64_t text_percent = 70;

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_printable(char c) { return c >= ' ' && c <= '~'; }
constexpr bool ends_line(char c) { return c == '\r' || c == '\n' || c == '\t'; }

/// What a module says that was asked this, but for the sum.
bool could_answer(const SerialBytes& bytes, const SerialBytes& request) {
  return bytes[1] == request[0] && bytes[3] == request[1] &&
         find_status(static_cast<Status>(bytes[2])) != nullptr;
}

}  // namespace

void Heard::note(const Traffic& traffic) {
  if (traffic.direction == Traffic::Direction::in) {
    if (has_asked_ && traffic.at - asked_at_ > longest_answer) unasked_ += traffic.bytes.size();
    for (const auto byte : traffic.bytes) note_byte(byte);
    return;
  }
  if (traffic.bytes.size() != asked_.size()) return;
  std::ranges::copy(traffic.bytes, asked_.begin());
  has_asked_ = true;
  asked_at_ = traffic.at;
  decoder_.expect_version_text(asked_[1] ==
                               static_cast<std::uint8_t>(Command::GET_FIRMWARE_VERSION));
}

void Heard::begin_anew() {
  Heard anew(host_);
  anew.asked_ = asked_;
  anew.has_asked_ = has_asked_;
  anew.asked_at_ = asked_at_;
  *this = std::move(anew);
}

void Heard::note_byte(std::uint8_t byte) {
  ++bytes_;
  if (size_ == window_.size()) {
    note_stray(window_.front());
    std::shift_left(window_.begin(), window_.end(), 1);
    --size_;
  }
  window_[size_++] = byte;
  // What it holds are the last bytes of the window.
  const bool is_reply = decoder_.push(byte).has_value();
  if (size_ < window_.size() || !takes_whole_datagram(is_reply)) return;
  size_ = 0;
  decoder_.reset();
}

bool Heard::takes_whole_datagram(bool is_reply) {
  // An echo of a question to the host's own number may look like a reply.
  const bool is_echo = has_asked_ && window_ == asked_;
  const bool fits = has_asked_ && could_answer(window_, asked_);
  const bool is_whole = detail::is_sealed(window_);
  const bool is_version = is_reply && !is_whole;
  if (is_echo) {
    ++echoes_;
  } else if (is_reply && (fits || is_version)) {
    ++answers_;
  } else if (is_reply || (fits && is_whole)) {
    ++foreign_;
  } else if (fits && window_[0] == host_) {
    ++damaged_;
  } else {
    return false;
  }
  return true;
}

void Heard::note_stray(std::uint8_t byte) {
  ++stray_;
  const auto character = static_cast<char>(byte);
  if (is_printable(character) || ends_line(character)) ++printable_;
  note_character(character);
}

void Heard::note_character(char character) {
  if (!is_printable(character)) {
    take_line();
    line_ = {};
    line_.is_whole = ends_line(character);
    letters_ = 0;
    return;
  }
  letters_ = is_letter(character) ? letters_ + 1 : 0;
  if (letters_ >= letters_of_word) line_.has_word = true;
  if (line_.text.size() < most_text) line_.text += character;
}

void Heard::take_line() {
  if (!line_.has_word) return;
  if (!text_.has_word || (line_.is_whole && !text_.is_whole)) text_ = line_;
}

bool Heard::is_text() const {
  return text_.has_word && stray_ >= least_text && printable_ * 100 >= stray_ * text_percent;
}

HeardKind Heard::kind() const {
  const auto outweighs_stray = [this](std::uint64_t datagrams, std::uint64_t weight = 1) {
    return datagrams != 0 && datagrams * serial_datagram_size * weight >= stray_;
  };
  if (answers_ != 0) return HeardKind::answers;
  if (outweighs_stray(damaged_, weight_of_damaged)) return HeardKind::wrong_checksums;
  if (outweighs_stray(foreign_)) return HeardKind::foreign;
  if (outweighs_stray(echoes_)) return HeardKind::echo;
  if (is_text()) return HeardKind::text;
  if (unasked_ >= least_noise) return HeardKind::noise;
  return bytes_ != 0 ? HeardKind::other_baud_rate : HeardKind::nothing;
}

HeardVerdict Heard::verdict() const {
  auto end = *this;
  for (const auto byte : std::span(window_).first(size_)) end.note_stray(byte);
  end.take_line();
  const auto kind = end.kind();
  return {kind, bytes_, kind == HeardKind::text ? end.text_.text : std::string()};
}

std::string_view name_of(HeardKind kind) {
  switch (kind) {
    case HeardKind::nothing: return "nothing";
    case HeardKind::answers: return "answers";
    case HeardKind::wrong_checksums: return "wrong_checksums";
    case HeardKind::foreign: return "foreign";
    case HeardKind::echo: return "echo";
    case HeardKind::text: return "text";
    case HeardKind::other_baud_rate: return "other_baud_rate";
    case HeardKind::noise: return "noise";
  }
  return {};
}

std::string meaning_of(const HeardVerdict& heard) {
  switch (heard.kind) {
    case HeardKind::nothing: return "nothing came back";
    case HeardKind::answers: return "modules answer";
    case HeardKind::wrong_checksums:
      return "answers came, but their checksums are wrong: the line damages bytes";
    case HeardKind::foreign: return "replies came, but to questions that were not asked here";
    case HeardKind::echo: return "only what was sent came back: the line echoes";
    case HeardKind::text: return fmt::format("text came, as of a console: \"{}\"", heard.text);
    case HeardKind::other_baud_rate:
      return fmt::format(
          "{} bytes without a meaning came after questions: a module speaks at another baud rate, "
          "or "
          "two have one address",
          heard.bytes);
    case HeardKind::noise:
      return fmt::format("{} bytes without a meaning came, also unasked: noise, or another device",
                         heard.bytes);
  }
  return {};
}

std::string hint_for(HeardKind kind, std::string_view link) {
  const auto search = link.empty()
                          ? "what is between must have the baud rate of the modules"
                          : fmt::format("'tmclctl --direct {} scan --bauds' finds the rate", link);
  switch (kind) {
    case HeardKind::nothing:
      return "check the supply, the cabling (A and B, or RX and TX swapped?), whether this is the "
             "port, "
             "and the baud rate, 9600 of a new module: " +
             search;
    case HeardKind::answers: return {};
    case HeardKind::wrong_checksums:
      return "check ground, shield and termination, and that no two modules have one address";
    case HeardKind::foreign:
      return "end the other program or host that asks on this line; or the module answers another "
             "host address (global parameter 76, `host_address` in the configuration)";
    case HeardKind::echo:
      return "check the supply and the cable of the module; where no module is meant to be, RX and "
             "TX are joined, or the adapter hears itself, which does no harm";
    case HeardKind::text:
      return "another device is on this port, a console that the kernel or getty writes to, or a "
             "module in ASCII mode: 'tmclctl ports' lists the ports";
    case HeardKind::other_baud_rate: return "new modules speak 9600 baud: " + search;
    case HeardKind::noise:
      return "check ground, shield, termination and whether another device is on this port; if all "
             "is "
             "well, " +
             search;
  }
  return {};
}

}  // namespace tmcl
