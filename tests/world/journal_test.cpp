// The daemon is killed, and another one takes its place: what the first one led is put in order.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Killed : public Cable {
 protected:
  Killed() {
    std::filesystem::create_directory(folder_);
    end_gateway();
    start_gateway(journal_);
    events.clear();
    wire.on_request = [this](const tmcl::Request& request) { requests.push_back(request); };
  }
  ~Killed() override { std::filesystem::remove_all(folder_); }

  std::string text() const {
    std::ostringstream out;
    out << std::ifstream(journal_).rdbuf();
    return out.str();
  }
  void write(const std::string& text) const { std::ofstream(journal_) << text; }
  /// What it would still have written is not there.
  void kill() {
    const auto left = text();
    end_gateway();
    if (!left.empty()) write(left);
    events.clear();
  }
  void start_again() {
    requests.clear();
    start_gateway(journal_);
    time.run_for(5s);
  }
  std::string name_of_call(const char* method, json::object params) {
    params["axis"] = "x";
    return name_of_error(call(method, std::move(params)));
  }
  bool is_nothing_held() const { return !std::filesystem::exists(journal_); }

  const std::string folder_ =
      std::filesystem::temp_directory_path() / ("tmcl-journal-" + std::to_string(::getpid()));
  const std::string journal_ = folder_ + "/journal";
  std::vector<tmcl::Request> requests;
};

TEST_F(Killed, OnALineItStopsTheAxesAndSetsTheirSpeedsBack) {
  const auto before = std::pair(get(0, ap::max_velocity), get(1, ap::max_velocity));
  call("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{900, 300}}});
  time.run_for(1s);
  ASSERT_TRUE(moves());
  ASSERT_NE(before, std::pair(get(0, ap::max_velocity), get(1, ap::max_velocity)));
  kill();
  time.run_for(2s);
  ASSERT_TRUE(moves()) << "nobody has told the modules";
  start_again();
  EXPECT_FALSE(moves());
  EXPECT_EQ(before, std::pair(get(0, ap::max_velocity), get(1, ap::max_velocity)));
  ASSERT_EQ(orphans.size(), 2U);
  EXPECT_THAT(orphans[0] + orphans[1], HasSubstr("(line); "));
  EXPECT_THAT(orphans[0] + orphans[1], HasSubstr("max_velocity is set back to "));
  EXPECT_EQ(name_of_call("axis.move_to", {{"position", 5}}), "none") << "it is free again";
  time.run_for(2s);
  EXPECT_TRUE(is_nothing_held()) << text();
}

TEST_F(Killed, OnAPathItStopsTheAxes) {
  const auto path = begin_path();
  kill();
  start_again();
  EXPECT_FALSE(moves());
  EXPECT_EQ(orphans.size(), 2U);
}

TEST_F(Killed, ItStopsWhatAClientLetTurn) {
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  time.run_for(1s);
  kill();
  start_again();
  EXPECT_FALSE(moves());
  ASSERT_THAT(orphans, ElementsAre(HasSubstr("(turning); no setting had been changed")));
}

TEST_F(Killed, ItStopsTheAxesOfALease) {
  ASSERT_TRUE(call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}}));
  call("axis.move_to", {{"axis", "x"}, {"position", 900}});
  time.run_for(1s);
  kill();
  start_again();
  EXPECT_FALSE(moves());
  EXPECT_THAT(orphans, ElementsAre(HasSubstr("(lease); ")));
}

TEST_F(Killed, WhatTurnsUnattendedGoesOnAndIsKnown) {
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}, {"unattended", true}});
  time.run_for(1s);
  kill();
  start_again();
  EXPECT_TRUE(moves());
  EXPECT_THAT(orphans, IsEmpty());
  EXPECT_EQ(call("axis.get_state", {{"axis", "x"}})->at("unattended"), true);
  call("axis.stop", {{"axis", "x"}});
}

TEST_F(Killed, ASingleMoveGoesOn) {
  call("axis.move_to", {{"axis", "x"}, {"position", 900}});
  time.run_for(1s);
  kill();
  start_again();
  EXPECT_TRUE(moves());
  EXPECT_THAT(orphans, IsEmpty());
}

TEST_F(Killed, NobodyElseMovesAnOrphanBeforeItStands) {
  call("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{900, 300}}});
  time.run_for(1s);
  kill();
  wire.is_cut = true;
  start_again();
  EXPECT_TRUE(moves()) << "its module cannot be reached";
  EXPECT_NE(name_of_call("axis.move_to", {{"position", 5}}), "none");
  EXPECT_THAT(text(), HasSubstr("\"why\":\"stop\""));
  kill();
  wire.is_cut = false;
  start_again();
  EXPECT_FALSE(moves()) << "across another restart of the daemon";
  ASSERT_EQ(orphans.size(), 2U);
  EXPECT_THAT(orphans[0], HasSubstr("is set back to "));
}

/// What stands in the file is not what was written to it.
class Damaged : public Killed, public testing::WithParamInterface<const char*> {
 protected:
  /// Returns with the next daemon running.
  void start_with_damage() {
    const auto whole = text();
    kill();
    const std::string how = GetParam();
    write(how == "cut"       ? whole.substr(0, whole.size() / 2)
          : how == "version" ? "{\"version\":9,\"axes\":[]}"
          : how == "empty"   ? ""
                             : "\x01garbage" + whole.substr(8));
    start_again();
  }
};

TEST_P(Damaged, JournalMeansThatWhatTurnsIsStopped) {
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  time.run_for(1s);
  start_with_damage();
  EXPECT_FALSE(moves());
  EXPECT_THAT(orphans, ElementsAre(HasSubstr("could not be read")));
  EXPECT_EQ(name_of_call("axis.move_to", {{"position", 5}}), "none") << "it is free again";
}

TEST_P(Damaged, JournalMeansThatWhatTurnsWithoutAnAxisIsStopped) {
  call("axis.rotate", {{"axis", "1/3"}, {"velocity_internal", 5000}});
  time.run_for(1s);
  ASSERT_NE(get(3, ap::actual_velocity), 0);
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  start_with_damage();
  EXPECT_EQ(get(3, ap::actual_velocity), 0);
  EXPECT_EQ(orphans.size(), 2U);
}

TEST_P(Damaged, JournalIsHeededWhenTheModuleAnswersLater) {
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  time.run_for(1s);
  wire.is_cut = true;
  start_with_damage();
  ASSERT_TRUE(moves());
  kill();
  start_again();
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_FALSE(moves()) << "across another restart of the daemon";
}

INSTANTIATE_TEST_SUITE_P(OfEachKind, Damaged, testing::Values("cut", "version", "empty", "garbage"),
                         [](const auto& value) { return std::string(value.param); });

TEST_F(Killed, AModuleThatHasStartedAgainIsSetNothing) {
  call("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{900, 300}}});
  time.run_for(1s);
  kill();
  module.power_cycle();
  wire.touch();
  time.run_for(500ms);
  start_again();
  for (const auto& request : requests) EXPECT_NE(request.command, tmcl::Command::SAP);
  ASSERT_EQ(orphans.size(), 2U);
  EXPECT_THAT(orphans[0], HasSubstr("has started again since, so no setting is set back"));
  EXPECT_EQ(name_of_call("axis.move_to", {{"position", 5}}), "latched");
}

TEST_F(Killed, AJournalThatIsNoneIsToldAndReplaced) {
  kill();
  for (const auto* text : {"", "{", "[]", "{\"axes\":[{\"bus\":5}]}", "{\"axes\":5}"}) {
    write(text);
    start_again();
    EXPECT_TRUE(is_nothing_held()) << text;
    end_gateway();
  }
}

}  // namespace
}  // namespace tmcld::test
