// Hosts at a port see what they would see alone: modules that are not there cost them nothing, and
// a module on USB answers to any address.
#include <gmock/gmock.h>

#include "unit/port_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
namespace ap = tmcl::axis_parameter;
using testing::Optional;

Request position_of(std::uint8_t module) {
  return request_of(Command::GAP, ap::actual_position, 0, 0, module);
}

class Alone : public testing::Test {
 protected:
  tmcl::Duration time_for(const Request& request, PortHost& host) {
    const auto begin = bench.time.now();
    EXPECT_EQ(host.status_of(request), Status::ok) << describe(request);
    return bench.time.now() - begin;
  }

  VirtualGateway bench;
};

// ---- modules that are not there -----------------------------------------------------------------

// As a host with a short time-out does: it asks one that is not there, waits, and asks another.
TEST_F(Alone, ASilentModuleHoldsUpNobodyAtThePort) {
  PortHost host(bench, "a", Role::operate);
  time_for(position_of(1), host);
  for (const auto& to_silent :
       {position_of(2), request_of(Command::SAP, 4, 0, 500, 2),
        request_of(Command::MST, 0, 0, 0, 2), request_of(Command::MVP, 0, 0, 100, 2)}) {
    for (int round = 0; round < 5; ++round) {
      host.say(to_silent);
      bench.time.run_for(round % 2 == 0 ? 25ms : 310ms);
      for (const auto& request :
           {position_of(1), request_of(Command::SAP, ap::max_velocity, 0, 500)})
        EXPECT_LE(time_for(request, host), 15ms) << describe(to_silent) << ", round " << round;
    }
  }
}

// One process for each command.
TEST_F(Alone, NorTheNextHost) {
  for (int round = 0; round < 5; ++round) {
    {
      PortHost first(bench, "a", Role::operate);
      first.say(position_of(2));
      bench.time.run_for(25ms);
    }
    PortHost next(bench, "a", Role::operate);
    EXPECT_LE(time_for(position_of(1), next), 15ms);
  }
}

TEST_F(Alone, NothingIsToldOfASilentModuleWhateverIsAskedNext) {
  PortHost host(bench, "a", Role::operate);
  for (int round = 0; round < 20; ++round) {
    host.say(position_of(2));
    bench.time.run_for(25ms);
    const auto reply = host.ask(position_of(1));
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->module, 1);
  }
  EXPECT_EQ(host.hear(), std::nullopt);
}

// Who asks on without waiting is answered in order all the same.
TEST_F(Alone, RequestsInARowAreAnsweredInARow) {
  PortHost host(bench, "a", Role::operate);
  const std::vector<Request> row{position_of(1), request_of(Command::SAP, ap::max_velocity, 0, 700),
                                 request_of(Command::GAP, ap::max_velocity),
                                 request_of(Command::SAP, ap::max_velocity, 0, 800),
                                 request_of(Command::GAP, ap::max_velocity)};
  for (const auto& request : row) host.say(request);
  std::vector<std::int32_t> values;
  for (const auto& request : row) {
    const auto bytes = host.hear();
    ASSERT_TRUE(bytes);
    const auto reply = tmcl::decode_serial_reply(*bytes);
    EXPECT_EQ(reply->command, request.command);
    values.push_back(reply->value);
  }
  const auto position = bench.wire.modules.at(1).parameter(0, ap::actual_position);
  EXPECT_THAT(values, testing::ElementsAre(position, 700, 700, 800, 800));
}

// ---- modules on USB -----------------------------------------------------------------------------

class OnUsb : public Alone {
 protected:
  OnUsb() {
    bench.wire.takes_any_address = true;
    bench.wire.modules.at(1).global(tmcl::global_parameter::serial_address) = 1;
  }
  std::optional<Reply> expected(const Request& request) const {
    return Reply{2, 1, Status::ok, request.command, request.value};
  }
};

TEST_F(OnUsb, AHostMayUseAnyAddress) {
  PortHost host(bench, "a", Role::operate);
  for (const std::uint8_t address : {std::uint8_t{0}, std::uint8_t{7}, std::uint8_t{1}}) {
    for (auto request : {request_of(Command::SAP, ap::max_velocity, 0, 700),
                         request_of(Command::MVP, 0, 0, 500), request_of(Command::MST, 0)}) {
      request.address = tmcl::ModuleAddress{address};
      EXPECT_EQ(host.ask(request), expected(request)) << describe(request);
    }
    auto question = request_of(Command::GAP, ap::max_velocity);
    question.address = tmcl::ModuleAddress{address};
    EXPECT_THAT(host.ask(question), Optional(Reply{2, 1, Status::ok, Command::GAP, 700}));
  }
}

TEST_F(OnUsb, NineZeroBytesAreRefusedAsByTheModule) {
  PortHost host(bench, "a", Role::observe);
  host.say_bytes(tmcl::SerialBytes{});
  const tmcl::SerialBytes refusal{2, 1, 2, 0, 0, 0, 0, 0, 5};
  EXPECT_THAT(host.hear(), Optional(refusal));
}

TEST_F(OnUsb, NobodyIsSuspected) {
  PortHost host(bench, "a", Role::operate);
  for (const std::uint8_t address : {std::uint8_t{0}, std::uint8_t{7}, std::uint8_t{200}}) {
    PortHost next(bench, "b", Role::operate);
    EXPECT_EQ(next.status_of(position_of(address)), Status::ok);
    EXPECT_EQ(host.status_of(request_of(Command::MST, 0, 0, 0, address)), Status::ok);
  }
  const auto counters = bench.gateway().buses().front()->link().counters();
  EXPECT_EQ(counters.surplus, 0U);
  EXPECT_EQ(counters.timeouts, 0U);
  EXPECT_FALSE(
      bench.gateway().buses().front()->find_module(tmcl::ModuleAddress{1})->duplicate_suspected());
}

// Its limits hold, whatever it is called.
TEST(OnUsbLimits, AnotherAddressIsNoWayRoundThem) {
  VirtualGateway bench(std::string(bench_bus) +
                       axis_section("x", 0, "soft_limits = [-100, 100]\n"));
  bench.wire.takes_any_address = true;
  bench.wire.modules.at(1).global(tmcl::global_parameter::serial_address) = 1;
  PortHost host(bench, "a", Role::operate);
  EXPECT_EQ(host.status_of(request_of(Command::MVP, 0, 0, 90, 0)), Status::ok);
  EXPECT_EQ(host.status_of(request_of(Command::MVP, 0, 0, 1000, 0)), Status::command_not_available);
}

// Where more than one module is known, an address means a module.
TEST(OnALine, AnotherAddressIsAnotherModule) {
  VirtualGateway bench(std::string(bench_bus) + axis_section("x", 0) + axis_section("y", 0, {}, 2));
  bench.wire.modules.try_emplace(2, 2);
  PortHost host(bench, "a", Role::operate);
  EXPECT_EQ(host.ask(position_of(7)), std::nullopt);
  EXPECT_EQ(host.ask(request_of(Command::MVP, 0, 0, 100, 7)), std::nullopt);
  EXPECT_EQ(host.ask(position_of(2))->module, 2);
}

}  // namespace
}  // namespace tmcld::test
