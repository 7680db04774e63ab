// The table of docs/TROUBLESHOOTING.md is that of the checks. TMCL_DRAW=1 writes it anew.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "support/build_paths.hpp"
#include "tmcl/doctor.hpp"

namespace tmcl {
namespace {

constexpr std::string_view heading = "| check | question | if not |\n| --- | --- | --- |\n";

std::string table() {
  std::string text(heading);
  for (const auto& check : checks())
    text += fmt::format("| `{}` | {} | {} |\n", check.name, check.question,
                        cure_of({check.check, "NAME", true, {}}));
  return text;
}

TEST(DoctorPage, HasTheTableOfTheChecks) {
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "TROUBLESHOOTING.md";
  std::ifstream file(path);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const auto begin = page.find(heading);
  ASSERT_NE(begin, std::string::npos);
  const auto end = page.find("\n\n", begin);
  ASSERT_NE(end, std::string::npos);
  const auto drawn = page.substr(0, begin) + table() + page.substr(end + 1);
  if (std::getenv("TMCL_DRAW") != nullptr) std::ofstream(path) << drawn;
  EXPECT_EQ(page, drawn) << "TMCL_DRAW=1 draws it anew";
}

TEST(DoctorTable, NamesAreOfOneCheckEach) {
  std::set<std::string_view> names;
  for (const auto& check : checks()) {
    EXPECT_TRUE(names.insert(check.name).second) << check.name;
    EXPECT_FALSE(check.question.empty() || check.cure.empty()) << check.name;
  }
}

TEST(DoctorTable, ACureNamesItsSubject) {
  EXPECT_EQ(cure_of({Check::reference, "x", true, {}}), "'tmclctl home x' searches it");
}

}  // namespace
}  // namespace tmcl
