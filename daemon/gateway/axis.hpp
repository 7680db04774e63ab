/// A named axis: the verbs that clients have, with the rules that hold for all of them.
///
/// Nothing moves before its module has said what it is, and nothing that was asked for before a
/// stop goes out after it: also not the second half of a verb of several exchanges.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "config/config.hpp"
#include "gateway/bus.hpp"
#include "gateway/module.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {

class AxisPoller;

/// One look at an axis.
struct AxisReading {
  tmcl::AxisState state;
  std::optional<double> velocity_pps;  ///< Nothing where the model is not known.
  tmcl::TimePoint taken{};             ///< When the look began: nothing in it is older.
};

/// Ends a call early: gives an error once the caller has lost interest.
using Objection = std::function<std::optional<tmcl::Error>()>;
using Deadline = std::optional<tmcl::TimePoint>;

class GatewayAxis : public std::enable_shared_from_this<GatewayAxis> {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;

  GatewayAxis(AxisConfig config, std::shared_ptr<GatewayBus> bus);

  const std::string& name() const { return config_.name; }
  tmcl::AxisAddress address() const { return config_.address; }
  GatewayBus& bus() const { return *bus_; }
  GatewayModule& module() const { return module_; }
  /// The parameters of its model; empty while that is not known.
  std::span<const tmcl::ParameterInfo> parameters() const;

  /// The module has said what it is, and has such a motor.
  Awaitable<void> be_ready();

  /// The right to move the axis until it is stopped. Take it when a call comes in, before anything
  /// is waited for: a stop that comes meanwhile must win.
  RunOptions begin_movement(Deadline deadline) const;

  // Each of these begins with be_ready().
  Awaitable<tmcl::Microsteps> move_to(tmcl::Microsteps target, RunOptions movement);
  /// Errors: also Errc::bad_argument for a target outside what the model can hold.
  Awaitable<tmcl::Microsteps> move_by(tmcl::Microsteps distance, RunOptions movement);
  Awaitable<void> rotate(tmcl::InternalVelocity velocity, RunOptions movement);
  Awaitable<void> set(std::uint8_t parameter, std::int32_t value, RunOptions movement);
  Awaitable<tmcl::Microsteps> wait(tmcl::WaitOptions options, Objection objection);
  Awaitable<std::int32_t> get(std::uint8_t parameter, Deadline deadline);
  Awaitable<AxisReading> read_state();

  /// Goes out before everything else, whatever is known about the module.
  Awaitable<void> stop();
  /// Calls that began before this have no right to move the axis any more.
  void revoke_movements() { ++stops_; }

  /// The one who reads this axis for all who watch it.
  const std::shared_ptr<AxisPoller>& poller();

 private:
  template <class T>
  Awaitable<T> run(tmcl::Script<tmcl::Result<T>> script, RunOptions options);
  boost::asio::awaitable<std::optional<double>> to_pps(tmcl::InternalVelocity velocity);
  boost::asio::awaitable<std::optional<tmcl::PulsesPerSecond>> read_velocity_unit(
      const tmcl::Model& model);

  AxisConfig config_;
  std::shared_ptr<GatewayBus> bus_;
  GatewayModule& module_;
  std::uint64_t stops_ = 0;
  /// What the module counts velocities in, until its settings may have changed.
  struct VelocityUnit {
    std::uint64_t settings_epoch;
    tmcl::PulsesPerSecond unit;
  };
  std::optional<VelocityUnit> velocity_unit_;
  std::shared_ptr<AxisPoller> poller_;
};

}  // namespace tmcld
