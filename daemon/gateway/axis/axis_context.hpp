/// An axis and the way to its module: what its verbs, its units and its admission share.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>

#include <boost/asio/awaitable.hpp>

#include "config/config.hpp"
#include "gateway/bus.hpp"
#include "gateway/module/module.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {

class AxisLimits;

using Deadline = std::optional<tmcl::TimePoint>;

class AxisContext {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;

  AxisContext(AxisConfig config, std::shared_ptr<GatewayBus> bus);

  const AxisConfig& config() const { return config_; }
  const std::string& name() const { return config_.name; }
  tmcl::AxisAddress address() const { return config_.address; }
  GatewayBus& bus() const { return *bus_; }
  GatewayModule& module() const { return module_; }
  /// Null if it has none.
  const std::shared_ptr<AxisLimits>& limits() const { return limits_; }
  /// The parameters of its model; empty while that is not known.
  std::span<const tmcl::ParameterInfo> parameters() const;

  /// The module has said what it is, and has such a motor.
  Awaitable<void> be_ready();

  /// Learns from what comes of it whether the module answers.
  template <class T>
  Awaitable<T> run(tmcl::Script<tmcl::Result<T>> script, RunOptions options) {
    auto result = co_await bus_->run(std::move(script), std::move(options));
    if (!result) note(result.error());
    co_return result;
  }
  /// What moves nothing.
  template <class T>
  Awaitable<T> run(tmcl::Script<tmcl::Result<T>> script, Deadline deadline = {}) {
    RunOptions options;
    options.deadline = deadline;
    return run(std::move(script), std::move(options));
  }

  /// `error` as one of this axis.
  tmcl::Error on_bus(tmcl::Error error) const {
    error.bus = config_.bus;
    return error;
  }

 private:
  void note(tmcl::Error& error) {
    module_.note(error);
    if (error.bus.empty()) error.bus = config_.bus;
  }

  AxisConfig config_;
  std::shared_ptr<GatewayBus> bus_;
  GatewayModule& module_;
  std::shared_ptr<AxisLimits> limits_;
};

}  // namespace tmcld
