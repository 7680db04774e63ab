/// How long the computer has slept since it was started. Its processes stood still then, and so did
/// CLOCK_MONOTONIC: no timer has noticed.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/execution_context.hpp>

#include "tmcl/clock.hpp"

namespace tmcld {

/// In virtual time as long as VirtualSleep of the context says, and not at all without one.
tmcl::Duration slept(const boost::asio::any_io_executor& executor);

class VirtualSleep final : public boost::asio::execution_context::service {
 public:
  using key_type = VirtualSleep;
  static inline boost::asio::execution_context::id id;

  explicit VirtualSleep(boost::asio::execution_context& context) : service(context) {}

  tmcl::Duration slept{};

 private:
  void shutdown() override {}
};

}  // namespace tmcld
