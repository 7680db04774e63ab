// What takes a module out of the reach of its bus is refused to hosts at ports, to raw commands and
// in programs, and nothing else is.
#include <gmock/gmock.h>

#include "tmcl/model.hpp"
#include "tmcl/reach.hpp"
#include "unit/engine_on_line.hpp"
#include "unit/port_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
namespace gp = tmcl::global_parameter;

const std::vector<Request> cutting{
    request_of(Command::ENTER_ASCII_MODE, 0),
    request_of(Command::ENTER_BOOTLOADER, 0x81, 0x92, static_cast<std::int32_t>(0xA3B4C5D6)),
    request_of(Command::FACTORY_RESET, 0, 0, 1234),
    request_of(Command::SGP, gp::ascii_mode, 0, 1),
    request_of(Command::SGP, gp::ascii_mode, 0, 0x31),
    request_of(Command::SGP, gp::eeprom_magic, 0, 0),
    request_of(Command::SGP, gp::serial_baud_rate, 0, 7),
    request_of(Command::SGP, gp::serial_address, 0, 2),
    request_of(Command::SGP, gp::serial_host_address, 0, 3),
    request_of(Command::SGP, 88, 0, 1),
    request_of(Command::SGP, gp::suppress_reply, 0, 1),
    request_of(Command::AGP, gp::serial_address),
    request_of(Command::AGP, gp::ascii_mode),
    request_of(Command::RSGP, gp::serial_baud_rate),
};
const std::vector<Request> harmless{
    request_of(Command::SGP, gp::ascii_mode, 0, 0x20),
    request_of(Command::SGP, gp::eeprom_magic, 0, 228),
    request_of(Command::SGP, gp::serial_address, 0, 1),
    request_of(Command::SGP, gp::serial_host_address, 0, 2),
    request_of(Command::SGP, gp::telegram_pause_time, 0, 20),
    request_of(Command::SGP, gp::can_bit_rate, 0, 5),
    request_of(Command::SGP, gp::suppress_reply, 0, 0),
    request_of(Command::SGP, gp::serial_address, 2, 7),
    request_of(Command::AGP, gp::serial_address, 2),
};

class Reached : public testing::Test {
 protected:
  bool was_sent(const Request& request) const {
    return std::ranges::count(bench.wire.seen, request) > 0;
  }
  Result<boost::json::object> execute(const Request& request) {
    return bench.call("module.execute", {{"bus", "bench"},
                                         {"address", number(request.address)},
                                         {"command", static_cast<int>(request.command)},
                                         {"type", request.type},
                                         {"motor", request.motor},
                                         {"value", request.value}});
  }

  VirtualGateway bench;
  PortHost host{bench, "a", Role::configure};
};

TEST_F(Reached, APortRefusesWhatCutsAModuleOff) {
  for (const auto& request : cutting) {
    EXPECT_EQ(host.status_of(request), Status::command_not_available) << describe(request);
    EXPECT_FALSE(was_sent(request)) << describe(request);
  }
  for (const auto& request : harmless) {
    EXPECT_EQ(host.status_of(request), Status::ok) << describe(request);
    EXPECT_TRUE(was_sent(request)) << describe(request);
  }
}

TEST_F(Reached, SoDoesARawCommand) {
  for (const auto& request : cutting) {
    const auto result = execute(request);
    ASSERT_FALSE(result) << describe(request);
    EXPECT_EQ(result.error().name, "not_permitted");
    EXPECT_EQ(result.error().outcome, tmcl::Outcome::not_sent);
    EXPECT_FALSE(was_sent(request)) << describe(request);
  }
  for (const auto& request : harmless) EXPECT_TRUE(execute(request)) << describe(request);
}

/// After a line that is refused the others would stand at wrong addresses.
TEST_F(Reached, NoLineOfAProgramThatAPortLoadsCutsAModuleOff) {
  const auto line = harmless.front();
  for (const auto& request : cutting) {
    SCOPED_TRACE(describe(request));
    const bool is_line = static_cast<int>(request.command) < 128;
    EXPECT_EQ(host.status_of(request_of(Command::START_DOWNLOAD, 0)), Status::ok);
    EXPECT_EQ(host.status_of(line), Status::command_loaded);
    EXPECT_EQ(host.status_of(request), Status::command_not_available);
    EXPECT_EQ(host.status_of(line),
              is_line ? Status::command_not_available : Status::command_loaded);
    EXPECT_EQ(host.status_of(request_of(Command::END_DOWNLOAD, 0)), Status::ok);
    EXPECT_FALSE(was_sent(request));
  }
  EXPECT_EQ(host.status_of(request_of(Command::START_DOWNLOAD, 0)), Status::ok);
  for (const auto& request : harmless)
    EXPECT_EQ(host.status_of(request), Status::command_loaded) << describe(request);
  EXPECT_EQ(host.status_of(request_of(Command::END_DOWNLOAD, 0)), Status::ok);
}

TEST_F(Reached, NorDoesAProgramThatAClientLoads) {
  const auto load = [&](std::string_view method, const Request& request) {
    const tmcl::program::Program program{
        {Command::MST},
        {request.command, request.type, request.motor, request.value},
        {Command::STOP}};
    return bench.call(method, {{"bus", "bench"},
                               {"address", 1},
                               {"first_address", 10},
                               {"program", tmcl::program::to_hex(program)}});
  };
  for (const auto& request : cutting) {
    if (static_cast<int>(request.command) >= 128) continue;  // no line of a program
    SCOPED_TRACE(describe(request));
    const auto result = load("program.load", request);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().name, "not_permitted");
    EXPECT_EQ(result.error().outcome, tmcl::Outcome::not_sent);
    EXPECT_THAT(result.error().message, testing::HasSubstr(" at address 11 of the program: "));
    EXPECT_FALSE(was_sent(request));
    EXPECT_EQ(std::ranges::count(bench.wire.seen, Command::START_DOWNLOAD, &Request::command), 0);
  }
  for (const auto& request : harmless) EXPECT_TRUE(load("program.load", request));
}

// Who sets up a module by name does it knowingly, but not while a motor could not be stopped.
TEST_F(Reached, AnAddressIsSetByNameOnlyWhileNothingMoves) {
  const json::object change{
      {"bus", "bench"}, {"address", 1}, {"parameter", int{gp::serial_address}}, {"value", 5}};
  ASSERT_TRUE(bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 100}}));
  const auto refused = bench.call("global.set", change);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().name, "not_permitted");
  ASSERT_TRUE(bench.call("system.stop_all", {}));
  EXPECT_TRUE(bench.call("global.set", change));
}

/// Whether the module is heard at its address after this, and after it has started again.
bool stays_within_reach(const tmcl::Model& model, const Request& request) {
  tmcl::test::EngineOnLine line(9600);
  line.add(1, model.number);
  const auto question = request_of(Command::GET_FIRMWARE_VERSION, 1);
  line.ask(request);
  line.pass(1s);
  const bool answers = line.ask(question).has_value();
  line.ask(request_of(Command::SOFTWARE_RESET, 0, 0, 1234));
  line.pass(1s);
  return answers && line.ask(question).has_value();
}

TEST(Reach, WhatIsLetThroughLeavesASimulatedModuleWhereItIs) {
  const tmcl::Reach reach{tmcl::Framing::serial, 2, 2, 50ms};
  for (const auto number : {351, 1021, 1110, 1161, 1276, 3110, 6110, 6214}) {
    const auto& model = *tmcl::find_model(static_cast<std::uint16_t>(number));
    for (const auto& row : tmcl::global_parameters(model)) {
      for (const auto value : {row.minimum, row.maximum, row.minimum + 1, 49}) {
        const auto request = request_of(Command::SGP, row.number, 0, value);
        if (tmcl::loss_of_reach(request, reach)) continue;
        EXPECT_TRUE(stays_within_reach(model, request)) << model.name << ' ' << describe(request);
      }
    }
    for (int command = 0; command < 256; ++command) {
      for (const std::int32_t value : {0, 1, 1234}) {
        const auto request = request_of(static_cast<Command>(command), 0, 0, value);
        // One has to ask for it, and for its end.
        const bool loads = request.command == Command::START_DOWNLOAD;
        if (loads || tmcl::loss_of_reach(request, reach)) continue;
        EXPECT_TRUE(stays_within_reach(model, request)) << model.name << ' ' << describe(request);
      }
    }
  }
}

TEST(Reach, KnowsTheLinkAndItsOptions) {
  tmcl::Reach can{tmcl::Framing::can, 2, 0x122, {}};
  const auto loses = [](const Request& request, const tmcl::Reach& reach) {
    return tmcl::loss_of_reach(request, reach).has_value();
  };
  const auto set = [](std::uint8_t parameter, std::int32_t value) {
    return request_of(Command::SGP, parameter, 0, value);
  };
  EXPECT_TRUE(loses(set(gp::can_id, 2), can));
  EXPECT_FALSE(loses(set(gp::can_id, 1), can));
  EXPECT_TRUE(loses(set(gp::can_bit_rate, 5), can));
  EXPECT_TRUE(loses(set(gp::can_reply_id, 2), can));
  EXPECT_FALSE(loses(set(gp::can_reply_id, 0x122), can));
  EXPECT_FALSE(loses(set(gp::serial_baud_rate, 5), can));
  EXPECT_TRUE(loses(set(gp::ascii_mode, 1), can));
  const tmcl::Reach serial{tmcl::Framing::serial, 2, 2, 50ms};
  EXPECT_FALSE(loses(set(gp::telegram_pause_time, 50), serial));
  EXPECT_TRUE(loses(set(gp::telegram_pause_time, 51), serial));
  EXPECT_FALSE(loses(set(gp::can_id, 2), serial));
}

}  // namespace
}  // namespace tmcld::test
