/// What a module remembers without power.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"

namespace tmcl::sim {

/// Number 0 of each motor is RAM only.
constexpr std::size_t coordinates_per_motor = 21;

/// Where a number is kept.
struct EepromCell {
  enum class Area : std::uint8_t { axis_parameter, global_parameter, coordinate };
  Area area;
  std::uint8_t index;   ///< Motor, or bank of global parameters.
  std::uint8_t number;  ///< Of the parameter or coordinate.
  auto operator<=>(const EepromCell&) const = default;
};

/// A cell that was never written holds the factory setting, whatever that is: an Eeprom knows only
/// what differs from it. A real one wears, so writes are counted, all of them, over its whole life.
class Eeprom {
 public:
  std::optional<std::int32_t> read(EepromCell cell) const;
  void write(EepromCell cell, std::int32_t value);
  /// As write(), but it is how the module left the factory, or its owner's bench: not counted.
  void preset(EepromCell cell, std::int32_t value) { cells_[cell] = value; }

  /// The stand-alone program in the form of a program file (tmcl/program.hpp); empty if there is
  /// none.
  std::span<const std::uint8_t> program() const { return program_; }
  void write_program(std::span<const std::uint8_t> bytes);

  /// Back to the factory settings.
  void erase();

  std::uint64_t writes() const { return writes_; }
  /// Called after every write. The callback must not write.
  void on_write(std::function<void()> callback) { on_write_ = std::move(callback); }

  /// The contents as bytes, for a file between runs: with the model, and a sum at the end.
  std::vector<std::uint8_t> to_image(const Model& model) const;
  /// The error is a sentence about the image without a subject or full stop, such as "is of a
  /// TMCM-6110, not of a TMCM-1110": for what is no image, is damaged or is another model's.
  static tl::expected<Eeprom, std::string> from_image(std::span<const std::uint8_t> image,
                                                      const Model& model);

 private:
  void written();

  std::map<EepromCell, std::int32_t> cells_;
  std::vector<std::uint8_t> program_;
  std::uint64_t writes_ = 0;
  std::function<void()> on_write_;
};

}  // namespace tmcl::sim
