#include "method_words.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "command_line/verb_info.hpp"

namespace tmclctl {
namespace {

constexpr auto words_of_methods = std::to_array<MethodWord>({
    {"rpc.discover", "--help"},
    // No verb lists the buses; this one says which there are modules on.
    {"bus.list", "modules"},
    {"bus.scan", "scan"},
    {"bus.trace", "trace"},
    {"module.list", "modules"},
    {"module.execute", "raw"},
    {"axis.list", "axes"},
    {"axis.move_to", "move"},
    {"axis.move_by", "move --by"},
    {"axis.rotate", "rotate"},
    {"axis.jog", "jog"},
    {"axis.resonance", "resonance"},
    {"axis.stop", "stop"},
    {"lease.acquire", "lease run"},
    {"lease.renew", "lease run"},
    {"lease.release", "lease run"},
    {"lease.list", "lease list"},
    {"lease.break", "lease break"},
    {"token.add", "token add"},
    {"token.list", "token list"},
    {"token.invite", "page --phone"},
    {"token.revoke", "token revoke"},
    {"client.list", "clients"},
    {"audit.tail", "audit"},
    {"page.find", "page"},
    {"configuration.get", "fleet apply"},
    {"configuration.set", "fleet apply"},
    {"axis.wait", "wait"},
    {"line.move", "line"},
    {"path.stage", "path run"},
    {"path.plan", "path run --dry-run"},
    {"path.run", "path run"},
    {"path.pause", "path pause"},
    {"path.resume", "path resume"},
    {"path.status", "path status"},
    {"path.feed", "path feed"},
    {"path.stop", "path stop"},
    {"mint.run", "mint run"},
    {"axis.get_ramp", "plot --compare"},
    {"axis.plan_ramp", "ramp --dry-run"},
    {"axis.set_ramp", "ramp"},
    {"ramp.compare", "ramp --compare"},
    {"ramp.find", "ramp --fastest"},
    {"profile.simulate", "profile simulate"},
    {"profile.solve", "profile solve"},
    {"axis.home", "home"},
    {"axis.start_home", "home --no-wait"},
    {"axis.stop_home", "home --stop"},
    {"axis.recover", "recover"},
    {"doctor.examine", "doctor"},
    {"axis.get_errors", "errors"},
    {"axis.set_deadman", "deadman set"},
    {"axis.test_deadman", "deadman test"},
    {"axis.tune", "tune"},
    {"axis.verify", "verify"},
    {"capture.start", "capture"},
    {"capture.state", "capture"},
    {"capture.read", "capture"},
    {"capture.end", "capture"},
    {"axis.get_state", "state"},
    {"axis.get_units", "params"},
    {"parameter.get", "get"},
    {"parameter.set", "set"},
    {"parameter.store", "store"},
    {"parameter.restore", "restore"},
    {"parameter.list", "params"},
    {"settings.read", "settings show"},
    {"settings.compare", "settings diff"},
    {"settings.load", "settings load"},
    {"settings.store", "store --all"},
    {"coordinate.get", "coordinate get"},
    {"coordinate.set", "coordinate set"},
    {"coordinate.capture", "coordinate capture"},
    {"coordinate.move", "coordinate move"},
    {"coordinate.start", "coordinate start"},
    {"coordinate.store", "coordinate store"},
    {"coordinate.load", "coordinate load"},
    {"global.get", "global get"},
    {"global.set", "global set"},
    {"global.store", "global store"},
    {"global.restore", "global restore"},
    {"io.get", "input"},
    {"io.set", "output"},
    {"module.info", "info"},
    {"module.report_arrivals", "arrivals"},
    {"module.reset", "reset"},
    {"module.factory_reset", "factory-reset"},
    {"program.assemble", "program assemble"},
    {"program.load", "program upload"},
    {"program.compare", "program verify"},
    {"program.read", "program download"},
    {"program.run", "program run"},
    {"program.stop", "program stop"},
    {"program.step", "program step"},
    {"program.step_to", "program debug"},
    {"program.reset", "program reset"},
    {"program.status", "program status"},
    {"program.set_breakpoint", "program breakpoint"},
    {"program.clear_breakpoint", "program clear-breakpoint"},
    {"program.clear_breakpoints", "program clear-breakpoints"},
    {"firmware.status", "firmware check"},
    {"firmware.stage", "firmware upload"},
    {"firmware.upload", "firmware upload"},
    {"system.stop_all", "stop --all"},
});

bool is_of_a_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// A name as it stands in a text: not a part of a longer one, and not of a file's, such as
/// path.stop.csv; the point at the end of a sentence may follow.
bool stands_alone(std::string_view text, std::size_t at, std::size_t length) {
  const auto after = text.substr(at + length);
  const bool begins = at == 0 || (!is_of_a_word(text[at - 1]) && text[at - 1] != '/');
  const bool goes_on = !after.empty() && is_of_a_word(after.front());
  const bool has_ending = after.size() > 1 && after.front() == '.' && is_of_a_word(after[1]);
  return begins && !goes_on && !has_ending;
}

/// What stands behind "tmclctl " begins with the name of a verb that asks a gateway.
bool asks_a_gateway(std::string_view words, const std::vector<VerbInfo>& verbs) {
  const VerbInfo* named = nullptr;
  for (const auto& verb : verbs) {
    const auto after = words.substr(std::min(verb.name.size(), words.size()));
    const bool is_whole = after.empty() || !is_of_a_word(after.front());
    const bool is_longer = named == nullptr || verb.name.size() > named->name.size();
    if (words.starts_with(verb.name) && is_whole && is_longer) named = &verb;
  }
  return named != nullptr && named->doors != Doors::offline;
}

}  // namespace

std::span<const MethodWord> method_words() { return words_of_methods; }

std::string with_verbs(std::string_view text) {
  std::string words;
  for (std::size_t at = 0; at < text.size();) {
    const auto* found = std::ranges::find_if(words_of_methods, [&](const MethodWord& word) {
      return text.substr(at).starts_with(word.method) && stands_alone(text, at, word.method.size());
    });
    if (found == words_of_methods.end()) {
      words += text[at++];
      continue;
    }
    words += fmt::format("'tmclctl {}'", found->verb);
    at += found->method.size();
  }
  return words;
}

std::string with_gateway(std::string_view text, std::string_view options) {
  constexpr std::string_view program = "'tmclctl ";
  std::string words;
  for (auto at = text.find(program); at != std::string_view::npos && !options.empty();
       at = text.find(program)) {
    static const auto verbs = verb_table();
    const auto verb = at + program.size();
    // Without the space: the options begin with one.
    words += text.substr(0, verb - 1);
    if (asks_a_gateway(text.substr(verb), verbs)) words += options;
    text.remove_prefix(verb - 1);
  }
  return words.append(text);
}

}  // namespace tmclctl
