// What was found of a module, as a file that tmclsim and tmcld take and people read.
#include <chrono>

#include <fmt/format.h>

#include "tmcl/model.hpp"
#include "tmcl/seconds.hpp"
#include "tmcl/verification.hpp"

namespace tmcl {
namespace {

std::string words_of(const TraitInfo& info, const std::vector<std::uint8_t>& variants) {
  std::string words;
  for (const auto variant : variants)
    words += (words.empty() ? "" : " or ") + std::string(info.variants[variant]);
  return words;
}

std::string line_of(const TraitFinding& finding) {
  const auto& info = trait_table()[static_cast<std::size_t>(finding.trait)];
  const auto expected = info.variants[finding.expected];
  if (const auto variant = finding.found()) {
    const auto pair = fmt::format("{} = \"{}\"", info.name, info.variants[*variant]);
    const auto judged = *variant == finding.expected ? "as foreseen" : "foreseen was";
    const auto other = *variant == finding.expected ? "" : fmt::format(" {}", expected);
    return fmt::format("{:<34}# {}{}: {}\n", pair, judged, other, finding.text);
  }
  if (!finding.measured)
    return fmt::format("# {}: not measured, {} was taken for granted: {}\n", info.name, expected,
                       finding.text);
  if (finding.fits.empty())
    return fmt::format("# {}: like no known variant; foreseen was {}: {}\n", info.name, expected,
                       finding.text);
  return fmt::format("# {}: {}; foreseen was {}: {}\n", info.name, words_of(info, finding.fits),
                     expected, finding.text);
}

std::string line_of(const VerifiedMove& move) {
  return fmt::format("#   {:>4} microsteps, {}: foreseen {:.4f} s, took {:.4f} to {:.4f} s\n",
                     move.distance, move.settings, seconds(move.foreseen), seconds(move.least),
                     seconds(move.most));
}

}  // namespace

std::string report_of(const Verification& verification, std::string_view of) {
  const std::string_view name = verification.model->name;
  auto text = fmt::format(
      "# What a {0} is like, by 'tmclctl verify' on {1}. To make a simulated module like it:\n"
      "#   tmclsim --module {0} --as FILE\n"
      "# To foresee its movements as it makes them: as = \"FILE\" in a [[module]] of tmcld.toml.\n"
      "[module]\nmodel = \"{0}\"\nfirmware_version = \"{2}\"\n",
      name, of, to_string(verification.version));
  if (verification.answer) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(*verification.answer);
    text += fmt::format("{:<34}# the quickest, as far as the line lets that be seen\n",
                        fmt::format("answer_us = {}", us.count()));
  }
  for (const auto& finding : verification.traits) text += line_of(finding);
  if (!verification.moves.empty()) text += "# Its movements:\n";
  for (const auto& move : verification.moves) text += line_of(move);
  return text;
}

}  // namespace tmcl
