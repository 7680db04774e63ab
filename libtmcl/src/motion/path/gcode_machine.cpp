#include "motion/path/gcode_machine.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

constexpr std::uint8_t spindle_off = 5;
constexpr std::uint8_t change_of_tool = 6;
constexpr std::uint8_t coolant_off = 9;

bool is_switch(double number) {
  return number == std::round(number) && number >= 3 && number <= coolant_off;
}

}  // namespace

void Machine::take(const Block& block) {
  hides_words_ = false;
  for (const auto& m : block.m()) take_m(m);
  for (const char letter : std::string_view("ST")) {
    if (block.has(letter))
      report_.remark(block.find(letter)->column, fmt::format("{} is not carried out", letter));
  }
  take_tool(block);
}

void Machine::take_m(const Word& m) {
  if (m.value == 2 || m.value == 30) {
    has_ended_ = true;
  } else if (m.value == 0) {
    stands_ = true;
    stop_ = 0;
  } else if (m.value == 1) {
    stands_ = true;
    report_.remark(m.column, "M1 does not wait: the axes stand and go on");
  } else if (is_switch(m.value)) {
    take_switch(static_cast<std::uint8_t>(m.value), m.column);
  } else {
    report_.complain(Wrong{
        m.column, fmt::format("M{} is not known here", plain_number(m.value, 6)), {}, false, true});
    hides_words_ = hides_words_ || report_.skips_unknowns();
  }
}

void Machine::take_switch(std::uint8_t word, std::size_t column) {
  if (!words_.test(word))
    return report_.remark(column, fmt::format("M{} is not carried out", word));
  path_.dwell(0, word);
  if (word == 3 || word == 4) spindle_is_on_ = true;
  if (word == spindle_off) spindle_is_on_ = false;
  if (word == 7 || word == 8) coolant_is_on_ = true;
  if (word == coolant_off) coolant_is_on_ = false;
}

void Machine::take_tool(const Block& block) {
  if (const auto& tool = block.find('T')) tool_chosen_ = tool->value;
  if (std::ranges::find(block.m(), change_of_tool, &Word::value) != block.m().end())
    tool_in_use_ = tool_chosen_;
}

void Machine::end_line() {
  if (std::exchange(stands_, false)) path_.dwell(0, std::exchange(stop_, std::nullopt));
}

void Machine::switch_off() {
  if (spindle_is_on_ && words_.test(spindle_off)) path_.dwell(0, spindle_off);
  if (coolant_is_on_ && words_.test(coolant_off)) path_.dwell(0, coolant_off);
}

}  // namespace tmcl::plan::path_file::gcode
