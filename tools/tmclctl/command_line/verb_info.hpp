/// What each verb needs, and what it does to modules.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tmclctl {

enum class Doors : std::uint8_t {
  both,        ///< Through tmcld, and with --direct.
  tmcld_only,  ///< Refused with --direct.
  offline,     ///< Needs neither.
  fleet_only,  ///< Through a broker, with --fleet.
};

enum class VerbEffect : std::uint8_t {
  reads,  ///< Changes nothing, whatever becomes of it.
  acts,   ///< May have been executed if its outcome is not known.
  tells,  ///< As well, and its own messages say how far it came.
};

struct Access {
  Doors doors = Doors::both;
  VerbEffect effect = VerbEffect::reads;
  /// Why it does not go through both doors: a sentence without its end.
  std::string_view reason{};
};
namespace access {
inline constexpr Access reads{Doors::both, VerbEffect::reads};
inline constexpr Access acts{Doors::both, VerbEffect::acts};
inline constexpr Access tells{Doors::both, VerbEffect::tells};
constexpr Access tmcld_only(VerbEffect effect, std::string_view reason) {
  return {Doors::tmcld_only, effect, reason};
}
constexpr Access fleet_only(VerbEffect effect) {
  return {Doors::fleet_only, effect, "it is about many gateways"};
}
constexpr Access offline(std::string_view reason) {
  return {Doors::offline, VerbEffect::reads, reason};
}
}  // namespace access

struct VerbInfo : Access {
  std::string name;       ///< As it is typed: "path run".
  bool in_fleet = false;  ///< Also on many gateways at once, with --fleet.
};

/// All verbs.
std::vector<VerbInfo> verb_table();

}  // namespace tmclctl
