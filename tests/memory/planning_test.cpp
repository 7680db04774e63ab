// How much memory plans take: those that wait, and the one that is made.
#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "memory/allocations.hpp"
#include "memory/bench.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
namespace plan = tmcl::plan;

std::string repeated(std::string text, std::string_view lines, std::size_t times) {
  for (std::size_t i = 0; i < times; ++i) text += lines;
  return text;
}

TEST(MemoryOfPlans, ThatWaitIsWhatTheBudgetCounts) {
  MemoryBench bench;
  auto& planning = bench.daemon().gateway().planning;
  planning.set_limit(std::size_t{16} << 20);
  for (const std::size_t lines : {1U, 100U, 5000U}) {
    // The first one is made all the time, so that all others wait.
    bench.let_work_take(1min);
    std::vector<std::unique_ptr<MemoryClient>> clients;
    const auto text = repeated("G1 F600\\n", "X1\\nX0\\n", lines);
    begin_to_measure();
    for (int i = 0; i < 8; ++i) {
      auto& client = *clients.emplace_back(std::make_unique<MemoryClient>(bench));
      for (int k = 0; k < 64; ++k)
        client.send("path.plan", R"({"axes":["x"],"text":")" + text + "\"}");
    }
    bench.run_for(1s);
    const auto counted = planning.taken();
    // Beside them there is what each client has anyhow.
    constexpr std::size_t of_client = std::size_t{256} << 10;
    EXPECT_LE(taken_bytes(), counted + clients.size() * of_client) << lines;
    EXPECT_GE(2 * taken_bytes(), counted) << lines;
    std::cout << text.size() << " bytes: " << counted << " counted, " << taken_bytes()
              << " taken\n";
    clients.clear();
    bench.let_work_take({});
    bench.run_for(2min);
    EXPECT_EQ(planning.taken(), 0U);
  }
}

TEST(MemoryOfPlans, ThatArePassedIsWhatTheBudgetCounts) {
  plan::PathLimits limits;
  limits.axes = 1;
  limits.axis[0] = {100, 1000};
  std::string table = "t,x\n";
  for (int row = 0; row < 5000; ++row)
    table += std::to_string(row) + "," + (row % 2 == 0 ? "0\n" : "1\n");
  for (const auto& [text, format] :
       {std::pair(repeated("G1 F600\n", "X1\nX0\n", 5000), plan::PathFormat::gcode),
        std::pair(repeated("G1 F600\n", "X1\nG4P0\nX0\nG4P0\n", 3000), plan::PathFormat::gcode),
        std::pair(table, plan::PathFormat::csv)}) {
    auto source = plan::read_path(text, format, 0.05);
    ASSERT_TRUE(source);
    begin_to_measure();
    const Watched watched;
    const auto course = plan::course_of(*source, limits, 1e9, 0.05);
    ASSERT_TRUE(course) << text.size();
    EXPECT_GE(1.1 * static_cast<double>(course->bytes()), static_cast<double>(taken_bytes()));
    EXPECT_LE(course->bytes(), taken_bytes() + sizeof *course);
  }
}

struct Text {
  const char* name;
  std::string text;
  plan::PathFormat format = plan::PathFormat::gcode;
};

/// What one takes grows with the legs of its path, and those are bounded.
TEST(MemoryOfPlans, ThatAreMadeIsBoundedByTheirLegs) {
  constexpr std::size_t bytes_of_leg = 1000;
  std::string table = "x,y\n";
  for (int row = 0; row < 5000; ++row) table += row % 2 == 0 ? "0,1\n" : "1,0\n";
  const std::vector<Text> texts{
      {"short lines", repeated("G1 F600\n", "X1\nX0\n", 5000)},
      {"long lines", repeated("", "G1 X20.123456789 Y10.123456789 F600.00\nG1 X0.1 Y1.1\n", 1000)},
      {"dwells", repeated("G1 F600\n", "X1\nG4P0\nX0\nG4P0\n", 3000)},
      {"arcs", repeated("G1 F600\n", "G2 X10 Y0 I5 J0\nG2 X0 Y0 I-5 J0\n", 300)},
      {"a table", table, plan::PathFormat::csv},
  };
  for (const auto& [name, text, format] : texts) {
    begin_to_measure();
    const Watched watched;
    const auto source = plan::read_path(text, format, 0.05);
    ASSERT_TRUE(source) << name;
    plan::PathLimits limits;
    limits.axes = source->path.axes.size();
    for (auto& axis : limits.axis) axis = {100, 1000};
    const auto course = plan::course_of(*source, limits, 1e9, 0.05);
    ASSERT_TRUE(course) << name;
    EXPECT_LE(most_bytes(), bytes_of_leg * course->legs()) << name;
    std::cout << name << ": " << most_bytes() / text.size() << " times its text, "
              << most_bytes() / course->legs() << " bytes for a leg\n";
  }
}

}  // namespace
}  // namespace tmcld::test
