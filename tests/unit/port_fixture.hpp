/// A host at a port of a gateway in virtual time, and the bytes that it is told.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fronts/port_session.hpp"
#include "fronts/port_stream.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {

using tmcl::Command;
using tmcl::Reply;
using tmcl::Request;
using tmcl::Status;

inline Request request_of(Command command, std::uint8_t type, std::uint8_t motor = 0,
                          std::int32_t value = 0, std::uint8_t module = 1) {
  return {tmcl::ModuleAddress{module}, command, type, motor, value};
}

/// It speaks bytes, as on a serial line.
class PortHost {
 public:
  template <class Bench>
  PortHost(Bench& bench, const std::string& name, Role role) : time_(&bench.time) {
    PortConfig config;
    config.name = name;
    config.bus = "bench";
    config.role = role;
    const auto session = std::make_shared<PortSession>(
        bench.gateway().shared_from_this(), config, "port " + name,
        [heard = heard_](const Told& told, CanForm) { heard->push_back(to_serial(told)); }, [] {});
    session->start();
    stream_ = std::make_shared<PortStream>(session, bench.gateway().buses().front()->executor(),
                                           [] { return false; });
  }
  PortHost(const PortHost&) = delete;
  PortHost& operator=(const PortHost&) = delete;
  ~PortHost() { go(); }

  void say(const Request& request) { say_bytes(encode_serial(request)); }
  void say_bytes(std::span<const std::uint8_t> bytes) { stream_->receive(bytes); }
  /// What has been heard, oldest first; nothing after ten seconds of silence.
  std::optional<tmcl::SerialBytes> hear() {
    const auto has_some = [this] { return !heard_->empty(); };
    if (!time_->run_while_not(has_some, std::chrono::seconds(10))) return std::nullopt;
    const auto first = heard_->front();
    heard_->erase(heard_->begin());
    return first;
  }
  std::optional<Reply> ask(const Request& request) {
    say(request);
    const auto bytes = hear();
    return bytes ? tmcl::decode_serial_reply(*bytes) : std::nullopt;
  }
  /// Nothing: silence.
  std::optional<Status> status_of(const Request& request) {
    const auto reply = ask(request);
    return reply ? std::optional(reply->status) : std::nullopt;
  }
  PortSession& session() { return *stream_->session(); }
  void go() { stream_->close(); }

 private:
  tmcl::VirtualTime* time_;
  std::shared_ptr<std::vector<tmcl::SerialBytes>> heard_ =
      std::make_shared<std::vector<tmcl::SerialBytes>>();
  std::shared_ptr<PortStream> stream_;
};

}  // namespace tmcld::test
