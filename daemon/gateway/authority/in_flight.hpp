/// What is known of a request for as long as it is on its way to a module.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "gateway/authority/judge.hpp"
#include "gateway/authority/motors.hpp"
#include "gateway/module/module.hpp"
#include "tmcl/command.hpp"
#include "tmcl/error.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

/// The call that sends a request may end at any time: it is on its way for as long as this lives.
class MoveInFlight {
 public:
  MoveInFlight(Motors& motors, GatewayModule* module, const tmcl::Request& request, Permit of)
      : motors_(motors), module_(module), request_(request) {
    motors_.begin(request_, of);
    if (module_ != nullptr) module_->note_sending(request_);
  }
  MoveInFlight(const MoveInFlight&) = delete;
  MoveInFlight& operator=(const MoveInFlight&) = delete;
  ~MoveInFlight() {
    motors_.end(request_);
    if (module_ != nullptr) note_broken_off();
  }
  void note(const tmcl::Result<tmcl::Answer>& answer) {
    if (auto* module = std::exchange(module_, nullptr))
      module->note_moved(request_, answer ? tmcl::Outcome::done : answer.error().outcome);
  }

 private:
  /// Without memory for that a restart of its module is not noticed.
  void note_broken_off() noexcept {
    try {
      module_->note_moved(request_, tmcl::Outcome::unknown);
    } catch (...) {  // what ends like this ends for want of memory
    }
  }

  Motors& motors_;
  GatewayModule* module_;  ///< Null if none is watched, and when it has been told.
  tmcl::Request request_;
};

/// Keeps a stop that does not get an answer while this lives.
class StopOnItsWay {
 public:
  using Owe = std::function<void()>;
  explicit StopOnItsWay(Owe owe) : owe_(std::move(owe)) {}
  StopOnItsWay(const StopOnItsWay&) = delete;
  StopOnItsWay& operator=(const StopOnItsWay&) = delete;
  ~StopOnItsWay() {
    if (owe_) owe_();
  }
  /// Whether the module got it, or will not take it.
  void note(const tmcl::Result<tmcl::Answer>& answer) {
    const auto code = answer ? std::optional<tmcl::Errc>() : answer.error().code;
    const bool is_unreachable = code == tmcl::Errc::link_lost ||
                                code == tmcl::Errc::reply_timeout ||
                                code == tmcl::Errc::module_silent;
    if (!is_unreachable) owe_ = {};
  }

 private:
  Owe owe_;
};

}  // namespace tmcld
