#include "sim/module/eeprom.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "tmcl/program.hpp"

namespace tmcl::sim {
namespace {

using Area = EepromCell::Area;

// An image: this mark, the model's number, the writes, how many cells, the cells, how many bytes of
// program, the program, and a CRC-32 of all that. Numbers are big endian.
constexpr std::string_view mark = "tmcleep1";
constexpr std::size_t checksum_size = 4;
constexpr std::size_t most_program_bytes = program::most_commands * program::instruction_size;

constexpr auto crc_table = [] {
  constexpr std::uint32_t polynomial = 0xEDB88320;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    auto rest = byte;
    for (int bit = 0; bit < 8; ++bit)
      rest = (rest & 1U) != 0 ? rest >> 1U ^ polynomial : rest >> 1U;
    table[byte] = rest;
  }
  return table;
}();

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0xFFFFFFFF;
  for (const auto byte : bytes) sum = crc_table[(sum ^ byte) & 0xFFU] ^ sum >> 8U;
  return ~sum;
}

class Writer {
 public:
  void put(std::uint64_t value, int size) {
    for (int byte = size - 1; byte >= 0; --byte) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
    }
  }
  // One by one: g++ 14 warns of what it makes of a range.
  template <class Bytes>
  void put_all(const Bytes& bytes) {
    for (const auto byte : bytes) bytes_.push_back(static_cast<std::uint8_t>(byte));
  }
  std::vector<std::uint8_t> finish() {
    put(crc32(bytes_), checksum_size);
    return std::move(bytes_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  /// Zero, and failed(), where there is no more.
  std::uint64_t get(std::size_t size) {
    std::uint64_t value = 0;
    for (const auto byte : get_all(size)) value = value << 8U | byte;
    return value;
  }
  std::span<const std::uint8_t> get_all(std::size_t size) {
    if (size > bytes_.size()) failed_ = true;
    const auto taken = bytes_.first(failed_ ? 0 : size);
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  bool failed() const { return failed_; }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool failed_ = false;
};

bool begins_with_mark(std::span<const std::uint8_t> image) {
  return image.size() >= mark.size() + checksum_size &&
         std::equal(mark.begin(), mark.end(), image.begin());
}

bool is_sound(std::span<const std::uint8_t> image) {
  const auto body = image.first(image.size() - checksum_size);
  return Reader(image.subspan(body.size())).get(checksum_size) == crc32(body);
}

bool exists(EepromCell cell, const Model& model) {
  switch (cell.area) {
    case Area::axis_parameter: return cell.index < model.axes;
    case Area::global_parameter: return true;
    case Area::coordinate: return cell.index < model.axes && cell.number < coordinates_per_motor;
  }
  return false;
}

tl::unexpected<std::string> wrong(std::string sentence) {
  return tl::unexpected(std::move(sentence));
}

std::string foreign(std::uint64_t number, const Model& model) {
  const auto* other = find_model(static_cast<std::uint16_t>(number));
  const auto name = other != nullptr ? std::string(other->name) : "model " + std::to_string(number);
  return "is of a " + name + ", not of a " + std::string(model.name);
}

}  // namespace

std::optional<std::int32_t> Eeprom::read(EepromCell cell) const {
  const auto found = cells_.find(cell);
  return found == cells_.end() ? std::nullopt : std::optional(found->second);
}

void Eeprom::write(EepromCell cell, std::int32_t value) {
  cells_[cell] = value;
  written();
}

void Eeprom::write_program(std::span<const std::uint8_t> bytes) {
  program_.assign(bytes.begin(), bytes.end());
  written();
}

void Eeprom::erase() {
  cells_.clear();
  program_.clear();
  written();
}

void Eeprom::written() {
  ++writes_;
  if (on_write_) on_write_();
}

std::vector<std::uint8_t> Eeprom::to_image(const Model& model) const {
  Writer out;
  out.put_all(mark);
  out.put(model.number, 2);
  out.put(writes_, 8);
  out.put(cells_.size(), 4);
  for (const auto& [cell, value] : cells_) {
    out.put(static_cast<std::uint8_t>(cell.area), 1);
    out.put(cell.index, 1);
    out.put(cell.number, 1);
    out.put(static_cast<std::uint32_t>(value), 4);
  }
  out.put(program_.size(), 4);
  out.put_all(program_);
  return out.finish();
}

tl::expected<Eeprom, std::string> Eeprom::from_image(std::span<const std::uint8_t> image,
                                                     const Model& model) {
  if (!begins_with_mark(image)) return wrong("is not the memory of a simulated module");
  if (!is_sound(image)) return wrong("is damaged: its checksum is wrong");
  Reader in(image.first(image.size() - checksum_size));
  in.get_all(mark.size());
  if (const auto number = in.get(2); number != model.number) {
    return wrong(foreign(number, model));
  }
  const auto senseless = wrong("is damaged: its contents make no sense");
  Eeprom eeprom;
  eeprom.writes_ = in.get(8);
  for (auto cells = in.get(4); cells > 0 && !in.failed(); --cells) {
    const auto area = static_cast<Area>(in.get(1));
    const auto index = static_cast<std::uint8_t>(in.get(1));
    const auto number = static_cast<std::uint8_t>(in.get(1));
    const EepromCell cell{area, index, number};
    if (!exists(cell, model)) return senseless;
    eeprom.cells_[cell] = static_cast<std::int32_t>(in.get(4));
  }
  const auto program = in.get_all(in.get(4));
  if (in.failed() || !in.at_end() || program.size() > most_program_bytes) {
    return senseless;
  }
  eeprom.program_.assign(program.begin(), program.end());
  return eeprom;
}

}  // namespace tmcl::sim
