// tmclctl jog on a terminal that reports releases of keys, and on one that does not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <string_view>

#include <boost/json.hpp>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr std::string_view press_right = "\x1b[1;1:1C";
constexpr std::string_view release_right = "\x1b[1;1:3C";
constexpr std::string_view release_right_with_num_lock = "\x1b[1;129:3C";
constexpr std::string_view press_right_without_event = "\x1b[C";

class TmclctlJog : public testing::Test, public CtlBench {
 protected:
  TmclctlJog() { start_daemon(); }

  std::int64_t state(const char* field) const {
    const auto ran = ctl(through_daemon(), {"--json", "state", "x"});
    return boost::json::parse(ran.out).at(field).to_number<std::int64_t>();
  }
  /// A press that a busy computer reads too late moves nothing.
  bool moves_by(const OnTerminal& jog, std::string_view key) const {
    return becomes([&] {
      jog.type(key);
      return state("position_microsteps") > 0;
    });
  }
  static bool becomes(const std::function<bool()>& is_so) {
    for (const auto end = std::chrono::steady_clock::now() + 60s;
         std::chrono::steady_clock::now() < end;)
      if (is_so()) return true;
    return false;
  }
};

TEST_F(TmclctlJog, AReleaseThatTheTerminalReportsStopsTheAxis) {
  for (const auto release : {release_right, release_right_with_num_lock}) {
    OnTerminal jog(through_daemon(), {"jog", "x"});
    ASSERT_TRUE(jog.wait_for("\x1b[>2u")) << "it asks for that";
    ASSERT_TRUE(jog.wait_for("hold an arrow"));
    const auto stops = state("last_stop");
    ASSERT_TRUE(moves_by(jog, press_right));
    EXPECT_EQ(state("last_stop"), stops);
    jog.type(release);
    EXPECT_TRUE(becomes([&] { return state("last_stop") > stops; }));
    jog.press('q');
    EXPECT_EQ(jog.wait(), 0);
    EXPECT_THAT(jog.output(), HasSubstr("\x1b[<u")) << "the terminal is as it was";
    ASSERT_EQ(ctl(through_daemon(), {"move", "x", "0", "--wait"}).status, 0);
  }
}

TEST_F(TmclctlJog, WithoutReleasesAnAxisComesToRestByItself) {
  OnTerminal jog(through_daemon(), {"jog", "x"});
  ASSERT_TRUE(jog.wait_for("hold an arrow"));
  const auto stops = state("last_stop");
  ASSERT_TRUE(moves_by(jog, press_right_without_event));
  EXPECT_TRUE(becomes([&] { return state("velocity_internal") == 0; }));
  EXPECT_EQ(state("last_stop"), stops);
  jog.press('q');
  EXPECT_EQ(jog.wait(), 0);
}

}  // namespace
}  // namespace tmcl::test
