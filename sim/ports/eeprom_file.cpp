#include "sim/ports/eeprom_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>

#include <array>
#include <cstring>
#include <iostream>
#include <span>
#include <vector>

#include "tmcl/file_descriptor.hpp"

namespace tmcl::sim {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

/// Far more than any EEPROM holds.
constexpr std::size_t most_bytes = std::size_t{1} << 20;

tl::unexpected<std::string> failed(const fs::path& path, const std::string& reason) {
  return tl::unexpected(path.string() + " " + reason);
}

tl::unexpected<std::string> system_error(const fs::path& path, const std::string& what) {
  return failed(path, what + ": " + std::strerror(errno));
}

// One byte too many is enough to see that it is no EEPROM.
std::optional<Bytes> read_all(int file) {
  Bytes bytes;
  std::array<std::uint8_t, 4096> part{};
  while (bytes.size() <= most_bytes) {
    const auto count = ::read(file, part.data(), part.size());
    if (count < 0) return std::nullopt;
    if (count == 0) break;
    bytes.insert(bytes.end(), part.begin(), part.begin() + count);
  }
  return bytes;
}

bool write_all(int file, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const auto count = ::write(file, bytes.data(), bytes.size());
    if (count < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return ::fsync(file) == 0;
}

}  // namespace

tl::expected<std::optional<Eeprom>, std::string> read_eeprom_file(const fs::path& path,
                                                                  const Model& model) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) {
    if (errno == ENOENT) return std::nullopt;
    return system_error(path, "cannot be opened");
  }
  const auto bytes = read_all(file.get());
  if (!bytes) return system_error(path, "cannot be read");
  auto eeprom = Eeprom::from_image(*bytes, model);
  if (!eeprom) return failed(path, eeprom.error());
  return std::optional(std::move(*eeprom));
}

tl::expected<void, std::string> write_eeprom_file(const fs::path& path, const Eeprom& eeprom,
                                                  const Model& model) {
  std::error_code ignored;  // what cannot be made cannot be opened either
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), ignored);
  auto fresh = path;
  fresh += ".new";
  // What stands there is left over, or a link to a file that is not ours to write.
  ::unlink(fresh.c_str());
  const FileDescriptor file(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) return system_error(fresh, "cannot be written");
  const bool written = write_all(file.get(), eeprom.to_image(model));
  if (!written || ::rename(fresh.c_str(), path.c_str()) != 0) {
    const auto error = system_error(path, "cannot be written");
    ::unlink(fresh.c_str());
    return error;
  }
  return {};
}

EepromFile::EepromFile(boost::asio::io_context& io, Module& module, fs::path path)
    : module_(&module), path_(std::move(path)), timer_(io.get_executor()) {
  module_->eeprom().on_write([this] { changed(); });
}

EepromFile::~EepromFile() {
  module_->eeprom().on_write({});
  if (dirty_) save();
}

void EepromFile::changed() {
  if (std::exchange(dirty_, true)) return;
  timer_.expires_after(delay);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) save();
  });
}

void EepromFile::save() {
  dirty_ = false;
  const auto written = write_eeprom_file(path_, module_->eeprom(), module_->model());
  if (!written) std::cerr << "tmclsim: " << written.error() << '\n';
}

}  // namespace tmcl::sim
