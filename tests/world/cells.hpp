/// Which cells judge() is asked about while worlds run: see support/judged_cells.hpp. The linker
/// puts the count between it and those who ask.
#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <map>
#include <optional>

#include "support/judged_cells.hpp"

namespace tmcld::test {

class CellCount {
 public:
  /// A row more than there are states, for a motor of which nothing is known.
  static constexpr std::size_t rows = 19;

  void note(const JudgedCase& it, const tmcl::Intent& intent);
  std::size_t judgements() const { return judgements_; }

  /// A table for each kind of caller: what is known of the motor, by what the command does.
  void print(std::ostream& out) const;

 private:
  using Counts = std::array<std::size_t, rows>;
  /// Nothing where there is no such cell.
  std::optional<std::size_t> in(const KindOfIntent& kind, std::size_t caller,
                                std::size_t state) const;

  using OfIntent = std::array<Counts, 5>;  ///< By caller.

  std::map<KindOfIntent, OfIntent> counts_;
  std::size_t judgements_ = 0;
};

/// Of all judgements in this process.
CellCount& cell_count();

}  // namespace tmcld::test
