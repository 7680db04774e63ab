// The grammar for editors has the commands and types of the assembler. TMCL_DRAW=1 draws it anew.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include <fmt/ranges.h>
#include <boost/json.hpp>

#include "support/build_paths.hpp"
#include "tmcl/assembler.hpp"
#include "tmcl/command.hpp"

namespace tmcl {
namespace {

namespace json = boost::json;

const std::filesystem::path extension =
    std::filesystem::path(TMCL_SOURCE_DIR) / "tools" / "editors" / "vscode";

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The longest first: an editor takes the first that fits.
std::string any_of(const std::set<std::string, std::greater<>>& words) {
  return fmt::format("(?i)\\\\b(?:{})\\\\b", fmt::join(words, "|"));
}

std::string commands() {
  std::set<std::string, std::greater<>> names;
  for (const auto& row : command_table())
    if (row.operands) names.emplace(row.name);
  return "(?i)\\\\.raw\\\\b|" + any_of(names);
}

std::string types() {
  std::set<std::string, std::greater<>> names;
  for (const auto& row : subtype_table()) {
    const auto* command = find_command(static_cast<std::uint8_t>(row.command));
    if (!row.name.empty() && command->operands) names.emplace(row.name);
  }
  return any_of(names);
}

/// With the pattern of this rule of the grammar.
std::string with_pattern(std::string text, const std::string& rule, const std::string& pattern) {
  const auto begin = text.find("\"match\": \"", text.find("\"" + rule + "\": {\"name\"")) + 10;
  return text.replace(begin, text.find('"', begin) - begin, pattern);
}

TEST(EditorGrammar, HasTheCommandsAndTypesOfTheAssembler) {
  const auto path = extension / "tmcl.tmLanguage.json";
  const auto text = contents(path);
  const auto drawn = with_pattern(with_pattern(text, "commands", commands()), "types", types());
  if (std::getenv("TMCL_DRAW") != nullptr) std::ofstream(path) << drawn;
  EXPECT_EQ(text, drawn) << "TMCL_DRAW=1 draws it anew";
  EXPECT_EQ(json::parse(text).at("scopeName"), "source.tmcl");
}

TEST(EditorGrammar, IsOfTheVersionOfTheProject) {
  const auto package = json::parse(contents(extension / "package.json"));
  const auto project = contents(std::filesystem::path(TMCL_SOURCE_DIR) / "CMakeLists.txt");
  const auto wanted =
      fmt::format("project(tmcl VERSION {} ", package.at("version").as_string().c_str());
  EXPECT_NE(project.find(wanted), std::string::npos) << wanted;
}

TEST(EditorGrammar, ProblemsAreFoundByTheProblemMatcher) {
  const auto package = json::parse(contents(extension / "package.json"));
  const auto& pattern =
      package.at("contributes").at("problemMatchers").at(0).at("pattern").as_object();
  const std::regex matcher(pattern.at("regexp").as_string().c_str());
  const auto part = [&](const std::smatch& found, const char* name) {
    return found[static_cast<std::size_t>(pattern.at(name).as_int64())].str();
  };
  const auto read = [](const std::string&) { return std::string("  MVP ABS, 0, 10\n  MVPP 1\n"); };
  const auto assembled = program::assemble("folder/it.tmc", read, nullptr);
  ASSERT_FALSE(assembled);
  const auto line = describe(assembled.error().front(), "folder/it.tmc");
  std::smatch found;
  ASSERT_TRUE(std::regex_match(line, found, matcher)) << line;
  EXPECT_EQ(part(found, "file"), "folder/it.tmc");
  EXPECT_EQ(part(found, "line"), "2");
  EXPECT_EQ(part(found, "column"), "3");
  EXPECT_EQ(part(found, "message"), assembled.error().front().message);
}

}  // namespace
}  // namespace tmcl
