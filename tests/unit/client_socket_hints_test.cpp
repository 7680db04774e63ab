// What to try when tmcld's socket cannot be used.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>

#include "client/socket_hints.hpp"

namespace tmcl::client {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(SocketHints, AGroupForSharingIsJoined) {
  const auto hint = access_hint({"anna", "lab", 1004});
  EXPECT_THAT(hint, HasSubstr("group 'lab'"));
  EXPECT_THAT(hint, HasSubstr("'sudo adduser $USER lab'"));
}

TEST(SocketHints, TheGroupThatThePackageMakesIsJoinedThoughItIsOneOfTheSystem) {
  const auto hint = access_hint({"tmcld", "tmcl", 998});
  EXPECT_THAT(hint, HasSubstr("user 'tmcld' and group 'tmcl'"));
  EXPECT_THAT(hint, HasSubstr("'sudo adduser $USER tmcl', and log in again"));
  EXPECT_THAT(hint, Not(HasSubstr("addgroup")));
}

TEST(SocketHints, NobodyIsToldToJoinAGroupOfTheSystemOrOfAUser) {
  for (const auto& owner : {FileOwner{"root", "root", 0}, FileOwner{"root", "sudo", 27},
                            FileOwner{"tmcld", "dialout", 20}, FileOwner{"anna", "anna", 1000}}) {
    const auto hint = access_hint(owner);
    EXPECT_THAT(hint, HasSubstr("user '" + owner.user + "' and group '" + owner.group + "'"));
    EXPECT_THAT(hint, Not(HasSubstr("$USER " + owner.group)));
    EXPECT_THAT(hint, HasSubstr("'sudo addgroup tmcl'"));
  }
}

TEST(SocketHints, TheOwnerIsThatOfTheFile) {
  // Nobody is root's group but root: the tests may run as anybody.
  EXPECT_THAT(hint_for(EACCES, "/"), HasSubstr("user 'root' and group 'root'"));
  EXPECT_THAT(hint_for(EACCES, "/no/such/socket"), HasSubstr("may not look into the directory"));
}

TEST(SocketHints, NothingIsNamedThatIsNotInstalled) {
  for (const auto& hint : {hint_for(ENOENT, "/no/such/socket"), hint_for(ECONNREFUSED, "/"),
                           hint_for(EAGAIN, "/"), hint_after_loss()}) {
    EXPECT_THAT(hint, Not(HasSubstr("systemctl")));
  }
  EXPECT_THAT(hint_for(ENOENT, "/no/such/socket"), HasSubstr("tmcld --config FILE"));
  EXPECT_THAT(hint_after_loss(), HasSubstr("tmcld --config FILE"));
}

}  // namespace
}  // namespace tmcl::client
