// Signals that come while tmclctl writes.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ostream>
#include <string>

#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include "output/steady_stream.hpp"

namespace tmclctl::test {
namespace {

std::array<int, 2> pipe_ends{-1, -1};
std::string* received = nullptr;

void read_what_is_there() {
  std::array<char, 8192> block{};
  for (ssize_t count = 0; (count = ::read(pipe_ends[0], block.data(), block.size())) > 0;)
    received->append(block.data(), static_cast<std::size_t>(count));
}

/// Allocates nothing: `received` has room for all.
void make_room(int) {
  const int before = errno;
  read_what_is_there();
  errno = before;
}

void do_nothing(int) {}

/// A pipe whose reader reads only in the handler of a timer's signal.
class CtlSteadyStream : public testing::Test {
 protected:
  CtlSteadyStream() {
    received = &text_;
    text_.reserve(1 << 20);
    EXPECT_EQ(::pipe2(pipe_ends.data(), O_CLOEXEC), 0);
    ::fcntl(pipe_ends[0], F_SETFL, O_NONBLOCK);
    ::fcntl(pipe_ends[1], F_SETPIPE_SZ, 4096);
  }
  ~CtlSteadyStream() override {
    const itimerval off{};
    ::setitimer(ITIMER_REAL, &off, nullptr);
    ::sigaction(SIGALRM, &before_, nullptr);
    for (const int end : pipe_ends) ::close(end);
  }
  void interrupt_with(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    ::sigaction(SIGALRM, &action, &before_);
    const itimerval each_millisecond{{0, 1000}, {0, 1000}};
    ::setitimer(ITIMER_REAL, &each_millisecond, nullptr);
  }

  std::string text_;
  struct sigaction before_ {};
};

TEST_F(CtlSteadyStream, TakesTextAfterAnInterruptedWrite) {
  std::ostream stream(nullptr);
  std::string wanted;
  {
    const SteadyStream steady(stream, pipe_ends[1]);
    stream.clear();
    interrupt_with(make_room);
    for (int i = 0; i < 4000; ++i) {
      const auto line = "line " + std::to_string(i) + '\n';
      wanted += line;
      stream << line << std::flush;
    }
    EXPECT_TRUE(stream.good());
  }
  read_what_is_there();
  EXPECT_TRUE(text_ == wanted) << text_.size() << " bytes of " << wanted.size();
}

TEST_F(CtlSteadyStream, GivesUpWhereNothingIsRead) {
  std::ostream stream(nullptr);
  const SteadyStream steady(stream, pipe_ends[1]);
  stream.clear();
  interrupt_with(do_nothing);
  stream << std::string(10'000, 'x') << std::flush;
  EXPECT_TRUE(stream.bad());
}

}  // namespace
}  // namespace tmclctl::test
