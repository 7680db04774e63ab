/// The methods of a gateway in this process for a tmcl::client::Caller, without a socket.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "api/local_gateway.hpp"
#include "tmcl/client.hpp"

namespace tmcld {

/// Its end is that of the gateway, in good order: that may take seconds.
class LocalChannel final : public tmcl::client::Channel {
 public:
  /// `version` is that of the program. `cancelled` is asked every few milliseconds during a call
  /// or a wait; true ends it.
  LocalChannel(std::unique_ptr<LocalGateway> gateway, std::string version,
               std::function<bool()> cancelled)
      : gateway_(std::move(gateway)),
        version_(std::move(version)),
        cancelled_(std::move(cancelled)) {}
  ~LocalChannel() override { gateway_->end(); }

  tmcl::client::Result<boost::json::object> call(std::string_view method,
                                                 boost::json::object params,
                                                 const tmcl::client::CallOptions& options) override;
  /// Errors: a bus is not open any more.
  tmcl::client::Result<void> listen(tmcl::Duration at_most) override;
  void on_notification(Listener listener) override {
    gateway_->on_notification(std::move(listener));
  }
  tmcl::client::Result<void> reopen() override { return check_buses(); }
  std::string version() const override { return version_; }

  /// Lets time pass, in which everything goes on; cancelling ends that early.
  void run_for(tmcl::Duration duration);
  LocalGateway& local() { return *gateway_; }

 private:
  tmcl::client::Result<void> check_buses() const;
  tmcl::client::Result<boost::json::object> cut_short(const LocalCall& call);
  bool is_cancelled() const { return cancelled_ && cancelled_(); }

  std::unique_ptr<LocalGateway> gateway_;
  std::string version_;
  std::function<bool()> cancelled_;
};

}  // namespace tmcld
