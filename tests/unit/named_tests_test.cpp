// The tests that documents name as holding what they say are there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/build_paths.hpp"

namespace tmcl::test {
namespace {

const std::filesystem::path sources = TMCL_SOURCE_DIR;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The two groups of every match, joined.
void collect(const std::string& text, const std::string& pattern, const std::string& between,
             std::set<std::string>& into) {
  const std::regex expression(pattern);
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match)
    into.insert((*match)[1].str() + between + (*match)[2].str());
}

/// Of all test programs, and "motion: ROR turns a motor right" for conformance cases.
std::set<std::string> all_tests() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(sources / "tests")) {
    const auto& path = entry.path();
    if (path.extension() == ".cpp")
      collect(text_of(path), R"(TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\))", ".", names);
    if (path.parent_path().filename() != "cases") continue;
    std::set<std::string> cases;
    collect(text_of(path), R"((?:^|\n)case ([^\n]+)())", "", cases);
    for (const auto& name : cases) names.insert(path.stem().string() + ": " + name);
  }
  return names;
}

/// What stands in `...` and looks like one.
std::set<std::string> named_in(const std::string& text) {
  std::set<std::string> names;
  collect(text, R"(`([A-Z]\w*)\.([A-Z]\w*)`)", ".", names);
  collect(text, R"(`([a-z]\w*): ([^`]+)`)", ": ", names);
  return names;
}

class NamedTests : public testing::TestWithParam<const char*> {};

TEST_P(NamedTests, AreThere) {
  static const auto tests = all_tests();
  const auto names = named_in(text_of(sources / "docs" / GetParam()));
  EXPECT_GE(names.size(), 5U);
  for (const auto& name : names) EXPECT_TRUE(tests.contains(name)) << name;
}

INSTANTIATE_TEST_SUITE_P(Pages, NamedTests, testing::Values("RAMPS.md", "NOTES.md"),
                         [](const auto& page) {
                           return std::string(page.param, std::string(page.param).find('.'));
                         });

std::vector<std::string> rows_of_statements() {
  std::vector<std::string> rows;
  std::ifstream file(sources / "docs/NOTES.md");
  for (std::string line; std::getline(file, line);)
    if (std::regex_search(line, std::regex(R"(^\| \d+ \|)"))) rows.push_back(line);
  return rows;
}

// Four documents with 57, 38, 22 and 17 statements.
TEST(NotesPage, SaysOfEachStatementWhatHoldsItOrWhyNothingDoes) {
  const auto rows = rows_of_statements();
  EXPECT_EQ(rows.size(), 57U + 38 + 22 + 17);
  for (const auto& row : rows) {
    EXPECT_EQ(std::ranges::count(row, '|'), 5) << row;
    EXPECT_TRUE(!named_in(row).empty() || row.ends_with("| — |")) << row;
  }
}

}  // namespace
}  // namespace tmcl::test
