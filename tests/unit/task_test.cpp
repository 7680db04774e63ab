#include "api/task.hpp"

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace tmcld {
namespace {

using boost::asio::awaitable;

Error refusal(const std::string& message) { return param_error("bad_argument", "p", message); }

Result<int> there(int value) { return value; }
Result<int> missing() { return tl::unexpected(refusal("missing")); }

awaitable<void> elsewhere() {
  co_await boost::asio::post(co_await boost::asio::this_coro::executor, boost::asio::use_awaitable);
}

awaitable<tmcl::Result<int>> answered(int value) {
  co_await elsewhere();
  co_return value;
}
awaitable<tmcl::Result<int>> unanswered() {
  co_await elsewhere();
  co_return tl::unexpected(tmcl::bad_argument("unanswered"));
}
awaitable<int> thrown() {
  co_await elsewhere();
  throw std::runtime_error("thrown");
}

class TaskTest : public testing::Test {
 protected:
  /// What came of it: the value, the error's message, or what was thrown.
  static std::string end_of(Task<std::string> task) {
    boost::asio::io_context context;
    std::string end = "none";
    boost::asio::co_spawn(context, tell(std::move(task), end), boost::asio::detached);
    context.run();
    return end;
  }

  std::vector<std::string> said;

 private:
  static awaitable<void> tell(Task<std::string> task, std::string& end) {
    try {
      co_await task.promise().run();
      const auto result = task.take();
      end = result ? *result : "error: " + result.error().message;
    } catch (const std::exception& error) {
      end = std::string("exception: ") + error.what();
    }
  }
};

TEST_F(TaskTest, GoesOnWithWhatItMustHave) {
  const auto task = []() -> Task<std::string> {
    const auto first = co_await must(there(1));
    const auto second = co_await must(answered(2));
    co_await must_not(std::optional<Error>());
    co_await elsewhere();
    co_return std::to_string(first + second);
  };
  EXPECT_EQ(end_of(task()), "3");
}

TEST_F(TaskTest, EndsWhereAStepIsRefused) {
  const auto at = [this](int step) -> Task<std::string> {
    if (step == 0) co_await must(missing());
    if (step == 1) co_await must(unanswered());
    if (step == 2) co_await must_not(std::optional(refusal("objection")));
    if (step == 3) co_await refuse(refusal("no"));
    if (step == 4) co_return tl::unexpected(refusal("returned"));
    said.emplace_back("went on");
    co_return "done";
  };
  EXPECT_EQ(end_of(at(0)), "error: missing");
  EXPECT_EQ(end_of(at(1)), "error: unanswered");
  EXPECT_EQ(end_of(at(2)), "error: objection");
  EXPECT_EQ(end_of(at(3)), "error: no");
  EXPECT_EQ(end_of(at(4)), "error: returned");
  EXPECT_TRUE(said.empty());
}

TEST_F(TaskTest, EndsWithATaskThatItMustHave) {
  const auto inner = [](bool is_refused) -> Task<int> {
    co_await elsewhere();
    if (is_refused) co_await must(missing());
    co_return 7;
  };
  const auto middle = [&](bool is_refused) -> Task<void> { co_await must(inner(is_refused)); };
  const auto outer = [&](bool is_refused) -> Task<std::string> {
    co_await must(middle(is_refused));
    const auto again = co_await must(inner(is_refused));
    co_return std::to_string(again);
  };
  EXPECT_EQ(end_of(outer(false)), "7");
  EXPECT_EQ(end_of(outer(true)), "error: missing");
}

TEST_F(TaskTest, SeesTheErrorOfATaskThatItMerelyAwaits) {
  const auto inner = []() -> Task<int> {
    co_await must(unanswered());
    co_return 7;
  };
  const auto outer = [&]() -> Task<std::string> {
    const auto result = co_await inner();
    co_return result ? "done" : "saw " + result.error().message;
  };
  EXPECT_EQ(end_of(outer()), "saw unanswered");
}

TEST_F(TaskTest, IsThrownWhatAStepThrows) {
  const auto lets_through = []() -> Task<std::string> {
    co_await thrown();
    co_return "done";
  };
  const auto catches = [&]() -> Task<std::string> {
    try {
      co_await must(lets_through());
    } catch (const std::runtime_error& error) {
      co_return std::string("caught ") + error.what();
    }
    co_return "done";
  };
  EXPECT_EQ(end_of(lets_through()), "exception: thrown");
  EXPECT_EQ(end_of(catches()), "caught thrown");
}

TEST_F(TaskTest, DestroysItsLocalsWhereverItEnds) {
  struct Told {
    std::vector<std::string>& said;
    explicit Told(std::vector<std::string>& into) : said(into) {}
    Told(const Told&) = delete;
    Told& operator=(const Told&) = delete;
    ~Told() { said.emplace_back("destroyed"); }
  };
  const auto task = [this](bool is_refused) -> Task<std::string> {
    const Told told(said);
    if (is_refused) co_await must(unanswered());
    co_return "done";
  };
  EXPECT_EQ(end_of(task(true)), "error: unanswered");
  EXPECT_EQ(said.size(), 1U);
  EXPECT_EQ(end_of(task(false)), "done");
  EXPECT_EQ(said.size(), 2U);
  { const auto never_run = task(true); }
  EXPECT_EQ(said.size(), 2U);
}

}  // namespace
}  // namespace tmcld
