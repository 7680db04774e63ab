// What [[port]] says, and what is wrong with it.
#include <gmock/gmock.h>

#include "config/load.hpp"

namespace tmcld {
namespace {

using testing::ElementsAre;

constexpr auto bench = R"([daemon]
socket = "/s"
[[bus]]
name = "bench"
link = "can:can0"
[[port]]
name = "a"
)";

std::vector<std::string> problems(const std::string& lines) {
  const auto config = parse_config(bench + lines);
  std::vector<std::string> found;
  if (config) return found;
  for (const auto& problem : config.error()) found.push_back(describe(problem, "f"));
  return found;
}

TEST(PortConfig, HasAPlaceAndARole) {
  const auto config = parse_config(std::string(bench) + R"(bus = "bench"
pty = "/run/tmcld/a"
[[port]]
name = "b"
bus = "bench"
tcp = "127.0.0.1:4001"
may = ["move"]
[[port]]
name = "c"
bus = "bench"
can = "vcan0"
may = ["configure"]
)");
  ASSERT_TRUE(config) << config.error().front().message;
  const auto& ports = config->ports;
  ASSERT_EQ(ports.size(), 3U);
  EXPECT_EQ(std::get<PtyName>(ports[0].place).path, "/run/tmcld/a");
  EXPECT_EQ(ports[0].role, Role::observe);
  EXPECT_EQ(std::get<tmcl::TcpName>(ports[1].place).port, 4001);
  EXPECT_EQ(ports[1].role, Role::operate);
  EXPECT_EQ(std::get<tmcl::CanName>(ports[2].place).interface, "vcan0");
  EXPECT_EQ(ports[2].role, Role::configure);
}

TEST(PortConfig, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(problems("bus = \"bench\"\n"),
              ElementsAre("f:6:1: [[port]] needs one of 'pty', 'tcp' and 'can': where its hosts "
                          "find the bus"));
  EXPECT_THAT(problems("bus = \"bench\"\npty = \"/a\"\ntcp = \"a:1\"\n"),
              ElementsAre("f:6:1: [[port]] needs one of 'pty', 'tcp' and 'can': where its hosts "
                          "find the bus"));
  EXPECT_THAT(problems("bus = \"bench\"\ntcp = \"localhost\"\n"),
              ElementsAre("f:9:7: 'tcp' is 'localhost', but must be HOST:PORT"));
  EXPECT_THAT(problems("bus = \"bench\"\ncan = \"can0\"\n"),
              ElementsAre("f:9:7: bus 'bench' is there: a port needs an interface of its own"));
  EXPECT_THAT(problems("bus = \"bensch\"\npty = \"/a\"\n"),
              ElementsAre("f:8:7: there is no bus 'bensch'. Did you mean 'bench'?"));
  EXPECT_THAT(problems("bus = \"bench\"\npty = \"/a\"\nmay = [\"moves\"]\n"),
              ElementsAre("f:10:7: 'may' has 'moves', but can only have move and configure. Did "
                          "you mean 'move'?"));
  EXPECT_THAT(problems("bus = \"bench\"\npty = \"/a\"\n[[port]]\nname = \"b\"\nbus = "
                       "\"bench\"\npty = \"/a\"\n"),
              ElementsAre("f:13:7: port 'a' is there already"));
  EXPECT_THAT(problems("pty = \"/a\"\n"),
              ElementsAre("f:6:1: [[port]] needs the key 'bus': name of the bus that its host "
                          "speaks to"));
}

}  // namespace
}  // namespace tmcld
