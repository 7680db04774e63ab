/// What a module remembers, in a file between runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <boost/asio/io_context.hpp>
#include <tl/expected.hpp>

#include "sim/module/module.hpp"
#include "tmcl/timer.hpp"

namespace tmcl::sim {

/// Nothing if there is no such file. The error is a sentence that begins with the file: it cannot
/// be read, is damaged, or belongs to another model.
tl::expected<std::optional<Eeprom>, std::string> read_eeprom_file(const std::filesystem::path& path,
                                                                  const Model& model);

/// Replaces the file as a whole: a reader finds the old one or the new one. Makes its
/// folder if there is none. The error is a sentence.
tl::expected<void, std::string> write_eeprom_file(const std::filesystem::path& path,
                                                  const Eeprom& eeprom, const Model& model);

/// Writes the file of a module some time after its EEPROM was written, many changes at once.
class EepromFile {
 public:
  static constexpr auto delay = std::chrono::milliseconds(200);

  /// The module must outlive this. What goes wrong later is said on standard error.
  EepromFile(boost::asio::io_context& io, Module& module, std::filesystem::path path);
  EepromFile(const EepromFile&) = delete;
  EepromFile& operator=(const EepromFile&) = delete;
  /// Writes what has not been written yet.
  ~EepromFile();

 private:
  void changed();
  void save();

  Module* module_;
  std::filesystem::path path_;
  Timer timer_;
  bool dirty_ = false;
};

}  // namespace tmcl::sim
