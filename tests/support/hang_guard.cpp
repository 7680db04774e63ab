// TMCL_TEST_SECONDS says how long each test may take; without it, any time.
#include "support/hang_guard.hpp"

#include <cstdlib>

namespace {

[[maybe_unused]] const bool guards = [] {
  const char* most = std::getenv("TMCL_TEST_SECONDS");
  if (most != nullptr)
    testing::UnitTest::GetInstance()->listeners().Append(
        new tmcl::test::HangGuard(std::chrono::seconds(std::stoi(most))));
  return most != nullptr;
}();

}  // namespace
