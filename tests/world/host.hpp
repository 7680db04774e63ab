/// A program at a port of a bus, as if it were alone with the modules.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "async/rest.hpp"
#include "fronts/port_session.hpp"

namespace tmcld::test {

class WorldHost {
 public:
  /// What it waits for an answer: longer than the port tries to send what it has asked for.
  static constexpr tmcl::Duration patience = std::chrono::seconds(10);

  WorldHost(const std::shared_ptr<Gateway>& gateway, const std::string& bus)
      : number_(next_number(*gateway)),
        session_(std::make_shared<PortSession>(
            gateway, PortConfig{.name = "host", .bus = bus, .place = {}, .role = Role::configure},
            "port host", [told = told_](const Told& said, CanForm) { *told = said; }, [] {})) {
    session_->start();
  }

  /// As what client the gateway knows it.
  std::uint64_t number() const { return number_; }
  void say(const tmcl::Request& request) {
    told_->reset();
    session_->on_request(request);
  }
  /// What it was told, or silence.
  boost::asio::awaitable<std::optional<Told>> answer() const {
    for (tmcl::Duration waited{}; !*told_ && waited < patience; waited += look) co_await rest(look);
    co_return *told_;
  }
  void go() { session_->close(); }

 private:
  static constexpr tmcl::Duration look = std::chrono::milliseconds(10);

  /// Clients are numbered one after the other.
  static std::uint64_t next_number(Gateway& gateway) {
    const auto last = gateway.add_client().number;
    gateway.remove_client(last);
    return last + 1;
  }

  std::uint64_t number_;
  std::shared_ptr<std::optional<Told>> told_ = std::make_shared<std::optional<Told>>();
  std::shared_ptr<PortSession> session_;
};

}  // namespace tmcld::test
