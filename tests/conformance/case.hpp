/// Conformance cases: what a module answers, written as text that can be read beside its manual.
///
///     # A comment. Cases of one family of commands are in one file.
///     module TMCM-1110 TMCM-6212           each case below is run on both
///
///     case MST brings a motor to rest
///       stage left_switch = -1000          a line of the axis in the simulator's bench file
///       setting behaviour = "lite"         a line of the module in that file
///       before GAP 3, 0 -> 100 0           command, status and value of the reply
///       ROR 0, 350 -> 100 350              "-> 100" alone leaves the value open
///       MST 0 -> 100 0
///       raw 01 03 00 00 00 00 00 00 04 -> 02 01 64 03 00 00 00 00 6A
///       wait 50 ms
///       until 2 s GAP 3, 0 -> 100 0        asked again until the reply fits
///       event 128 1                        a datagram that comes by itself, within two seconds
///       FACTORY_RESET 0, 0, 1234 -> silence
///       GET_FIRMWARE_VERSION 0, 0, 0 -> text 1110V113
///       console input 1 0 1                a line for tmclsim's console
///       restart                            the power goes off and on; what is stored stays
///       program                            downloaded; text in the assembler's language
///         CALC LOAD, 1
///       end
///       parameter 5, 0 default 500 takes 0 2047 refuses -1 2048
///       reads 8, 0 1                       a parameter that cannot be written, and its value
///
/// "before" and "after" tell the reader what a line is for. A command that programs know is written
/// as in a program; others have type, motor and value.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/program.hpp"

namespace tmcl::conformance {

using Bytes = std::vector<std::uint8_t>;

struct Expected {
  enum class Kind : std::uint8_t { reply, silence, text };
  Kind kind = Kind::reply;
  int status = 100;
  std::optional<std::int32_t> value{};
  std::string text{};
};

/// What one line of a case does.
struct Ask {
  Request request;
  Expected expected;
  std::chrono::milliseconds patience{0};  ///< 0: the first reply counts.
};
struct RawExchange {
  Bytes request;
  Bytes reply;
};
struct Wait {
  std::chrono::milliseconds time;
};
struct Event {
  int status = 0;
  std::int32_t value = 0;
};
struct Console {
  std::string line;
};
struct Restart {};
struct Download {
  program::Program program;
};

struct Line {
  std::size_t number = 0;
  std::variant<Ask, RawExchange, Wait, Event, Console, Restart, Download> action;
};

struct Case {
  std::string file;
  std::string title;
  std::size_t line = 0;  ///< Where it begins.
  const Model* model = nullptr;
  std::vector<std::string> stage;     ///< Lines for the bench file's axis.
  std::vector<std::string> settings;  ///< Lines for its module.
  std::vector<Line> lines;
};

/// All cases of all files in tests/conformance/cases. Throws std::runtime_error that names file and
/// line.
std::vector<Case> load_cases();

/// The nine bytes of a request, and of a reply of module 1 to host 2: worked out here, so that the
/// library's own code is held against it.
Bytes serial_bytes(const Request& request);
Bytes serial_bytes(int status, std::uint8_t command, std::int32_t value);

}  // namespace tmcl::conformance
