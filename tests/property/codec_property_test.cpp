// The bytes: decode(encode(x)) = x, and how a stream was cut into reads makes no difference.

#include <gtest/gtest.h>

#include <random>

#include "support/seed.hpp"
#include "tmcl/serial_decoder.hpp"

namespace tmcl {
namespace {

constexpr int rounds = 20'000;

std::uint8_t byte(std::mt19937_64& random) { return static_cast<std::uint8_t>(random()); }

Request any_request(std::mt19937_64& random, unsigned highest_address) {
  return {ModuleAddress{static_cast<std::uint16_t>(random() % (highest_address + 1))},
          static_cast<Command>(random()), byte(random), byte(random),
          static_cast<std::int32_t>(random())};
}

Reply any_reply(std::mt19937_64& random) {
  const auto table = status_table();
  return {byte(random), byte(random), table[random() % table.size()].status,
          static_cast<Command>(random()), static_cast<std::int32_t>(random())};
}

TEST(Codec, DecodingAnEncodedDatagramGivesItBack) {
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < rounds; ++i) {
    const auto request = any_request(random, 255);
    ASSERT_EQ(decode_serial_request(encode_serial(request)), request);
    const auto wide = any_request(random, 2047);
    ASSERT_EQ(decode_can_request(encode_can(wide, i % 2 == 0)), wide);
    const auto reply = any_reply(random);
    ASSERT_EQ(decode_serial_reply(encode_serial(reply)), reply);
    const std::uint8_t length = i % 2 == 0 ? 7 : 8;
    ASSERT_EQ(decode_can_reply(encode_can(reply, reply.host, false, length)), reply);
  }
}

TEST(Codec, NoSingleWrongByteIsAccepted) {
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < rounds; ++i) {
    auto bytes = encode_serial(any_request(random, 255));
    auto& victim = bytes[random() % bytes.size()];
    victim = static_cast<std::uint8_t>(victim + 1 + random() % 255);
    ASSERT_FALSE(decode_serial_request(bytes));
  }
}

std::vector<SerialItem> decode(std::span<const std::uint8_t> stream, std::uint64_t& dropped) {
  SerialDecoder decoder;
  std::vector<SerialItem> items;
  for (const auto one : stream) {
    if (const auto item = decoder.push(one)) items.push_back(*item);
  }
  dropped = decoder.dropped_bytes();
  return items;
}

TEST(SerialDecoder, FindsEveryReplyAmongGarbageThatHoldsNoHostAddress) {
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < rounds / 20; ++i) {
    std::vector<std::uint8_t> stream;
    std::vector<SerialItem> expected;
    std::uint64_t garbage = 0;
    for (int j = 0; j < 10; ++j) {
      for (auto n = random() % 12; n > 0; --n, ++garbage)
        stream.push_back(static_cast<std::uint8_t>(3 + random() % 253));
      auto reply = any_reply(random);
      reply.host = default_host_address;
      expected.emplace_back(reply);
      const auto bytes = encode_serial(reply);
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    std::uint64_t dropped = 0;
    ASSERT_EQ(decode(stream, dropped), expected);
    ASSERT_EQ(dropped, garbage);
  }
}

TEST(SerialDecoder, NeverAcceptsAWrongChecksum) {
  std::mt19937_64 random(test::seed());
  SerialDecoder decoder;
  SerialBytes last{};
  for (int i = 0; i < rounds * 10; ++i) {
    const auto next = random() % 4 == 0 ? std::uint8_t{2} : byte(random);
    std::copy(last.begin() + 1, last.end(), last.begin());
    last.back() = next;
    if (!decoder.push(next)) continue;
    ASSERT_EQ(last[8], checksum(std::span(last).first(8)));
  }
}

}  // namespace
}  // namespace tmcl
