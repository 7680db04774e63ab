/// What is done where an exception can be caught nowhere: what moves is stopped before the process
/// ends. So it is where a destructor throws, and those of Asio do where there is no memory at all.
#pragma once

#include <exception>
#include <utility>

#include "gateway/gateway.hpp"

namespace tmcld {

/// For as long as it lives, of one gateway at a time. Whichever thread ends the process: nothing of
/// the reactor's is to be kept in order any more.
class LastStop {
 public:
  explicit LastStop(Gateway& gateway) {
    of_ = &gateway;
    before_ = std::set_terminate(&LastStop::stop);
  }
  LastStop(const LastStop&) = delete;
  LastStop& operator=(const LastStop&) = delete;
  ~LastStop() {
    std::set_terminate(before_);
    of_ = nullptr;
  }

 private:
  /// The handler before it says what was thrown, and ends the process.
  static void stop() {
    if (auto* gateway = std::exchange(of_, nullptr)) gateway->stop_at_once();
    before_();
  }

  static inline Gateway* of_ = nullptr;
  static inline std::terminate_handler before_ = nullptr;
};

}  // namespace tmcld
