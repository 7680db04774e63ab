// Programs that know nothing of tmcld find its bus at ports, beside each other and beside tmclctl.
#include <chrono>

#include <gmock/gmock.h>

#include "support/tmcl_host.hpp"
#include "system/tmcld_fixture.hpp"
#include "tmcl/error.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
namespace ap = axis_parameter;

constexpr std::uint8_t absolute = 0;
constexpr std::uint8_t relative = 1;

Request to(std::uint8_t module, Command command, std::uint8_t type, std::uint8_t motor = 0,
           std::int32_t value = 0) {
  return {ModuleAddress{module}, command, type, motor, value};
}

class TmcldPort : public TmcldTest {
 protected:
  void start(const std::string& ports) {
    start_simulator_on_pty();
    write_config(pty_link(), ports);
    start_daemon();
  }
  std::string port_on_pty(const std::string& name, const std::string& may = "move") const {
    return "[[port]]\nname = \"" + name + "\"\nbus = \"bench\"\npty = \"" + path(name) +
           "\"\nmay = [\"" + may + "\"]\n";
  }
  TmclHost host(const std::string& name) const { return TmclHost::on_pty(path(name)); }
  void let_arrive(TmclHost& host, std::uint8_t module) {
    while (host.value_of(to(module, Command::GAP, ap::position_reached)) == 0) {
    }
  }
};

TEST_F(TmcldPort, EveryHostSeesWhatItWouldSeeAlone) {
  start(port_on_pty("a"));
  Program alone(
      {"tmclsim", "--module", "TMCM-1110@1", "--module", "TMCM-3110@2", "--pty", path("alone")});
  ASSERT_TRUE(alone.wait_for("ready"));
  auto at_port = host("a");
  auto at_module = host("alone");
  std::vector<Request> requests;
  for (int type = 0; type <= 255; ++type) {
    const auto parameter = static_cast<std::uint8_t>(type);
    requests.push_back(to(1, Command::GAP, parameter));
    requests.push_back(to(2, Command::GAP, parameter, 2));
    const bool tells_time =
        type == global_parameter::tick_timer || type == global_parameter::random_number;
    if (!tells_time) requests.push_back(to(2, Command::GGP, parameter));
  }
  for (const auto& request :
       {to(1, Command::GET_FIRMWARE_VERSION, 0), to(2, Command::GET_FIRMWARE_VERSION, 1),
        to(1, Command::GAP, 1, 9, 5), to(1, Command::GAP, 99, 0, 5), to(2, Command::MST, 0, 7),
        to(2, Command::MVP, absolute, 7, 100), to(2, Command::SAP, 4, 0, 1000),
        to(2, Command::SAP, 4, 0, 1'000'000), to(2, Command::SAP, 3, 1, 5),
        to(1, Command::READ_TMCL_MEMORY, 0), to(2, Command::RFS, 2), to(2, Command::GIO, 0, 1),
        to(2, Command::SIO, 0, 2, 1), to(2, Command::MVP, absolute, 0, 300)})
    requests.push_back(request);
  for (const auto& request : requests)
    ASSERT_EQ(at_port.ask(request), at_module.ask(request)) << describe(request);
  let_arrive(at_port, 2);
  let_arrive(at_module, 2);
  const auto by = to(2, Command::MVP, relative, 0, 50);
  EXPECT_EQ(at_port.ask(by), at_module.ask(by));
  let_arrive(at_port, 2);
  EXPECT_EQ(at_port.value_of(to(2, Command::GAP, ap::actual_position)), 350);
  auto garbled = encode_serial(to(1, Command::GAP, 1));
  garbled.back() ^= 1;
  at_port.say(garbled);
  at_module.say(garbled);
  EXPECT_EQ(at_port.hear(), at_module.hear());
}

TEST_F(TmcldPort, MovesWhileSomebodyWatches) {
  start(port_on_pty("a"));
  Program watch({"tmclctl", "--socket", socket(), "watch", "y"});
  ASSERT_TRUE(watch.wait_for("y"));
  auto a = host("a");
  EXPECT_EQ(a.value_of(to(2, Command::MVP, absolute, 0, 4000)), 4000);
  EXPECT_TRUE(watch.wait_for("4000")) << watch.output();
  const auto move = run_program({"tmclctl", "--socket", socket(), "move", "y", "0"});
  EXPECT_NE(move.status, 0);
  EXPECT_THAT(move.output, HasSubstr("port a"));
}

/// One host, an axis and settings of its own.
class Worker {
 public:
  Worker(TmclHost host, std::uint8_t module, std::uint8_t motor)
      : host_(std::move(host)), module_(module), motor_(motor) {}

  void work(std::int32_t round) {
    const auto speed = 500 + round % 500 + module_;
    EXPECT_EQ(host_.value_of(of(Command::SAP, ap::max_velocity, speed)), speed);
    EXPECT_EQ(host_.value_of(of(Command::GAP, ap::max_velocity)), speed);
    const auto target = round * 10 % 2000 + module_;
    EXPECT_EQ(host_.value_of(of(Command::MVP, absolute, target)), target);
    EXPECT_EQ(host_.value_of(of(Command::GAP, ap::target_position)), target);
    EXPECT_EQ(host_.value_of(of(Command::GAP, ap::max_velocity)), speed);
    const auto here = host_.value_of(of(Command::GAP, ap::actual_position));
    EXPECT_TRUE(here >= 0 && here <= 2002) << here;
    if (round % 10 == 0) {
      EXPECT_EQ(host_.value_of(of(Command::MST, 0)), 0);
    }
  }

 private:
  Request of(Command command, std::uint8_t type, std::int32_t value = 0) const {
    return to(module_, command, type, motor_, value);
  }

  TmclHost host_;
  std::uint8_t module_;
  std::uint8_t motor_;
};

TEST_F(TmcldPort, TwoHostsAndTmclctlWorkSideBySide) {
  start(port_on_pty("a") + port_on_pty("b"));
  Program watch({"tmclctl", "--socket", socket(), "watch", "y"});
  ASSERT_TRUE(watch.wait_for("y"));
  Worker a(host("a"), 1, 0);
  Worker b(host("b"), 2, 0);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::int32_t round = 0;
  for (; std::chrono::steady_clock::now() < end && !HasFailure(); ++round) {
    a.work(round);
    b.work(round);
    if (round % 100 != 0) continue;
    const auto moved =
        run_program({"tmclctl", "--socket", socket(), "move", "z", std::to_string(round)});
    EXPECT_EQ(moved.status, 0) << moved.output;
  }
  EXPECT_GT(round, 0);
  RpcClient client(socket());
  const auto buses = client.result("bus.list").at("buses").as_array();
  EXPECT_EQ(buses.front().at("counters").at("surplus").as_int64(), 0);
}

TEST_F(TmcldPort, StartsAnewWithEachHost) {
  start(port_on_pty("a"));
  const auto version = encode_serial(to(1, Command::GET_FIRMWARE_VERSION, 1));
  {
    auto first = host("a");
    EXPECT_TRUE(first.ask(to(2, Command::MVP, absolute, 0, 100)));
    // Half a datagram, and answers that it does not wait for.
    for (int i = 0; i < 5; ++i) first.say(version);
    first.say(std::span(version).first(4));
  }
  RpcClient client(socket());
  const auto leases = [&] { return client.result("lease.list").at("leases").as_array().size(); };
  while (leases() != 0) {
  }
  auto second = host("a");
  EXPECT_EQ(second.value_of(to(1, Command::SAP, ap::max_velocity, 0, 777)), 777);
  EXPECT_EQ(second.value_of(to(1, Command::GAP, ap::max_velocity)), 777);
}

TEST_F(TmcldPort, ServesOverTcp) {
  start_simulator_on_pty();
  // Any port that is free now.
  const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof any;
  ASSERT_EQ(::bind(probe, reinterpret_cast<const sockaddr*>(&any), size), 0);
  ASSERT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&any), &size), 0);
  ::close(probe);
  const auto number = ntohs(any.sin_port);
  write_config(pty_link(), "[[port]]\nname = \"t\"\nbus = \"bench\"\ntcp = \"127.0.0.1:" +
                               std::to_string(number) + "\"\nmay = [\"move\"]\n");
  start_daemon();
  auto one = TmclHost::on_tcp(number);
  auto other = TmclHost::on_tcp(number);
  EXPECT_EQ(one.value_of(to(1, Command::MVP, absolute, 0, 100)), 100);
  EXPECT_EQ(other.value_of(to(2, Command::MVP, absolute, 0, 200)), 200);
  const auto refused = decode_serial_reply(other.ask(to(1, Command::MVP, absolute, 0, 5)).value());
  EXPECT_EQ(refused->status, Status::command_not_available) << "the axis is that of another host";
  EXPECT_EQ(other.value_of(to(1, Command::MST, 0)), 0);
}

}  // namespace
}  // namespace tmcl::test
