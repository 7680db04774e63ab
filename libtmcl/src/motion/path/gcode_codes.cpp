#include "motion/path/gcode_codes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

struct KnownCode {
  int tenths;
  Group group;
};
constexpr std::array known_codes{
    KnownCode{0, Group::motion},          KnownCode{10, Group::motion},
    KnownCode{20, Group::motion},         KnownCode{30, Group::motion},
    KnownCode{40, Group::once},           KnownCode{100, Group::once},
    KnownCode{170, Group::plane},         KnownCode{180, Group::plane},
    KnownCode{190, Group::plane},         KnownCode{200, Group::unit},
    KnownCode{210, Group::unit},          KnownCode{280, Group::once},
    KnownCode{281, Group::once},          KnownCode{300, Group::once},
    KnownCode{301, Group::once},          KnownCode{400, Group::tool_radius},
    KnownCode{430, Group::tool_length},   KnownCode{431, Group::tool_length},
    KnownCode{490, Group::tool_length},   KnownCode{520, Group::once},
    KnownCode{530, Group::once},          KnownCode{540, Group::system},
    KnownCode{550, Group::system},        KnownCode{560, Group::system},
    KnownCode{570, Group::system},        KnownCode{580, Group::system},
    KnownCode{590, Group::system},        KnownCode{610, Group::corners},
    KnownCode{611, Group::corners},       KnownCode{640, Group::corners},
    KnownCode{800, Group::end_of_cycles}, KnownCode{900, Group::distance},
    KnownCode{901, Group::centres},       KnownCode{910, Group::distance},
    KnownCode{911, Group::centres},       KnownCode{920, Group::once},
    KnownCode{921, Group::once},          KnownCode{922, Group::once},
    KnownCode{923, Group::once},          KnownCode{930, Group::feed},
    KnownCode{940, Group::feed},          KnownCode{950, Group::feed}};

/// What is known of a code that is refused.
struct RefusedCode {
  int first, last;  ///< In tenths.
  const char* why;
  bool hides_words = true;
  bool hides_motion = false;
};
constexpr std::array refused_codes{
    RefusedCode{50, 69, "splines are not read", true, true},
    RefusedCode{330, 331, "no spindle leads the axes", true, true},
    RefusedCode{380, 389, "there is no probe", true, true},
    RefusedCode{410, 421, "the radius of a tool is not known", false},
    RefusedCode{432, 432, "one length of a tool holds at a time"},
    RefusedCode{730, 730, "drilling cycles are not read", true, true},
    RefusedCode{760, 760, "no spindle leads the axes", true, true},
    RefusedCode{810, 890, "drilling cycles are not read", true, true}};

std::string name_of(int tenths) { return "G" + plain_number(tenths / 10.0, 6); }

}  // namespace

Codes::Codes(const Block& block) {
  for (const auto& word : block.g()) add(word);
  check_together();
}

bool Codes::take_axes() const { return are(Group::tool_length, 431) || once_takes_axes(); }

bool Codes::once_takes_axes() const {
  const auto code = of(Group::once);
  return code && *code != 530 && *code != 281 && *code != 301 && *code != 921 && *code != 922 &&
         *code != 923;
}

void Codes::add(const Word& word) {
  constexpr double most = 1000;
  const double tenths = word.value * 10;
  const bool may_be_known = std::abs(tenths) < most && std::abs(tenths - std::round(tenths)) < 1e-6;
  const int code = may_be_known ? static_cast<int>(std::lround(tenths)) : -1;
  const auto known = std::ranges::find(known_codes, code, &KnownCode::tenths);
  if (known == known_codes.end()) return add_unknown(word, code);
  const auto group = static_cast<std::size_t>(known->group);
  if (known->group == Group::motion && codes_[group]) {
    wrongs_.push_back({word.column, "there are two movements on this line", {}, true});
  } else if (codes_[group] && *codes_[group] != code) {
    wrongs_.push_back(
        {word.column,
         fmt::format("{} and {} exclude each other", name_of(*codes_[group]), name_of(code)),
         {},
         true});
  }
  codes_[group] = code;
  columns_[group] = word.column;
}

void Codes::add_unknown(const Word& word, int tenths) {
  auto message = fmt::format("G{} is not known here", plain_number(word.value, 6));
  const auto refused = std::ranges::find_if(refused_codes, [&](const RefusedCode& one) {
    return one.first <= tenths && tenths <= one.last;
  });
  const bool is_refused = refused != refused_codes.end();
  if (is_refused) message += fmt::format(": {}", refused->why);
  const bool hides = !is_refused || refused->hides_words;
  hide_words_ = hide_words_ || hides;
  hide_motion_ = hide_motion_ || (is_refused && refused->hides_motion);
  wrongs_.push_back({word.column, std::move(message), {}, hides, true});
}

void Codes::check_together() {
  const bool lengthens = are(Group::tool_length, 431);
  const auto group = lengthens ? Group::tool_length : Group::once;
  if (lengthens && once_takes_axes()) exclude(group, Group::once, name_of(*of(Group::once)));
  if (of(Group::motion) && take_axes()) exclude(group, Group::motion, "a movement");
}

void Codes::exclude(Group one, Group other, const std::string& what) {
  wrongs_.push_back({std::max(column_of(one), column_of(other)),
                     fmt::format("{} and {} exclude each other", name_of(*of(one)), what),
                     {},
                     true});
}

}  // namespace tmcl::plan::path_file::gcode
