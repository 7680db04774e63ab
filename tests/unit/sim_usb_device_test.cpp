// A module as a USB device: what a host's controller asks when it is plugged in, reads and writes.
#include <gmock/gmock.h>

#include <cerrno>

#include "sim/wire/usb_device.hpp"
#include "sim/wire/usbip.hpp"
#include "sim_fixture.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::uint8_t to_host = 0x80;
constexpr std::uint8_t of_class = 0x21;

class SimUsbDevice : public SimTest {
 protected:
  explicit SimUsbDevice(UsbLayout layout = UsbLayout::gd32) : layout_(layout) {}

  UsbRequest control(std::uint8_t type, std::uint8_t request, std::uint8_t high, std::uint8_t low,
                     std::uint8_t length = 255, Bytes data = {}) {
    UsbRequest what;
    what.id = ++last_id;
    what.in = (type & to_host) != 0;
    what.length = length;
    what.setup = {type, request, low, high, 0, 0, length, 0};
    what.data = std::move(data);
    return what;
  }
  UsbRequest bulk(std::uint8_t endpoint, bool in, Bytes data = {}) {
    UsbRequest what;
    what.id = ++last_id;
    what.in = in;
    what.endpoint = endpoint;
    what.length = 512;
    what.data = std::move(data);
    return what;
  }
  /// Its result, which must come at once.
  UsbResult result_of(const UsbRequest& request) {
    results.clear();
    device.submit(request);
    EXPECT_THAT(results, SizeIs(1));
    if (results.empty()) return {};
    EXPECT_EQ(results.front().id, request.id);
    return results.front();
  }
  Bytes descriptor(std::uint8_t type, std::uint8_t index, std::uint8_t length = 255) {
    return result_of(control(to_host, 6, type, index, length)).data;
  }
  std::string string(std::uint8_t index) {
    const auto bytes = descriptor(3, index);
    std::string text;
    for (std::size_t i = 2; i < bytes.size(); i += 2) text += static_cast<char>(bytes[i]);
    return text;
  }
  void read() { device.submit(bulk(1, true)); }
  UsbResult write(Bytes bytes) {
    return result_of(bulk(descriptors_of(layout_).data_out, false, std::move(bytes)));
  }
  Bytes question() const {
    const auto bytes = encode_serial({ModuleAddress{1}, Command::GAP, 4, 0, 0});
    return {bytes.begin(), bytes.end()};
  }

  UsbLayout layout_;
  Module& module = add(3110, 7);
  std::vector<UsbResult> results;
  std::uint32_t last_id = 0;
  UsbDevice device{bench, module, layout_,
                   [this](const auto& result) { results.push_back(result); }, 1};
};

class OldSimUsbDevice : public SimUsbDevice {
 protected:
  OldSimUsbDevice() : SimUsbDevice(UsbLayout::mk20) {}
};

TEST_F(SimUsbDevice, SaysWhatItIs) {
  const auto own = descriptor(1, 0);
  ASSERT_THAT(own, SizeIs(18));
  EXPECT_EQ(own[8] | own[9] << 8, 0x2A3C);
  EXPECT_EQ(own[10] | own[11] << 8, 0x0100);
  EXPECT_EQ(string(own[14]), "Trinamic Motion Control");
  EXPECT_EQ(string(own[15]), "Stepper Device");
  EXPECT_EQ(string(own[16]), "TMCSTEP");
  EXPECT_THAT(descriptor(3, 0), ElementsAre(4, 3, 0x09, 0x04)) << "English";
  EXPECT_THAT(descriptor(2, 0, 9), SizeIs(9)) << "as a host asks first";
}

TEST_F(OldSimUsbDevice, SaysWhatItIs) {
  const auto own = descriptor(1, 0);
  ASSERT_THAT(own, SizeIs(18));
  EXPECT_EQ(string(own[14]), "TRINAMIC Motion Control     ");
  EXPECT_EQ(string(own[15]), "Stepper Motor Dev ");
  EXPECT_EQ(own[16], 0) << "no serial number";
}

/// Every descriptor is as long as it says; endpoints are those that the device serves.
void expect_sound(UsbLayout layout) {
  const auto& own = descriptors_of(layout);
  const auto all = own.configuration;
  EXPECT_EQ(all.size(), std::size_t{all[2]} | std::size_t{all[3]} << 8);
  std::vector<int> bulk;
  std::size_t at = 0;
  for (; at < all.size(); at += all[at]) {
    ASSERT_GT(all[at], 0);
    const bool is_bulk = all[at + 1] == 5 && all[at + 3] == 2;
    if (!is_bulk) continue;
    bulk.push_back(all[at + 2]);
    EXPECT_EQ(all[at + 4], own.packet_size);
  }
  EXPECT_EQ(at, all.size());
  EXPECT_THAT(bulk, testing::UnorderedElementsAre(own.data_in | to_host, own.data_out));
}

TEST(UsbLayouts, AreSound) {
  expect_sound(UsbLayout::gd32);
  expect_sound(UsbLayout::mk20);
}

TEST_F(SimUsbDevice, IsConfiguredAndRemembersItsLine) {
  EXPECT_THAT(result_of(control(to_host, 8, 0, 0)).data, ElementsAre(0));
  EXPECT_EQ(result_of(control(0, 9, 0, 1)).status, 0);
  EXPECT_THAT(result_of(control(to_host, 8, 0, 0)).data, ElementsAre(1));
  const Bytes coding{0, 0xC2, 1, 0, 0, 0, 8};
  EXPECT_EQ(result_of(control(of_class, 0x20, 0, 0, 7, coding)).transferred, 7);
  EXPECT_EQ(result_of(control(of_class | to_host, 0x21, 0, 0)).data, coding);
  EXPECT_EQ(result_of(control(of_class, 0x22, 0, 3, 0)).status, 0);
  EXPECT_EQ(result_of(control(of_class, 0x20, 0, 0, 3, {1, 2, 3})).status, -EPIPE);
}

TEST_F(SimUsbDevice, StallsWhatItDoesNotKnow) {
  EXPECT_EQ(result_of(control(to_host, 6, 6, 0)).status, -EPIPE) << "it has no other speed";
  EXPECT_EQ(result_of(control(to_host, 6, 3, 9)).status, -EPIPE) << "nor such a string";
  EXPECT_EQ(result_of(control(to_host, 6, 2, 1)).status, -EPIPE) << "nor another configuration";
  EXPECT_EQ(result_of(control(0x40, 1, 0, 0)).status, -EPIPE);
  EXPECT_EQ(result_of(bulk(5, false, {1})).status, -EPIPE);
}

TEST_F(SimUsbDevice, AnswersACommandWhenTheHostReads) {
  read();
  EXPECT_EQ(write(question()).transferred, 9);
  results.clear();
  pass(UsbLine::longest_answer);
  ASSERT_THAT(results, SizeIs(1));
  EXPECT_EQ(results.front().id, 1);
  const auto reply = reply_in(results.front().data);
  EXPECT_EQ(reply->value, module.axis(0).get(axis_parameter::max_velocity));
}

TEST_F(SimUsbDevice, KeepsAnswersForAHostThatReadsLater) {
  for (std::size_t i = 0; i < UsbDevice::most_answers + 3; ++i) write(question());
  results.clear();
  pass(40 * UsbLine::longest_answer);
  EXPECT_THAT(results, IsEmpty());
  for (std::size_t i = 0; i < UsbDevice::most_answers + 3; ++i) read();
  EXPECT_THAT(results, SizeIs(UsbDevice::most_answers)) << "the oldest are lost";
}

TEST_F(SimUsbDevice, ForgetsAReaderThatWantsNothingAnyMore) {
  read();
  EXPECT_TRUE(device.cancel(1));
  EXPECT_FALSE(device.cancel(1));
  device.submit(bulk(2, true));
  EXPECT_TRUE(device.cancel(2)) << "of the interrupt endpoint";
  read();
  write(question());
  results.clear();
  pass(UsbLine::longest_answer);
  ASSERT_THAT(results, SizeIs(1));
  EXPECT_EQ(results.front().id, 3);
}

Bytes joined(Bytes one, const Bytes& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

TEST_F(SimUsbDevice, TakesOneCommandOfAPacketOf64) {
  for (int i = 0; i < 4; ++i) read();
  Bytes many;
  for (int i = 0; i < 8; ++i) many = joined(many, question());  // 72 bytes, two packets
  write(many);
  results.clear();
  pass(UsbLine::longest_answer);
  EXPECT_THAT(results, SizeIs(1)) << "the second packet has eight bytes";
}

TEST_F(OldSimUsbDevice, LetsAStrayByteSpoilTheNextCommand) {
  read();
  read();
  write({0});
  write(question());
  pass(UsbLine::longest_answer);
  ASSERT_THAT(results, SizeIs(2)) << "of the write, and of the read";
  EXPECT_EQ(reply_in(results.back().data)->status, Status::wrong_checksum);
}

// ---- its bytes ---------------------------------------------------------------------------------

Bytes submit_of(const UsbRequest& request) {
  Bytes bytes(48);
  bytes[3] = 1;
  bytes[7] = static_cast<std::uint8_t>(request.id);
  bytes[15] = request.in ? 1 : 0;
  bytes[19] = request.endpoint;
  bytes[27] = static_cast<std::uint8_t>(request.in ? request.length : request.data.size());
  std::ranges::copy(request.setup, bytes.begin() + 40);
  return joined(bytes, request.data);
}

TEST(Usbip, ReadsCommandsHoweverTheyAreCut) {
  UsbRequest write{9, false, 3, 0, {}, {1, 2, 3}};
  UsbRequest read{10, true, 1, 64, {}, {}};
  Bytes cancel(48);
  cancel[3] = 2;
  cancel[7] = 11;
  cancel[23] = 10;
  const auto all = joined(joined(submit_of(write), submit_of(read)), cancel);
  for (std::size_t piece = 1; piece <= all.size(); ++piece) {
    UsbipDecoder decoder;
    std::vector<UsbipDecoder::Command> commands;
    for (std::size_t at = 0; at < all.size(); at += piece) {
      decoder.feed(std::span(all).subspan(at, std::min(piece, all.size() - at)));
      while (const auto command = decoder.next()) commands.push_back(*command);
    }
    ASSERT_THAT(commands, SizeIs(3)) << piece;
    EXPECT_EQ(std::get<UsbRequest>(commands[0]).data, write.data);
    EXPECT_EQ(std::get<UsbRequest>(commands[1]).length, 64);
    EXPECT_TRUE(std::get<UsbRequest>(commands[1]).in);
    EXPECT_EQ(std::get<UsbipCancel>(commands[2]).id, 11);
    EXPECT_EQ(std::get<UsbipCancel>(commands[2]).request, 10);
  }
}

TEST(Usbip, WritesResults) {
  const auto bytes = encode_usbip(UsbResult{258, -EPIPE, 2, {7, 8}});
  ASSERT_THAT(bytes, SizeIs(50));
  EXPECT_THAT(std::vector(bytes.begin(), bytes.begin() + 8), ElementsAre(0, 0, 0, 3, 0, 0, 1, 2));
  EXPECT_THAT(std::vector(bytes.begin() + 20, bytes.begin() + 28),
              ElementsAre(255, 255, 255, 224, 0, 0, 0, 2));
  EXPECT_THAT(std::vector(bytes.end() - 2, bytes.end()), ElementsAre(7, 8));
  EXPECT_EQ(encode_usbip(UsbipCancel{5, 4}, true)[23], 256 - ECONNRESET);
  EXPECT_EQ(encode_usbip(UsbipCancel{5, 4}, false)[23], 0) << "too late";
}

TEST(Usbip, GivesUpWhatIsNone) {
  UsbipDecoder decoder;
  decoder.feed(Bytes(48, 0xFF));
  EXPECT_FALSE(decoder.next());
  EXPECT_TRUE(decoder.is_broken());
}

TEST_F(SimUsbDevice, TakesAnythingFromAnybody) {
  const auto seed = test::seed();
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
  test::Random<int> random(seed);
  const auto byte = [&] { return static_cast<std::uint8_t>(random.between(0, 255)); };
  for (int round = 0; round < test::rounds(2000); ++round) {
    UsbRequest request = bulk(static_cast<std::uint8_t>(random.between(0, 4)), byte() % 2 == 0);
    for (auto& one : request.setup) one = byte();
    if (!request.in) request.data.resize(static_cast<std::size_t>(random.between(0, 200)), byte());
    request.length = static_cast<std::uint32_t>(random.between(0, 70));
    device.submit(request);
    if (random.between(0, 3) == 0) device.cancel(static_cast<std::uint32_t>(round));
    pass(std::chrono::microseconds(random.between(0, 2000)));
  }
  for (const auto& result : results) EXPECT_LE(result.data.size(), 70);
}

}  // namespace
}  // namespace tmcl::sim
