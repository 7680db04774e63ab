#include "protocol/sparkplug_payload.hpp"

#include <chrono>

#include <protozero/pbf_reader.hpp>
#include <protozero/pbf_writer.hpp>

namespace tmclmqtt {
namespace {

namespace json = boost::json;
using protozero::pbf_reader;
using protozero::pbf_wire_type;
using protozero::pbf_writer;

// Numbers of fields, as sparkplug_b.proto of the specification has them.
namespace of_payload {
constexpr protozero::pbf_tag_type timestamp = 1;
constexpr protozero::pbf_tag_type metrics = 2;
constexpr protozero::pbf_tag_type seq = 3;
}  // namespace of_payload
namespace of_metric {
constexpr protozero::pbf_tag_type name = 1;
constexpr protozero::pbf_tag_type timestamp = 3;
constexpr protozero::pbf_tag_type datatype = 4;
constexpr protozero::pbf_tag_type is_null = 7;
constexpr protozero::pbf_tag_type properties = 9;
constexpr protozero::pbf_tag_type long_value = 11;
constexpr protozero::pbf_tag_type double_value = 13;
constexpr protozero::pbf_tag_type boolean_value = 14;
constexpr protozero::pbf_tag_type string_value = 15;
}  // namespace of_metric
namespace of_properties {
constexpr protozero::pbf_tag_type keys = 1;
constexpr protozero::pbf_tag_type values = 2;
}  // namespace of_properties
namespace of_property {
constexpr protozero::pbf_tag_type type = 1;
constexpr protozero::pbf_tag_type string_value = 8;
}  // namespace of_property

void add_value(pbf_writer& into, const Metric& metric) {
  const auto& value = metric.value;
  if (value.is_null()) return into.add_bool(of_metric::is_null, true);
  switch (metric.type) {
    case MetricType::int64:
      return into.add_uint64(of_metric::long_value,
                             static_cast<std::uint64_t>(value.to_number<std::int64_t>()));
    case MetricType::floating:
      return into.add_double(of_metric::double_value, value.to_number<double>());
    case MetricType::boolean: return into.add_bool(of_metric::boolean_value, value.as_bool());
    case MetricType::text: {
      const auto& text = value.as_string();
      return into.add_string(of_metric::string_value, text.data(), text.size());
    }
  }
}

void add_unit(pbf_writer& into, const std::string& unit) {
  if (unit.empty()) return;
  pbf_writer properties(into, of_metric::properties);
  properties.add_string(of_properties::keys, "engUnit");
  pbf_writer property(properties, of_properties::values);
  property.add_uint32(of_property::type, static_cast<std::uint32_t>(MetricType::text));
  property.add_string(of_property::string_value, unit);
}

bool is_rebirth(pbf_reader metric) {
  bool is_named = false;
  bool is_wanted = false;
  while (metric.next()) {
    if (metric.tag() == of_metric::name && metric.wire_type() == pbf_wire_type::length_delimited) {
      const auto name = metric.get_view();
      is_named = std::string_view(name.data(), name.size()) == rebirth_metric;
    } else if (metric.tag() == of_metric::boolean_value &&
               metric.wire_type() == pbf_wire_type::varint) {
      is_wanted = metric.get_bool();
    } else {
      metric.skip();
    }
  }
  return is_named && is_wanted;
}

}  // namespace

std::string sparkplug_payload(const std::vector<Metric>& metrics, tmcl::UtcTime utc,
                              std::optional<std::uint8_t> sequence) {
  const auto since_1970 = std::chrono::floor<std::chrono::milliseconds>(utc.time_since_epoch());
  const auto utc_ms = static_cast<std::uint64_t>(since_1970.count());
  std::string payload;
  pbf_writer message(payload);
  message.add_uint64(of_payload::timestamp, utc_ms);
  for (const auto& metric : metrics) {
    pbf_writer one(message, of_payload::metrics);
    one.add_string(of_metric::name, metric.name);
    one.add_uint64(of_metric::timestamp, utc_ms);
    one.add_uint32(of_metric::datatype, static_cast<std::uint32_t>(metric.type));
    add_unit(one, metric.unit);
    add_value(one, metric);
  }
  if (sequence) message.add_uint64(of_payload::seq, *sequence);
  return payload;
}

bool asks_for_rebirth(std::string_view payload) try {
  pbf_reader message(payload.data(), payload.size());
  while (message.next()) {
    const bool is_metric = message.tag() == of_payload::metrics &&
                           message.wire_type() == pbf_wire_type::length_delimited;
    if (!is_metric) {
      message.skip();
    } else if (is_rebirth(message.get_message())) {
      return true;
    }
  }
  return false;
} catch (const protozero::exception&) {
  return false;
}

}  // namespace tmclmqtt
