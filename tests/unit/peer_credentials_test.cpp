// Who connects is what the kernel says, not what the other end says.
#include "fronts/peer_credentials.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "support/other_user.hpp"
#include "support/temp_path.hpp"

namespace tmcld {
namespace {

class PeerCredentials : public testing::Test {
 protected:
  PeerCredentials() {
    std::copy_n(path.c_str(), path.size() + 1, address.sun_path);
    EXPECT_EQ(::bind(listening, generic(), sizeof address), 0);
    EXPECT_EQ(::listen(listening, 1), 0);
    std::filesystem::permissions(path, std::filesystem::perms::all);
  }
  ~PeerCredentials() override {
    ::close(listening);
    std::filesystem::remove(path);
  }
  const sockaddr* generic() const { return reinterpret_cast<const sockaddr*>(&address); }

  std::string path = tmcl::test::temp_path("socket");
  sockaddr_un address{AF_UNIX, {}};
  int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
};

TEST_F(PeerCredentials, AreThoseOfTheProcessThatConnected) {
  const auto said = tmcl::test::told_by_other_user([&] {
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    const bool connected = ::connect(socket, generic(), sizeof address) == 0;
    return connected ? std::to_string(::getpid()) + " " + std::to_string(::getuid()) : "no";
  });
  ASSERT_NE(said, "no");
  const int accepted = ::accept(listening, nullptr, nullptr);
  const auto credentials = credentials_of_peer(accepted);
  ::close(accepted);
  EXPECT_EQ(std::to_string(credentials.pid) + " " + std::to_string(credentials.uid), said);
  std::vector<gid_t> groups(static_cast<std::size_t>(::getgroups(0, nullptr)));
  ::getgroups(static_cast<int>(groups.size()), groups.data());
  groups.push_back(::getegid());
  EXPECT_THAT(credentials.groups, testing::IsSupersetOf(groups));
}

TEST_F(PeerCredentials, AreNobodysWhereThereIsNoSocket) {
  const auto credentials = credentials_of_peer(-1);
  EXPECT_EQ(credentials.uid, 65534U);
  EXPECT_TRUE(credentials.groups.empty());
}

}  // namespace
}  // namespace tmcld
