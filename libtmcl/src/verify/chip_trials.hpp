/// Movements by which the variants of a TMC429 are told apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "verify/chip_candidates.hpp"
#include "verify/inquiry.hpp"
#include "verify/watched_axis.hpp"

namespace tmcl::verbs {

/// The axis stands at home, and ends there.
class ChipTrials {
 public:
  ChipTrials(Inquiry& inquiry, WatchedAxis& watched, Room room)
      : inquiry_(inquiry),
        watched_(watched),
        room_(room),
        candidates_(inquiry.options().expected) {}

  /// Until they are told apart, or no movement helps. Errors: those of WatchedAxis.
  Script<Result<void>> run();

 private:
  Script<std::optional<std::size_t>> choose(plan::ChipCandidates::Pairs pairs_of) const;
  Script<Result<void>> level();
  /// The one of that number in experiments(), there and back.
  Script<Result<void>> make(std::size_t number);
  Script<Result<void>> way(std::size_t number, std::int32_t target);
  bool is_within(const plan::Experiment& experiment) const;
  void conclude();

  Inquiry& inquiry_;
  WatchedAxis& watched_;
  Room room_;
  plan::ChipCandidates candidates_;
  std::int32_t offset_ = 0;  ///< From home, in the direction of the movements.
  std::array<unsigned, 64> made_{};
};

}  // namespace tmcl::verbs
