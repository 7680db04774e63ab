// A host that speaks TMCL at a port of the daemon is told what its module would tell it, may do
// what the configuration says, and costs nobody else anything.
#include <gmock/gmock.h>

#include "tmcl/parameter_number.hpp"
#include "unit/port_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
namespace ap = tmcl::axis_parameter;
using testing::Contains;
using testing::HasSubstr;
using testing::Optional;

constexpr std::uint8_t absolute = 0;
constexpr std::uint8_t relative = 1;
constexpr auto max_current = tmcl::number_of("max_current");

Request move_to(std::int32_t position, std::uint8_t motor = 0) {
  return request_of(Command::MVP, absolute, motor, position);
}
Request stop_of(std::uint8_t motor) { return request_of(Command::MST, 0, motor); }
Request read_of(std::uint8_t parameter, std::uint8_t motor = 0) {
  return request_of(Command::GAP, parameter, motor);
}

class Port : public testing::Test {
 protected:
  FakeModule& module() { return bench.wire.modules.at(1); }
  std::string holder() {
    const auto list = bench.call("lease.list", {});
    const auto& leases = list->at("leases").as_array();
    return leases.empty() ? "" : text(leases.front().at("holder"));
  }

  VirtualGateway bench;
  PortHost host{bench, "a", Role::operate};
};

TEST_F(Port, AnswersAsTheModuleItself) {
  for (const auto& request :
       {read_of(ap::max_velocity), read_of(ap::actual_position, 2), read_of(max_current, 9),
        request_of(Command::GGP, 76), request_of(Command::GET_FIRMWARE_VERSION, 1),
        request_of(Command::GIO, 0)}) {
    FakeModule alone(1);
    auto expected = alone.execute(request);
    EXPECT_THAT(host.ask(request), Optional(expected)) << describe(request);
  }
}

// Most repeat the value, and some say 0; it is handed on, whatever it is. What is no question is
// answered with the value that it came with, or it is no answer to it.
TEST_F(Port, ARefusedReadingHasTheValueThatTheModuleGivesIt) {
  const auto asked = {read_of(max_current), request_of(Command::GIO, 0),
                      request_of(Command::GCO, 3)};
  module().play = [&](const Request& request) -> std::optional<Reply> {
    if (std::ranges::count(asked, request) == 0) return std::nullopt;
    return Reply{2, 1, Status::wrong_type, request.command, 4711};
  };
  for (const auto& request : asked) {
    const Reply refusal{2, 1, Status::wrong_type, request.command, 4711};
    EXPECT_THAT(host.ask(request), Optional(refusal)) << describe(request);
  }
}

TEST_F(Port, SaysNothingForModulesThatAreNotThere) {
  EXPECT_EQ(host.ask(request_of(Command::GAP, 1, 0, 0, 7)), std::nullopt);
  EXPECT_EQ(host.ask(request_of(Command::MVP, 0, 0, 100, 7)), std::nullopt);
  EXPECT_EQ(host.ask(request_of(Command::SGP, 66, 0, 100, 7)), std::nullopt) << "nor a refusal";
}

TEST_F(Port, SaysNothingWhenTheLinkIsLost) {
  bench.wire.unplug();
  EXPECT_EQ(host.ask(move_to(100)), std::nullopt);
  EXPECT_EQ(host.status_of(read_of(ap::actual_position)), Status::ok) << "it was opened again";
}

// ---- what it may do ----------------------------------------------------------------------------

TEST_F(Port, ReadsAndStopsWithoutBeingAllowedTo) {
  PortHost reader(bench, "reader", Role::observe);
  for (const auto& request :
       {move_to(100), request_of(Command::ROR, 0, 0, 10), request_of(Command::SAP, max_current),
        request_of(Command::SIO, 0, 2, 1), request_of(Command::RFS, 0),
        request_of(Command::STAP, max_current), request_of(Command::SOFTWARE_RESET, 0, 0, 1234)}) {
    const auto before = module().executed().size();
    const Reply refused{2, 1, Status::command_not_available, request.command, request.value};
    EXPECT_THAT(reader.ask(request), Optional(refused)) << describe(request);
    for (auto i = before; i < module().executed().size(); ++i)
      EXPECT_EQ(effect_of(module().executed()[i].command, module().executed()[i].type),
                tmcl::Effect::reads);
  }
  EXPECT_EQ(reader.status_of(read_of(ap::max_velocity)), Status::ok);
  EXPECT_EQ(reader.status_of(stop_of(0)), Status::ok);
  EXPECT_EQ(reader.status_of(request_of(Command::RFS, 1)), Status::ok);
}

TEST_F(Port, MovesAndSetsButStoresAndCutsOffNothing) {
  EXPECT_EQ(host.status_of(request_of(Command::SAP, max_current, 0, 50)), Status::ok);
  EXPECT_EQ(host.status_of(move_to(500)), Status::ok);
  EXPECT_EQ(host.status_of(request_of(Command::SIO, 0, 2, 1)), Status::ok);
  for (const auto& request :
       {request_of(Command::STAP, max_current), request_of(Command::SGP, 66, 0, 2),
        request_of(Command::START_DOWNLOAD, 0), request_of(Command::RUN_APPLICATION, 0),
        request_of(Command::ENTER_ASCII_MODE, 0), request_of(Command::ENTER_BOOTLOADER, 0x81)})
    EXPECT_EQ(host.status_of(request), Status::command_not_available) << describe(request);
}

TEST_F(Port, StoresWhereItMayConfigure) {
  PortHost configures(bench, "c", Role::configure);
  EXPECT_EQ(configures.status_of(request_of(Command::STAP, max_current)), Status::ok);
  EXPECT_EQ(configures.status_of(request_of(Command::SGP, 77, 0, 1)), Status::ok);
  EXPECT_EQ(configures.status_of(move_to(500)), Status::ok);
}

TEST_F(Port, LoadsAProgramThatIsRecordedAsItIs) {
  PortHost loads(bench, "c", Role::configure);
  EXPECT_EQ(loads.status_of(request_of(Command::START_DOWNLOAD, 0)), Status::ok);
  const auto by = request_of(Command::MVP, relative, 0, 100);
  EXPECT_EQ(loads.status_of(by), Status::command_loaded);
  EXPECT_EQ(loads.status_of(stop_of(0)), Status::command_loaded);
  EXPECT_EQ(loads.status_of(request_of(Command::END_DOWNLOAD, 0)), Status::ok);
  EXPECT_THAT(module().recorded(), testing::ElementsAre(by, stop_of(0)));
  EXPECT_EQ(loads.status_of(read_of(ap::max_velocity)), Status::ok);
}

TEST_F(Port, LeavesNoModuleInDownloadMode) {
  PortHost loads(bench, "c", Role::configure);
  EXPECT_EQ(loads.status_of(request_of(Command::START_DOWNLOAD, 0)), Status::ok);
  loads.go();
  EXPECT_EQ(host.status_of(read_of(ap::max_velocity)), Status::ok);
  EXPECT_FALSE(module().downloading());
}

TEST(PortLimits, SendsNoAxisBeyondItsSoftLimits) {
  VirtualGateway bench(std::string(bench_bus) +
                       axis_section("x", 0, "soft_limits = [-100, 100]\n"));
  PortHost host(bench, "a", Role::operate);
  EXPECT_EQ(host.status_of(move_to(100)), Status::ok);
  EXPECT_EQ(host.status_of(move_to(101)), Status::command_not_available);
  EXPECT_EQ(host.status_of(request_of(Command::MVP, relative, 0, 1)),
            Status::command_not_available);
  EXPECT_EQ(host.status_of(request_of(Command::ROL, 0, 0, 1)), Status::command_not_available);
  EXPECT_EQ(host.status_of(request_of(Command::SAP, ap::target_position, 0, 101)),
            Status::command_not_available);
  EXPECT_EQ(bench.wire.modules.at(1).parameter(0, ap::target_position), 100);
}

// ---- relative moves ----------------------------------------------------------------------------

TEST_F(Port, SendsARelativeMoveAsAnAbsoluteOne) {
  host.ask(move_to(500));
  const auto by = request_of(Command::MVP, relative, 0, 20);
  EXPECT_THAT(host.ask(by), Optional(Reply{2, 1, Status::ok, Command::MVP, 20}));
  EXPECT_EQ(module().executed().back(), move_to(520));
  EXPECT_THAT(module().executed(), testing::Not(Contains(by)));
}

TEST(PortOfNewerModules, AnswersARelativeMoveWithItsTarget) {
  VirtualGateway bench;
  bench.wire.model = 6212;
  bench.wire.modules.at(1).parameter(0, tmcl::number_of("relative_positioning_option")) = 0;
  // It is asked anew what it is.
  bench.gateway().buses().front()->find_module(tmcl::ModuleAddress{1})->forget_state();
  ASSERT_TRUE(bench.call("axis.get_state", {{"axis", "x"}}));
  ASSERT_TRUE(bench.call("axis.recover", {{"axis", "x"}})) << "it is another module than before";
  PortHost host(bench, "a", Role::operate);
  host.ask(move_to(500));
  bench.wire.modules.at(1).parameter(0, ap::actual_position) = 100;
  const auto by = request_of(Command::MVP, relative, 0, 20);
  EXPECT_THAT(host.ask(by), Optional(Reply{2, 1, Status::ok, Command::MVP, 520}))
      << "it counts from the target";
}

// ---- leases ------------------------------------------------------------------------------------

TEST_F(Port, HasTheAxesForItselfThatItMoves) {
  PortHost other(bench, "b", Role::operate);
  EXPECT_EQ(host.status_of(move_to(500)), Status::ok);
  EXPECT_EQ(holder(), "port a");
  EXPECT_EQ(other.status_of(move_to(600)), Status::command_not_available);
  EXPECT_EQ(other.status_of(request_of(Command::SAP, max_current, 0, 9)),
            Status::command_not_available);
  EXPECT_EQ(other.status_of(move_to(600, 1)), Status::ok) << "another axis";
  EXPECT_EQ(other.status_of(read_of(ap::actual_position)), Status::ok);
  EXPECT_EQ(other.status_of(stop_of(0)), Status::ok);
  EXPECT_FALSE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}));
}

TEST_F(Port, GivesAnAxisBackThatStandsWhenItsHostIsQuiet) {
  host.ask(move_to(500));
  bench.time.run_for(port_idle_time - 100ms);
  host.ask(read_of(ap::actual_position));
  bench.time.run_for(port_idle_time - 100ms);
  EXPECT_EQ(holder(), "port a") << "its host has read something";
  bench.time.run_for(1s);
  EXPECT_EQ(holder(), "");
}

TEST_F(Port, KeepsAnAxisThatMoves) {
  host.ask(move_to(500));
  module().parameter(0, ap::actual_velocity) = 10;
  bench.time.run_for(10min);
  EXPECT_EQ(holder(), "port a");
  module().parameter(0, ap::actual_velocity) = 0;
  bench.time.run_for(3s);
  EXPECT_EQ(holder(), "");
}

TEST_F(Port, GivesItsAxesBackWhenItsHostGoes) {
  host.ask(move_to(500));
  host.go();
  EXPECT_EQ(holder(), "");
  bench.time.run_for(1s);
  EXPECT_EQ(bench.wire.count(Command::MST), 0U) << "a move goes on to its target";
}

TEST_F(Port, StopsWhatTurnsWhenItsHostGoes) {
  host.ask(request_of(Command::ROR, 0, 0, 100));
  host.ask(move_to(500, 1));
  host.go();
  bench.time.run_for(1s);
  EXPECT_EQ(holder(), "");
  EXPECT_THAT(module().executed(), Contains(stop_of(0)));
  EXPECT_EQ(bench.wire.count(Command::MST), 1U);
}

TEST_F(Port, TakesAnAxisAgainThatWasTakenFromIt) {
  host.ask(move_to(500));
  ASSERT_TRUE(bench.call("lease.break", {{"axis", "x"}}));
  EXPECT_EQ(host.status_of(move_to(600)), Status::ok);
  EXPECT_EQ(holder(), "port a");
}

TEST_F(Port, IsNamedInTheAudit) {
  host.ask(move_to(500));
  EXPECT_THAT(bench.audited, Contains(HasSubstr("port a of bus bench: MVP ABS 500 for motor 0 of "
                                                "module 1 outcome=done")));
}

// ---- one at a time -----------------------------------------------------------------------------

TEST_F(Port, LetsAStopPassWhatWaits) {
  host.ask(move_to(100));
  bench.wire.holds = true;
  host.say(read_of(ap::max_velocity));
  host.say(move_to(500));
  host.say(stop_of(0));
  bench.time.run_for(10ms);
  bench.wire.release();
  EXPECT_EQ(tmcl::decode_serial_reply(host.hear().value())->command, Command::GAP);
  const auto moved = tmcl::decode_serial_reply(host.hear().value());
  EXPECT_EQ(moved->command, Command::MVP);
  EXPECT_EQ(moved->status, Status::command_not_available) << "the stop came behind it";
  EXPECT_EQ(tmcl::decode_serial_reply(host.hear().value())->command, Command::MST);
  EXPECT_THAT(module().executed(), testing::Not(Contains(move_to(500))));
}

TEST_F(Port, HearsOnlySoManyRequestsAtOnce) {
  bench.wire.holds = true;
  for (int i = 0; i < 100; ++i) host.say(read_of(ap::max_velocity));
  bench.time.run_for(1ms);
  bench.wire.release();
  std::size_t answers = 0;
  while (host.hear()) ++answers;
  EXPECT_EQ(answers, most_requests_at_port);
}

TEST_F(Port, TellsNothingThatTheHostHasThrownAway) {
  bench.wire.holds = true;
  host.say(read_of(ap::max_velocity));
  bench.time.run_for(1ms);
  host.session().forget_answers();
  bench.wire.release();
  EXPECT_THAT(host.ask(read_of(ap::actual_position)),
              Optional(testing::Field(&Reply::value, module().parameter(0, ap::actual_position))));
  EXPECT_EQ(host.hear(), std::nullopt);
}

TEST_F(Port, SendsNothingLateForAHostThatHasGivenItUp) {
  bench.wire.loses = [](const Request&) { return true; };
  for (int i = 0; i < 8; ++i) host.say(read_of(ap::max_velocity));
  host.say(move_to(500));
  bench.time.run_for(1min);
  EXPECT_THAT(module().executed(), testing::Not(Contains(move_to(500))));
}

// ---- bytes -------------------------------------------------------------------------------------

TEST_F(Port, AnswersAWrongChecksumAsTheModuleDoes) {
  auto bytes = encode_serial(move_to(500));
  bytes.back() ^= 0xFF;
  host.say_bytes(bytes);
  const Reply garbled{2, 1, Status::wrong_checksum, Command{}, 0};
  EXPECT_EQ(host.hear(), encode_serial(garbled));
  bytes.front() = 77;
  host.say_bytes(bytes);
  EXPECT_EQ(host.hear(), std::nullopt) << "there is no such module";
  EXPECT_THAT(module().executed(), testing::Not(Contains(move_to(500))));
}

TEST_F(Port, DropsHalfADatagramAfterSilence) {
  const auto bytes = encode_serial(read_of(ap::max_velocity));
  host.say_bytes(std::span(bytes).first(5));
  bench.time.run_for(PortFramer::longest_gap - 1ms);
  host.say_bytes(std::span(bytes).subspan(5));
  EXPECT_NE(host.hear(), std::nullopt) << "the rest came in time";
  host.say_bytes(std::span(bytes).first(5));
  bench.time.run_for(PortFramer::longest_gap + 1ms);
  EXPECT_EQ(host.status_of(read_of(ap::max_velocity)), Status::ok);
}

TEST_F(Port, TellsOfArrivalsToWhoeverAskedForThem) {
  PortHost other(bench, "b", Role::operate);
  const auto each = request_of(Command::TARGET_REACHED_EVENT, 1, 0, 1);
  EXPECT_EQ(host.status_of(each), Status::ok);
  bench.gateway().buses().front()->emit(
      {GatewayEvent::Kind::target_reached, "bench", std::uint16_t{1}, 1});
  const Reply event{2, 1, Status::delayed, Command::TARGET_REACHED_EVENT, 1};
  EXPECT_EQ(host.hear(), encode_serial(event));
  EXPECT_EQ(other.hear(), std::nullopt);
}

TEST(PortBytes, HasTheVersionAsTextInItsOwnForm) {
  const Told told{{2, 1, Status::ok, Command::GET_FIRMWARE_VERSION, 0},
                  tmcl::version_from_text("1110V101")};
  const auto bytes = to_serial(told);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()),
            "\x02"
            "1110V101");
  const auto frame = to_can(told, 2, {});
  EXPECT_EQ(frame.length, 7);
  EXPECT_EQ(std::string(frame.data.begin(), frame.data.begin() + 7), "1110V10");
}

}  // namespace
}  // namespace tmcld::test
