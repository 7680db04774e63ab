// What --help says: examples that can be typed, and nothing that is not so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <ranges>
#include <set>
#include <sstream>

#include "command_line/method_words.hpp"
#include "command_line/options.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

std::string information(const Words& words) {
  return std::get<Information>(parse_options(words).value()).text;
}

Words lines_of(const std::string& text) {
  std::istringstream in(text);
  Words lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

Words verbs_under(Words group) {
  group.insert(group.begin(), {"__complete", "verbs"});
  return lines_of(information(group));
}

std::vector<Words> sought_verbs() {
  std::vector<Words> verbs;
  for (const auto& verb : verbs_under({})) {
    verbs.push_back({verb});
    for (const auto& inner : verbs_under({verb})) verbs.push_back({verb, inner});
  }
  return verbs;
}
// To build the options of all verbs takes long with sanitizers: so these are kept for all tests.
/// Each verb as it is typed, with the words of its group.
const std::vector<Words>& all_verbs() {
  static const auto verbs = sought_verbs();
  return verbs;
}
const std::string& help_of(const Words& verb) {
  static std::map<Words, std::string> known;
  auto& text = known[verb];
  if (text.empty()) {
    auto words = verb;
    words.emplace_back("--help");
    text = information(words);
  }
  return text;
}

bool is_group(const Words& verb) {
  return std::ranges::any_of(all_verbs(), [&](const Words& other) {
    return other.size() > verb.size() &&
           std::ranges::equal(verb, other | std::views::take(verb.size()));
  });
}

/// Without what is said beside it, three blanks further on.
std::string command_in(const std::string& line) { return line.substr(0, line.find("   ", 2)); }

/// The command lines among the lines of a help: those of a line with ; and && are several.
std::vector<Words> examples_in(const std::string& help) {
  std::vector<Words> examples;
  std::string whole;
  for (const auto& line : lines_of(help)) {
    if (whole.empty() && !line.starts_with("  tmclctl ")) continue;
    whole += ' ' + command_in(line);
    if (whole.ends_with('\\')) {
      whole.pop_back();
      continue;
    }
    std::istringstream in(std::exchange(whole, {}));
    examples.emplace_back();
    for (std::string word; in >> word;) {
      const bool ends = word == "&&" || word.ends_with(';');
      if (word.ends_with(';')) word.pop_back();
      if (word != "&&") examples.back().push_back(word);
      if (ends) examples.emplace_back();
    }
  }
  std::erase_if(examples,
                [](const Words& words) { return words.empty() || words[0] != "tmclctl"; });
  for (auto& example : examples) example.erase(example.begin());
  return examples;
}

std::string joined(const Words& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

TEST(CtlHelp, EveryVerbHasAnExampleOfItself) {
  for (const auto& verb : all_verbs()) {
    const auto examples = examples_in(help_of(verb));
    const bool shown = std::ranges::any_of(examples, [&](const Words& example) {
      return !std::ranges::search(example, verb).empty();
    });
    EXPECT_TRUE(shown) << joined(verb);
  }
}

TEST(CtlHelp, TheTableHasEveryVerbAndNothingElse) {
  std::set<std::string> typed;
  for (const auto& verb : all_verbs()) {
    if (!is_group(verb) && verb != Words{"help"}) typed.insert(joined(verb));
  }
  std::set<std::string> listed;
  for (const auto& verb : verb_table()) {
    EXPECT_TRUE(listed.insert(std::string(verb.name)).second) << verb.name << " is listed twice";
    EXPECT_EQ(verb.doors == Doors::both, verb.reason.empty()) << verb.name;
  }
  EXPECT_EQ(typed, listed);
}

TEST(CtlHelp, SaysThroughWhichDoorsAVerbGoes) {
  EXPECT_THAT(help_of({"move"}), HasSubstr("through tmcld, and straight on a bus with --direct"));
  EXPECT_THAT(help_of({"path", "stop"}), HasSubstr("through tmcld only: with --direct"));
  EXPECT_THAT(help_of({"convert"}), HasSubstr("Needs neither tmcld nor a bus: it computes"));
  EXPECT_THAT(help_of({"path"}), Not(HasSubstr("Goes through")));
}

TEST(CtlHelp, EveryExampleCanBeTyped) {
  auto helps = all_verbs();
  helps.emplace_back();
  for (const auto& verb : helps) {
    for (const auto& example : examples_in(help_of(verb))) {
      const auto parsed = parse_options(example);
      EXPECT_TRUE(parsed) << joined(verb) << " --help: " << joined(example) << ": "
                          << error_text(parsed.error());
    }
  }
}

TEST(CtlHelp, NothingIsSaidToBeSentOnlyWhereThatHoldsForAllVerbsOfTheGroup) {
  Words quiet;
  for (const auto& verb : all_verbs()) {
    if (is_group(verb) && help_of(verb).find("Nothing is sent") != std::string::npos)
      quiet.push_back(joined(verb));
  }
  EXPECT_THAT(quiet, testing::ElementsAre("profile"));
  EXPECT_THAT(help_of({"program"}), HasSubstr("'assemble' and 'disassemble'"));
}

TEST(CtlHelp, NamesVerbsAndNoMethods) {
  auto helps = all_verbs();
  helps.emplace_back();
  for (const auto& verb : helps) {
    // That one calls methods by their names.
    if (joined(verb) == "call") continue;
    const auto help = help_of(verb);
    EXPECT_EQ(with_verbs(help), help) << joined(verb);
  }
}

TEST(CtlHelp, HelpVerbIsVerbHelp) {
  EXPECT_EQ(information({"help"}), information({"--help"}));
  EXPECT_EQ(information({"help", "move"}), help_of({"move"}));
  EXPECT_EQ(information({"help", "path", "run"}), help_of({"path", "run"}));
  EXPECT_EQ(information({"--json", "help", "move"}), help_of({"move"}));
  const auto unknown = parse_options({"help", "mvoe"});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(exit_code_of(unknown.error()), ExitCode::usage);
  EXPECT_THAT(unknown.error().hint, HasSubstr("'move'"));
}

TEST(CtlHelp, AccelerationsAreWrittenInOneWay) {
  for (const auto& verb : all_verbs()) {
    auto help = help_of(verb);
    // Where it is said that this is understood, too.
    if (verb == Words{"profile", "solve"}) continue;
    EXPECT_THAT(help, Not(testing::ContainsRegex("[a-z]/s2"))) << joined(verb);
  }
}

}  // namespace
}  // namespace tmclctl
