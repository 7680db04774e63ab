// What a service is told, by whom it was started: the environment, and a datagram at a time.
#include "service/service.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <gmock/gmock.h>

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ServiceEnvironment : public testing::Test {
 protected:
  static constexpr std::array names{"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID", "LISTEN_FDS",
                                    "LISTEN_PID"};
  ServiceEnvironment() {
    for (const char* name : names) ::unsetenv(name);
  }
  ~ServiceEnvironment() override {
    for (const char* name : names) ::unsetenv(name);
    if (manager_ >= 0) ::close(manager_);
  }

  static void set(const char* name, const std::string& value) { ::setenv(name, value.c_str(), 1); }
  static std::string our_process() { return std::to_string(::getpid()); }

  /// Somebody who wants to know, at an abstract address.
  void listen() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const auto name = "tmcl-service-test-" + our_process();
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    const auto size = offsetof(sockaddr_un, sun_path) + 1 + name.size();
    manager_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    ASSERT_EQ(::bind(manager_, reinterpret_cast<sockaddr*>(&address), static_cast<socklen_t>(size)),
              0);
    set("NOTIFY_SOCKET", "@" + name);
  }
  /// Empty if it was told nothing more.
  std::string next() const {
    std::array<char, 256> text{};
    const auto size = ::recv(manager_, text.data(), text.size(), 0);
    return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : std::string();
  }

 private:
  int manager_ = -1;
};

TEST_F(ServiceEnvironment, WithoutAManagerNobodyIsTold) {
  const auto service = Service::of_environment();
  ASSERT_TRUE(service);
  EXPECT_FALSE(service->is_watched());
  service->ready("never mind");
  service->alive();
}

TEST_F(ServiceEnvironment, ManagerIsToldInDatagrams) {
  listen();
  set("WATCHDOG_USEC", "2000000");
  const auto service = Service::of_environment();
  ASSERT_TRUE(service && service->is_watched());
  EXPECT_EQ(service->report_interval(), 1s);
  service->ready("3 axes");
  service->alive();
  service->status("2 axes");
  service->stopping("bye");
  EXPECT_EQ(next(), "READY=1\nSTATUS=3 axes");
  EXPECT_EQ(next(), "WATCHDOG=1");
  EXPECT_EQ(next(), "STATUS=2 axes");
  EXPECT_EQ(next(), "STOPPING=1\nSTATUS=bye");
}

TEST_F(ServiceEnvironment, WatchdogOfAnotherProcessIsNotFed) {
  listen();
  set("WATCHDOG_USEC", "2000000");
  set("WATCHDOG_PID", "1");
  const auto service = Service::of_environment();
  service->alive();
  EXPECT_EQ(next(), "");
  set("WATCHDOG_PID", our_process());
  Service::of_environment()->alive();
  EXPECT_EQ(next(), "WATCHDOG=1");
}

TEST_F(ServiceEnvironment, AddressesThatAreNoneAreLeftAlone) {
  for (const std::string& address : {std::string("relative"), "/" + std::string(200, 'x')}) {
    set("NOTIFY_SOCKET", address);
    EXPECT_FALSE(Service::of_environment()->is_watched()) << address;
  }
}

TEST_F(ServiceEnvironment, ManagerThatHasGoneIsNoFault) {
  set("NOTIFY_SOCKET", "/nowhere/notify");
  const auto service = Service::of_environment();
  ASSERT_TRUE(service);
  service->ready("nobody hears it");
}

TEST_F(ServiceEnvironment, OnlyOneSocketCanBePassed) {
  set("LISTEN_FDS", "2");
  EXPECT_TRUE(Service::of_environment()) << "they are for another process";
  set("LISTEN_PID", our_process());
  const auto service = Service::of_environment();
  ASSERT_FALSE(service);
  EXPECT_THAT(service.error(), HasSubstr("was passed 2 sockets"));
  EXPECT_THAT(service.error(), HasSubstr("ListenStream="));
}

}  // namespace
}  // namespace tmcld::test
