// How much memory plans take: those that wait, and the one that is made.
#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "memory/allocations.hpp"
#include "memory/bench.hpp"
#include "tmcl/plan/mint_preparation.hpp"
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

// ---- Mint programs -----------------------------------------------------------------------------

std::vector<plan::MintAxis> mint_axes() {
  std::vector<plan::MintAxis> axes;
  for (unsigned number = 0; number < plan::mint::most_axes; ++number) {
    plan::MintAxis axis{number, {"x", tmcl::find_model("TMCM-1110")}, {}};
    axis.units.module = tmcl::module_units(tmcl::Tmc429Dividers{7, 7});
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// As long as a program may be.
std::string mint_program(std::string_view to, std::string_view back) {
  std::string text = "SPEED = 9000;\nACCEL = 90000;\n";
  for (std::size_t statements = 6; statements <= plan::mint::most_statements; statements += 4) {
    text += to;
    text += ":GO\n";
    text += back;
    text += ":GO\n";
  }
  return text;
}

TEST(MemoryOfMintPlans, ThatAreRunIsWhatTheBudgetCounts) {
  const auto axes = mint_axes();
  for (const auto& text :
       {mint_program("MOVEA=500", "MOVEA=0"), mint_program("MOVEA[0,1]=500;", "MOVEA[0,1]=0;")}) {
    const auto program = plan::read_mint(text);
    ASSERT_TRUE(program);
    begin_to_measure();
    const Watched watched;
    auto planned = plan::plan_mint(*program, axes);
    ASSERT_TRUE(planned) << planned.error().message;
    const auto counted = planned->bytes();
    const plan::MintDrive drive(std::move(planned->groups), {{0, 0}, {0, 1}});
    EXPECT_GE(1.1 * static_cast<double>(counted), static_cast<double>(taken_bytes()));
    EXPECT_LE(counted, taken_bytes() + sizeof *planned);
  }
}

TEST(MemoryOfMintPlans, ThatAreMadeIsBoundedByTheirStatements) {
  constexpr std::size_t most = std::size_t{150} << 20;
  const auto axes = mint_axes();
  const auto text = mint_program("MOVEA[0,1,2,3,4,5,6,7]=500;", "MOVEA[0,1,2,3,4,5,6,7]=0;");
  begin_to_measure();
  const Watched watched;
  const auto program = plan::read_mint(text);
  ASSERT_TRUE(program) << program.error().problems.front().message;
  const auto planned = plan::plan_mint(*program, axes);
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_LE(most_bytes(), most);
  std::cout << text.size() << " bytes of text: " << (most_bytes() >> 20) << " MB at most, "
            << (planned->bytes() >> 20) << " MB while it is run\n";
}

// ---- paths -------------------------------------------------------------------------------------

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
