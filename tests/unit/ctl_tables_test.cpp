// Tables: as wide as the terminal, with tabs for programs, and in red where something is wrong.
#include <sstream>

#include <gmock/gmock.h>

#include "output/print.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

struct Shown {
  std::string out;
  std::string err;
};

Shown show(const Table& table, Screen screen = {}, TableStyle style = {}) {
  std::ostringstream out;
  std::ostringstream err;
  Output output{out, err, screen, screen};
  output.tables = std::move(style);
  table.print(output);
  return {out.str(), err.str()};
}

Table some_table() {
  Table table({"NAME", "UNIT", "MEANING"});
  table.add({"max_velocity", "internal", "greatest speed of a positioning move"});
  table.add({"max_current", "1/255", "current while moving, as a part of the greatest"}, true);
  return table;
}

TEST(Tables, AreWholeInAFile) {
  EXPECT_EQ(show(some_table()).out,
            "NAME          UNIT      MEANING\n"
            "max_velocity  internal  greatest speed of a positioning move\n"
            "max_current   1/255     current while moving, as a part of the greatest\n");
}

TEST(Tables, AreCutToTheTerminal) {
  const Screen narrow{.terminal = true, .colour = false, .utf8 = false, .width = 50};
  EXPECT_EQ(show(some_table(), narrow).out,
            "NAME          UNIT      MEANING\n"
            "max_velocity  internal  greatest speed of a pos...\n"
            "max_current   1/255     current while moving, a...\n");
  EXPECT_THAT(show(some_table(), narrow, {.wide = true}).out, HasSubstr("positioning move\n"));
}

TEST(Tables, AreNoWiderThanTheTerminalWhereOneColumnIsWide) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 200; ++round) {
    Table table({"A", "LONG", "B"});
    for (int row = 0; row < 5; ++row)
      table.add({std::string(static_cast<std::size_t>(random.between(0, 8)), 'a'),
                 std::string(static_cast<std::size_t>(random.between(0, 200)), 'm'),
                 std::string(static_cast<std::size_t>(random.between(0, 8)), 'b')});
    const auto width = static_cast<int>(random.between(40, 150));
    std::istringstream lines(
        show(table, {.terminal = true, .colour = false, .utf8 = false, .width = width}).out);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), static_cast<std::size_t>(width));
  }
}

TEST(Tables, HaveTabsForPrograms) {
  EXPECT_EQ(show(some_table(), {.terminal = true, .width = 40}, {.tsv = true}).out,
            "NAME\tUNIT\tMEANING\n"
            "max_velocity\tinternal\tgreatest speed of a positioning move\n"
            "max_current\t1/255\tcurrent while moving, as a part of the greatest\n");
}

TEST(Tables, HaveTheColumnsThatAreWanted) {
  EXPECT_EQ(show(some_table(), {}, {.columns = {"unit", "NAME"}}).out,
            "UNIT      NAME\n"
            "internal  max_velocity\n"
            "1/255     max_current\n");
  const auto shown = show(some_table(), {}, {.columns = {"name", "size"}});
  EXPECT_EQ(shown.out, "NAME\nmax_velocity\nmax_current\n");
  EXPECT_THAT(shown.err, HasSubstr("there is no column 'size'; there are: NAME, UNIT, MEANING"));
}

TEST(Tables, ShowInRedWhatIsWrong) {
  const auto shown =
      show(some_table(), {.terminal = true, .colour = true, .utf8 = false, .width = 100}).out;
  EXPECT_THAT(shown, HasSubstr("\nmax_velocity"));
  EXPECT_THAT(shown, HasSubstr("\n\x1b[31mmax_current   1/255"));
  EXPECT_THAT(shown, HasSubstr("\x1b[0m\n"));
}

}  // namespace
}  // namespace tmclctl
