// The files of what a daemon has to know when it runs again belong to one daemon at a time.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>

#include "config/load.hpp"
#include "daemon.hpp"
#include "gateway/store/lock_file.hpp"
#include "log/log.hpp"

namespace tmcld::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class StateLock : public testing::Test {
 protected:
  StateLock() {
    silence_log();
    auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
    folder = ::mkdtemp(name.data());
    for (const char* one : {"/a", "/b", "/state"}) std::filesystem::create_directory(folder + one);
  }
  ~StateLock() override { std::filesystem::remove_all(folder); }

  using Made = tl::expected<std::unique_ptr<Daemon>, std::string>;
  Made daemon(const std::string& socket, const std::string& state) {
    const auto config = parse_config("[daemon]\nsocket = \"" + folder + socket + "\"\nstate = \"" +
                                     folder + state + "\"\n");
    return Daemon::create(context, config.value());
  }

  std::string folder;
  boost::asio::io_context context{1};
};

TEST_F(StateLock, ASecondDaemonOfTheSameNameDoesNotStart) {
  const auto first = daemon("/a/tmcld.sock", "/state");
  ASSERT_TRUE(first) << first.error();
  const auto second = daemon("/b/tmcld.sock", "/state");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(),
              AllOf(HasSubstr("process " + std::to_string(::getpid())),
                    HasSubstr(folder + "/state/tmcld.sock."), HasSubstr("choose another 'state'")));
  EXPECT_FALSE(std::filesystem::exists(folder + "/b/tmcld.sock")) << "its socket is gone again";
}

TEST_F(StateLock, ASecondDaemonByAnotherPathOfTheFolderDoesNotStart) {
  std::filesystem::create_directory_symlink(folder + "/state", folder + "/other");
  const auto first = daemon("/a/tmcld.sock", "/state");
  ASSERT_TRUE(first) << first.error();
  EXPECT_FALSE(daemon("/b/tmcld.sock", "/other"));
  EXPECT_FALSE(daemon("/b/tmcld.sock", "/a/../state"));
}

TEST_F(StateLock, DaemonsOfOtherNamesShareAFolder) {
  const auto first = daemon("/a/one.sock", "/state");
  const auto second = daemon("/a/two.sock", "/state");
  EXPECT_TRUE(first && second);
}

TEST_F(StateLock, EndsWithTheDaemon) {
  EXPECT_TRUE(daemon("/a/tmcld.sock", "/state"));
  EXPECT_TRUE(daemon("/b/tmcld.sock", "/state"));
}

TEST_F(StateLock, EndsWithItsProcessHoweverThatIs) {
  const auto path = folder + "/lock";
  const auto child = ::fork();
  if (child == 0) {
    const auto lock = LockFile::take(path);
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  ASSERT_TRUE(std::filesystem::exists(path));
  const auto lock = LockFile::take(path);
  EXPECT_TRUE(lock && *lock);
}

TEST_F(StateLock, OfAFolderThatTakesNoFileKeepsNoDaemonFromStarting) {
  EXPECT_TRUE(daemon("/a/tmcld.sock", "/nowhere"));
}

}  // namespace
}  // namespace tmcld::test
