/// Axes behind a door: those of a gateway, wherever that is.
#pragma once

#include <string>

#include "door.hpp"
#include "target.hpp"

namespace tmclctl {

/// Where it is said which axes there are.
enum class AxesFrom : std::uint8_t {
  configuration,
  scan,  ///< Of the one bus: nothing is configured.
};

class GatewayTarget final : public Target {
 public:
  /// `options` is how another tmclctl names the same gateway.
  GatewayTarget(std::unique_ptr<Door> door, std::string options, AxesFrom axes, Host& host);

  Result<ScanResult> scan(ScanRange range, const Progress& progress) override;
  Result<std::vector<ModuleRow>> modules() override;
  Result<std::vector<AxisRow>> axes() override;
  Result<std::vector<tmcl::api::parameter::Parameter>> parameters(const std::string& axis) override;
  Result<tmcl::api::parameter::Held> get(const std::string& axis,
                                         const std::string& parameter) override;
  using Target::set;
  Result<tmcl::api::parameter::Held> set(const std::string& axis, const std::string& parameter,
                                         const Typed& value) override;
  Result<AxisUnits> units(const std::string& axis) override;
  Result<tmcl::api::axis::StartedMove> move_to(const std::string& axis,
                                               const Typed& position) override;
  Result<tmcl::api::axis::StartedMove> move_by(const std::string& axis,
                                               const Typed& distance) override;
  Result<tmcl::api::axis::Turning> rotate(const std::string& axis, const Typed& velocity,
                                          bool unattended) override;
  Result<void> stop(const std::string& axis) override;
  Result<std::vector<StoppedAxis>> stop_all() override;
  Result<AxisReading> state(const std::string& axis) override;
  Result<void> watch(const std::string& axis, tmcl::Duration interval,
                     const ReadingHandler& on_reading) override;
  Result<Warnings> wait(const Wait& wait,
                        const std::function<void(const AxisReading&)>& on_reading) override;
  Result<void> watch_axes(const std::vector<std::string>& axes, tmcl::Duration interval,
                          const AxesWatcher& watcher) override;
  Result<void> reopen() override { return door_->reopen(); }
  Result<RawAnswer> raw(const RawCommand& command) override;
  Result<tmcl::FirmwareMatch> match_firmware(const ModuleName& module,
                                             const tmcl::firmware::Image& image) override;
  Result<tmcl::FirmwareReport> upload_firmware(const ModuleName& module,
                                               const tmcl::firmware::Image& image,
                                               const tmcl::FirmwareOptions& options) override;
  Result<void> hear_arrivals(const ModuleName& module, const std::function<Result<void>()>& ask,
                             const ArrivalHandler& on_arrival) override;
  Result<boost::json::object> perform(const std::string& method, boost::json::object params,
                                      const NewsHandler& on_news) override;
  Result<boost::json::object> perform_watched(const std::string& method, boost::json::object params,
                                              const std::string* text,
                                              const Watcher& watcher) override;
  void sleep(tmcl::Duration duration) override { door_->sleep(duration); }
  Result<void> see_through(bool tell, Output& output) override {
    return door_->see_through(tell, output);
  }
  std::string options() const override { return options_; }

 private:
  Result<std::vector<AxisRow>> found_axes();
  Result<std::vector<StoppedAxis>> stop_found();
  void stop_motors(const ModuleRow& module, std::vector<StoppedAxis>& stopped);
  Result<Warnings> await_standing(const Wait& wait);
  void add_reasons(std::vector<AxisRow>& axes);
  Result<boost::json::object> call(std::string_view method, boost::json::object params);
  AxisReading reading_from(const tmcl::api::axis::State& state) const;
  Result<tmcl::api::OnModule> params_for(const ModuleName& module);
  Result<tmcl::api::bus::Bus> bus_named(const std::string& name);

  std::unique_ptr<Door> door_;
  std::string options_;
  AxesFrom axes_from_;
  Host& host_;
};

}  // namespace tmclctl
