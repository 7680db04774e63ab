/// What each verb needs, and what it does to modules: the one list of all verbs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tmclctl {

enum class Doors : std::uint8_t {
  both,        ///< Through tmcld, and with --direct.
  tmcld_only,  ///< Refused with --direct.
  offline,     ///< Needs neither.
};

enum class VerbEffect : std::uint8_t {
  reads,  ///< Changes nothing, whatever becomes of it.
  acts,   ///< May have been executed if its outcome is not known.
  tells,  ///< As well, and its own messages say how far it came.
};

struct VerbInfo {
  std::string_view name;  ///< As it is typed: "path run".
  Doors doors = Doors::both;
  VerbEffect effect = VerbEffect::reads;
  std::string_view
      reason{};  ///< Why it does not go through both doors: a sentence without its end.
};

std::span<const VerbInfo> verb_table();
/// Null for what is no verb, such as the first word of several.
const VerbInfo* find_verb(std::string_view name);
/// For --help: through which doors it goes, in a sentence.
std::string doors_text(const VerbInfo& verb);

}  // namespace tmclctl
