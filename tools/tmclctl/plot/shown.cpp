#include "plot/shown.hpp"

#include <algorithm>
#include <string_view>

namespace tmclctl::plot {
namespace {

constexpr std::string_view letters = "xvaj";

Reading read_shown(std::string_view list, Shown& into) {
  Shown shown;
  for (std::size_t begin = 0; begin <= list.size();) {
    const auto comma = std::min(list.find(',', begin), list.size());
    const auto word = list.substr(begin, comma - begin);
    const auto place = word.size() == 1 ? letters.find(word.front()) : std::string_view::npos;
    if (place == std::string_view::npos)
      return tl::unexpected(fmt::format("'{}' is none of x, v, a and j", word));
    const auto quantity = static_cast<Quantity>(place);
    if (std::ranges::count(shown, quantity) > 0)
      return tl::unexpected(fmt::format("'{}' is there twice", word));
    shown.push_back(quantity);
    begin = comma + 1;
  }
  into = std::move(shown);
  return {};
}

}  // namespace

Shown or_usual(Shown shown) {
  return shown.empty() ? Shown{Quantity::position, Quantity::velocity} : std::move(shown);
}

Shown or_usual_columns(Shown shown) {
  if (!shown.empty()) return shown;
  return {Quantity::position, Quantity::velocity, Quantity::acceleration};
}

Shown all_quantities() {
  return {Quantity::position, Quantity::velocity, Quantity::acceleration, Quantity::jerk};
}

char letter_of(Quantity quantity) { return letters[static_cast<std::size_t>(quantity)]; }

std::string csv_heading(const Shown& shown) {
  std::string text = "t";
  for (const auto quantity : shown) text += {',', letter_of(quantity)};
  return text + '\n';
}

void add_show(Form& form, Shown& into) {
  form.option("--show", "x,v,a,j",
              "Draw these: position, velocity, acceleration, jerk (default x,v)",
              [&into](const std::string& text) { return read_shown(text, into); });
}

}  // namespace tmclctl::plot
