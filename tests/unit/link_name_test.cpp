#include "tmcl/link_name.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temp_path.hpp"
#include "tmcl/bit_rate.hpp"
#include "tmcl/link.hpp"

namespace tmcl {
namespace {

using testing::HasSubstr;

TEST(LinkName, GoesThereAndBack) {
  for (const auto* text :
       {"serial:/dev/ttyACM0@115200", "serial:/dev/ttyS0@28800", "can:can0", "tcp:127.0.0.1:4001",
        "tcp:[::1]:4001", "usb:auto", "usb:1-1.2", "usb:12-4.1.1.10",
        "serial:/dev/serial/by-id/usb-Trinamic@if00@250000"}) {
    const auto name = parse_link_name(text);
    ASSERT_TRUE(name) << text;
    EXPECT_EQ(to_string(*name), text);
  }
  EXPECT_EQ(std::get<SerialName>(*parse_link_name("serial:/dev/ttyS0")).baud, 9600U);
  EXPECT_EQ(to_string(*parse_link_name("/dev/ttyACM0")), "serial:/dev/ttyACM0@9600");
  EXPECT_EQ(to_string(*parse_link_name("/dev/serial/by-path/pci-0:1.0@115200")),
            "serial:/dev/serial/by-path/pci-0:1.0@115200");
}

TEST(LinkName, TellsTheBitRateOfASerialLineOnly) {
  const auto rate = [](const char* text) { return bit_rate_of(*parse_link_name(text)); };
  EXPECT_EQ(rate("serial:/dev/ttyS0@115200"), 115200U);
  EXPECT_EQ(rate("serial:/dev/nothing-there"), 9600U);
  for (const auto* text :
       {"/dev/ttyACM0@115200", "usb:1-1.2", "usb:auto", "tcp:127.0.0.1:1", "can:no-such-can"})
    EXPECT_EQ(rate(text), std::nullopt) << text;
}

TEST(LinkName, TellsNoBitRateOfAUsbModuleByAnotherName) {
  const std::filesystem::path folder = test::temp_path("links");
  std::filesystem::create_directories(folder);
  const auto rate = [&](const std::string& device) {
    std::ofstream{folder / device};
    const auto link = folder / ("by-path-" + device);
    std::filesystem::create_symlink(device, link);
    return bit_rate_of(SerialName{link.string(), 57600});
  };
  EXPECT_EQ(rate("ttyACM7"), std::nullopt);
  EXPECT_EQ(rate("ttyUSB7"), 57600U);
  std::filesystem::remove_all(folder);
}

TEST(LinkName, WhatIsWrongIsNamed) {
  const auto message = [](const char* text) {
    const auto name = parse_link_name(text);
    return name ? std::string("no error") : name.error().message;
  };
  EXPECT_THAT(message("serial"), HasSubstr("does not begin with a kind"));
  EXPECT_THAT(message("seriel:/dev/x"), HasSubstr("Did you mean 'serial'?"));
  EXPECT_THAT(message("/dev/x@"), HasSubstr("baud rate"));
  EXPECT_THAT(message("serial:"), HasSubstr("device is missing"));
  EXPECT_THAT(message("serial:/dev/x@fast"), HasSubstr("baud rate"));
  EXPECT_THAT(message("serial:/dev/x@49"), HasSubstr("baud rate"));
  EXPECT_THAT(message("can:"), HasSubstr("interface is missing"));
  EXPECT_THAT(message("can:a-name-that-is-too-long"), HasSubstr("15 characters"));
  EXPECT_THAT(message("can:vcan0@500000"),
              HasSubstr("`ip link set vcan0 type can bitrate 500000`"));
  EXPECT_THAT(message("usb:any"), HasSubstr("comes auto, or the kernel's name of a port"));
  for (const auto* port :
       {"usb:", "usb:1", "usb:1-", "usb:-1", "usb:1-1.", "usb:1-1..2", "usb:1-2x", "usb:1-1:1.0",
        "usb:../../1-1", "usb:1-1.1.1.1.1.1.1.1.1.1.1.1.1.1.1.1"})
    EXPECT_THAT(message(port), HasSubstr("'tmclctl ports'")) << port;
  EXPECT_THAT(message("tcp:host"), HasSubstr("port is missing"));
  EXPECT_THAT(message("tcp:host:0"), HasSubstr("1 to 65535"));
  EXPECT_THAT(message("tcp::4001"), HasSubstr("host is missing"));
}

TEST(Link, OpeningWhatIsNotThereSaysWhatToTry) {
  const auto serial = Link::open("serial:/dev/no-such-port@9600");
  ASSERT_FALSE(serial);
  EXPECT_EQ(serial.error().code, Errc::link_open_failed);
  EXPECT_EQ(serial.error().outcome, Outcome::not_sent);
  EXPECT_THAT(serial.error().message, HasSubstr("No such file"));
  EXPECT_THAT(serial.error().hint, HasSubstr("plugged in"));
  const auto file = Link::open("serial:/dev/null");
  ASSERT_FALSE(file);
  const auto tcp = Link::open("tcp:127.0.0.1:1");
  ASSERT_FALSE(tcp);
  EXPECT_THAT(tcp.error().message, HasSubstr("refused"));
}

}  // namespace
}  // namespace tmcl
