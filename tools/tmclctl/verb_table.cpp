#include "verb_table.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace tmclctl {
namespace {

using enum Doors;
using enum VerbEffect;

constexpr std::string_view computes = "it computes, and asks no module";
constexpr std::string_view alone = "with --direct nobody else is there";
constexpr std::string_view files = "it is about files";
constexpr std::string_view tables = "it shows what this program knows";
constexpr std::string_view looks = "it opens no port";
constexpr std::string_view leads =
    "with --direct it is the program that began a path that leads it";

constexpr auto table = std::to_array<VerbInfo>({
    {"ports", offline, reads, looks},
    {"scan", both, reads},
    {"modules", both, reads},
    {"axes", both, reads},
    {"params", both, reads},
    {"models", offline, reads, tables},
    {"get", both, reads},
    {"set", both, acts},
    {"move", both, acts},
    {"wait", both, reads},
    {"line", both, acts},
    {"rotate", both, acts},
    {"lease run", tmcld_only, tells, alone},
    {"lease list", tmcld_only, reads, alone},
    {"lease break", tmcld_only, acts, alone},
    {"token add", tmcld_only, acts, alone},
    {"token list", tmcld_only, reads, alone},
    {"token revoke", tmcld_only, acts, alone},
    {"stop", both, acts},
    {"state", both, reads},
    {"watch", both, reads},
    {"top", both, reads},
    {"buses", both, reads},
    {"trace", tmcld_only, reads, alone},
    {"plot", both, acts},
    {"capture", both, acts},
    {"home", both, acts},
    {"recover", both, acts},
    {"errors", both, reads},
    {"deadman set", both, acts},
    {"deadman off", both, acts},
    {"deadman test", both, acts},
    {"verify", both, acts},
    {"coordinate set", both, acts},
    {"coordinate get", both, reads},
    {"coordinate capture", both, acts},
    {"coordinate move", both, acts},
    {"coordinate start", both, acts},
    {"coordinate store", both, acts},
    {"coordinate load", both, acts},
    {"arrivals", both, tells},
    {"store", both, acts},
    {"restore", both, acts},
    {"global get", both, reads},
    {"global set", both, acts},
    {"global store", both, acts},
    {"global restore", both, acts},
    {"input", both, reads},
    {"output", both, acts},
    {"info", both, reads},
    {"reset", both, acts},
    {"factory-reset", both, acts},
    {"raw", both, acts},
    {"firmware info", offline, reads, files},
    {"firmware check", both, reads},
    {"firmware upload", both, tells},
    {"profile simulate", offline, reads, computes},
    {"profile solve", offline, reads, computes},
    {"mint check", offline, reads, computes},
    {"mint run", both, tells},
    {"path check", offline, reads, computes},
    {"path run", both, tells},
    {"path pause", tmcld_only, acts, leads},
    {"path resume", tmcld_only, acts, leads},
    {"path stop", tmcld_only, acts, leads},
    {"program assemble", offline, reads, files},
    {"program disassemble", offline, reads, files},
    {"program upload", both, acts},
    {"program verify", both, reads},
    {"program download", both, reads},
    {"program run", both, acts},
    {"program stop", both, acts},
    {"program step", both, acts},
    {"program reset", both, acts},
    {"program status", both, reads},
    {"program breakpoint", both, acts},
    {"program clear-breakpoint", both, acts},
    {"program clear-breakpoints", both, acts},
    {"ramp", both, acts},
    {"convert", offline, reads, computes},
});

}  // namespace

std::span<const VerbInfo> verb_table() { return table; }

const VerbInfo* find_verb(std::string_view name) {
  const auto* found = std::ranges::find(table, name, &VerbInfo::name);
  return found != table.end() ? found : nullptr;
}

std::string doors_text(const VerbInfo& verb) {
  switch (verb.doors) {
    case both: return "Goes through tmcld, and straight on a bus with --direct.\n";
    case tmcld_only: return fmt::format("Goes through tmcld only: {}.\n", verb.reason);
    case offline: return fmt::format("Needs neither tmcld nor a bus: {}.\n", verb.reason);
  }
  return {};
}

}  // namespace tmclctl
