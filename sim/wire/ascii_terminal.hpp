/// What a module in ASCII mode makes of the characters that it hears.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "tmcl/ascii.hpp"

namespace tmcl::sim {

/// Gathers a line until its carriage return; line feeds count for nothing, and backspace takes the
/// last character back. Echoes only lines that begin with the module's own letter: on a line with
/// several modules not everybody may talk.
class AsciiTerminal {
 public:
  enum class Echo : std::uint8_t { characters, lines, none };

  /// Bits 4 and 5 of global parameter 67; the fourth combination is not told by the manuals.
  static Echo echo_of(std::int32_t mode) {
    constexpr std::int32_t whole_lines = 0x10;
    constexpr std::int32_t no_echo = 0x20;
    if ((mode & no_echo) != 0) return Echo::none;
    return (mode & whole_lines) != 0 ? Echo::lines : Echo::characters;
  }

  struct Heard {
    std::string echo;
    std::optional<std::string> line;  ///< When it has ended. May be longer than allowed, by one.
  };

  Heard push(std::uint8_t byte, std::uint8_t address, Echo echo) {
    const auto character = static_cast<char>(byte);
    if (character == '\r') return end(address, echo);
    if (character == '\b' || character == rubout) return take_back(address, echo);
    if (character < ' ' && character != '\t') return {};
    if (line_.size() > ascii::longest_line) return {};
    line_.push_back(character);
    return {echoed(address, echo, Echo::characters, std::string(1, character)), {}};
  }
  void reset() { line_.clear(); }

 private:
  static constexpr char rubout = '\x7F';

  Heard end(std::uint8_t address, Echo echo) {
    auto text = echoed(address, echo, Echo::characters, "\r") +
                echoed(address, echo, Echo::lines, line_ + '\r');
    return {std::move(text), std::exchange(line_, {})};
  }
  Heard take_back(std::uint8_t address, Echo echo) {
    if (line_.empty()) return {};
    auto text = echoed(address, echo, Echo::characters, "\b \b");
    line_.pop_back();
    return {std::move(text), {}};
  }
  std::string echoed(std::uint8_t address, Echo echo, Echo with, const std::string& text) const {
    const auto meant = ascii::address_of(line_);
    const bool mine = meant && reply_byte(*meant) == address;
    return mine && echo == with ? text : std::string{};
  }

  std::string line_;
};

}  // namespace tmcl::sim
