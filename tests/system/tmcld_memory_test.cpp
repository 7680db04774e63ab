// A daemon that gets no more memory: a client learns that its call failed, everybody else is
// served, and if the daemon cannot go on it stops what moves.
#include <sys/resource.h>

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "system/tmcld_fixture.hpp"
#include "tmcl/hex.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

#ifdef __SANITIZE_ADDRESS__
constexpr bool memory_can_be_limited = false;  // the sanitizer ends the program itself
#else
constexpr bool memory_can_be_limited = true;
#endif

constexpr rlim_t megabyte = 1U << 20U;

/// So much memory, from now on, for a process: beyond it the kernel kills it, as it does a service
/// with MemoryMax.
class MemoryGroup {
 public:
  MemoryGroup(pid_t process, rlim_t bytes)
      : folder_((is_first_version() ? "/sys/fs/cgroup/memory/tmcl-" : "/sys/fs/cgroup/tmcl-") +
                std::to_string(process)),
        process_(static_cast<rlim_t>(process)) {
    std::error_code error;
    std::filesystem::create_directory(folder_, error);
    holds_ = write(is_first_version() ? "memory.limit_in_bytes" : "memory.max", bytes) &&
             write("cgroup.procs", process_);
  }
  MemoryGroup(const MemoryGroup&) = delete;
  MemoryGroup& operator=(const MemoryGroup&) = delete;
  ~MemoryGroup() {
    write("../cgroup.procs", process_);  // only an empty group can be removed
    ::rmdir(folder_.c_str());
  }

  /// False where this user may make none.
  bool holds() const { return holds_; }

 private:
  static bool is_first_version() { return std::filesystem::exists("/sys/fs/cgroup/memory"); }
  bool write(const char* file, rlim_t value) const {
    std::ofstream out(folder_ + "/" + file);
    out << value << std::flush;
    return out.good();
  }

  std::string folder_;
  rlim_t process_;
  bool holds_ = false;
};

class TmcldMemory : public TmcldTest {
 protected:
  void SetUp() override {
    if (!memory_can_be_limited) GTEST_SKIP();
    start_simulator_on_pty();
    write_config(pty_link(), "unit = \"mm\"\nscrew_pitch = 5\n");
    start_daemon();
  }

  /// As much as the daemon has, and so much more.
  void allow(rlim_t more) const {
    std::ifstream status("/proc/" + std::to_string(daemon->process()) + "/statm");
    rlim_t pages = 0;
    status >> pages;
    rlimit limit{};
    ASSERT_EQ(prlimit(daemon->process(), RLIMIT_AS, nullptr, &limit), 0);
    limit.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + more;
    ASSERT_EQ(prlimit(daemon->process(), RLIMIT_AS, &limit, nullptr), 0);
  }

  /// As many legs as a path may have.
  static std::string longest_path() {
    std::string text = "G1 F600\n";
    for (int i = 0; i < 499'999; ++i) text += "G1 X1\nG1 X0\n";
    return text;
  }
  /// What became of the path, by name; empty if the daemon has gone.
  static std::string pass(RpcClient& client, const std::string& path) {
    constexpr std::size_t part = 30'000;
    for (std::size_t offset = 0; offset < path.size(); offset += part) {
      const auto piece = std::string_view(path).substr(offset, part);
      const std::vector<std::uint8_t> bytes(piece.begin(), piece.end());
      const auto answer = client.call("path.stage", {{"offset", offset}, {"data", to_hex(bytes)}});
      if (answer.contains("error")) return name_in(answer);
    }
    return name_in(client.call("path.run", {{"axes", json::array{"z"}}, {"bytes", path.size()}}));
  }
  static std::string name_in(const json::object& answer) {
    const auto* error = answer.if_contains("error");
    if (error == nullptr) return "done";
    return std::string(error->at("data").at("name").as_string());
  }
  /// A daemon that was killed stops what turned, and lets no client move it until it stands.
  bool begins_to_turn(RpcClient& client) {
    const json::object turn{{"axis", "x"}, {"velocity_internal", 100}};
    bool turns = client.call("axis.rotate", turn).contains("result");
    for (int looks = 0; looks < 100 && !turns; ++looks) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      turns = client.call("axis.rotate", turn).contains("result");
    }
    return turns;
  }
  bool comes_to_stand(RpcClient& client) {
    for (int looks = 0; looks < 100 && turns(client); ++looks)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return !turns(client);
  }
  bool turns(RpcClient& client) {
    return client.result("axis.get_state", {{"axis", "x"}}).at("moving").as_bool();
  }
};

TEST_F(TmcldMemory, ThatAPathDoesNotGetCostsThePathOnly) {
  RpcClient other(socket());
  other.result("axis.rotate", {{"axis", "x"}, {"velocity_internal", 100}});
  const auto path = longest_path();
  for (const rlim_t more : {32U, 128U, 384U}) {
    SCOPED_TRACE(more);
    RpcClient client(socket());
    allow(more * megabyte);
    EXPECT_EQ(pass(client, path), "internal_error");
    EXPECT_TRUE(turns(other)) << "of this axis it was not the fault";
  }
  EXPECT_TRUE(daemon->wait_for("internal error in path.")) << daemon->output();
  other.result("axis.stop", {{"axis", "x"}});
  daemon->signal(SIGTERM);
  EXPECT_EQ(daemon->wait(), 0) << daemon->output();
}

TEST_F(TmcldMemory, ThatTheKernelRefusesEndsNothingThatTurns) {
  const auto path = longest_path();
  int killed = 0;
  for (const rlim_t megabytes : {2U, 16U, 64U, 256U}) {
    SCOPED_TRACE(megabytes);
    auto owner = std::make_unique<RpcClient>(socket());
    ASSERT_TRUE(begins_to_turn(*owner));
    const MemoryGroup group(daemon->process(), megabytes * megabyte);
    std::vector<std::unique_ptr<RpcClient>> clients;
    try {
      for (int i = 0; i < 20; ++i) {
        clients.push_back(std::make_unique<RpcClient>(socket()));
        clients.back()->result("subscribe", {{"axes", json::array{"x", "y"}}, {"interval_ms", 10}});
      }
      // As the kernel would, where no group can be made.
      if (!group.holds()) daemon->signal(SIGKILL);
      pass(*clients.front(), path);
      EXPECT_TRUE(turns(*owner));
      owner->result("axis.stop", {{"axis", "x"}});
    } catch (const std::exception&) {
      ++killed;
      owner.reset();
      EXPECT_EQ(daemon->wait(), 128 + SIGKILL) << daemon->output();
      start_daemon();
    }
    RpcClient look(socket());
    EXPECT_TRUE(comes_to_stand(look));
    look.call("system.stop_all", {});
  }
  EXPECT_GT(killed, 0) << "these limits are no limits";
}

// Whatever is thrown where: it goes on, or it stops what moves and ends with a word.
TEST_F(TmcldMemory, ThatNobodyGetsEndsNothingUnseen) {
  RpcClient(socket()).result("axis.rotate",
                             {{"axis", "x"}, {"velocity_internal", 100}, {"unattended", true}});
  allow(0);
  // Some 30 bytes of memory for each two of the line.
  std::string line = R"({"jsonrpc":"2.0","id":1,"method":"axis.list","params":{"axes":[1)";
  while (line.size() < 60'000) line += ",1";
  line += "]}}\n";
  std::vector<std::unique_ptr<RpcClient>> clients;
  bool lives = true;
  for (int i = 0; i < 40 && lives; ++i) {
    try {
      clients.push_back(std::make_unique<RpcClient>(socket(), false));
      for (int k = 0; k < 200; ++k) clients.back()->send_if_room(line);
    } catch (const std::exception&) {
      lives = false;
    }
  }
  clients.clear();
  try {
    allow(1024 * megabyte);
    RpcClient client(socket());
    EXPECT_TRUE(turns(client));
    daemon->signal(SIGTERM);
    EXPECT_EQ(daemon->wait(), 0) << daemon->output();
  } catch (const std::exception&) {
    EXPECT_EQ(daemon->wait(), 1) << daemon->output();
    EXPECT_THAT(daemon->output(), HasSubstr("all axes are stopped"));
    start_daemon();
    RpcClient client(socket());
    EXPECT_FALSE(turns(client));
  }
}

}  // namespace
}  // namespace tmcl::test
