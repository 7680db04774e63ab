// What keeps a client, or a noisy bus, from costing more than it may.
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>

#include "api/notifications.hpp"
#include "fronts/line_buffer.hpp"
#include "fronts/outbox.hpp"
#include "log/limiter.hpp"
#include "support/seed.hpp"

namespace tmcld {
namespace {

using testing::ElementsAre;

constexpr std::size_t limit = 8;

class Lines {
 public:
  void push(std::string_view bytes) {
    buffer_.push(bytes, [&](std::optional<std::string_view> line) {
      got.emplace_back(line ? std::string(*line) : "TOO LONG");
    });
  }
  std::vector<std::string> got;

 private:
  LineBuffer buffer_{limit};
};

TEST(DaemonLineBuffer, CutsAtLineEnds) {
  Lines lines;
  lines.push("one\ntw");
  lines.push("o\n\nrest");
  EXPECT_THAT(lines.got, ElementsAre("one", "two", ""));
}

TEST(DaemonLineBuffer, AdmitsALineOfTheFullLengthAndNoLonger) {
  Lines lines;
  lines.push("12345678\n123456789\nnext\n");
  EXPECT_THAT(lines.got, ElementsAre("12345678", "TOO LONG", "next"));
}

TEST(DaemonLineBuffer, TellsOfALongLineOnceAndForgetsTheRest) {
  Lines lines;
  for (int i = 0; i < 100; ++i) lines.push("0123456789");
  lines.push("\nnext\n");
  EXPECT_THAT(lines.got, ElementsAre("TOO LONG", "next"));
}

TEST(DaemonLineBuffer, DoesNotCareHowBytesComeInPieces) {
  const std::string text = "a\nlonger than eight\n\n12345678\nbb\n";
  Lines whole;
  whole.push(text);
  std::mt19937_64 random(tmcl::test::seed());
  for (int round = 0; round < 200; ++round) {
    Lines pieces;
    for (std::size_t at = 0; at < text.size();) {
      const auto size = 1 + random() % 5;
      pieces.push(std::string_view(text).substr(at, size));
      at += size;
    }
    ASSERT_EQ(pieces.got, whole.got);
  }
}

TEST(DaemonOutbox, AdmitsAnswersUpToItsBound) {
  Outbox outbox;
  const std::string kilobyte(1023, 'a');
  for (int i = 0; i < 256; ++i) ASSERT_TRUE(outbox.push_answer(kilobyte));
  EXPECT_FALSE(outbox.push_answer("x"));
  outbox.take_answer();
  EXPECT_TRUE(outbox.push_answer("x"));
}

TEST(DaemonOutbox, AdmitsAsManyAsCanBeInProgressHoweverLongTheyAre) {
  Outbox outbox;
  for (std::size_t i = 0; i < max_unsent_answers; ++i)
    ASSERT_TRUE(outbox.push_answer(std::string(max_unsent_answer_bytes, 'a')));
  EXPECT_FALSE(outbox.push_answer("x"));
}

TEST(DaemonNotifications, DropTheOldestAndSayHowMany) {
  boost::asio::io_context context;
  Notifications notifications(Gateway::create(context.get_executor(), {}), [] {});
  for (int i = 0; i < static_cast<int>(max_unsent_notifications) + 3; ++i)
    notifications.push("n", {{"number", i}});
  const auto first = notifications.take();
  EXPECT_EQ(first->params.at("number"), 3);
  EXPECT_EQ(first->params.at("dropped"), 3);
  EXPECT_EQ(notifications.take()->params.at("dropped"), 0);
}

TEST(DaemonLogLimiter, LetsSoManyLinesPassAndSaysHowManyDidNot) {
  LogLimiter limiter;
  tmcl::VirtualClock clock;
  clock.advance(std::chrono::hours(1));
  unsigned admitted = 0;
  for (int i = 0; i < 1000; ++i) admitted += limiter.admit("a", clock.now()) ? 1U : 0U;
  EXPECT_EQ(admitted, LogLimiter::lines_per_period);
  clock.advance(LogLimiter::period);
  EXPECT_EQ(limiter.admit("b", clock.now()), "b (990 lines held back before)");
  EXPECT_EQ(limiter.admit("c", clock.now()), "c");
}

}  // namespace
}  // namespace tmcld
