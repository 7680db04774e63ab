#include "protocol/births.hpp"

#include <chrono>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "tmcl/json_text.hpp"

namespace tmclmqtt {
namespace {

namespace json = boost::json;

Publication said_at(const std::string& topic, const json::object& text) {
  return {.topic = topic, .payload = tmcl::json_text(text), .retained = true, .qos = 1};
}

}  // namespace

Publication Births::will(std::string_view epoch) const {
  return said_at(topic_, {{"online", false}, {"epoch", epoch}});
}

Publication Births::birth(const GatewayNow& gateway, tmcl::TimePoint now) {
  const auto ttl = std::chrono::duration_cast<std::chrono::milliseconds>(gateway.nonce_time);
  json::object text{{"online", true},
                    {"epoch", gateway.epoch},
                    {"nonce_ttl_ms", ttl.count()},
                    {"tmcld_mqtt", version_},
                    {"tmcld", nullptr},
                    {"axes", json::array(gateway.axes.begin(), gateway.axes.end())}};
  if (!gateway.daemon.empty()) text["tmcld"] = gateway.daemon;
  last_ = said_at(topic_, text);
  said_ = now;
  is_replaced_ = false;
  return last_;
}

void Births::see(const Message& message) {
  is_replaced_ = !last_.topic.empty() && message.payload != last_.payload;
}

std::optional<Publication> Births::due(tmcl::TimePoint now) {
  if (!is_replaced_ || now - said_ < least_interval) return std::nullopt;
  said_ = now;
  is_replaced_ = false;
  return last_;
}

}  // namespace tmclmqtt
