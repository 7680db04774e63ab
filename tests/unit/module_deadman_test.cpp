// A module that takes a time for its deadman, and keeps another one; what feeding takes of a wire.
#include <gmock/gmock.h>

#include "config/feeding.hpp"
#include "tmcl/version.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;

TEST(ModuleDeadman, IsNotWrittenAgainToAModuleThatDoesNotKeepIt) {
  VirtualGateway bench(two_axes() +
                       "[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 1000\n");
  auto& module = bench.wire.modules.at(1);
  EXPECT_EQ(bench.wire.count(Command::SGP), 0U) << "it starts a program by itself";
  module.global(tmcl::global_parameter::auto_start_mode) = 0;
  // Another one with the same address, which begins anew.
  auto minor = std::uint8_t{14};
  module.play = [&](const tmcl::Request& request) -> std::optional<tmcl::Reply> {
    if (request.command != Command::GET_FIRMWARE_VERSION) return std::nullopt;
    return tmcl::Reply{tmcl::default_host_address, 1, tmcl::Status::ok, request.command,
                       to_value(tmcl::FirmwareVersion{3110, 1, minor})};
  };
  for (int silences = 0; silences < 3; ++silences) {
    bench.wire.loses = [](const tmcl::Request&) { return true; };
    bench.call("axis.get_state", {{"axis", "x"}});
    bench.wire.loses = {};
    bench.time.run_for(5s);
    EXPECT_EQ(bench.wire.count(Command::SGP), 1U);
  }
  EXPECT_THAT(bench.audited.back(), HasSubstr("error=unexpected_value"));
  EXPECT_TRUE(bench.call("axis.recover", {{"axis", "x"}}));
  EXPECT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5}}));
}

BusConfig six_modules(std::string_view link, std::int32_t deadman_ms) {
  BusConfig bus;
  bus.name = "line";
  bus.link = tmcl::parse_link_name(link).value();
  for (std::uint16_t address = 1; address <= 6; ++address)
    bus.modules.push_back({tmcl::ModuleAddress{address}, {}, deadman_ms});
  return bus;
}

TEST(Feeding, OfSixModulesAtNineThousandSixHundredBaudTakesMostOfTheWire) {
  const auto bus = six_modules("serial:/dev/none", 500);
  EXPECT_NEAR(feeding_percent(bus), 71, 1);
  EXPECT_THAT(fault_of_feeding(bus), HasSubstr("takes 71 % of bus 'line' at 9600 baud"));
  EXPECT_EQ(fault_of_feeding(six_modules("serial:/dev/none", 1000)), "");
}

TEST(Feeding, OfMoreThanHalfOfTheWireIsRefusedByItsKey) {
  std::string toml =
      "[daemon]\nsocket = \"/none\"\n[[bus]]\nname = \"line\"\n"
      "link = \"serial:/dev/none\"\n";
  for (const auto* address : {"1", "2", "3", "4", "5", "6"})
    toml +=
        "[[module]]\nbus = \"line\"\naddress = " + std::string(address) + "\ndeadman_ms = 600\n";
  const auto config = parse_config(toml);
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().front().message,
              HasSubstr("'deadman_ms' takes 59 % of bus 'line' at 9600 baud"));
}

TEST(Feeding, TellsFromWhenOnALostAnswerIsMadeUpFor) {
  EXPECT_EQ(shortest_steady_deadman(six_modules("serial:/dev/none@1000000", 500)), 176ms);
}

TEST(Feeding, WithoutADeadmanTakesNothing) {
  EXPECT_EQ(feeding_percent(six_modules("can:can0", 0)), 0);
  EXPECT_EQ(fault_of_feeding(six_modules("can:can0", 0)), "");
}

}  // namespace
}  // namespace tmcld::test
