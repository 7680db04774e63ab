/// Bytes that a host writes, on a pseudo terminal or a connection, become what it asks for.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "fronts/port_framer.hpp"
#include "fronts/port_session.hpp"
#include "tmcl/timer.hpp"

namespace tmcld {

/// When bytes are read says little about when they came, on a busy computer. So silence is what was
/// looked for and seen.
class PortStream : public std::enable_shared_from_this<PortStream> {
 public:
  /// `has_input`: more has come, and waits to be read.
  PortStream(std::shared_ptr<PortSession> session, const boost::asio::any_io_executor& executor,
             std::function<bool()> has_input)
      : session_(std::move(session)), silence_(executor), has_input_(std::move(has_input)) {}

  const std::shared_ptr<PortSession>& session() const { return session_; }
  void receive(std::span<const std::uint8_t> bytes) {
    ++received_;
    framer_.push(bytes, [this](const tmcl::SerialBytes& datagram) { take(datagram); });
    if (framer_.has_begun()) look_later();
  }
  /// What is not whole yet never will be.
  void drop_half() { framer_.drop(); }
  void close() {
    silence_.cancel();
    session_->close();
  }

 private:
  void take(const tmcl::SerialBytes& datagram) {
    const auto request = tmcl::decode_serial_request(datagram);
    if (request) return session_->on_request(*request);
    session_->on_wrong_checksum(tmcl::ModuleAddress{datagram.front()});
  }
  void look_later() {
    silence_.expires_after(PortFramer::longest_gap);
    silence_.async_wait([weak = weak_from_this(), seen = received_](const auto& error) {
      const auto self = weak.lock();
      if (error || !self || self->received_ != seen || self->has_input_()) return;
      self->framer_.drop();
    });
  }

  std::shared_ptr<PortSession> session_;
  PortFramer framer_;
  tmcl::Timer silence_;
  std::function<bool()> has_input_;
  std::uint64_t received_ = 0;
};

/// Whether there is a stop among what could not be taken.
bool asks_for_stop(std::span<const std::uint8_t> bytes);

/// Whether a descriptor can be read without waiting.
bool has_input(int descriptor);

}  // namespace tmcld
