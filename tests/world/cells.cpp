#include "world/cells.hpp"

#include <ostream>
#include <string>

#include <fmt/format.h>

namespace tmcld::test {
/// The linker gives judge() this name, and has who asks it call count_and_judge() instead: see
/// tests/CMakeLists.txt.
Verdict real_judge(const MotorState& state, const tmcl::Intent& intent, const Permit& permit,
                   tmcl::TimePoint now) asm("__real_" TMCL_JUDGE);

namespace {

/// Nothing keeps a read or a stop back, and the gate does not ask about it.
std::vector<KindOfIntent> kinds_asked_about() {
  std::vector<KindOfIntent> kinds;
  for (const auto& intent : one_intent_of_each_kind()) {
    const bool is_asked_about =
        intent.effect == tmcl::Effect::writes || intent.effect == tmcl::Effect::moves;
    if (is_asked_about) kinds.push_back(kind_of(intent));
  }
  return kinds;
}

}  // namespace

Verdict count_and_judge(const MotorState& state, const tmcl::Intent& intent, const Permit& permit,
                        tmcl::TimePoint now) asm("__wrap_" TMCL_JUDGE);
Verdict count_and_judge(const MotorState& state, const tmcl::Intent& intent, const Permit& permit,
                        tmcl::TimePoint now) {
  cell_count().note({state, permit, now}, intent);
  return real_judge(state, intent, permit, now);
}

CellCount& cell_count() {
  static CellCount count;
  return count;
}

void CellCount::note(const JudgedCase& it, const tmcl::Intent& intent) {
  ++judgements_;
  auto& counts = counts_[kind_of(intent)].at(static_cast<std::size_t>(caller_of(it)));
  bool is_bare = true;
  for (std::size_t i = 0; i < states().size(); ++i) {
    if (!states()[i].holds(it)) continue;
    is_bare = false;
    ++counts.at(i);
  }
  if (is_bare) ++counts.back();
}

std::optional<std::size_t> CellCount::in(const KindOfIntent& kind, std::size_t caller,
                                         std::size_t state) const {
  const bool is_bare = state == states().size();
  if (!is_bare && !is_possible(callers().at(caller), states()[state])) return std::nullopt;
  const auto found = counts_.find(kind);
  return found == counts_.end() ? 0 : found->second.at(caller).at(state);
}

void CellCount::print(std::ostream& out) const {
  const auto kinds = kinds_asked_about();
  std::size_t cells = 0, reached = 0;
  for (std::size_t caller = 0; caller < callers().size(); ++caller) {
    out << fmt::format("\ncells of {}, by what a command does:\n", callers().at(caller).name);
    for (std::size_t i = 0; i < kinds.size(); ++i) out << fmt::format("{:>7}", i + 1);
    out << '\n';
    for (std::size_t state = 0; state < rows; ++state) {
      for (const auto& kind : kinds) {
        const auto count = in(kind, caller, state);
        cells += count ? 1U : 0U;
        reached += count.value_or(0) > 0 ? 1U : 0U;
        out << fmt::format("{:>7}", !count ? "-" : *count == 0 ? "." : std::to_string(*count));
      }
      out << fmt::format("  {}\n",
                         state == states().size() ? "nothing else" : states()[state].name);
    }
  }
  out << '\n';
  for (std::size_t i = 0; i < kinds.size(); ++i)
    out << fmt::format("{:>7} = {}\n", i + 1, name_of(kinds[i]));
  out << fmt::format("cells: {} of {} reached (. is never, - cannot be), by {} judgements\n",
                     reached, cells, judgements_);
}

}  // namespace tmcld::test
