// The tests that documents name as holding what they say are there.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "support/build_paths.hpp"

namespace tmcl::test {
namespace {

std::set<std::string> all_tests() {
  std::set<std::string> names;
  const auto& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const auto& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j)
      names.insert(std::string(suite.name()) + '.' + suite.GetTestInfo(j)->name());
  }
  return names;
}

TEST(NamedTests, AreThere) {
  std::ifstream file(TMCL_SOURCE_DIR "/docs/RAMPS.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex name("`([A-Z][A-Za-z0-9]*\\.[A-Z][A-Za-z0-9]*)`");
  const auto tests = all_tests();
  int found = 0;
  for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match) {
    EXPECT_TRUE(tests.contains((*match)[1])) << (*match)[1];
    ++found;
  }
  EXPECT_GE(found, 5);
}

}  // namespace
}  // namespace tmcl::test
