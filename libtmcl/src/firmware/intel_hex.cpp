#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "program/expression.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/firmware.hpp"

namespace tmcl::firmware {
namespace {

using program::printable;
using program::within_line;

enum class RecordType : std::uint8_t {
  data = 0,
  end = 1,
  segment_base = 2,
  segment_start = 3,
  linear_base = 4,
  linear_start = 5,
};

struct Record {
  RecordType type{};
  std::uint16_t offset = 0;
  std::vector<std::uint8_t> data;
};

// Where the parts of a record stand in its line.
constexpr std::size_t length_at = 1;
constexpr std::size_t type_at = 7;
constexpr std::size_t data_at = 9;
constexpr std::size_t fixed_bytes = 5;  ///< Length, two of the offset, type, sum.

constexpr std::uint64_t segment_size = 0x10000;
constexpr std::uint64_t end_of_addresses = std::uint64_t{1} << 32U;

tl::unexpected<TextProblem> fault(std::size_t at, std::string word, std::string message) {
  return tl::unexpected(within_line(at, std::move(word), std::move(message)));
}

std::string digits_of(std::uint64_t value, std::size_t count) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text(count, '0');
  for (std::size_t i = count; i-- > 0; value >>= 4U) text[i] = digits[value & 0xFU];
  return text;
}

std::optional<unsigned> value_of(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  return std::nullopt;
}

/// All bytes behind the colon.
tl::expected<std::vector<std::uint8_t>, TextProblem> bytes_of(std::string_view line) {
  if (line.front() != ':') {
    return fault(0, printable(line.substr(0, 1)),
                 "a record begins with ':', not with '" + printable(line.substr(0, 1)) + "'");
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = 1; at < line.size(); ++at) {
    const auto value = value_of(line[at]);
    if (!value) {
      const auto word = printable(line.substr(at, 1));
      return fault(at, word, "'" + word + "' is no hexadecimal digit");
    }
    if (at % 2 == 1) {
      bytes.push_back(static_cast<std::uint8_t>(*value << 4U));
    } else {
      bytes.back() = static_cast<std::uint8_t>(bytes.back() | *value);
    }
  }
  if (line.size() % 2 == 0) return fault(line.size() - 1, "", "half a byte is missing at the end");
  return bytes;
}

std::optional<TextProblem> wrong_length(std::string_view line,
                                        std::span<const std::uint8_t> bytes) {
  const auto expected = bytes.empty() ? fixed_bytes : bytes[0] + fixed_bytes;
  if (bytes.size() == expected) return std::nullopt;
  return within_line(length_at, printable(line.substr(length_at, 2)),
                     "the record should have " + std::to_string(expected) + " bytes and has " +
                         std::to_string(bytes.size()));
}

std::optional<TextProblem> wrong_sum(std::string_view line, std::span<const std::uint8_t> bytes) {
  if (tmcl::checksum(bytes) == 0) return std::nullopt;
  const auto right = static_cast<std::uint8_t>(0U - tmcl::checksum(bytes.first(bytes.size() - 1)));
  const auto written = line.substr(line.size() - 2);
  return within_line(line.size() - 2, std::string(written),
                     "wrong checksum " + std::string(written) + "; the bytes before it give " +
                         digits_of(right, 2));
}

std::optional<TextProblem> wrong_type(std::string_view line, const Record& record) {
  constexpr std::array<std::size_t, 6> lengths{0, 0, 2, 4, 2, 4};
  const auto type = static_cast<std::size_t>(record.type);
  const auto written = std::string(line.substr(type_at, 2));
  if (type >= lengths.size())
    return within_line(type_at, written, "there is no record type " + written);
  if (record.type == RecordType::data || record.data.size() == lengths[type]) return std::nullopt;
  return within_line(length_at, std::string(line.substr(length_at, 2)),
                     "a record of type " + written + " has " + std::to_string(lengths[type]) +
                         " bytes of data, not " + std::to_string(record.data.size()));
}

tl::expected<Record, TextProblem> record_of(std::string_view line) {
  const auto bytes = bytes_of(line);
  if (!bytes) return tl::unexpected(bytes.error());
  if (auto wrong = wrong_length(line, *bytes)) return tl::unexpected(std::move(*wrong));
  if (auto wrong = wrong_sum(line, *bytes)) return tl::unexpected(std::move(*wrong));
  Record record{static_cast<RecordType>((*bytes)[3]),
                static_cast<std::uint16_t>((*bytes)[1] << 8U | (*bytes)[2]),
                {bytes->begin() + 4, bytes->end() - 1}};
  if (auto wrong = wrong_type(line, record)) return tl::unexpected(std::move(*wrong));
  return record;
}

/// The data of all records, by address.
class Memory {
 public:
  bool empty() const { return pieces_.empty(); }

  std::optional<TextProblem> add(std::uint64_t address, std::vector<std::uint8_t> data,
                                 std::size_t line) {
    if (data.empty()) return std::nullopt;
    const auto end = address + data.size();
    if (const auto* other = overlapping(address, end)) {
      return within_line(data_at, "",
                         "there is data for " + text_of(address) + " already, from line " +
                             std::to_string(other->line));
    }
    begin_ = empty() ? address : std::min(begin_, address);
    end_ = std::max(end_, end);
    if (end_ - begin_ > most_image_bytes) {
      return within_line(data_at, "",
                         "an image has at most " + std::to_string(most_image_bytes) +
                             " bytes; from " + text_of(begin_) + " to " + text_of(end_ - 1) +
                             " there are more");
    }
    pieces_.emplace(address, Piece{std::move(data), line});
    return std::nullopt;
  }

  Image image() const {
    Image image{static_cast<std::uint32_t>(begin_), {}};
    image.bytes.assign(end_ - begin_, erased_byte);
    for (const auto& [address, piece] : pieces_) {
      std::ranges::copy(piece.data,
                        image.bytes.begin() + static_cast<std::ptrdiff_t>(address - begin_));
    }
    return image;
  }

 private:
  struct Piece {
    std::vector<std::uint8_t> data;
    std::size_t line = 0;
  };

  static std::string text_of(std::uint64_t address) {
    return address_text(static_cast<std::uint32_t>(address));
  }

  const Piece* overlapping(std::uint64_t begin, std::uint64_t end) const {
    const auto next = pieces_.lower_bound(begin);
    if (next != pieces_.end() && next->first < end) return &next->second;
    if (next == pieces_.begin()) return nullptr;
    const auto before = std::prev(next);
    return before->first + before->second.data.size() > begin ? &before->second : nullptr;
  }

  std::map<std::uint64_t, Piece> pieces_;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
};

class Reader {
 public:
  bool ended() const { return ended_; }
  const Memory& memory() const { return memory_; }

  std::optional<TextProblem> take(std::string_view line, std::size_t number) {
    if (ended_) return within_line(0, printable(line), "nothing may follow the end record");
    auto record = record_of(line);
    if (!record) return std::move(record.error());
    return carry_out(*record, number);
  }

 private:
  std::optional<TextProblem> carry_out(Record& record, std::size_t number) {
    switch (record.type) {
      case RecordType::data: return add(record, number);
      case RecordType::end: ended_ = true; break;
      case RecordType::segment_base: set_base(record, 4); break;
      case RecordType::linear_base: set_base(record, 16); break;
      case RecordType::segment_start:
      case RecordType::linear_start: break;
    }
    return std::nullopt;
  }

  void set_base(const Record& record, unsigned shift) {
    base_ = std::uint64_t{static_cast<std::uint16_t>(record.data[0] << 8U | record.data[1])}
            << shift;
    segmented_ = record.type == RecordType::segment_base;
  }

  std::optional<TextProblem> add(Record& record, std::size_t number) {
    // In a segment the addresses begin again behind the last, and so do all behind 4 GiB. That is
    // never meant; it would put the data where something else should be.
    const auto end = record.offset + record.data.size();
    if (segmented_ && end > segment_size)
      return within_line(data_at, "", "the record runs over the end of its segment");
    if (base_ + end > end_of_addresses)
      return within_line(data_at, "", "the record runs over the last address, 0xFFFFFFFF");
    return memory_.add(base_ + record.offset, std::move(record.data), number);
  }

  Memory memory_;
  std::uint64_t base_ = 0;
  bool segmented_ = false;
  bool ended_ = false;
};

std::string_view without_blanks_at_end(std::string_view line) {
  const auto last = line.find_last_not_of(" \t\r");
  return last == std::string_view::npos ? std::string_view{} : line.substr(0, last + 1);
}

tl::unexpected<TextProblem> problem(std::string message) {
  return tl::unexpected(TextProblem{0, 0, std::move(message)});
}

}  // namespace

std::string address_text(std::uint32_t address) { return "0x" + digits_of(address, 8); }

tl::expected<Image, TextProblem> read_intel_hex(std::string_view text) {
  if (text.size() > most_file_bytes)
    return problem("the file has more than " + std::to_string(most_file_bytes) + " bytes");
  Reader reader;
  std::size_t number = 0;
  while (!text.empty()) {
    ++number;
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = without_blanks_at_end(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    if (auto wrong = reader.take(line, number)) {
      wrong->line = number;
      return tl::unexpected(std::move(*wrong));
    }
  }
  if (!reader.ended()) return problem("there is no end record; the file seems to be cut short");
  if (reader.memory().empty()) return problem("there is no data in it");
  return reader.memory().image();
}

}  // namespace tmcl::firmware
