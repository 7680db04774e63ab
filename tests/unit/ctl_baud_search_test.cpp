// Which baud rate and addresses a port leads to, in virtual time.
#include "connection/baud_search.hpp"

#include <gmock/gmock.h>

#include <deque>
#include <map>
#include <set>

#include <fmt/format.h>

#include "tmcl/datagram.hpp"
#include "tmcl/harmless_question.hpp"

namespace tmclctl::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using namespace std::chrono_literals;

/// A line with modules that answer at one rate, or with something else. Time passes only while it
/// is listened to.
class FakePort final : public SearchedPort {
 public:
  std::uint32_t rate = 0;  ///< Of the modules; 0: there are none.
  std::set<std::uint8_t> addresses{};
  bool echoes = false;
  std::map<std::uint32_t, std::string> says{};  ///< To any question, by the rate of the host.
  std::map<std::uint32_t, int> asked{};
  tmcl::Duration least_silence = 1h;

  Result<void> open(std::uint32_t baud) override {
    baud_ = baud;
    coming_.clear();
    return {};
  }
  Result<void> send(std::span<const std::uint8_t> bytes) override {
    ++asked[baud_];
    least_silence = std::min(least_silence, now_ - last_byte_);
    if (echoes) add(bytes);
    if (const auto text = says.find(baud_); text != says.end())
      for (const char c : text->second) coming_.push_back(static_cast<std::uint8_t>(c));
    const auto request = tmcl::decode_serial_request(bytes.first<9>());
    const auto address = static_cast<std::uint8_t>(number(request->address));
    if (baud_ == rate && addresses.contains(address)) {
      add(tmcl::encode_serial(tmcl::Reply{2, address, tmcl::Status::ok, request->command,
                                          tmcl::to_value({3110, 1, 14})}));
    }
    last_byte_ = now_ + std::chrono::nanoseconds(90s) / baud_;
    return {};
  }
  Result<std::size_t> receive(std::span<std::uint8_t> into, tmcl::Duration at_most) override {
    now_ += coming_.empty() ? at_most : std::min<tmcl::Duration>(at_most, 1ms);
    std::size_t size = 0;
    // Three at a time: answers come in pieces.
    for (; size < 3 && !coming_.empty(); ++size) {
      into[size] = coming_.front();
      coming_.pop_front();
    }
    return size;
  }
  tmcl::TimePoint now() const override { return now_; }
  tmcl::Duration passed() const { return now_ - tmcl::TimePoint{1h}; }

 private:
  void add(std::span<const std::uint8_t> bytes) {
    coming_.insert(coming_.end(), bytes.begin(), bytes.end());
  }

  std::uint32_t baud_ = 0;
  std::deque<std::uint8_t> coming_;
  tmcl::TimePoint now_{1h};
  tmcl::TimePoint last_byte_{};
};

class BaudSearch : public testing::Test {
 protected:
  tmcl::HeardKind search() {
    BaudSearchNews news;
    news.found = [this](const FoundAtRate& one) {
      found.push_back(fmt::format("{}@{} {}", one.address, one.baud, one.version.model));
    };
    const auto heard = search_bauds(port, options, news);
    return heard.value().kind;
  }

  FakePort port;
  BaudSearchOptions options{1, 5};
  std::vector<std::string> found;
};

TEST_F(BaudSearch, FindsAllModulesOfTheRate) {
  port.rate = 57'600;
  port.addresses = {1, 3, 5};
  EXPECT_EQ(search(), tmcl::HeardKind::answers);
  EXPECT_THAT(found, ElementsAre("1@57600 3110", "3@57600 3110", "5@57600 3110"));
  EXPECT_EQ(port.asked[9'600], 1);
  EXPECT_EQ(port.asked[57'600], 5);
  EXPECT_EQ(port.asked[38'400], 0);
}

TEST_F(BaudSearch, FindsThemAtEachRate) {
  for (const auto rate : tmcl::serial_rates) {
    port = FakePort();
    found.clear();
    port.rate = rate;
    port.addresses = {4};
    EXPECT_EQ(search(), tmcl::HeardKind::answers);
    EXPECT_THAT(found, ElementsAre(fmt::format("4@{} 3110", rate)));
  }
}

TEST_F(BaudSearch, AnEchoHidesNoModule) {
  port.echoes = true;
  port.rate = 19'200;
  port.addresses = {2};
  EXPECT_EQ(search(), tmcl::HeardKind::answers);
  EXPECT_THAT(found, ElementsAre("2@19200 3110"));
}

TEST_F(BaudSearch, TellsWhatCameWhereNoModuleAnswers) {
  EXPECT_EQ(search(), tmcl::HeardKind::nothing);
  port.says = {{9'600, "\x91\x17\xf8"}, {115'200, "login: "}};
  EXPECT_EQ(search(), tmcl::HeardKind::text);
  port.says = {};
  port.echoes = true;
  EXPECT_EQ(search(), tmcl::HeardKind::echo);
  EXPECT_THAT(found, IsEmpty());
}

TEST_F(BaudSearch, TakesNoLongerThanIsSaid) {
  options = {1, 255};
  EXPECT_EQ(search(), tmcl::HeardKind::nothing);
  EXPECT_LE(port.passed(), longest_search(options));
  EXPECT_GE(port.passed(), longest_search(options) * 9 / 10);
  EXPECT_LT(longest_search(options), 2min);
}

TEST_F(BaudSearch, BetweenTwoQuestionsTheLineIsSilent) {
  port.rate = 9'600;
  port.addresses = {1, 2, 3, 4, 5};
  search();
  EXPECT_GT(port.least_silence, 5ms);
}

TEST_F(BaudSearch, EndsWhenItIsToldTo) {
  BaudSearchNews news;
  int left = 7;
  news.cancelled = [&left] { return left-- <= 0; };
  ASSERT_TRUE(search_bauds(port, options, news).has_value());
  int asked = 0;
  for (const auto& [rate, count] : port.asked) asked += count;
  EXPECT_EQ(asked, 7);
}

}  // namespace
}  // namespace tmclctl::test
