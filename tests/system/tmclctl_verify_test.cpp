// tmclctl verify on a real pty: what it finds is no other than what the module is, and the
// simulator takes the file about it. A busy computer lets it find less.
#include <gmock/gmock.h>

#include <fstream>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

TEST(TmclctlVerify, WritesAFileThatMakesASimulatedModuleLikeIt) {
  CtlBench bench;
  const auto like = bench.file("like.toml");
  std::ofstream(like) << "[module]\nmodel = \"TMCM-1110\"\nlast_step = \"r2\"\n"
                         "range_check = \"wrap\"\nrelative_answer = \"target\"\n";
  Program module({"tmclsim", "--module", "TMCM-1110", "--as", like, "--pty", bench.file("like")});
  ASSERT_TRUE(module.wait_for("ready"));
  const auto report = bench.file("report.toml");
  // Nothing that moves a motor is sent twice: on a busy computer its answer may take long.
  const auto config = bench.file("patient.toml");
  const auto link = "serial:" + bench.file("like") + "@115200";
  std::ofstream(config) << "[[bus]]\nname = \"bench\"\nlink = \"" << link
                        << "\"\nreply_timeout_ms = 20000\n";
  const auto ran =
      bench.ctl({"--direct", link, "--config", config},
                {"verify", "1/0", "--travel", "-100..100", "--yes", "--report", report});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("range_check"));
  const auto text = contents(report);
  EXPECT_THAT(text, HasSubstr("range_check = \"wrap\""));
  EXPECT_THAT(text, HasSubstr("last_step"));
  EXPECT_THAT(text, Not(AnyOf(HasSubstr("last_step = \"r1\""), HasSubstr("last_step = \"r3\""),
                              HasSubstr("relative_answer = \"distance\""),
                              HasSubstr("like no known variant"))));
  Program again({"tmclsim", "--module", "TMCM-1110", "--as", report, "--pty", bench.file("again")});
  EXPECT_TRUE(again.wait_for("ready")) << again.output();
}

TEST(TmclctlVerify, RefusesWithoutATravelAndWithoutAnybodyToAsk) {
  CtlBench bench;
  const auto travel = bench.ctl(bench.direct(), {"verify", "1/0", "--yes"});
  EXPECT_EQ(travel.status, 2);
  EXPECT_THAT(travel.err, HasSubstr("no soft limits"));
  const auto asked = bench.ctl(bench.direct(), {"verify", "1/0", "--travel", "-9..9"});
  EXPECT_EQ(asked.status, 2);
  EXPECT_THAT(asked.err, HasSubstr("--yes"));
}

}  // namespace
}  // namespace tmcl::test
