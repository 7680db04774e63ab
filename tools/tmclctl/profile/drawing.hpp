/// Simulated movements as curves.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plot/picture.hpp"
#include "profile/load_run.hpp"
#include "profile/setup.hpp"

namespace tmclctl::profile {

/// A movement that was followed.
struct Profile {
  std::string label;  ///< What tells it from the others.
  Setup setup;
  std::unique_ptr<Simulation> simulation;
  Outcome outcome;
  plot::Recording recording{};    ///< What is drawn of it; see record().
  std::optional<LoadRun> load{};  ///< What it moves, if that was to be followed.
};

/// A generator that swings has no end: without --until, so many phases are drawn.
constexpr std::size_t most_drawn_phases = 40;

/// Its motion at evenly spread times, and in each phase. `all`: however many phases there are.
Result<plot::Recording> record(const Profile& profile, bool all);

/// Of recorded profiles: the first with its phases; of more than one, all of them without.
plot::Picture picture_of(const std::vector<Profile>& profiles, const plot::Shown& shown);
/// It moves on behind the last phase that was recorded.
bool goes_on(const Profile& profile);

}  // namespace tmclctl::profile
