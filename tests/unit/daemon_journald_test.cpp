// Lines of the log as journald gets them.
#include "log/journald.hpp"

#include <gmock/gmock.h>

#include <array>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "support/temp_path.hpp"

namespace tmcld {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

TEST(Journald, FindsTheFieldsOfALine) {
  EXPECT_THAT(
      journald_fields(R"(client="port lab" method=axis.stop params={"axis":"x"} outcome=done)"),
      ElementsAre(Pair("TMCL_CLIENT", "port lab"), Pair("TMCL_METHOD", "axis.stop"),
                  Pair("TMCL_OUTCOME", "done"), Pair("TMCL_AXIS", "x")));
  EXPECT_THAT(journald_fields(R"(bus=bench deadman of module 1 error=leased)"),
              ElementsAre(Pair("TMCL_ERROR", "leased"), Pair("TMCL_BUS", "bench")));
  EXPECT_THAT(journald_fields(R"(method=bus.scan params={"bus":"bench","first":1} outcome=done)"),
              ElementsAre(Pair("TMCL_METHOD", "bus.scan"), Pair("TMCL_OUTCOME", "done"),
                          Pair("TMCL_BUS", "bench")));
}

TEST(Journald, OtherLinesHaveNone) {
  for (const auto* line : {"", "ready", "bench: open on serial:/dev/ttyACM0", "axis=", "method=",
                           "amethod=x", R"({"axis":""})", R"({"axis":)", R"(client=")"})
    EXPECT_THAT(journald_fields(line), IsEmpty()) << line;
}

TEST(Journald, AnEntrySaysHowLongEachFieldIs) {
  using namespace std::string_literals;
  EXPECT_EQ(journald_entry(4, "bus=b\nx"),
            "PRIORITY\n\x01\0\0\0\0\0\0\0"
            "4\nSYSLOG_IDENTIFIER\n\x05\0\0\0\0\0\0\0tmcld\n"
            "TMCL_BUS\n\x03\0\0\0\0\0\0\0b\nx\nMESSAGE\n\x07\0\0\0\0\0\0\0bus=b\nx\n"s);
}

TEST(Journald, GoesToWhoeverListens) {
  const auto path = tmcl::test::temp_path("journald");
  EXPECT_FALSE(JournaldSocket(path).is_there());
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int listener = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const JournaldSocket socket(path);
  ASSERT_TRUE(socket.is_there());
  EXPECT_TRUE(socket.send(journald_entry(6, "ready")));
  std::array<char, 256> heard{};
  const auto count = ::recv(listener, heard.data(), heard.size(), 0);
  EXPECT_EQ(std::string(heard.data(), static_cast<std::size_t>(count)), journald_entry(6, "ready"));
  ::close(listener);
  ::unlink(path.c_str());
  EXPECT_FALSE(socket.send("x"));
}

}  // namespace
}  // namespace tmcld
