// The journal's file: when it says what is held, and how often it is written.
#include "gateway/store/journal.hpp"

#include <filesystem>

#include <sys/stat.h>

#include <boost/asio/io_context.hpp>

#include <gmock/gmock.h>

#include "async/spawn.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "support/temp_path.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;

class JournalFile : public testing::Test {
 protected:
  JournalFile() {
    std::filesystem::remove(path);
    time.set_time_for_work([this] { return time_for_work(); });
  }
  ~JournalFile() override {
    journal->close();
    std::filesystem::remove(path);
  }

  /// Of a motor.
  static Holdings holding(std::uint8_t motor) {
    return {{"bench", {tmcl::ModuleAddress{1}, motor}, "turning"}};
  }
  Holdings in_file() const { return Journal::read(path).value(); }
  /// Another one each time it is written: see replace_state_file().
  ino_t file() const {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
  }
  void hold(Holdings what) {
    held = std::move(what);
    history.push_back(held);
  }
  /// When it returns, the file says what was held then, or later.
  void write() {
    spawn(context.get_executor(), [](JournalFile& self) -> boost::asio::awaitable<void> {
      const auto begun = self.history.size() - 1;
      co_await Journal::write(self.journal);
      const auto now = self.in_file();
      const auto since = std::span(self.history).subspan(begun);
      EXPECT_NE(std::ranges::find(since, now), since.end());
      ++self.returned;
    }(*this));
  }

  boost::asio::io_context context;
  tmcl::VirtualTime time{context};
  std::function<tmcl::Duration()> time_for_work = [] { return 10ms; };
  const std::string path = tmcl::test::temp_path("journal");
  Holdings held;
  std::vector<Holdings> history{{}};
  int returned = 0;
  std::shared_ptr<Journal> journal = std::make_shared<Journal>(
      context.get_executor(), path, [this] { return held; }, no_log, [](const std::string&) {});
};

TEST_F(JournalFile, SaysWhatIsHeldToAllThatWaitForTheSame) {
  hold(holding(1));
  for (int i = 0; i < 3; ++i) write();
  time.run_for(9ms);
  EXPECT_EQ(returned, 0) << "nothing is in the file yet";
  time.run_for(20ms);
  EXPECT_EQ(returned, 3);
  EXPECT_EQ(in_file(), held);
}

TEST_F(JournalFile, IsNotWrittenAgainWithTheSame) {
  hold(holding(1));
  write();
  time.run_for(20ms);
  const auto before = file();
  hold(holding(1));
  write();
  time.run_for(5s);
  EXPECT_EQ(file(), before);
  hold(holding(2));
  write();
  time.run_for(20ms);
  EXPECT_NE(file(), before);
}

TEST_F(JournalFile, SaysAtTheEndOfEachWriteWhatWasHeldAtItsBeginOrLater) {
  tmcl::test::Random<> random(tmcl::test::seed());
  time_for_work = [&] { return std::chrono::milliseconds(random.between(0, 40)); };
  for (int i = 0; i < 300; ++i) {
    if (random.one_in(2))
      hold(random.one_in(4) ? Holdings{}
                            : holding(static_cast<std::uint8_t>(random.between(0, 3))));
    if (random.one_in(2)) write();
    time.run_for(std::chrono::milliseconds(random.between(0, 30)));
  }
  hold({});
  write();
  time.run_for(5s);
  EXPECT_FALSE(std::filesystem::exists(path)) << "nothing is held";
}

}  // namespace
}  // namespace tmcld::test
