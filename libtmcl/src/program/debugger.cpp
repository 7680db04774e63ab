#include <algorithm>
#include <cstdio>
#include <span>

#include "core/text.hpp"
#include "tmcl/program_debugger.hpp"
#include "tmcl/spelling.hpp"
#include "tmcl/status.hpp"

namespace tmcl::program {

using Kind = DebugOrder::Kind;

/// The first one that begins with what was typed is meant: so each has its letter.
struct Debugger::Command {
  std::string_view name;
  std::string_view operands;
  std::string_view meaning;
  std::size_t most_words;
  bool repeats;  ///< By an empty line.
  DebugOrder (*run)(Debugger& self, const Words& words);
};

namespace {

constexpr std::size_t lines_around = 5;
constexpr std::uint32_t most_steps_at_once = 1'000'000;

DebugOrder told(std::string text) { return {Kind::none, 0, std::move(text), false}; }
DebugOrder wrong(const std::string& sentence) {
  return {Kind::none, 0, "error: " + sentence + '\n', true};
}
DebugOrder order(Kind kind, std::uint32_t steps = 0) { return {kind, steps, {}, false}; }

std::optional<std::uint32_t> count_in(std::string_view word) {
  const auto count = text::parse_integer<std::uint32_t>(word);
  return count && *count >= 1 && *count <= most_steps_at_once ? count : std::nullopt;
}

DebugOrder wrong_count(std::string_view word) {
  return wrong(quoted(word) + " is no number of commands: 1 to " +
               std::to_string(most_steps_at_once));
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}
std::string right_of(std::size_t number, std::size_t width) {
  const auto digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), ' ') + digits;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4f s", seconds);
  return text;
}

std::string_view sign_of(int compared) {
  return compared < 0 ? "less" : compared > 0 ? "greater" : "equal";
}

template <class List>
std::string joined(const List& parts) {
  std::string all;
  for (const auto& part : parts) all += (all.empty() ? "" : " ") + part;
  return all.empty() ? "none" : all;
}

struct Row {
  std::string name;
  std::string value;
};

std::vector<Row> rows_of(const Registers& of, const ProgramMap& map) {
  std::vector<std::string> returns;
  for (const auto address : of.returns) returns.push_back(map.name_of(address));
  return {{"accumulator", std::to_string(of.accumulator)},
          {"X", std::to_string(of.x)},
          {"zero", of.zero ? "yes" : "no"},
          {"compared", std::string(sign_of(of.compared))},
          {"errors", joined(of.errors)},
          {"stack", joined(returns)},
          {"interrupted", of.resumes ? "at " + map.name_of(*of.resumes) : "no"}};
}

std::string text_of_error(std::int32_t error) {
  const auto* status = find_status(static_cast<Status>(error));
  auto text = "error " + std::to_string(error);
  return status == nullptr ? text : text + " (" + std::string(status->name) + ")";
}

}  // namespace

std::string to_text(const Watched& watched) {
  if (!watched.motor) return "variable " + watched.name;
  return "motor " + std::to_string(*watched.motor) + ' ' + watched.name;
}

const std::vector<Debugger::Command>& Debugger::commands() {
  static const std::vector<Command> all{
      {"step", "[N]", "execute the next command, or N of them", 2, true,
       [](Debugger& self, const Words& words) { return self.step(words); }},
      {"break", "[LABEL|LINE]", "stand before it from now on; alone: show where", 2, false,
       [](Debugger& self, const Words& words) { return self.add_breakpoint(words); }},
      {"continue", "[N]", "go on to a breakpoint or the end, but at most N commands", 2, true,
       [](Debugger& self, const Words& words) { return self.go_on(words); }},
      {"delete", "LABEL|LINE", "do not stand there any more", 2, false,
       [](Debugger& self, const Words& words) { return self.remove_breakpoint(words); }},
      {"list", "[LABEL|LINE]", "show the text around it, or around the next command", 2, false,
       [](Debugger& self, const Words& words) { return self.list(words); }},
      {"registers", "", "accumulator, X, flags, stack (simulator only)", 1, false,
       [](Debugger& self, const Words& words) { return self.registers(words); }},
      {"variables", "", "the user variables of the program", 1, false,
       [](Debugger&, const Words&) { return order(Kind::read); }},
      {"watch", "VARIABLE | MOTOR PARAM", "show it from now on, wherever the program stands", 3,
       false, [](Debugger& self, const Words& words) { return self.watch(words); }},
      {"unwatch", "VARIABLE | MOTOR PARAM", "do not show it any more", 3, false,
       [](Debugger& self, const Words& words) { return self.unwatch(words); }},
      {"quit", "", "end", 1, false, [](Debugger&, const Words&) { return order(Kind::quit); }},
      {"help", "", "show this", 1, false,
       [](Debugger& self, const Words& words) { return self.help(words); }},
      {"back", "[N]", "undo the last command, or N of them (simulator only)", 2, true,
       [](Debugger& self, const Words& words) { return self.back(words); }},
      {"where", "", "show how the program stands", 1, false,
       [](Debugger&, const Words&) { return order(Kind::look); }},
      {"restart", "", "back to the first command; motors stop", 1, false,
       [](Debugger&, const Words&) { return order(Kind::restart); }},
      {"stop", "", "end the program; motors stop", 1, false,
       [](Debugger&, const Words&) { return order(Kind::stop); }},
  };
  return all;
}

DebugOrder Debugger::say(std::string_view line) {
  if (line.size() > longest_line)
    return wrong("a line has at most " + std::to_string(longest_line) + " characters");
  auto words = words_in(line);
  if (words.empty()) words = words_in(repeated_);
  if (words.empty()) return order(Kind::none);
  const auto command = std::ranges::find_if(commands(), [&](const Command& one) {
    return text::equal_ignoring_case(one.name.substr(0, words[0].size()), words[0]);
  });
  if (command == commands().end()) {
    std::vector<std::string_view> names;
    for (const auto& one : commands()) names.push_back(one.name);
    return wrong(quoted(words[0]) + " is no command; 'help' shows them." +
                 did_you_mean(words[0], names));
  }
  if (words.size() > command->most_words) {
    return wrong(quoted(words[command->most_words]) + " is too much: it is '" +
                 std::string(command->name) + (command->operands.empty() ? "" : " ") +
                 std::string(command->operands) + "'");
  }
  auto done = command->run(*this, words);
  // What is repeated is what was typed, and not the memory that it stands in.
  if (!words_in(line).empty()) repeated_ = command->repeats ? std::string(line) : std::string();
  return done;
}

DebugOrder Debugger::step(const Words& words) {
  const auto count = words.size() == 1 ? std::optional(1U) : count_in(words[1]);
  return count ? order(Kind::step, *count) : wrong_count(words[1]);
}

DebugOrder Debugger::go_on(const Words& words) {
  const auto count = words.size() == 1 ? std::optional(options_.most_steps) : count_in(words[1]);
  return count ? order(Kind::step, *count) : wrong_count(words[1]);
}

DebugOrder Debugger::back(const Words& words) {
  if (!options_.is_simulated)
    return wrong("a module cannot go back; a simulated one can: tmclsim --debug FILE");
  const auto count = words.size() == 1 ? std::optional(1U) : count_in(words[1]);
  return count ? order(Kind::back, *count) : wrong_count(words[1]);
}

DebugOrder Debugger::registers(const Words& /*words*/) {
  if (!options_.is_simulated)
    return wrong(
        "not told by modules: accumulator, X, flags and stack; a simulated module shows them: "
        "tmclsim --debug FILE");
  if (!standing_.registers) return told("not known yet\n");
  std::string text;
  for (const auto& row : rows_of(*standing_.registers, map_))
    text += "      " + padded(row.name, 12) + ' ' + row.value + '\n';
  return told(text);
}

DebugOrder Debugger::add_breakpoint(const Words& words) {
  if (words.size() == 1) {
    if (breakpoints_.empty()) return told("no breakpoints\n");
    std::string text;
    for (const auto address : breakpoints_) {
      const auto place = *map_.at(address);
      text += "  " + padded(map_.name_of(address), 16) + ' ' + place.file + ':' +
              std::to_string(place.line) + "  " + place.text + '\n';
    }
    return told(text);
  }
  const auto address = map_.find(words[1]);
  if (!address) return wrong(address.error());
  const auto there = std::ranges::lower_bound(breakpoints_, *address);
  const bool is_new = there == breakpoints_.end() || *there != *address;
  if (is_new && breakpoints_.size() == most_breakpoints)
    return wrong("there are " + std::to_string(most_breakpoints) + " breakpoints already");
  if (is_new) breakpoints_.insert(there, *address);
  const auto place = *map_.at(*address);
  return told("breakpoint before " + map_.name_of(*address) + ", " + place.file + ':' +
              std::to_string(place.line) + '\n');
}

DebugOrder Debugger::remove_breakpoint(const Words& words) {
  if (words.size() == 1) return wrong("which one? It is 'delete LABEL|LINE'");
  const auto address = map_.find(words[1]);
  if (!address) return wrong(address.error());
  if (std::erase(breakpoints_, *address) == 0)
    return wrong("there is no breakpoint at " + quoted(words[1]));
  return told("no breakpoint before " + map_.name_of(*address) + " any more\n");
}

namespace {

/// Nothing if the words name neither a user variable nor a motor and a parameter.
std::optional<Watched> watched_in(std::span<const std::string_view> operands, unsigned motors) {
  if (operands.empty()) return std::nullopt;
  const auto number = text::parse_byte(operands[0]);
  if (!number) return std::nullopt;
  if (operands.size() == 1) return Watched{std::nullopt, std::string(operands[0])};
  if (*number >= motors) return std::nullopt;
  return Watched{*number, std::string(operands[1])};
}

DebugOrder no_watched(std::span<const std::string_view> operands, unsigned motors) {
  if (operands.empty())
    return wrong("what? It is a VARIABLE, 0 to 255, or MOTOR PARAM, such as 0 actual_position");
  if (operands.size() > 1 && text::parse_byte(operands[0]))
    return wrong("there is no motor " + std::string(operands[0]) + ": they are 0 to " +
                 std::to_string(motors - 1));
  return wrong(quoted(operands[0]) +
               " is no number of a user variable, 0 to 255, nor of a motor before a parameter");
}

}  // namespace

DebugOrder Debugger::watch(const Words& words) {
  const auto operands = std::span(words).subspan(1);
  const auto watched = watched_in(operands, options_.motors);
  if (!watched) return no_watched(operands, options_.motors);
  if (std::ranges::find(watched_, *watched) == watched_.end()) {
    if (watched_.size() == most_watched)
      return wrong("there are " + std::to_string(most_watched) + " watched already");
    watched_.push_back(*watched);
  }
  return order(Kind::look);
}

DebugOrder Debugger::unwatch(const Words& words) {
  const auto operands = std::span(words).subspan(1);
  const auto watched = watched_in(operands, options_.motors);
  if (!watched) return no_watched(operands, options_.motors);
  if (std::erase(watched_, *watched) == 0) return wrong(to_text(*watched) + " is not watched");
  return told(to_text(*watched) + " is not shown any more\n");
}

DebugOrder Debugger::help(const Words& /*words*/) {
  std::string text;
  for (const auto& one : commands()) {
    const auto usage = std::string(one.name) + ' ' + std::string(one.operands);
    text += padded(usage, 31) + ' ' + std::string(one.meaning) + '\n';
  }
  return told(
      text +
      "Each can be shortened: of those that begin the same, the first is meant. An empty "
      "line repeats\nstep, continue or back. LINE is one of the first file, or FILE:LINE.\n");
}

DebugOrder Debugger::list(const Words& words) {
  auto centre = standing_.address.value_or(0);
  if (words.size() > 1) {
    const auto address = map_.find(words[1]);
    if (!address) return wrong(address.error());
    centre = *address;
  }
  const auto& lines = map_.assembly().lines;
  auto around = std::ranges::find_if(lines, [&](const SourceLine& line) {
    return line.address && static_cast<std::int64_t>(*line.address) >= centre;
  });
  const auto middle = static_cast<std::size_t>(around - lines.begin());
  const auto first = middle - std::min(middle, lines_around);
  const auto end = std::min(lines.size(), middle + lines_around + 1);
  std::string text;
  for (auto i = first; i < end; ++i) {
    const auto& line = lines[i];
    const bool is_next = line.address && standing_.address &&
                         static_cast<std::int64_t>(*line.address) == *standing_.address;
    const bool stands = line.address && std::ranges::binary_search(breakpoints_, *line.address);
    auto row = std::string(is_next ? ">" : " ") + (stands ? "*" : " ");
    row += line.address ? right_of(*line.address, 4) : std::string(4, ' ');
    row += ' ' + right_of(line.line, 5) + "  ";
    for (const char c : line.text) row += (c >= 0 && c < ' ') || c == 127 ? ' ' : c;
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  return told(text);
}

std::vector<Watched> Debugger::to_read(Kind kind) const {
  if (kind != Kind::read) return watched_;
  std::vector<Watched> all;
  for (const auto variable : map_.variables())
    all.push_back({std::nullopt, std::to_string(variable)});
  for (const auto& one : watched_)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
  return all;
}

std::string Debugger::place_text() const {
  if (!standing_.address) return "the module does not tell where its program stands\n";
  const auto place = map_.at(*standing_.address);
  if (!place)
    return right_of(static_cast<std::size_t>(*standing_.address), 4) + "  behind the program\n";
  return right_of(place->address, 4) + "  " + padded(place->label, 12) + ' ' + place->file + ':' +
         std::to_string(place->line) + "  " + place->text + '\n';
}

std::string Debugger::changes(const Standing& before) const {
  if (!before.registers || !standing_.registers) return {};
  const auto old = rows_of(*before.registers, map_);
  const auto now = rows_of(*standing_.registers, map_);
  std::string text;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i].value == old[i].value) continue;
    text += "      " + now[i].name + ": " + old[i].value + " -> " + now[i].value + '\n';
  }
  return text;
}

std::string Debugger::readings_text(const std::vector<Reading>& readings) {
  std::string text;
  for (const auto& reading : readings) {
    const auto name = to_text(reading.watched);
    if (!reading.value) {
      text += "      " + name + ": " + reading.value.error() + '\n';
      continue;
    }
    const auto known = known_.find(name);
    const bool is_new = known == known_.end() || known->second != *reading.value;
    const auto before = known == known_.end() || !is_new
                            ? std::string()
                            : " (was " + std::to_string(known->second) + ")";
    text += "      " + name + " = " + std::to_string(*reading.value) + before + '\n';
    known_[name] = *reading.value;
  }
  return text;
}

namespace {

std::string why_it_stands(const Standing& now, const ProgramMap& map) {
  if (now.last_error.value_or(0) != 0)
    return "the program has failed: " + text_of_error(*now.last_error) + '\n';
  if (now.state == "running") return "the program runs\n";
  if (now.reason == "ended") return "the program has ended\n";
  if (now.reason == "waits") return "it waits for what has not come so far\n";
  if (now.reason == "breakpoint")
    return "breakpoint " + map.name_of(now.address.value_or(0)) + " after " +
           std::to_string(now.steps) + (now.steps == 1 ? " command\n" : " commands\n");
  return {};
}

}  // namespace

std::string Debugger::stands(Kind kind, const Standing& now, const std::vector<Reading>& readings) {
  const auto before = std::exchange(standing_, now);
  if (kind == Kind::read) {
    if (readings.empty()) return "the program names no user variable\n";
    return readings_text(readings);
  }
  std::string text = why_it_stands(now, map_);
  if (now.time_s) text += padded(seconds_text(*now.time_s), 12);
  return text + place_text() + changes(before) + readings_text(readings);
}

}  // namespace tmcl::program
