// path check --svg: the path, and ten times as far how far it is from what the file draws.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Points = std::vector<std::array<double, 2>>;

class CtlPathPicture : public testing::Test {
 protected:
  ~CtlPathPicture() override {
    std::filesystem::remove(path);
    std::filesystem::remove(path + ".svg");
  }
  std::string picture_of(const std::string& text, std::vector<std::string> options) {
    std::ofstream(path) << text;
    std::vector<std::string> words{"path", "check", path, "--svg", path + ".svg"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(ctl.run(words), ExitCode::done) << ctl.err;
    std::ifstream file(path + ".svg");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const std::string path = tmcl::test::temp_path("ctl_path_picture_test");
  CtlBench ctl;
};

/// Of the first line of this kind: the plane is above the axes over time, and above its legend.
Points line_of(const std::string& svg, const std::string& kind) {
  const std::string before = "class=\"curve " + kind + "\" points=\"";
  const auto at = svg.find(before);
  if (at == std::string::npos) return {};
  const auto from = at + before.size();
  std::istringstream words(svg.substr(from, svg.find('"', from) - from));
  Points points;
  char comma = 0;
  for (std::array<double, 2> point{}; words >> point[0] >> comma >> point[1];)
    points.push_back(point);
  return points;
}

TEST_F(CtlPathPicture, ShowsTheChordsOfAnArcTenTimesAsFarOff) {
  const auto svg = picture_of("G1 X20 F600\nG1 X0\nG2 X0 Y0 I10 J0\n", {"--tolerance", "0.2"});
  EXPECT_THAT(svg, AllOf(HasSubstr(">ten times off<"), HasSubstr(" off the drawn line, at "),
                         HasSubstr(", within the tolerance<")));
  const auto planned = line_of(svg, "position");
  const auto enlarged = line_of(svg, "difference");
  ASSERT_EQ(planned.size(), enlarged.size());
  ASSERT_GT(planned.size(), 100U);
  // The lines before it pass the whole diameter, which chords need not reach.
  double radius = 0;
  for (const auto& point : planned) radius = std::max(radius, (point[0] - planned[0][0]) / 2);
  const std::array<double, 2> centre{planned[0][0] + radius, planned[0][1]};
  const auto inside = [&](const std::array<double, 2>& point) {
    return radius - std::hypot(point[0] - centre[0], point[1] - centre[1]);
  };
  double farthest = 0;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    if (planned[i][1] == centre[1]) continue;  // on those lines
    // Both are written to a tenth of a pixel.
    EXPECT_NEAR(inside(enlarged[i]), 10 * inside(planned[i]), 1.5) << i;
    farthest = std::max(farthest, inside(enlarged[i]));
  }
  EXPECT_GT(farthest, 8) << "it can be seen";
}

TEST_F(CtlPathPicture, ShowsHowFarAShaperLeavesACorner) {
  const auto svg = picture_of("G1 X10 F1200\nG1 Y10\n", {"--shape", "zv", "--resonance", "6Hz"});
  EXPECT_THAT(svg, AllOf(HasSubstr(">ten times off<"), HasSubstr(" more than the tolerance<")));
  EXPECT_THAT(ctl.err, HasSubstr("more than the tolerance"));
}

TEST_F(CtlPathPicture, LeavesItOutWhereThePathIsTheDrawnLine) {
  const auto svg = picture_of("G1 X10 F1200\nG1 Y10\n", {});
  EXPECT_THAT(svg, AllOf(HasSubstr("class=\"curve position\""), Not(HasSubstr("ten times off")),
                         Not(HasSubstr("off the drawn line"))));
}

}  // namespace
}  // namespace tmclctl::test
