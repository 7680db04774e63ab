// Who may ask on a CAN interface: one program for each reply identifier.

#include "link/can_lock.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include "support/other_user.hpp"

namespace tmcl {
namespace {

using testing::HasSubstr;

class CanLock : public testing::Test {
 protected:
  // Tests of other processes run beside this one, and there is no such interface.
  CanReplies replies{0x4000'0000U + static_cast<unsigned>(getpid()), 2, false};

  std::string told() const {
    const auto lock = lock_can_replies(replies);
    if (lock) return "taken";
    const auto& error = lock.error();
    return error.code == Errc::link_busy ? "held by " + error.message : error.message;
  }
};

TEST_F(CanLock, ASecondProgramLearnsWhoHasIt) {
  const auto lock = lock_can_replies(replies);
  ASSERT_TRUE(lock);
  const auto me = "(process " + std::to_string(getpid()) + ")";
  EXPECT_THAT(told(), HasSubstr(me));
  EXPECT_THAT(test::told_by_other_user([this] { return told() + ", and again " + told(); }),
              testing::AllOf(testing::StartsWith("held by "), HasSubstr(me + ", and again held by"),
                             testing::EndsWith(me)));
}

TEST_F(CanLock, EndsWithItsHolder) {
  { ASSERT_TRUE(lock_can_replies(replies)); }
  EXPECT_EQ(told(), "taken");
  // Also if that is killed.
  test::told_by_other_user([this] {
    const auto lock = lock_can_replies(replies);
    _exit(0);
    return std::string();
  });
  EXPECT_EQ(told(), "taken");
}

TEST_F(CanLock, LeavesOtherRepliesToOthers) {
  const auto lock = lock_can_replies(replies);
  for (const auto& other : {CanReplies{replies.interface_index + 1, 2, false},
                            CanReplies{replies.interface_index, 22, false},
                            CanReplies{replies.interface_index, 2, true}})
    EXPECT_TRUE(lock_can_replies(other));
}

}  // namespace
}  // namespace tmcl
