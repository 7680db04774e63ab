// Links on real descriptors: ptys, sockets, and pairs of ends in memory.

#include "tmcl/link.hpp"

#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "support/other_user.hpp"
#include "support/program.hpp"
#include "support/pty.hpp"
#include "support/temp_path.hpp"
#include "tmcl/link_file.hpp"

namespace tmcl {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> read_after_wait(Link& link, std::size_t size) {
  std::vector<std::uint8_t> all;
  for (int round = 0; round < 50 && all.size() < size; ++round) {
    pollfd waiting{link.descriptor(), POLLIN, 0};
    poll(&waiting, 1, 20);
    std::array<std::uint8_t, 64> buffer{};
    const auto count = link.read(buffer);
    if (!count) break;
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
  }
  return all;
}

TEST(SerialLink, TakesAnyBaudRate) {
  for (const std::uint32_t baud : {9600U, 28800U, 76800U, 115200U, 250000U, 1000000U}) {
    const test::Pty pty;
    const auto link = Link::open("serial:" + pty.path() + "@" + std::to_string(baud));
    ASSERT_TRUE(link) << describe(link.error());
    termios2 settings{};
    ASSERT_EQ(ioctl(link->descriptor(), TCGETS2, &settings), 0);
    EXPECT_EQ(settings.c_ospeed, baud);
    EXPECT_EQ(settings.c_ispeed, baud);
  }
}

TEST(SerialLink, KnowsHowLongAnExchangeIsOnTheWire) {
  const test::Pty pty;
  const auto link = Link::open("serial:" + pty.path() + "@9600");
  ASSERT_TRUE(link);
  EXPECT_EQ(link->wire_time(), std::chrono::microseconds(18750));
}

TEST(SerialLink, PassesEveryByteUnchangedBothWays) {
  const test::Pty pty;
  auto link = Link::open("serial:" + pty.path() + "@115200");
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> every(256);
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = static_cast<std::uint8_t>(i);
  ASSERT_EQ(write(pty.master(), every.data(), every.size()), 256);
  EXPECT_EQ(read_after_wait(*link, every.size()), every);
  ASSERT_EQ(link->write(every), every.size());
  auto far_end = Link::adopt(dup(pty.master()), Framing::serial, "far end");
  EXPECT_EQ(read_after_wait(far_end, every.size()), every);
}

TEST(SerialLink, ASecondOpenerLearnsWhoHoldsThePort) {
  const test::Pty pty;
  // Has it open without using it as a port: not whom to blame.
  test::Program bystander(
      {"/bin/sh", "-c", "exec 3<>" + pty.path() + "; echo open; exec sleep 60"});
  ASSERT_TRUE(bystander.wait_for("open"));
  const auto name = "serial:" + pty.path() + "@115200";
  {
    const auto first = Link::open(name);
    ASSERT_TRUE(first);
    const auto second = Link::open(name);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::link_busy);
    EXPECT_THAT(second.error().message,
                HasSubstr("in use by unit_tests (process " + std::to_string(getpid()) + ")"));
  }
  EXPECT_TRUE(Link::open(name)) << "the port stayed locked";
}

TEST(SerialLink, CanBeOpenedAgainWhileSomebodyElseHasThePortOpen) {
  const test::Pty pty;
  ASSERT_EQ(chmod(pty.path().c_str(), 0666), 0);
  const int bystander = open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(bystander, 0);
  const auto name = "serial:" + pty.path() + "@115200";
  const auto told = test::told_by_other_user([&] {
    for (int round = 0; round < 3; ++round) {
      const auto link = Link::open(name);
      if (!link) return describe(link.error());
    }
    return std::string("opened each time");
  });
  EXPECT_EQ(told, "opened each time");
  close(bystander);
}

/// A process whose controlling terminal is the pty, as a shell in a window has one.
class Shell {
 public:
  explicit Shell(const test::Pty& pty) {
    std::array<int, 2> ready{};
    if (pipe(ready.data()) != 0) throw std::runtime_error("no pipe to be had");
    process_ = fork();
    if (process_ == 0) {
      setsid();
      const int terminal = open(pty.path().c_str(), O_RDWR);
      const bool has_it = terminal >= 0 && ioctl(terminal, TIOCSCTTY, 0) == 0;
      (void)!write(ready[1], has_it ? "y" : "n", 1);
      while (true) ::pause();
    }
    char answer = 'n';
    const auto got = read(ready[0], &answer, 1);
    for (const int end : ready) close(end);
    if (got != 1 || answer != 'y') throw std::runtime_error("the pty could not be made a terminal");
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell() { end(); }
  void end() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
};

bool is_untouched(const test::Pty& pty) {
  pollfd far{pty.master(), POLLIN, 0};
  termios2 settings{};
  ioctl(pty.master(), TCGETS2, &settings);
  return poll(&far, 1, 0) == 0 && (settings.c_lflag & ICANON) != 0;
}

TEST(SerialLink, ATerminalThatSomebodyWorksAtIsNotOpened) {
  const test::Pty pty;
  Shell shell(pty);
  const auto opened = Link::open(SerialName{pty.path(), 9600});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, Errc::link_open_failed);
  EXPECT_THAT(opened.error().message, HasSubstr(pty.path() + " is the terminal of "));
  EXPECT_TRUE(is_untouched(pty));
}

TEST(SerialLink, AStaleLinkToATerminalIsNamed) {
  const test::Pty pty;
  const std::string link = test::temp_path("stale");
  std::filesystem::create_symlink(pty.path(), link);
  {
    Shell shell(pty);
    const auto opened = Link::open(SerialName{link, 9600});
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, HasSubstr("the link " + link + " is stale"));
    EXPECT_THAT(opened.error().hint, HasSubstr("rm " + link));
    EXPECT_TRUE(is_untouched(pty));
  }
  std::filesystem::remove(link);
}

TEST(LinkFile, ReplacesALinkThatLeadsToATerminal) {
  const test::Pty pty;
  const test::Pty own;
  const std::string link = test::temp_path("pty");
  std::filesystem::create_symlink(pty.path(), link);
  EXPECT_FALSE(LinkFile::create(link, own.path())) << "another program may serve it";
  Shell shell(pty);
  const auto made = LinkFile::create(link, own.path());
  ASSERT_TRUE(made) << made.error();
  EXPECT_EQ(std::filesystem::read_symlink(link), own.path());
}

TEST(LinkFile, SaysWhyItCannotLookAtItsPath) {
  const test::Pty own;
  const auto made = LinkFile::create(test::temp_path(std::string(300, 'x')), own.path());
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error(), HasSubstr("File name too long"));
}

TEST(SerialLinkAsRoot, WhoMayNotOpenItIsToldWhoMay) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can take its rights away";
  const test::Pty pty;
  constexpr gid_t games = 60;
  ASSERT_EQ(chown(pty.path().c_str(), 0, games), 0);
  const auto told = [&](mode_t mode) {
    chmod(pty.path().c_str(), mode);
    return test::told_by_other_user([&] {
      const auto link = Link::open("serial:" + pty.path() + "@115200");
      return link ? "opened" : describe(link.error());
    });
  };
  EXPECT_THAT(told(0600), HasSubstr("Permission denied"));
  EXPECT_THAT(told(0600), HasSubstr("it is for user 'root' alone"));
  EXPECT_THAT(told(0620), HasSubstr("it is for user 'root' alone"));
  EXPECT_THAT(told(0660), HasSubstr("it is for group 'games': `sudo usermod -aG games $USER`"));
}

TEST(SerialLink, AHangUpIsALostLink) {
  test::Pty pty;
  auto link = Link::open("serial:" + pty.path() + "@115200");
  ASSERT_TRUE(link);
  std::array<std::uint8_t, 9> buffer{};
  EXPECT_EQ(link->read(buffer), std::size_t{0}) << "nothing is there yet";
  pty.hang_up();
  const auto count = link->read(buffer);
  ASSERT_FALSE(count);
  EXPECT_EQ(count.error().code, Errc::link_lost);
}

/// Listens, but has as many callers as it takes already: whoever calls now waits.
class BusyListener {
 public:
  BusyListener() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    const bool listens =
        bind(listener_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_) == 0 &&
        listen(listener_, 0) == 0 &&
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address_), &size) == 0;
    if (!listens) throw std::runtime_error("cannot listen");
    for (auto& caller : callers_) {
      caller = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
      connect(caller, reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
    }
  }
  BusyListener(const BusyListener&) = delete;
  BusyListener& operator=(const BusyListener&) = delete;
  ~BusyListener() {
    for (const int caller : callers_) close(caller);
    close(listener_);
  }
  std::string link() const { return "tcp:127.0.0.1:" + std::to_string(ntohs(address_.sin_port)); }

 private:
  int listener_;
  sockaddr_in address_{};
  std::array<int, 4> callers_{};
};

/// A signal every few milliseconds, whose handler does nothing.
class Signals {
 public:
  Signals() {
    struct sigaction action {};
    action.sa_handler = [](int) {};
    sigaction(SIGALRM, &action, &before_);
    const itimerval often{{0, 5'000}, {0, 5'000}};
    setitimer(ITIMER_REAL, &often, nullptr);
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals() {
    const itimerval never{};
    setitimer(ITIMER_REAL, &never, nullptr);
    sigaction(SIGALRM, &before_, nullptr);
  }

 private:
  struct sigaction before_ {};
};

TEST(TcpLink, SignalsDoNotMakeItOpen) {
  const BusyListener listener;
  constexpr auto patience = std::chrono::milliseconds(200);
  const auto began = RealClock().now();
  const Signals signals;
  const auto link = Link::open(listener.link(), {.connect_timeout = patience});
  ASSERT_FALSE(link);
  EXPECT_EQ(link.error().code, Errc::link_open_failed);
  EXPECT_THAT(link.error().message, HasSubstr("timed out"));
  EXPECT_GE(RealClock().now() - began, patience);
}

TEST(MemoryLink, JoinsTwoEnds) {
  auto ends = Link::memory_pair(Framing::serial);
  ASSERT_TRUE(ends);
  const auto bytes = encode_serial(Request{ModuleAddress{1}, Command::GAP, 1, 0, 0});
  ASSERT_EQ(ends->first.write(bytes), bytes.size());
  EXPECT_THAT(read_after_wait(ends->second, bytes.size()), testing::ElementsAreArray(bytes));
}

TEST(MemoryLink, WritingToAClosedEndIsALostLinkAndNoSignal) {
  auto ends = Link::memory_pair(Framing::serial);
  ASSERT_TRUE(ends);
  { const Link closed = std::move(ends->second); }
  const auto bytes = encode_serial(Request{});
  const auto count = ends->first.write(bytes);
  ASSERT_FALSE(count);
  EXPECT_EQ(count.error().code, Errc::link_lost);
}

class CanInMemory : public testing::Test {
 protected:
  CanInMemory() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0)
      throw std::runtime_error("no socket pair");
    raw_ = ends[1];
    link_.emplace(Link::adopt(ends[0], Framing::can, "memory"));
  }
  ~CanInMemory() override { close(raw_); }

  void put(const can_frame& frame) {
    ASSERT_EQ(write(raw_, &frame, sizeof frame), ssize_t{sizeof frame});
  }

  int raw_ = -1;
  std::optional<Link> link_;
};

TEST_F(CanInMemory, FramesGoThereAndBack) {
  const CanFrame frame{0x123, true, 7, {1, 2, 3, 4, 5, 6, 7, 0}};
  ASSERT_EQ(link_->write_frame(frame), true);
  can_frame seen{};
  ASSERT_EQ(read(raw_, &seen, sizeof seen), ssize_t{sizeof seen});
  EXPECT_EQ(seen.can_id, 0x123U | CAN_EFF_FLAG);
  put(seen);
  const auto back = link_->read_frame();
  ASSERT_TRUE(back && *back);
  EXPECT_EQ(std::get<CanFrame>(**back), frame);
}

TEST_F(CanInMemory, ErrorFramesAreReportedInWords) {
  can_frame error{};
  error.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  error.can_dlc = CAN_ERR_DLC;
  put(error);
  error.can_id = CAN_ERR_FLAG | CAN_ERR_CRTL;
  error.data[1] = CAN_ERR_CRTL_TX_PASSIVE;
  put(error);
  const auto first = link_->read_frame();
  ASSERT_TRUE(first && *first);
  EXPECT_EQ(std::get<CanCondition>(**first).text, "bus-off");
  EXPECT_TRUE(std::get<CanCondition>(**first).severe);
  const auto second = link_->read_frame();
  ASSERT_TRUE(second && *second);
  EXPECT_EQ(std::get<CanCondition>(**second).text, "error-passive");
}

}  // namespace
}  // namespace tmcl
