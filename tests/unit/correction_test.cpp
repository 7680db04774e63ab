// Tables of where an axis really is.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/temp_path.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/correction.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/plan/path_correction.hpp"
#include "unit/daemon_path_fixture.hpp"
#include "unit/daemon_scale_fixture.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

Correction correction_of(std::string_view text) {
  auto read = Correction::of(text);
  if (!read) throw std::runtime_error(describe(read.error()));
  return *std::move(read);
}

std::string problem_of(std::string_view text) {
  const auto read = Correction::of(text);
  return read ? "none" : describe(read.error(), "f");
}

constexpr std::string_view screw = R"(counted, actual   # by an interferometer
0, 0
10, 10.02

20, 19.99
)";

TEST(CorrectionTable, TellsWhereTheAxisReallyIs) {
  const auto table = correction_of(screw);
  EXPECT_DOUBLE_EQ(table.actual(0), 0);
  EXPECT_DOUBLE_EQ(table.actual(5), 5.01);
  EXPECT_DOUBLE_EQ(table.actual(10), 10.02);
  EXPECT_DOUBLE_EQ(table.actual(15), 15.005);
  EXPECT_DOUBLE_EQ(table.counted(15.005), 15);
}

TEST(CorrectionTable, KeepsItsErrorBeyondItsEnds) {
  const auto table = correction_of("1 1.5\n2 2.55");
  EXPECT_DOUBLE_EQ(table.actual(-9), -8.5);
  EXPECT_DOUBLE_EQ(table.actual(9), 9.55);
  EXPECT_DOUBLE_EQ(table.counted(-8.5), -9);
  EXPECT_DOUBLE_EQ(table.counted(9.55), 9);
}

TEST(CorrectionTable, OfAnotherUnitIsTheSameTable) {
  const auto in_um = correction_of(screw).in_unit(1000);
  EXPECT_DOUBLE_EQ(in_um.actual(5000), 5010);
}

TEST(CorrectionTable, NamesTheLineThatItCannotTake) {
  EXPECT_EQ(problem_of(""), "f: a correction needs two rows at least");
  EXPECT_EQ(problem_of("# nothing\n0 0\n"), "f: a correction needs two rows at least");
  EXPECT_THAT(problem_of("0 0\n1\n"), HasSubstr("f:2: '1' is not two numbers"));
  EXPECT_THAT(problem_of("0 0\n1 2 3\n"), HasSubstr("f:2:"));
  EXPECT_THAT(problem_of("0 0\n1,1\n2;2\n"), HasSubstr("f:3:"));
  EXPECT_THAT(problem_of("0 0\n1 nan\n"), HasSubstr("f:2:"));
  EXPECT_THAT(problem_of("0 0\n1 1\ncounted actual\n"), HasSubstr("f:3:"));
  EXPECT_THAT(problem_of("0 0\n0 1\n"), HasSubstr("f:2: the first column must rise"));
  EXPECT_THAT(problem_of("0 0\n10 25.4\n"), HasSubstr("f:2: from the line before"));
  std::string long_table;
  for (std::size_t i = 0; i <= Correction::most_rows; ++i)
    long_table += std::to_string(i) + ' ' + std::to_string(i) + '\n';
  EXPECT_THAT(problem_of(long_table), HasSubstr("more than 10000 rows"));
}

UserScale corrected_scale() {
  UserScale scale{"mm", 5, false, {200, 8}};
  scale.correction = std::make_shared<const Correction>(correction_of(screw));
  return scale;
}

TEST(CorrectionTable, CorrectsPositionsAndSoftLimits) {
  const auto scale = corrected_scale();
  EXPECT_EQ(to_microsteps(UserPosition{10.02}, scale)->value, 102'400);
  EXPECT_DOUBLE_EQ(to_user(Microsteps{102'400}, scale).value, 10.02);
  EXPECT_FALSE(beyond({{0}, {10.02}}, {102'400}, scale));
  EXPECT_TRUE(beyond({{0}, {10.02}}, {102'401}, scale));
  EXPECT_DOUBLE_EQ(to_user(Microsteps{102'400}, of_lengths(scale)).value, 10);
}

TEST(CorrectionTable, CorrectsWhatIsReversed) {
  auto scale = corrected_scale();
  scale.reverse = true;
  EXPECT_EQ(to_microsteps(UserPosition{10.02}, scale)->value, -102'400);
  EXPECT_DOUBLE_EQ(to_user(Microsteps{-102'400}, scale).value, 10.02);
}

// ---- paths ----

namespace pf = plan::path_file;

pf::Path one_line(pf::LineTo line) { return {{"X", "Y"}, {}, {line}}; }

std::vector<std::shared_ptr<const Correction>> of_x() {
  return {std::make_shared<const Correction>(correction_of(screw)), nullptr};
}

TEST(CorrectedPath, IsDividedWhereAnAxisPassesARow) {
  const auto path = plan::as_counted(one_line({{20, 40}, 3, {}, 7}), of_x());
  ASSERT_TRUE(path);
  ASSERT_EQ(path->elements.size(), 3U);
  const auto line = [&](std::size_t index) { return std::get<pf::LineTo>(path->elements[index]); };
  EXPECT_DOUBLE_EQ(line(0).target[0], 10);
  EXPECT_NEAR(line(0).target[1], 20.04, 1e-12);
  EXPECT_DOUBLE_EQ(line(1).target[0], 20);
  EXPECT_NEAR(line(1).target[1], 39.98, 1e-12);
  EXPECT_DOUBLE_EQ(line(2).target[0], 20.01);
  EXPECT_DOUBLE_EQ(line(2).target[1], 40);
  EXPECT_EQ(line(1).line, 7U);
  EXPECT_EQ(line(1).feed, 3);
}

TEST(CorrectedPath, OfATableWithTimesKeepsItsRows) {
  const auto path = plan::as_counted(one_line({{20, 40}, {}, 2.0, 1}), of_x());
  ASSERT_TRUE(path);
  ASSERT_EQ(path->elements.size(), 1U);
  EXPECT_DOUBLE_EQ(std::get<pf::LineTo>(path->elements[0]).target[0], 20.01);
}

TEST(CorrectedPath, MayBecomeTooLong) {
  pf::Path path{{"X", "Y"}, {}, {}};
  for (std::size_t i = 0; i < pf::most_elements / 2; ++i)
    path.elements.emplace_back(pf::LineTo{{i % 2 == 0 ? 20.0 : 0.0}, 1, {}, i + 1});
  const auto counted = plan::as_counted(std::move(path), of_x());
  ASSERT_FALSE(counted);
  EXPECT_THAT(counted.error(), HasSubstr("the path is too long; 1000000 elements at most"));
}

}  // namespace
}  // namespace tmcl::test

namespace tmcld::test {
namespace {

using testing::HasSubstr;

/// In a file while the test runs.
class CorrectionFile {
 public:
  explicit CorrectionFile(std::string_view text) { write(text); }
  CorrectionFile(const CorrectionFile&) = delete;
  CorrectionFile& operator=(const CorrectionFile&) = delete;
  ~CorrectionFile() { std::filesystem::remove(path_); }
  void write(std::string_view text) { std::ofstream(path_) << text; }
  std::string line() const { return "correction = \"" + path_ + "\"\n"; }

 private:
  std::string path_ = tmcl::test::temp_path("correction.csv");
};

std::string corrected_axis(const CorrectionFile& file) {
  return std::string(bench_bus) + axis_section("x", 0,
                                               "unit = \"mm\"\nscrew_pitch = 5\nmicrosteps = 256\n"
                                               "soft_limits = [0, 30]\n" +
                                                   file.line());
}

/// Before the daemon that reads it.
struct OnScrew {
  CorrectionFile file{"0 0\n10 10.02\n20 19.99\n"};
};

class DaemonCorrection : protected OnScrew, public DaemonScale {
 protected:
  DaemonCorrection() : DaemonScale(corrected_axis(file)) {}
  std::int64_t sent_to(std::string_view method, json::object params) {
    params["axis"] = "x";
    params["predict"] = false;
    return client->result(method, std::move(params)).at("target_microsteps").as_int64();
  }
};

TEST_F(DaemonCorrection, IsInWhatAnAxisIsSentTo) {
  EXPECT_EQ(sent_to("axis.move_to", {{"position", 10.02}}), 102'400);
  EXPECT_EQ(sent_to("axis.move_to", {{"position", "10020um"}}), 102'400);
  EXPECT_EQ(sent_to("axis.move_to", {{"position", "2rev"}}), 102'400) << "turns are turns";
  EXPECT_EQ(sent_to("axis.move_by", {{"distance", 9.97}}), 204'800) << "to 19.99 mm";
  EXPECT_EQ(sent_to("axis.move_by", {{"distance", -19.99}}), 0);
}

TEST_F(DaemonCorrection, IsInWhereAnAxisIs) {
  sent_to("axis.move_to", {{"position", 10.02}});
  const auto state = client->result("axis.get_state", {{"axis", "x"}});
  EXPECT_DOUBLE_EQ(state.at("position").as_double(), 10.02);
  EXPECT_EQ(state.at("position_microsteps"), 102'400);
}

TEST_F(DaemonCorrection, IsInItsSoftLimits) {
  EXPECT_EQ(sent_to("axis.move_to", {{"position", 30}}), std::lround(30.01 * 10'240));
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}, {"position", 30.01}}),
              HasSubstr("30.01 mm is beyond the soft limit of 30 mm"));
}

TEST(DaemonConfig, TellsWhatIsWrongWithACorrection) {
  const auto problems = [](const std::string& lines) {
    const auto config = parse_config("[daemon]\nsocket = \"/run/a\"\n" + std::string(bench_bus) +
                                     axis_section("x", 0, lines));
    return config ? std::string("none") : config.error().front().message;
  };
  const CorrectionFile file("0 0\n1 x\n");
  EXPECT_THAT(problems("unit = \"mm\"\nscrew_pitch = 5\n" + file.line()),
              HasSubstr("correction.csv:2: '1 x' is not two numbers"));
  EXPECT_THAT(problems("unit = \"mm\"\nscrew_pitch = 5\ncorrection = \"/no/such\"\n"),
              HasSubstr("'correction': /no/such: cannot be read"));
  EXPECT_THAT(problems(file.line()), HasSubstr("'correction' means nothing without 'unit'"));
}

TEST(DaemonConfig, OfAChangedCorrectionIsAnotherBus) {
  CorrectionFile file("0 0\n1 1\n");
  const auto said = [&] {
    return parse_config("[daemon]\nsocket = \"/run/a\"\n" + corrected_axis(file))->buses[0].said;
  };
  const auto before = said();
  EXPECT_EQ(said(), before);
  file.write("0 0\n1 1.01\n");
  EXPECT_NE(said(), before);
}

class CorrectedPathRun : protected OnScrew, public DaemonPath {
 protected:
  CorrectedPathRun() : DaemonPath(std::string(in_mm) + file.line()) {}
};

TEST_F(CorrectedPathRun, EndsWhereItReallyIsToEnd) {
  client->result("path.run", order("G1 X10 Y10.02 F1200\n"));
  EXPECT_NEAR(mm(0), 10, 1e-3);
  EXPECT_NEAR(mm(1), 10, 1e-3) << "by its steps";
  client->result("path.run", order("G91 G1 X-5 Y-5.01 F1200\n"));
  EXPECT_NEAR(mm(1), 5, 1e-3) << "from where it really was";
}

}  // namespace
}  // namespace tmcld::test
