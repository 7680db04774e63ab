// client.list and audit.tail: who is connected, and what was moved and set by whom.
#include <gmock/gmock.h>

#include <unistd.h>

#include "log/audit_memory.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class DaemonClientList : public testing::Test {
 protected:
  json::array clients() { return watcher_->result("client.list").at("clients").as_array(); }
  json::object tail(json::object params = {}) {
    return watcher_->result("audit.tail", std::move(params));
  }
  static std::string word(const json::value& from, std::string_view key) {
    return std::string(from.at(key).as_string());
  }

  MovesBench bench_;
  std::unique_ptr<RpcClient> watcher_ = std::make_unique<RpcClient>(bench_.daemon.socket());
};

TEST_F(DaemonClientList, AreListedWithTheirDoorRoleAndLeases) {
  RpcClient holder(bench_.daemon.socket());
  holder.result("lease.acquire", {{"axes", json::array{"x", "y"}}, {"ttl_ms", 60'000}});
  auto all = clients();
  // The bench has a client of its own, which came first.
  ASSERT_EQ(all.size(), 3U);
  all.erase(all.begin());
  for (const auto& one : all) {
    EXPECT_EQ(word(one, "door"), "socket");
    EXPECT_EQ(word(one, "role"), "configure");
    EXPECT_EQ(one.at("uid").to_number<std::uint32_t>(), ::getuid());
    EXPECT_EQ(one.at("pid").to_number<std::int32_t>(), ::getpid());
    EXPECT_TRUE(one.at("address").is_null());
    EXPECT_TRUE(one.at("token").is_null());
  }
  EXPECT_EQ(all[0].at("requests"), 1) << "the watcher's call of client.list";
  EXPECT_EQ(all[1].at("requests"), 0);
  EXPECT_THAT(all[0].at("axes").as_array(), IsEmpty());
  EXPECT_EQ(all[1].at("axes"), (json::array{"x", "y"}));
}

TEST_F(DaemonClientList, AreNotListedAnyMoreWhenTheyHaveGone) {
  const auto before = clients().size();
  auto other = std::make_unique<RpcClient>(bench_.daemon.socket());
  other->result("axis.list");
  EXPECT_EQ(clients().size(), before + 1);
  other.reset();
  bench_.daemon.run_for(std::chrono::seconds(1));
  EXPECT_EQ(clients().size(), before);
}

TEST_F(DaemonClientList, KeepTheirNamesHoweverManyComeAndGo) {
  const auto before = clients();
  for (int i = 0; i < 1100; ++i) RpcClient(bench_.daemon.socket()).result("axis.list");
  bench_.daemon.run_for(std::chrono::seconds(1));
  const auto after = clients();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(word(after[i], "client"), word(before[i], "client"));
}

TEST_F(DaemonClientList, AreToldWhatWasDoneAndByWhom) {
  watcher_->result("axis.stop", {{"axis", "x"}});
  const auto lines = tail().at("lines").as_array();
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(word(lines.back(), "text"),
              HasSubstr(R"(method=axis.stop params={"axis":"x"} outcome=done)"));
  EXPECT_EQ(lines.back().at("pid").to_number<std::int32_t>(), ::getpid());
  const auto last = tail().at("last").to_number<std::uint64_t>();
  EXPECT_THAT(tail({{"after", last}}).at("lines").as_array(), IsEmpty())
      << "a call that reads is not audited";
  watcher_->result("axis.stop", {{"axis", "y"}});
  watcher_->result("axis.stop", {{"axis", "x"}});
  const auto more = tail({{"after", last}, {"lines", 1}}).at("lines").as_array();
  ASSERT_EQ(more.size(), 1U);
  EXPECT_THAT(word(more[0], "text"), HasSubstr(R"({"axis":"y"})")) << "the oldest of the new ones";
  EXPECT_EQ(more[0].at("number").to_number<std::uint64_t>(), last + 1);
  EXPECT_THAT(tail({{"after", last + 1000}}).at("lines").as_array(), IsEmpty())
      << "numbers of an earlier tmcld";
}

AuditEntry entry_of(std::string text) { return {0, 1, std::move(text)}; }

TEST(AuditMemoryTest, KeepsTheLastLinesAndCountsThoseThatAreGone) {
  AuditMemory memory;
  EXPECT_EQ(memory.first(), 1U);
  EXPECT_EQ(memory.last(), 0U);
  for (int i = 1; i <= 1500; ++i) memory.add({}, entry_of(std::to_string(i)));
  EXPECT_EQ(memory.last(), 1500U);
  EXPECT_EQ(memory.first(), 501U);
  const auto after = memory.after(0, 2);
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(after[0].number, 501U);
  EXPECT_EQ(after[0].entry.text, "501");
  EXPECT_EQ(memory.after(1499, 10).size(), 1U);
  EXPECT_THAT(memory.after(1500, 10), IsEmpty());
}

TEST(AuditMemoryTest, KeepsNoMoreThanItsBytes) {
  AuditMemory memory;
  const std::string long_text(AuditMemory::most_bytes / 4, 'x');
  for (int i = 0; i < 10; ++i) memory.add({}, entry_of(long_text));
  EXPECT_EQ(memory.after(0, 100).size(), 4U);
  memory.add({}, entry_of(std::string(2 * AuditMemory::most_bytes, 'x')));
  EXPECT_EQ(memory.after(0, 100).size(), 1U) << "the newest is always there";
}

}  // namespace
}  // namespace tmcld::test
