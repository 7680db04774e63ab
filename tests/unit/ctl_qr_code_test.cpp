// A text as a picture; that phones read it is for the tests of whole programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "output/qr_code.hpp"

namespace tmclctl::test {
namespace {

std::vector<std::string> rows_of_picture(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(QrCode, HasAMarginAndItsMarkInThreeCorners) {
  const auto lines = rows_of_picture(qr_code("https://gateway:4143/#code=0123", Screen{}));
  ASSERT_GT(lines.size(), 21U + 8U);
  const auto size = lines.size();
  for (const auto& line : lines) {
    ASSERT_EQ(line.size(), 2 * size) << "modules are square";
    EXPECT_EQ(line.substr(0, 8) + line.substr(2 * size - 8), std::string(16, '#'));
  }
  const std::string edge(14, ' ');
  EXPECT_EQ(lines[4].substr(8, 14), edge);
  EXPECT_EQ(lines[4].substr(2 * size - 22, 14), edge);
  EXPECT_EQ(lines[size - 5].substr(8, 14), edge);
  EXPECT_NE(lines[size - 5].substr(2 * size - 22, 14), edge);
}

TEST(QrCode, HasTwoRowsInALineWhereThereAreHalfBlocks) {
  Screen screen;
  const auto rows = rows_of_picture(qr_code("a", screen)).size();
  screen.utf8 = true;
  EXPECT_EQ(rows_of_picture(qr_code("a", screen)).size(), (rows + 1) / 2);
  screen.colour = true;
  for (const auto& line : rows_of_picture(qr_code("a", screen)))
    EXPECT_TRUE(line.starts_with("\x1b[97;40m") && line.ends_with("\x1b[0m")) << line;
}

TEST(QrCode, IsNoneOfATextThatIsTooLong) {
  EXPECT_EQ(qr_code(std::string(4000, 'a'), Screen{}), "");
}

}  // namespace
}  // namespace tmclctl::test
