/// The words that `path check` and `path run` have in common.
#pragma once

#include "verbs.hpp"

namespace tmclctl {

// In the units of a path.
constexpr double least_of_path = 1e-9;
constexpr double most_of_path = 1e9;

template <class T>
void add_path_file(VerbForm<T>& form) {
  const auto in_units = [](auto& into) { return number(into, least_of_path, most_of_path); };
  form.word("FILE", "A table (.csv) or G-code", text(form->file));
  form.option("--tolerance", "UNITS", "How far from it the path may be passed (default 0.05)",
              in_units(form->tolerance));
  form.option("--svg", "FILE", "Draw the path and its axes into this file", svg_file(form->svg));
  form.flag("--lenient", "Skip words of G-code that are not known, with warnings", form->lenient);
}

}  // namespace tmclctl
