// A test that hangs ends, and is named.
#include "support/hang_guard.hpp"

namespace tmcl::test {
namespace {

const testing::TestInfo& this_test() {
  return *testing::UnitTest::GetInstance()->current_test_info();
}

TEST(HangGuardDeathTest, NamesTheTestThatHangs) {
  HangGuard guard(std::chrono::milliseconds(10));
  const auto hang = [&] {
    guard.OnTestStart(this_test());
    while (true) ::pause();
  };
  EXPECT_EXIT(hang(), testing::ExitedWithCode(EXIT_FAILURE),
              "hangs: HangGuardDeathTest.NamesTheTestThatHangs, ended");
}

TEST(HangGuardDeathTest, LetsATestEnd) {
  HangGuard guard(std::chrono::milliseconds(10));
  const auto end_in_time = [&] {
    guard.OnTestStart(this_test());
    guard.OnTestEnd(this_test());
    std::signal(SIGALRM, SIG_DFL);
    itimerval left{};
    ::getitimer(ITIMER_REAL, &left);
    std::_Exit(timerisset(&left.it_value) ? EXIT_FAILURE : EXIT_SUCCESS);
  };
  EXPECT_EXIT(end_in_time(), testing::ExitedWithCode(EXIT_SUCCESS), "");
}

}  // namespace
}  // namespace tmcl::test
