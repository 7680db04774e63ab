// The bytes as a Mint program, which runs without axes if it can be read.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "require.hpp"
#include "tmcl/plan/mint.hpp"

namespace {

namespace plan = tmcl::plan;
namespace mint = tmcl::plan::mint;
using tmcl::fuzz::require;

void look_at(const tmcl::TextProblems& problems, std::string_view text) {
  // Old systems end lines with \r alone.
  const char end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, end)) + 1;
  require(!problems.empty() && problems.size() <= plan::most_text_problems, "some problems");
  for (const auto& problem : problems) {
    require(!problem.message.empty(), "there is a reason");
    require(problem.line >= 1 && problem.line <= lines, "in a line of the text");
  }
}

void look_at(const mint::DryRun& run) {
  for (const auto& group : run.groups) {
    require(group.duration >= 0 && group.start_time >= 0, "time goes on");
    for (const auto& move : group.moves)
      require(move.axis < mint::most_axes && !std::isnan(move.duration()), "an axis moves");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto program = mint::read(text);
  if (!program) {
    look_at(program.error(), text);
    return 0;
  }
  const auto run = mint::dry_run(*program);
  if (run) {
    look_at(*run);
  } else {
    look_at(run.error(), text);
  }
  return 0;
}
