// Real SocketCAN: a vcan, and two real controllers' drivers (kvaser_pci, SJA1000) on one bus.
// tests/vm/run brings the kernel and the interfaces; the environment says what they are called.

#include <gmock/gmock.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "support/program.hpp"
#include "tmcl/bit_rate.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::Program;
using test::run_program;
using testing::HasSubstr;

// Longer than the emulated computer keeps the simulator waiting; what moves is never sent twice.
const BusOptions patient{.reply_timeout = 5s};

/// A test that cannot run fails.
std::string interface(const char* variable) {
  const char* name = std::getenv(variable);
  if (name == nullptr) throw std::runtime_error(std::string(variable) + " names no interface");
  return name;
}

void ip_link_set(const std::string& name, const std::string& state) {
  const auto result = run_program({"/bin/ip", "link", "set", name, state});
  ASSERT_EQ(result.status, 0) << result.output;
}

/// An interface with room for so few frames; puts back what it was.
class ShortQueue {
 public:
  ShortQueue(std::string name, int frames) : name_(std::move(name)) {
    std::ifstream("/sys/class/net/" + name_ + "/tx_queue_len") >> before_;
    set(frames);
  }
  ShortQueue(const ShortQueue&) = delete;
  ShortQueue& operator=(const ShortQueue&) = delete;
  ~ShortQueue() { set(before_); }

 private:
  void set(int frames) const {
    const auto result =
        run_program({"/bin/ip", "link", "set", name_, "txqueuelen", std::to_string(frames)});
    EXPECT_EQ(result.status, 0) << result.output;
  }

  std::string name_;
  int before_ = 10;
};

/// Stops motor 0 of all these modules at once.
Script<StepResult> stop_all(std::vector<ModuleAddress> modules) {
  std::vector<step::Exchange> stops;
  for (const auto module : modules) stops.push_back({{module, Command::MST, 0, 0, 0}, {}});
  auto results = co_await exchange_all(std::move(stops));
  co_return results;
}

/// A socket that puts any frame on the bus.
class RawCan {
 public:
  explicit RawCan(const std::string& name) : socket_(socket(PF_CAN, SOCK_RAW, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(name.c_str()));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot bind to " + name);
    }
  }
  RawCan(const RawCan&) = delete;
  RawCan& operator=(const RawCan&) = delete;
  ~RawCan() { close(socket_); }

  void put(canid_t id, std::vector<std::uint8_t> data) const {
    can_frame frame{};
    frame.can_id = id;
    frame.can_dlc = static_cast<__u8>(data.size());
    std::copy(data.begin(), data.end(), frame.data);
    ASSERT_EQ(write(socket_, &frame, sizeof frame), ssize_t{sizeof frame});
  }

 private:
  int socket_;
};

/// For a daemon: what it remembers ends with the test.
class Folder {
 public:
  Folder() {
    auto name = (std::filesystem::temp_directory_path() / "tmcl-can-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }

  std::string file(const std::string& name) const { return path_ / name; }
  std::string socket() const { return file("tmcld.sock"); }
  /// Writes the configuration of a bus, with further sections; returns the file's name.
  std::string config(const std::string& interface, const std::string& sections) const {
    std::ofstream(file("tmcld.toml"))
        << "[daemon]\nsocket = \"" << socket() << "\"\n[[bus]]\nname = \"bench\"\nlink = \"can:"
        << interface << "\"\nreply_timeout_ms = 5000\n"
        << sections;
    return file("tmcld.toml");
  }

 private:
  std::filesystem::path path_;
};

/// Who asks on which interface, and where the simulator listens.
struct Wires {
  const char* name;
  const char* host;
  const char* simulator;
};

class OnCan : public testing::TestWithParam<Wires> {
 protected:
  std::string host() const { return interface(GetParam().host); }
  std::vector<std::string> simulator(std::vector<std::string> modules) const {
    std::vector<std::string> words{"tmclsim"};
    for (const auto& module : modules) words.insert(words.end(), {"--module", module});
    words.insert(words.end(), {"--can", interface(GetParam().simulator)});
    return words;
  }
};

TEST_P(OnCan, ScanFindsTheModulesAndAMoveArrives) {
  Program simulator(OnCan::simulator({"TMCM-3110@1", "TMCM-1110@5"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  auto bus = blocking::Bus::open("can:" + host(), {}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  const auto found = bus->run(verbs::scan({.first = 1, .last = 40}));
  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ(found->at(0).model, "TMCM-3110");
  EXPECT_EQ(found->at(1).address, ModuleAddress{5});

  auto axis = bus->module(ModuleAddress{1}).axis(2);
  const auto moved = axis.move_to(Microsteps{20'000});
  ASSERT_TRUE(moved) << describe(moved.error());
  EXPECT_EQ(axis.wait_until_reached(), Microsteps{20'000});
}

TEST_P(OnCan, ExtendedIdentifiersWorkToo) {
  Program simulator(OnCan::simulator({"TMCM-1110@3"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  auto bus = blocking::Bus::open("can:" + host(), {.can_extended = true}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  EXPECT_EQ(bus->module(ModuleAddress{3}).axis(0).get(4), 1000);
}

TEST_P(OnCan, ForeignFramesDoNotReachTheEngine) {
  Program simulator(OnCan::simulator({"TMCM-1110@3"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  auto bus = blocking::Bus::open("can:" + host(), {}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  const RawCan noise(interface(GetParam().simulator));
  auto axis = bus->module(ModuleAddress{3}).axis(0);
  for (std::uint8_t i = 0; i < 50; ++i) {
    // 0x82 is what a filter on seven bits would let in as 2; the last is the right number in the
    // wrong format.
    noise.put(0x82, {3, 100, 6, 0, 0, 0, i});
    noise.put(0x700U + i, {i, i, i});
    noise.put(2U | CAN_EFF_FLAG, {3, 100, 6, 0, 0, 0, i});
    ASSERT_EQ(axis.get(4), 1000);
  }
  EXPECT_EQ(bus->counters().unexpected_replies, 0U);
  EXPECT_EQ(bus->counters().garbage_bytes, 0U);
}

TEST_P(OnCan, TwoModulesOfOneAddressAreReported) {
  Program simulator(OnCan::simulator({"TMCM-1110@3", "TMCM-3110@3"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  auto bus = blocking::Bus::open("can:" + host(), {}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  const auto found = bus->run(verbs::scan({.first = 1, .last = 8}));
  ASSERT_TRUE(found) << describe(found.error());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_TRUE(found->at(0).duplicate_suspected);
}

TEST_P(OnCan, StopsToMoreModulesThanTheQueueTakesAllArrive) {
  std::vector<std::string> names;
  std::vector<ModuleAddress> modules;
  // Not 2: that is what the replies come with.
  for (std::uint16_t address = 3; address < 27; ++address) {
    names.push_back("TMCM-1110@" + std::to_string(address));
    modules.push_back(ModuleAddress{address});
  }
  Program simulator(OnCan::simulator(names));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  const ShortQueue queue(host(), 2);
  auto bus = blocking::Bus::open("can:" + host());
  ASSERT_TRUE(bus) << describe(bus.error());
  // An emulated controller loses frames that nobody fetched in time, so answers may be missing.
  // What the queue had no room for would be told as such.
  const auto had_room = [](const auto& result) {
    return result || result.error().code != Errc::queue_full;
  };
  for (int round = 0; round < 5; ++round) {
    for (const auto module : modules) {
      const auto turned = bus->module(module).axis(0).rotate(InternalVelocity{500});
      EXPECT_TRUE(had_room(turned)) << describe(turned.error());
    }
    for (const auto& stopped : bus->run(stop_all(modules))) {
      EXPECT_TRUE(had_room(stopped)) << describe(stopped.error());
      EXPECT_TRUE(stopped || stopped.error().outcome == Outcome::unknown) << "it went out";
    }
  }
}

TEST_P(OnCan, TheDaemonMovesAnAxis) {
  Program simulator(OnCan::simulator({"TMCM-3110@1"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  const Folder folder;
  Program daemon({"tmcld", "--config",
                  folder.config(host(),
                                "[[axis]]\nname = \"x\"\nbus = \"bench\"\n"
                                "address = 1\nmotor = 0\n")});
  const auto ctl = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"tmclctl", "--socket", folder.socket()});
    return run_program(std::move(words));
  };
  for (int i = 0; i < 100 && ctl({"get", "x", "4"}).status != 0; ++i)
    std::this_thread::sleep_for(50ms);

  const auto moved = ctl({"move", "x", "30000", "--wait"});
  EXPECT_EQ(moved.status, 0) << moved.output << daemon.output();
  EXPECT_EQ(ctl({"get", "x", "actual_position"}).output, "30000\n");

  // The interface goes and comes back: nobody has to restart anything.
  ip_link_set(host(), "down");
  std::this_thread::sleep_for(300ms);
  EXPECT_NE(ctl({"get", "x", "4"}).status, 0);
  ip_link_set(host(), "up");
  int status = -1;
  for (int i = 0; i < 100 && status != 0; ++i) {
    std::this_thread::sleep_for(50ms);
    status = ctl({"get", "x", "4"}).status;
  }
  EXPECT_EQ(status, 0);
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0) << daemon.output();
}

TEST_P(OnCan, AModuleWithTheIdentifierOfRepliesObeysThem) {
  Program simulator(OnCan::simulator({"TMCM-1110@1", "TMCM-3110@2"}));
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  EXPECT_THAT(simulator.output(), HasSubstr("2 is the address of module 2 TMCM-3110 and, on CAN"));
  // A scan does not wait for long, so a busy computer may keep a module's answer from it.
  const auto danger = HasSubstr("DANGER: its address is the identifier of all replies");
  const auto scan = [&] {
    return run_program({"tmclctl", "--direct", "can:" + host(), "scan", "--addresses", "1-3"});
  };
  auto scanned = scan();
  for (int i = 1; i < 5 && !testing::Value(scanned.output, danger); ++i) scanned = scan();
  EXPECT_EQ(scanned.status, 0);
  EXPECT_THAT(scanned.output, danger);
  auto bus = blocking::Bus::open("can:" + host(), {}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  const auto turned = bus->module(ModuleAddress{1}).axis(0).rotate({300});
  ASSERT_TRUE(turned) << describe(turned.error());
  const auto velocity = [&] {
    return bus->module(ModuleAddress{2}).axis(1).get(axis_parameter::actual_velocity);
  };
  for (int i = 0; i < 100 && velocity() != 300; ++i) std::this_thread::sleep_for(50ms);
  EXPECT_EQ(velocity(), 300);
  const auto moved = bus->module(ModuleAddress{1}).set_global(0, global_parameter::can_id, 2);
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, Errc::bad_argument);
}

INSTANTIATE_TEST_SUITE_P(Wires, OnCan,
                         testing::Values(Wires{"vcan", "TMCL_CAN_VCAN", "TMCL_CAN_VCAN"},
                                         Wires{"kvaser", "TMCL_CAN_HOST", "TMCL_CAN_SIM"}),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(CanLink, SaysWhenTheInterfaceIsMissingOrDown) {
  const auto missing = Link::open("can:can99");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("there is no interface can99"));
  const auto name = interface("TMCL_CAN_VCAN2");
  ip_link_set(name, "down");
  const auto down = Link::open("can:" + name);
  ip_link_set(name, "up");
  ASSERT_FALSE(down);
  EXPECT_THAT(down.error().message, HasSubstr("down"));
  EXPECT_THAT(down.error().hint, HasSubstr("ip link set"));
  EXPECT_TRUE(Link::open("can:" + name));
}

TEST(CanLink, AControllerHasABitRateAndAVirtualOneHasNone) {
  EXPECT_EQ(bit_rate_of(CanName{interface("TMCL_CAN_HOST")}), 1'000'000U);
  EXPECT_EQ(bit_rate_of(CanName{interface("TMCL_CAN_VCAN")}), std::nullopt);
}

TEST(CanLink, ASecondHostLearnsWhoUsesTheInterface) {
  const auto name = "can:" + interface("TMCL_CAN_VCAN2");
  {
    const auto first = Link::open(name);
    ASSERT_TRUE(first) << describe(first.error());
    const auto second = Link::open(name);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::link_busy);
    const auto holder = "in use by can_tests (process " + std::to_string(getpid()) + ")";
    EXPECT_THAT(second.error().message, HasSubstr(holder));
    const auto program = run_program({"tmclctl", "--direct", name, "scan"});
    EXPECT_NE(program.status, 0);
    EXPECT_THAT(program.output, HasSubstr(holder));
    EXPECT_TRUE(Link::open(name, {.can_reply_id = 9}));
  }
  EXPECT_TRUE(Link::open(name)) << "the interface stayed locked";
}

TEST(CanLink, TheSimulatorFindsAnInterfaceThatWasMadeAnew) {
  const std::string name = "can60";
  const auto make = [&] {
    const auto made = run_program({"/bin/ip", "link", "add", "dev", name, "type", "vcan"});
    ASSERT_EQ(made.status, 0) << made.output;
    ip_link_set(name, "up");
  };
  make();
  Program simulator({"tmclsim", "--module", "TMCM-1110@3", "--can", name});
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  ASSERT_EQ(run_program({"/bin/ip", "link", "delete", name}).status, 0);
  ASSERT_TRUE(simulator.wait_for("there is no CAN interface 'can60'")) << simulator.output();
  make();
  ASSERT_TRUE(simulator.wait_for("the CAN interface 'can60' is there again")) << simulator.output();
  auto bus = blocking::Bus::open("can:" + name, {}, patient);
  ASSERT_TRUE(bus) << describe(bus.error());
  EXPECT_EQ(bus->module(ModuleAddress{3}).axis(0).get(4), 1000);
  EXPECT_EQ(run_program({"/bin/ip", "link", "delete", name}).status, 0);
}

/// A virtual interface for as long as this lives.
class Vcan {
 public:
  explicit Vcan(std::string name) : name_(std::move(name)) {
    const auto made = run_program({"/bin/ip", "link", "add", "dev", name_, "type", "vcan"});
    EXPECT_EQ(made.status, 0) << made.output;
    ip_link_set(name_, "up");
  }
  Vcan(const Vcan&) = delete;
  Vcan& operator=(const Vcan&) = delete;
  ~Vcan() { EXPECT_EQ(run_program({"/bin/ip", "link", "delete", name_}).status, 0); }

 private:
  std::string name_;
};

TEST(CanPort, AHostOnAnInterfaceOfItsOwnFindsTheBusOfADaemon) {
  const Vcan wire("can62");
  const Vcan of_host("can63");
  const Folder folder;
  const auto config =
      folder.config("can62",
                    "[[port]]\nname = \"p\"\nbus = \"bench\"\ncan = \"can63\"\nmay = [\"move\"]\n"
                    "[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 3\nmotor = 0\n");
  Program simulator({"tmclsim", "--module", "TMCM-1110@3", "--can", "can62"});
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  Program daemon({"tmcld", "--config", config});
  ASSERT_TRUE(daemon.wait_for("port p: bus bench on can63")) << daemon.output();
  ASSERT_TRUE(daemon.wait_for("module_answers (module 3)")) << daemon.output();
  auto host = blocking::Bus::open("can:can63", {}, patient);
  ASSERT_TRUE(host) << describe(host.error());
  auto axis = host->module(ModuleAddress{3}).axis(0);
  const auto moved = axis.move_to(Microsteps{2000});
  ASSERT_TRUE(moved) << describe(moved.error());
  const auto there = axis.wait_until_reached();
  ASSERT_TRUE(there) << describe(there.error());
  EXPECT_EQ(there->value, 2000);
  const auto stored = host->execute({ModuleAddress{3}, Command::STAP, 4, 0, 0});
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error().status, Status::command_not_available);
  const auto text = host->execute({ModuleAddress{3}, Command::GET_FIRMWARE_VERSION, 0, 0, 0});
  ASSERT_TRUE(text) << describe(text.error());
  EXPECT_TRUE(text->version_text);
}

TEST(CanLink, AnInterfaceThatGoesDownIsALostLink) {
  const auto name = interface("TMCL_CAN_VCAN2");
  auto bus = blocking::Bus::open("can:" + name);
  ASSERT_TRUE(bus);
  ip_link_set(name, "down");
  const auto position = bus->module(ModuleAddress{1}).axis(0).position();
  ip_link_set(name, "up");
  ASSERT_FALSE(position);
  EXPECT_EQ(position.error().code, Errc::link_lost);
}

TEST(CanLink, ErrorFramesBecomeEvents) {
  const auto name = interface("TMCL_CAN_VCAN2");
  auto bus = blocking::Bus::open("can:" + name, {}, {.reply_timeout = 50ms, .attempts = 1});
  ASSERT_TRUE(bus);
  std::vector<std::string> conditions;
  bus->on_event([&](const BusEvent& event) {
    if (event.kind == BusEvent::Kind::link_condition) conditions.push_back(event.text);
  });
  const RawCan controller(name);
  controller.put(CAN_ERR_FLAG | CAN_ERR_BUSOFF, std::vector<std::uint8_t>(8));
  EXPECT_FALSE(bus->module(ModuleAddress{1}).axis(0).position());
  EXPECT_THAT(conditions, testing::ElementsAre("bus-off"));
}

}  // namespace
}  // namespace tmcl
