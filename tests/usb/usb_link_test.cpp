// Links by libusb, past the terminal that the kernel makes of a module.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>

#include <sys/stat.h>

#include "sim/wire/usb_layout.hpp"
#include "support/other_user.hpp"
#include "support/temp_path.hpp"
#include "tmcl/blocking.hpp"
#include "usb/fragile_cable.hpp"
#include "usb/plugged_in.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::comes_true;
using test::FragileCable;
using test::Program;
using testing::HasSubstr;

const Request question{ModuleAddress{1}, Command::GAP, 4, 0, 0};
// Longer than the kernel takes to tell that a cable was pulled, however busy the computer is.
const BusOptions patient{.reply_timeout = 20s};

std::ptrdiff_t threads() {
  return std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
}

class UsbLink : public testing::TestWithParam<const char*>, protected test::PluggedIn {
 protected:
  std::string link() const { return "usb:" + place; }
  sim::UsbLayout layout() const {
    return GetParam() == std::string("mk20") ? sim::UsbLayout::mk20 : sim::UsbLayout::gd32;
  }
};

TEST_P(UsbLink, MovesAnAxisAndGivesTheTerminalBack) {
  plug_in({"--module", "TMCM-3110@7", "--usb", GetParam()});
  ASSERT_TRUE(comes_true([&] { return !terminal().empty(); }));
  for (const auto& name : {link(), std::string("usb:auto")}) {
    const auto moved = tmclctl(name, {"move", "7/0", "1000microsteps", "--wait"});
    EXPECT_EQ(moved.status, 0) << moved.output;
    EXPECT_TRUE(comes_true([&] { return !terminal().empty(); }));
  }
  const auto position = tmclctl({"get", "7/0", "actual_position"});
  EXPECT_EQ(position.status, 0) << position.output;
  EXPECT_THAT(position.output, HasSubstr("1000"));
}

/// At each event of an exchange in turn; the last is that the computer waits for what comes next.
TEST_P(UsbLink, ACablePulledDuringAnExchangeIsALostLink) {
  constexpr std::uint8_t sent = 1;
  constexpr std::uint8_t events = 4;  // command, taken, answer, command to read on
  for (std::uint8_t passing = 0; passing <= events; ++passing) {
    SCOPED_TRACE("after " + std::to_string(passing));
    const FragileCable cable(layout());
    ASSERT_TRUE(comes_true([&] { return !test::terminal_at(cable.place).empty(); }));
    auto bus = blocking::Bus::open("usb:" + cable.place, {}, patient);
    ASSERT_TRUE(bus) << describe(bus.error());
    ASSERT_TRUE(bus->execute(question));
    cable.pull_after(passing);
    auto result = bus->execute(question);
    EXPECT_FALSE(result && passing <= sent);
    EXPECT_TRUE(result || passing < events);
    // If it was answered, a later one is not.
    while (result) result = bus->execute(question);
    EXPECT_EQ(result.error().code, Errc::link_lost) << describe(result.error());
    EXPECT_FALSE(bus->is_open());
    const auto next = bus->execute(question);
    ASSERT_FALSE(next);
    EXPECT_EQ(next.error().code, Errc::link_lost);
    EXPECT_EQ(next.error().outcome, Outcome::not_sent);
    EXPECT_TRUE(comes_true([&] { return !fs::exists(test::usb_device_at(cable.place)); }));
  }
}

TEST_P(UsbLink, ACablePulledDuringOpeningIsAnError) {
  constexpr std::uint8_t most_events = 30;
  for (std::uint8_t passing = 0; passing < most_events; ++passing) {
    SCOPED_TRACE("after " + std::to_string(passing));
    const FragileCable cable(layout());
    ASSERT_TRUE(comes_true([&] { return !test::terminal_at(cable.place).empty(); }));
    cable.pull_after(passing);
    auto bus = blocking::Bus::open("usb:" + cable.place, {}, patient);
    if (bus && bus->execute(question)) {
      EXPECT_GT(passing, 4) << "no event of opening was met";
      return;
    }
    if (!bus) {
      EXPECT_EQ(bus.error().code, Errc::link_open_failed) << describe(bus.error());
    }
    EXPECT_TRUE(comes_true([&] { return !fs::exists(test::usb_device_at(cable.place)); }));
  }
  FAIL() << "it was never open";
}

TEST_P(UsbLink, CostsAboutWhatTheTerminalCosts) {
  plug_in({"--module", "TMCM-3110", "--usb", GetParam()});
  const auto median_us = [](const std::string& name) {
    auto bus = blocking::Bus::open(name, {}, patient);
    if (!bus) throw std::runtime_error(describe(bus.error()));
    std::vector<double> all;
    for (int i = 0; i < 200; ++i) {
      const auto began = std::chrono::steady_clock::now();
      EXPECT_TRUE(bus->execute(question));
      const std::chrono::duration<double, std::micro> took =
          std::chrono::steady_clock::now() - began;
      all.push_back(took.count());
    }
    std::ranges::sort(all);
    return all[all.size() / 2];
  };
  const auto by_terminal = median_us("serial:" + terminal());
  const auto by_libusb = median_us(link());
  // A figure to look at, and no limit: a computer may be busy.
  std::cout << "exchange (median, " << GetParam() << "): terminal " << by_terminal << " us, libusb "
            << by_libusb << " us\n";
}

INSTANTIATE_TEST_SUITE_P(Layouts, UsbLink, testing::Values("gd32", "mk20"));

class UsbHolders : public testing::Test, protected test::PluggedIn {
 protected:
  void SetUp() override { plug_in({"--module", "TMCM-3110", "--usb"}); }
  std::string link() const { return "usb:" + place; }
  std::string node() const {
    std::ifstream bus(device() / "busnum"), number(device() / "devnum");
    int b = 0, n = 0;
    bus >> b;
    number >> n;
    char text[64];
    std::snprintf(text, sizeof text, "/dev/bus/usb/%03d/%03d", b, n);
    return text;
  }
  /// With the terminal open, and without locking it.
  Program reader() const {
    return Program({"/bin/sh", "-c", "exec 3<>" + terminal() + "; echo open; exec sleep 60"});
  }
};

TEST_F(UsbHolders, ATerminalInUseIsLeftAlone) {
  auto user = reader();
  ASSERT_TRUE(user.wait_for("open"));
  for (const auto& name : {link(), std::string("usb:auto")}) {
    const auto refused = tmclctl(name, {"get", "1/0", "max_velocity"});
    EXPECT_EQ(refused.status, 3);
    EXPECT_THAT(refused.output,
                HasSubstr("is in use by sleep (process " + std::to_string(user.process())));
  }
  const auto listed = test::run_program({"tmclctl", "--json", "ports"});
  EXPECT_THAT(listed.output, HasSubstr("\"link\":\"serial:" + terminal() + "\""));
  EXPECT_THAT(listed.output,
              HasSubstr("\"held_by\":\"sleep (process " + std::to_string(user.process())));
  EXPECT_FALSE(terminal().empty());
}

TEST_F(UsbHolders, ATerminalInUseByAnotherUserIsLeftAlone) {
  ASSERT_EQ(chmod(node().c_str(), 0666), 0);
  const auto open = [this] {
    const auto opened = Link::open(link());
    return opened ? std::string("open") : describe(opened.error());
  };
  auto user = reader();
  ASSERT_TRUE(user.wait_for("open"));
  EXPECT_THAT(test::told_by_other_user(open), HasSubstr("in use by a program of another user"));
  user.signal(SIGKILL);
  EXPECT_TRUE(comes_true([&] { return test::told_by_other_user(open) == "open"; }));
}

TEST_F(UsbHolders, WhoMayNotUseItIsToldWhatToDo) {
  ASSERT_EQ(chmod(node().c_str(), 0600), 0);
  const auto told =
      test::told_by_other_user([this] { return describe(Link::open(link()).error()); });
  EXPECT_THAT(told, HasSubstr(node() + ": Permission denied"));
  EXPECT_THAT(told, HasSubstr("a udev rule gives it a group"));
}

TEST_F(UsbHolders, ASecondLinkLearnsWhoHasIt) {
  const auto first = Link::open(link());
  ASSERT_TRUE(first) << describe(first.error());
  const auto second = tmclctl(link(), {"get", "1/0", "max_velocity"});
  EXPECT_EQ(second.status, 3);
  EXPECT_THAT(second.output, HasSubstr("is in use by usb_tests (process"));
  const auto listed = test::run_program({"tmclctl", "ports"});
  EXPECT_THAT(listed.output, HasSubstr("usb:" + place));
  EXPECT_THAT(listed.output, HasSubstr("usb_tests (process"));
}

TEST_F(UsbHolders, ALinkNeedsNoThread) {
  const auto before = threads();
  const auto link_to_module = Link::open(link());
  ASSERT_TRUE(link_to_module);
  EXPECT_EQ(threads(), before);
}

TEST_F(UsbHolders, ThePlaceBesideItIsEmpty) {
  const auto wrong = Link::open("usb:" + place + ".7");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().hint, HasSubstr("there is usb:" + place + " (2a3c:0100"));
}

TEST_F(UsbHolders, AutoWantsTheOnlyModule) {
  EXPECT_EQ(tmclctl("auto", {"get", "1/0", "max_velocity"}).status, 0);
  pull_out();
  const auto none = tmclctl("usb:auto", {"get", "1/0", "max_velocity"});
  EXPECT_EQ(none.status, 3);
  EXPECT_THAT(none.output, HasSubstr("no module is on USB"));
  EXPECT_EQ(tmclctl("auto", {"get", "1/0", "max_velocity"}).status, 2);

  plug_in({"--module", "TMCM-1110", "--module", "TMCM-3110@7", "--usb", "1", "--usb", "7=mk20"});
  EXPECT_TRUE(comes_true([&] {
    const auto several = Link::open("usb:auto");
    return !several && several.error().message.find("several modules") != std::string::npos &&
           several.error().message.find("Stepper Motor Dev") != std::string::npos;
  }));
  EXPECT_TRUE(comes_true([&] {
    return tmclctl("auto", {"get", "1/0", "max_velocity"}).status == 2;
  }));
}

TEST_F(UsbHolders, TheDaemonOpensItAgainWhenItIsBack) {
  const auto socket = test::temp_path("tmcld.sock");
  const auto file = test::temp_path("tmcld.toml");
  std::ofstream(file) << "[daemon]\nsocket = \"" << socket
                      << "\"\n[[bus]]\nname = \"bench\"\nlink = \"" << link()
                      << "\"\n[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 1\nmotor = 0\n";
  Program daemon({"tmcld", "--config", file});
  const auto ask = [&] {
    return test::run_program({"tmclctl", "--socket", socket, "get", "x", "max_velocity"});
  };
  EXPECT_TRUE(comes_true([&] { return ask().status == 0; }));
  for (std::size_t round = 1; round <= 2; ++round) {
    pull_out();
    EXPECT_TRUE(daemon.wait_for_count("bench: link_lost: ", round)) << daemon.output();
    EXPECT_EQ(ask().status, 3);
    const auto before = place;
    plug_in_for_somebody({"--module", "TMCM-3110", "--usb"});
    ASSERT_EQ(place, before) << "plugged in elsewhere";
    EXPECT_TRUE(daemon.wait_for_count("bench: link_restored", round)) << daemon.output();
    EXPECT_TRUE(comes_true([&] { return ask().status == 0; }));
  }
}

}  // namespace
}  // namespace tmcl
