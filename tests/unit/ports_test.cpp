// What a computer has for modules, by a made-up /sys and /dev; and USB links without any USB.

#include "tmcl/ports.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <vector>

#include "command_line/exit_code.hpp"
#include "connection/port_choice.hpp"
#include "support/temp_path.hpp"
#include "tmcl/link.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ListedPorts : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(root / "sys/class/tty"); }
  void TearDown() override { fs::remove_all(root); }

  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text << '\n';
  }
  void link(const fs::path& path, const fs::path& target) const {
    fs::create_directories((root / path).parent_path());
    fs::create_directories(root / target);
    fs::create_symlink(fs::relative(root / target, (root / path).parent_path()), root / path);
  }
  /// Below the root hub of bus 1.
  fs::path plug_in(const std::string& port, const std::string& vendor, const std::string& product,
                   const std::string& name) const {
    const auto folder = fs::path("sys/devices/pci0000:00/usb1") / port;
    write(folder / "idVendor", vendor);
    write(folder / "idProduct", product);
    write(folder / "product", name);
    write(folder / "busnum", "1");
    write(folder / "devnum", "12");
    write(folder / (port + ":1.0") / "bInterfaceClass", "02");
    write(folder / (port + ":1.0") / "bInterfaceSubClass", "02");
    link(fs::path("sys/bus/usb/devices") / port, folder);
    return folder;
  }
  fs::path plug_in_module(const std::string& port) const {
    const auto folder = plug_in(port, "2a3c", "0100", "Stepper Device");
    write(folder / "manufacturer", "TRINAMIC Motion Control     ");
    return folder;
  }
  void add_terminal(const std::string& name, const fs::path& hardware,
                    const std::string& driver) const {
    const auto terminal = hardware / "tty" / name;
    link(terminal / "device", hardware);
    link(hardware / "driver", fs::path("sys/bus/drivers") / driver);
    link(fs::path("sys/class/tty") / name, terminal);
  }
  std::vector<std::string> links() const {
    std::vector<std::string> links;
    for (const auto& port : list_ports(root)) links.push_back(link_to(port));
    return links;
  }

  fs::path root = test::temp_path("ports");
};

TEST_F(ListedPorts, AComputerMayHaveNone) {
  EXPECT_THAT(list_ports(root), IsEmpty());
  EXPECT_THAT(list_ports(root / "nowhere"), IsEmpty());
}

TEST_F(ListedPorts, TellWhatIsBehindThem) {
  add_terminal("ttyACM0", plug_in_module("1-1.2") / "1-1.2:1.0", "cdc_acm");
  const auto name = std::string("pci-0000:00:14.0-usb-0:1.2:1.0");
  link("dev/serial/by-path/" + name, "dev/ttyACM0");
  const auto ports = list_ports(root);
  ASSERT_EQ(ports.size(), 1U);
  EXPECT_EQ(ports[0].device, "/dev/ttyACM0");
  EXPECT_EQ(ports[0].driver, "cdc_acm");
  EXPECT_EQ(ports[0].by_path, "/dev/serial/by-path/" + name);
  ASSERT_TRUE(ports[0].usb);
  EXPECT_EQ(ports[0].usb->port, "1-1.2");
  EXPECT_EQ(ports[0].usb->node, "/dev/bus/usb/001/012");
  EXPECT_EQ(describe(*ports[0].usb), "2a3c:0100 TRINAMIC Motion Control Stepper Device");
  EXPECT_TRUE(is_module(ports[0]));
}

TEST_F(ListedPorts, AModuleWithoutADriverIsNamedByItsPlace) {
  plug_in_module("1-4");
  EXPECT_THAT(links(), ElementsAre("usb:1-4"));
}

TEST_F(ListedPorts, WhatIsNoSerialPortIsLeftOut) {
  const auto keyboard = plug_in("1-2", "046d", "c31c", "Keyboard");
  write(keyboard / "1-2:1.0/bInterfaceClass", "03");
  plug_in("usb1", "1d6b", "0002", "root hub");
  write("sys/devices/pci0000:00/usb1/usb1/usb1:1.0/bInterfaceClass", "09");
  fs::create_directories(root / "sys/class/tty/tty0");  // a screen
  EXPECT_THAT(links(), IsEmpty());
}

TEST_F(ListedPorts, OnlySerialHardwareThatIsThereCounts) {
  add_terminal("ttyS0", "sys/devices/pnp0/00:05", "serial");
  write("sys/class/tty/ttyS0/type", "4");
  add_terminal("ttyS1", "sys/devices/platform/serial8250", "serial8250");
  write("sys/class/tty/ttyS1/type", "0");
  const auto adapter = plug_in("1-3", "0403", "6001", "FT232R");
  add_terminal("ttyUSB0", adapter / "1-3:1.0/ttyUSB0", "ftdi_sio");
  EXPECT_THAT(links(), ElementsAre("serial:/dev/ttyS0", "serial:/dev/ttyUSB0"));
  EXPECT_FALSE(is_module(list_ports(root)[0]));
  EXPECT_FALSE(is_module(list_ports(root)[1]));
  EXPECT_EQ(list_ports(root)[1].usb->port, "1-3");
}

TEST_F(ListedPorts, WhatADeviceSaysCannotControlTheScreen) {
  plug_in("1-5", "2a3c", "0100", "\x1b[31mred\x7f");
  EXPECT_EQ(describe(*list_ports(root).at(0).usb), "2a3c:0100 ?[31mred?");
}

TEST_F(ListedPorts, OlderModulesHaveOtherIdentifiers) {
  const auto is_one = [](std::uint16_t vendor, std::uint16_t product) {
    UsbDeviceInfo device;
    device.vendor = vendor;
    device.product = product;
    return is_module(device);
  };
  EXPECT_TRUE(is_one(0x16d0, 0x06cc));
  EXPECT_FALSE(is_one(0x16d0, 0x0001));
  EXPECT_FALSE(is_one(0x0483, 0x374b)) << "an adapter that many boards have";
}

TEST_F(ListedPorts, AutoIsTheOnlyModuleThereIs) {
  add_terminal("ttyS0", "sys/devices/pnp0/00:05", "serial");
  const auto none = tmclctl::only_module(list_ports(root));
  ASSERT_FALSE(none);
  EXPECT_EQ(tmclctl::exit_code_of(none.error()), tmclctl::ExitCode::usage);
  EXPECT_THAT(none.error().hint, HasSubstr("--direct serial:/dev/ttyS0"));

  add_terminal("ttyACM3", plug_in_module("1-1") / "1-1:1.0", "cdc_acm");
  EXPECT_EQ(tmclctl::only_module(list_ports(root)), "serial:/dev/ttyACM3");

  plug_in_module("1-2");
  const auto two = tmclctl::only_module(list_ports(root));
  ASSERT_FALSE(two);
  EXPECT_EQ(tmclctl::exit_code_of(two.error()), tmclctl::ExitCode::usage);
  EXPECT_THAT(two.error().hint, HasSubstr("--direct serial:/dev/ttyACM3, --direct usb:1-2"));
}

TEST(UsbLink, APlaceWhereNothingIsSaysWhatToTry) {
  const auto link = Link::open("usb:250-7.7");
  ASSERT_FALSE(link);
  EXPECT_EQ(link.error().code, Errc::link_open_failed);
  EXPECT_EQ(link.error().outcome, Outcome::not_sent);
  EXPECT_THAT(link.error().message, HasSubstr("cannot open usb:250-7.7: nothing there"));
  EXPECT_THAT(link.error().hint, HasSubstr("'tmclctl ports'"));
}

}  // namespace
}  // namespace tmcl
