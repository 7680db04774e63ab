// Several axes started at once: what is sent, and in which order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl_fixture.hpp"
#include "together.hpp"

namespace tmclctl {
namespace {

using testing::ElementsAre;

class CtlTogether : public testing::Test {
 protected:
  test::FakeHost host;
  test::FakeTarget target{host};
};

TEST_F(CtlTogether, TargetsAreLoadedFirstAndMotorsOfAModuleStartByOneCommand) {
  ASSERT_TRUE(start_together({"1/0", "2/0", "1/2"}, {{100}, {200}, {300}}, target));
  EXPECT_THAT(target.calls,
              ElementsAre(R"(coordinate.set {"axis":"1/0","number":0,"position_microsteps":100})",
                          R"(coordinate.set {"axis":"1/2","number":0,"position_microsteps":300})",
                          R"(coordinate.set {"axis":"2/0","number":0,"position_microsteps":200})",
                          R"(coordinate.start {"address":1,"number":0,"motors":[0,2]})",
                          R"(coordinate.move {"axis":"2/0","number":0})"));
}

TEST_F(CtlTogether, AnAxisWithANameIsLookedUp) {
  ASSERT_TRUE(start_together({"x", "1/1"}, {{100}, {200}}, target));
  EXPECT_EQ(target.calls.back(), R"(coordinate.move {"axis":"x","number":0})");
  EXPECT_EQ(start_together({"y", "1/1"}, {{1}, {2}}, target).error().name, "unknown_axis");
}

TEST_F(CtlTogether, NothingStartsIfATargetCannotBeLoaded) {
  target.failure = Failure{ExitCode::unknown, "reply_timeout", "silence"};
  EXPECT_FALSE(start_together({"1/0", "1/1"}, {{1}, {2}}, target));
  EXPECT_TRUE(target.calls.empty());
}

}  // namespace
}  // namespace tmclctl
