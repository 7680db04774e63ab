/// What a world suffers, and how to find the least of it that still makes it fail.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "world/wire.hpp"

namespace tmcld::test {

/// Of a thousand replies: so rarely late that two of them hardly ever meet.
inline constexpr int rarely_late = 3;

/// One reply that comes twice can be taken for the next where nothing moves by it, and so can one
/// that is late, with another one late: see docs/SAFETY.md.
inline bool values_are_right(const Faults& faults) {
  return faults.doubled == 0 && faults.late <= rarely_late;
}

/// What is broken on purpose, so that somebody must notice.
enum class Canary : std::uint8_t {
  none,
  forged_fences,        ///< The wire answers at once what shows that a line is in step.
  foreign_movement,     ///< Somebody else on the line moves an axis.
  movement_after_stop,  ///< Likewise, as it was moved before the stop that has been answered.
  swapped_value,        ///< What a module tells is what it told before, of something else.
  unheard_movement,     ///< The module does not get it, and it is answered as if done.
  doubled_movement,     ///< It goes out twice.
  wrong_outcome,        ///< A client is told that nothing was sent when nobody knows.
  owner_not_missed,     ///< The gateway is not told that a client has gone.
  no_limits,            ///< The gateway knows of no soft limits.
  no_answer,            ///< A client does not get one.
  host_not_missed,      ///< A port does not see that its host has gone.
  unheard_stop,         ///< The module does not get it, and it is answered as if done.
  program_not_told,     ///< An answer does not say that what a program moves is unattended.
  program_not_ended,    ///< A module does not get the end of its program; it is answered as done.
};

struct Trouble {
  Faults faults{};
  bool deaths = true;    ///< Clients lose their connections.
  bool supplies = true;  ///< Modules start again.
  int clients = 4;
  int calls = 40;  ///< Of each client.
  Canary canary = Canary::none;
  bool gaps = false;      ///< The process of the gateway is stopped for a while.
  bool raw = false;       ///< Clients send raw commands, and move to coordinates, too.
  bool doors = false;     ///< Hosts at ports, and a client that has a connection for each call.
  bool programs = false;  ///< Mint programs, and programs in modules.
};

/// Numbers in a fixed order, as TMCL_WORLD takes them.
inline std::string to_text(const Trouble& trouble) {
  std::ostringstream text;
  const auto& faults = trouble.faults;
  text << faults.lost << ',' << faults.late << ',' << faults.doubled << ',' << trouble.deaths << ','
       << trouble.supplies << ',' << trouble.clients << ',' << trouble.calls << ','
       << static_cast<int>(trouble.canary) << ',' << trouble.gaps;
  if (trouble.raw || trouble.doors || trouble.programs) text << ',' << trouble.raw;
  if (trouble.doors || trouble.programs) text << ',' << trouble.doors;
  if (trouble.programs) text << ",1";
  return text.str();
}

inline Trouble trouble_from(const std::string& text) {
  Trouble trouble;
  std::istringstream in(text);
  auto& faults = trouble.faults;
  char comma = 0;
  int canary = 0;
  in >> faults.lost >> comma >> faults.late >> comma >> faults.doubled >> comma >> trouble.deaths >>
      comma >> trouble.supplies >> comma >> trouble.clients >> comma >> trouble.calls >> comma >>
      canary >> comma >> trouble.gaps;
  trouble.canary = static_cast<Canary>(canary);
  const bool is_whole = !in.fail();
  in >> comma >> trouble.raw >> comma >> trouble.doors >> comma >> trouble.programs;
  if (!is_whole)
    throw std::invalid_argument("TMCL_WORLD: nine to twelve numbers, see tests/world/trouble.hpp");
  return trouble;
}

/// Each with less of one kind.
inline std::vector<Trouble> simpler(const Trouble& trouble) {
  std::vector<Trouble> all;
  const auto with = [&](auto change) {
    auto less = trouble;
    change(less);
    if (to_text(less) != to_text(trouble)) all.push_back(less);
  };
  with([](Trouble& less) { less.programs = false; });
  with([](Trouble& less) { less.doors = false; });
  with([](Trouble& less) { less.raw = false; });
  with([](Trouble& less) { less.gaps = false; });
  with([](Trouble& less) { less.supplies = false; });
  with([](Trouble& less) { less.deaths = false; });
  with([](Trouble& less) { less.faults.late = 0; });
  with([](Trouble& less) { less.faults.doubled = 0; });
  with([](Trouble& less) { less.faults.lost = 0; });
  with([](Trouble& less) { less.calls = std::max(less.calls / 2, 1); });
  with([](Trouble& less) { less.calls = std::max(less.calls - 1, 1); });
  with([](Trouble& less) { less.clients = std::max(less.clients - 1, 1); });
  return all;
}

/// As long as one of the simpler ones fails as well; so long at most.
inline Trouble shrunk(Trouble trouble, const std::function<bool(const Trouble&)>& fails,
                      std::chrono::seconds at_most = std::chrono::minutes(2)) {
  const auto until = std::chrono::steady_clock::now() + at_most;
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (const auto& less : simpler(trouble)) {
      if (std::chrono::steady_clock::now() > until) return trouble;
      if (!fails(less)) continue;
      trouble = less;
      goes_on = true;
      break;
    }
  }
  return trouble;
}

}  // namespace tmcld::test
