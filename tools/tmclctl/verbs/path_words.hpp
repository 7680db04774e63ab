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

template <class T>
void add_shaping(VerbForm<T>& form) {
  auto& said = form->shaping;
  form.option("--shape", "SHAPER", "zv, zvd or ei: let loads hardly swing after the path",
              [&said](const std::string& text) -> Reading {
                said.shaper = tmcl::plan::shaper_named(text);
                if (said.shaper) return {};
                return tl::unexpected("'" + text + "' is none of zv, zvd and ei");
              });
  form.option("--resonance", "HZ", "How fast they swing: for --shape, and what is said of --jerk",
              resonance(said.resonance_hz));
  form.option("--damping", "D", "Of those swings: 0 to less than 1 (default 0.05)",
              number(said.damping, 0, tmcl::ramp::greatest_load_damping));
}
/// Empty if its words go together.
inline const char* objection_to(const verb::ShapedPath& said, bool has_jerk) {
  if (said.shaper && !said.resonance_hz) return "--shape needs --resonance";
  if (said.resonance_hz && !said.shaper && !has_jerk) return "--resonance needs --shape or --jerk";
  return said.damping && !said.resonance_hz ? "--damping needs --resonance" : "";
}

}  // namespace tmclctl
