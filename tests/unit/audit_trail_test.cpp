// Lines of an audit file: all of them, or how many are missing; never through a symbolic link.
#include "log/audit_trail.hpp"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "log/log.hpp"
#include "support/temp_path.hpp"

namespace tmcld {
namespace {

using testing::HasSubstr;

class AuditFile : public testing::Test {
 protected:
  ~AuditFile() override {
    std::filesystem::remove(path);
    std::filesystem::remove(old);
  }
  static std::vector<std::string> lines_of(const std::string& file) {
    std::ifstream in(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  /// What does not fit is taken out again, so that two readings may differ in either way.
  void await_last(const std::string& ending) const {
    for (auto lines = lines_of(path); lines.empty() || !lines.back().ends_with(ending);
         lines = lines_of(path))
      std::this_thread::yield();
  }
  /// At its end a trail waits for a moment only; on a busy computer its thread writes the last
  /// lines after that.
  void await_lines(std::size_t count) const {
    while (lines_of(path).size() < count) std::this_thread::yield();
  }

  std::string path = tmcl::test::temp_path("audit");
  std::string old = path + ".1";
};

TEST_F(AuditFile, HasALineWithTimeUserAndProcess) {
  AuditTrail::open(path).value()->add({0, 4711, "method=axis.stop"});
  await_lines(1);
  EXPECT_THAT(lines_of(path),
              testing::ElementsAre(testing::ContainsRegex(
                  "^20[0-9-]*T[0-9:]*\\.[0-9]*Z uid=0 user=root pid=4711 method=axis\\.stop$")));
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07137U, 0U) << "at most 0640";
}

TEST_F(AuditFile, NamesNoUserOfThisComputerForAClientOfTheNetwork) {
  AuditTrail::open(path).value()->add({65534, 0, "client=\"token 'lab'\" method=axis.stop"});
  await_lines(1);
  EXPECT_THAT(lines_of(path), testing::ElementsAre(testing::ContainsRegex(
                                  "^20[^ ]*Z client=\"token 'lab'\" method=axis\\.stop$")));
}

TEST_F(AuditFile, IsAddedTo) {
  AuditTrail::open(path).value()->add({0, 1, "one"});
  AuditTrail::open(path).value()->add({0, 1, "two"});
  await_lines(2);
  EXPECT_EQ(lines_of(path).size(), 2U);
}

TEST_F(AuditFile, IsNoSymbolicLinkAndNoDevice) {
  std::ofstream(old) << "";
  std::filesystem::create_symlink(old, path);
  const auto link = AuditTrail::open(path);
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error(), HasSubstr("symbolic link"));
  EXPECT_FALSE(AuditTrail::open("/dev/null"));
}

/// Files can grow to so many bytes meanwhile, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(AuditFile, HasWholeLinesAndTheNumberOfThoseThatAFullDiskCost) {
  // So many that the thread meets the full disk; how many it meets is its own affair.
  constexpr std::size_t count = 500;
  for (const std::size_t room : {1U, 40U, 100U, 200U, 333U}) {
    std::filesystem::remove(path);
    const auto trail = AuditTrail::open(path).value();
    {
      const FullDisk disk(room);
      for (std::size_t i = 0; i < count; ++i) {
        trail->add({0, 1, "first"});
        std::this_thread::yield();
      }
    }
    trail->add({0, 1, "last"});
    await_last("last");
    std::size_t told = 0;
    for (const auto& line : lines_of(path)) {
      ASSERT_THAT(line, testing::ContainsRegex(
                            "^20[0-9-]*T[0-9:.]*Z (uid=0 user=root pid=1 |[0-9]* lines were)"));
      const auto words = line.substr(line.find(' ') + 1);
      EXPECT_EQ(line.find("pid=1 "), line.rfind("pid=1 ")) << "one line in another";
      told += words.starts_with("uid=") ? 1 : std::stoul(words);
    }
    EXPECT_EQ(told, count + 1) << room;
  }
}

TEST_F(AuditFile, IsJudgedWithoutBeingMade) {
  EXPECT_EQ(AuditTrail::problem_of(""), "");
  EXPECT_EQ(AuditTrail::problem_of(path), "");
  EXPECT_FALSE(std::filesystem::exists(path));
  std::ofstream(path) << "one\n";
  EXPECT_EQ(AuditTrail::problem_of(path), "");
  EXPECT_THAT(AuditTrail::problem_of("/nonexistent/audit"), HasSubstr("cannot be opened"));
  EXPECT_THAT(AuditTrail::problem_of("/dev/full"), HasSubstr("is no file"));
  std::filesystem::create_symlink(path, old);
  EXPECT_THAT(AuditTrail::problem_of(old), HasSubstr("symbolic link"));
}

TEST_F(AuditFile, IsOpenedAgainByItsName) {
  {
    const auto trail = AuditTrail::open(path).value();
    std::filesystem::rename(path, old);
    trail->reopen();
    trail->add({0, 1, "behind it"});
  }
  await_lines(1);
  EXPECT_EQ(lines_of(path).size(), 1U);
  EXPECT_TRUE(lines_of(old).empty());
}

/// Of all that were added: those that stand there, and those that one says to be missing.
std::size_t accounted_for(const std::vector<std::string>& lines) {
  std::size_t count = 0;
  for (const auto& line : lines) {
    const auto at = line.find(" lines were left out");
    count += at == std::string::npos ? 1 : std::stoul(line.substr(line.rfind(' ', at - 1)));
  }
  return count;
}

TEST_F(AuditFile, SaysHowManyLinesAreMissing) {
  constexpr std::size_t all = 4 * AuditTrail::most_waiting_lines;
  {
    const auto trail = AuditTrail::open(path).value();
    for (std::size_t i = 0; i < all; ++i) trail->add({0, 1, "line"});
  }
  while (accounted_for(lines_of(path)) < all) std::this_thread::yield();
  EXPECT_EQ(accounted_for(lines_of(path)), all);
}

}  // namespace
}  // namespace tmcld
