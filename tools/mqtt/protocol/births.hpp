/// What a gateway says of itself, retained: that it is there, under which epoch, with which axes.
/// Does no I/O, reads no clock.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "broker/message.hpp"
#include "tmcl/clock.hpp"

namespace tmclmqtt {

struct GatewayNow {
  std::string epoch{};
  tmcl::Duration nonce_time{};
  std::string daemon{};  ///< Version of tmcld; empty: it is not there.
  std::vector<std::string> axes{};
};

class Births {
 public:
  /// Another one than its own, a late will or a forged birth, is replaced so often at most.
  static constexpr tmcl::Duration least_interval = std::chrono::seconds(1);

  Births(std::string topic, std::string_view version)
      : topic_(std::move(topic)), version_(version) {}

  /// What the broker says once the connection is gone.
  Publication will(std::string_view epoch) const;
  /// To be said now.
  Publication birth(const GatewayNow& gateway, tmcl::TimePoint now);
  /// Before the connection ends as asked.
  Publication farewell(std::string_view epoch) const { return will(epoch); }
  /// A birth on this gateway's topic; what is not its own is remembered as wrong.
  void see(const Message& message);
  /// Its own again, when another one stands there.
  std::optional<Publication> due(tmcl::TimePoint now);

 private:
  std::string topic_;
  std::string version_;
  Publication last_{};
  tmcl::TimePoint said_{};
  bool is_replaced_ = false;
};

}  // namespace tmclmqtt
