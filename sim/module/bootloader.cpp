#include "sim/module/bootloader.hpp"

#include <algorithm>
#include <numeric>

#include "tmcl/bootloader.hpp"

namespace tmcl::sim {
namespace {

using bootloader::Info;
using bootloader::Seal;

using Word = std::array<std::uint8_t, Flash::word_size>;

Word bytes_of(std::uint32_t word) {
  Word bytes{};
  for (auto& byte : bytes) {
    byte = static_cast<std::uint8_t>(word & 0xFFU);
    word >>= 8U;
  }
  return bytes;
}

std::uint32_t unsigned_value(const Request& request) {
  return static_cast<std::uint32_t>(request.value);
}

Answer telling(std::uint32_t value) {
  return {Answer::Form::reply, Status::ok, static_cast<std::int32_t>(value)};
}

}  // namespace

Status check_bootloader_entry(const Request& request) {
  if (request.type != bootloader::entry_type) return Status::wrong_type;
  const bool meant = request.motor == bootloader::entry_motor &&
                     unsigned_value(request) == bootloader::entry_value;
  return meant ? Status::ok : Status::invalid_value;
}

Bootloader::Bootloader(std::uint16_t model, FirmwareVersion firmware) : model_(model) {
  clear_buffer();
  std::array<std::uint8_t, version_text_size> text{};
  std::ranges::copy(to_text(firmware), text.begin());
  flash_.write(Flash::start, text);
  write_word(length_address, text.size());
  write_word(checksum_address, sum_to(Flash::start + text.size() - 1));
}

Answer Bootloader::execute(const Request& request) {
  switch (request.command) {
    case Command::GET_FIRMWARE_VERSION: return tell_version(request);
    case Command::BOOT_ERASE_ALL: return erase(request);
    case Command::BOOT_WRITE_BUFFER: return fill_buffer(request);
    case Command::BOOT_WRITE_PAGE: return write_page(request);
    case Command::BOOT_GET_CHECKSUM: return tell_checksum(request);
    case Command::BOOT_READ_MEMORY: return read_memory(request);
    case Command::BOOT_GET_INFO: return tell_info(request);
    case Command::BOOT_WRITE_LENGTH: return write_length(request);
    case Command::BOOT_START_APPLICATION:
    case Command::ENTER_BOOTLOADER: return {Answer::Form::none, Status::ok, 0};
    default: return echo(request, Status::invalid_command);
  }
}

Answer Bootloader::tell_version(const Request& request) const {
  switch (static_cast<VersionForm>(request.type)) {
    case VersionForm::text: return {Answer::Form::version_text, Status::ok, 0};
    case VersionForm::binary: return {Answer::Form::reply, Status::ok, to_value(version())};
  }
  return echo(request, Status::wrong_type);
}

Answer Bootloader::erase(const Request& request) {
  flash_.erase();
  clear_buffer();
  return echo(request);
}

Answer Bootloader::fill_buffer(const Request& request) {
  const auto offset = Flash::word_size * (request.type + 256U * request.motor);
  if (offset >= buffer_.size()) return echo(request, Status::invalid_value);
  std::ranges::copy(bytes_of(unsigned_value(request)), buffer_.begin() + offset);
  return echo(request);
}

Answer Bootloader::write_page(const Request& request) {
  const auto address = unsigned_value(request);
  if (!Flash::contains(address)) return echo(request, Status::invalid_value);
  flash_.write(address / Flash::page_size * Flash::page_size, buffer_);
  clear_buffer();
  return echo(request);
}

Answer Bootloader::tell_checksum(const Request& request) const {
  const auto last = unsigned_value(request);
  if (!Flash::contains(last)) return echo(request, Status::invalid_value);
  return telling(sum_to(last));
}

Answer Bootloader::read_memory(const Request& request) const {
  const auto address = unsigned_value(request);
  const bool aligned = address % Flash::word_size == 0;
  if (!aligned || !Flash::contains(address)) return echo(request, Status::invalid_value);
  return telling(word_at(address));
}

Answer Bootloader::tell_info(const Request& request) const {
  switch (static_cast<Info>(request.type)) {
    case Info::page_size: return telling(Flash::page_size);
    case Info::start: return telling(Flash::start);
    case Info::size: return telling(Flash::size);
  }
  return echo(request, Status::wrong_type);
}

Answer Bootloader::write_length(const Request& request) {
  switch (static_cast<Seal>(request.type)) {
    case Seal::length: write_word(length_address, unsigned_value(request)); return echo(request);
    case Seal::checksum:
      write_word(checksum_address, unsigned_value(request));
      return echo(request);
  }
  return echo(request, Status::wrong_type);
}

void Bootloader::write_word(std::uint32_t address, std::uint32_t word) {
  flash_.write(address, bytes_of(word));
}

std::uint32_t Bootloader::word_at(std::uint32_t address) const {
  const auto bytes = flash_.read(address, Flash::word_size);
  return std::accumulate(bytes.rbegin(), bytes.rend(), std::uint32_t{0},
                         [](std::uint32_t word, std::uint8_t byte) { return word << 8U | byte; });
}

std::uint32_t Bootloader::sum_to(std::uint32_t last) const {
  const auto bytes = flash_.read(Flash::start, last - Flash::start + 1);
  return std::accumulate(bytes.begin(), bytes.end(), std::uint32_t{0});
}

bool Bootloader::has_firmware() const {
  const auto length = word_at(length_address);
  const bool possible = length > 0 && length <= length_address - Flash::start;
  return possible && sum_to(Flash::start + length - 1) == word_at(checksum_address);
}

FirmwareVersion Bootloader::firmware_version(FirmwareVersion otherwise) const {
  if (!has_firmware()) return otherwise;
  const firmware::Image image{Flash::start, flash_.read(Flash::start, word_at(length_address))};
  return firmware::version_for(image, model_).value_or(otherwise);
}

}  // namespace tmcl::sim
