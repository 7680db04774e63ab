/// A host of Sparkplug B as a test: it reads what an edge node publishes by the rules of the
/// specification, and fails for what a host could not use. It shares nothing with what it tests.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "broker/message.hpp"

namespace tmclmqtt::test {

/// Fields of a message in Protocol Buffers, in their order.
struct PbField {
  std::uint64_t number;
  std::uint64_t whole = 0;  ///< Of a varint, or the bits of a double.
  std::string_view text{};
};

inline std::uint64_t take_varint(std::string_view& left) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    if (left.empty()) throw std::runtime_error("a varint ends early");
    const auto byte = static_cast<std::uint8_t>(left.front());
    left.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if (byte < 0x80) return value;
  }
  throw std::runtime_error("a varint is too long");
}

inline std::string_view take_bytes(std::string_view& left, std::uint64_t count) {
  if (count > left.size()) throw std::runtime_error("bytes are missing");
  const auto taken = left.substr(0, count);
  left.remove_prefix(count);
  return taken;
}

inline std::vector<PbField> pb_fields(std::string_view left) {
  std::vector<PbField> fields;
  while (!left.empty()) {
    const auto key = take_varint(left);
    PbField field{key >> 3U};
    switch (key & 7U) {
      case 0: field.whole = take_varint(left); break;
      case 1: std::memcpy(&field.whole, take_bytes(left, 8).data(), 8); break;
      case 2: field.text = take_bytes(left, take_varint(left)); break;
      default: throw std::runtime_error("a field of a kind that Sparkplug does not have");
    }
    fields.push_back(field);
  }
  return fields;
}

struct HeardMetric {
  std::uint64_t type = 0;
  std::uint64_t time = 0;
  std::variant<std::monostate, std::int64_t, double, bool, std::string> value{};
  std::string unit{};
};

struct HeardPayload {
  std::optional<std::uint64_t> time{};
  std::optional<std::uint64_t> sequence{};
  std::map<std::string, HeardMetric> metrics{};
};

inline std::string unit_in(std::string_view properties) {
  std::string key;
  std::string unit;
  for (const auto& field : pb_fields(properties)) {
    if (field.number == 1) key = field.text;
    if (field.number != 2 || key != "engUnit") continue;
    for (const auto& part : pb_fields(field.text))
      if (part.number == 8) unit = part.text;
  }
  return unit;
}

inline std::pair<std::string, HeardMetric> heard_metric(std::string_view text) {
  std::string name;
  HeardMetric metric;
  bool is_null = false;
  bool has_value = false;
  for (const auto& field : pb_fields(text)) {
    has_value = has_value || field.number >= 10;
    switch (field.number) {
      case 1: name = field.text; break;
      case 3: metric.time = field.whole; break;
      case 4: metric.type = field.whole; break;
      case 7: is_null = field.whole != 0; break;
      case 9: metric.unit = unit_in(field.text); break;
      case 11: metric.value = static_cast<std::int64_t>(field.whole); break;
      case 13: {
        double value = 0;
        std::memcpy(&value, &field.whole, sizeof(value));
        metric.value = value;
        break;
      }
      case 14: metric.value = field.whole != 0; break;
      case 15: metric.value = std::string(field.text); break;
      default: throw std::runtime_error("a field of a metric that this host does not know");
    }
  }
  EXPECT_NE(is_null, has_value) << name << " has a value, or is said to have none";
  return {name, metric};
}

inline HeardPayload heard_payload(std::string_view text) {
  HeardPayload payload;
  for (const auto& field : pb_fields(text)) {
    if (field.number == 1) payload.time = field.whole;
    if (field.number == 3) payload.sequence = field.whole;
    if (field.number != 2) continue;
    auto [name, metric] = heard_metric(field.text);
    EXPECT_FALSE(name.empty());
    EXPECT_NE(metric.time, 0U) << name;
    EXPECT_TRUE(payload.metrics.emplace(name, metric).second) << name << " comes twice";
  }
  return payload;
}

class SparkplugHost {
 public:
  struct Device {
    bool is_alive = false;
    std::map<std::string, HeardMetric> metrics{};
  };

  SparkplugHost(std::string group, std::string node)
      : group_(std::move(group)), node_(std::move(node)) {}

  bool is_alive = false;
  std::optional<std::int64_t> birth_number{};
  std::map<std::string, HeardMetric> metrics{};
  std::map<std::string, Device> devices{};
  std::map<std::string, int> count{};  ///< Of messages, by verb.

  void take(const Publication& said) {
    SCOPED_TRACE(said.topic);
    const auto levels = levels_of_topic(said.topic);
    ASSERT_GE(levels.size(), 4U);
    EXPECT_EQ(levels[0], "spBv1.0");
    EXPECT_EQ(levels[1], group_);
    EXPECT_EQ(levels[3], node_);
    EXPECT_FALSE(said.retained);
    const auto& verb = levels[2];
    ++count[verb];
    const auto payload = heard_payload(said.payload);
    EXPECT_TRUE(payload.time);
    if (verb == "NDEATH") return take_death_of_node(said, payload);
    EXPECT_EQ(said.qos, 0);
    ASSERT_TRUE(payload.sequence);
    EXPECT_LE(*payload.sequence, 255U);
    const bool is_of_device = verb.front() == 'D';
    ASSERT_EQ(levels.size(), is_of_device ? 5U : 4U);
    if (verb == "NBIRTH") return take_birth_of_node(payload);
    ASSERT_TRUE(is_alive) << "before the birth of the node";
    EXPECT_EQ(*payload.sequence, (sequence_ + 1) % 256) << "a gap";
    sequence_ = *payload.sequence;
    if (verb == "NDATA") return take_values(payload, metrics);
    auto& device = devices[levels[4]];
    if (verb == "DBIRTH") return take_birth_of_device(payload, device);
    ASSERT_TRUE(device.is_alive) << "before the birth of the device";
    if (verb == "DDEATH") {
      device.is_alive = false;
    } else {
      ASSERT_EQ(verb, "DDATA");
      take_values(payload, device.metrics);
    }
  }

  /// Of the connection: the broker publishes it when that is lost.
  void expect_will(const Publication& will) { will_ = will; }
  void lose() {
    if (will_) take(*will_);
    will_.reset();
  }

 private:
  static std::vector<std::string> levels_of_topic(const std::string& topic) {
    std::vector<std::string> levels(1);
    for (const char c : topic) {
      if (c == '/') {
        levels.emplace_back();
      } else {
        levels.back() += c;
      }
    }
    return levels;
  }

  void take_death_of_node(const Publication& said, const HeardPayload& payload) {
    EXPECT_EQ(said.qos, 1);
    EXPECT_FALSE(payload.sequence);
    ASSERT_EQ(payload.metrics.size(), 1U);
    const auto number = std::get<std::int64_t>(payload.metrics.at("bdSeq").value);
    if (!is_alive || number != birth_number) return;
    is_alive = false;
    for (auto& [name, device] : devices) device.is_alive = false;
  }

  void take_birth_of_node(const HeardPayload& payload) {
    EXPECT_EQ(payload.sequence, 0U);
    const auto& number = payload.metrics.at("bdSeq");
    EXPECT_EQ(number.type, 4U);
    birth_number = std::get<std::int64_t>(number.value);
    EXPECT_GE(*birth_number, 0);
    EXPECT_LE(*birth_number, 255);
    if (will_) {
      const auto of_will = heard_payload(will_->payload).metrics.at("bdSeq").value;
      EXPECT_EQ(std::get<std::int64_t>(of_will), *birth_number) << "a stale bdSeq";
    }
    const auto& rebirth = payload.metrics.at("Node Control/Rebirth");
    EXPECT_EQ(rebirth.type, 11U);
    EXPECT_FALSE(std::get<bool>(rebirth.value));
    is_alive = true;
    metrics = payload.metrics;
    sequence_ = 0;
    // The births of those that are still there follow.
    for (auto& [name, device] : devices) device.is_alive = false;
  }

  static void take_birth_of_device(const HeardPayload& payload, Device& device) {
    device.is_alive = true;
    device.metrics = payload.metrics;
    for (const auto& [name, metric] : payload.metrics) EXPECT_NE(metric.type, 0U) << name;
  }

  static void take_values(const HeardPayload& payload, std::map<std::string, HeardMetric>& known) {
    EXPECT_FALSE(payload.metrics.empty());
    for (const auto& [name, metric] : payload.metrics) {
      const auto found = known.find(name);
      ASSERT_NE(found, known.end()) << name << " was in no birth";
      EXPECT_EQ(found->second.type, metric.type) << name;
      EXPECT_NE(found->second.value, metric.value) << name << " has not changed";
      found->second.value = metric.value;
    }
  }

  std::string group_;
  std::string node_;
  std::uint64_t sequence_ = 0;
  std::optional<Publication> will_{};
};

}  // namespace tmclmqtt::test
