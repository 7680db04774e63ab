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

  Attempt<ScanResult> scan(ScanRange range, const Progress& progress) override;
  Attempt<std::vector<ModuleRow>> modules() override;
  Attempt<std::vector<AxisRow>> axes() override;
  Attempt<std::vector<tmcl::api::parameter::Parameter>> parameters(
      const std::string& axis) override;
  Attempt<tmcl::api::parameter::Held> get(const std::string& axis,
                                          const std::string& parameter) override;
  using Target::set;
  Attempt<tmcl::api::parameter::Held> set(const std::string& axis, const std::string& parameter,
                                          const Typed& value) override;
  Attempt<AxisUnits> units(const std::string& axis) override;
  Attempt<tmcl::api::axis::StartedMove> move_to(const std::string& axis,
                                                const Typed& position) override;
  Attempt<tmcl::api::axis::StartedMove> move_by(const std::string& axis,
                                                const Typed& distance) override;
  Attempt<tmcl::api::axis::Turning> rotate(const std::string& axis, const Typed& velocity,
                                           bool unattended) override;
  Attempt<void> stop(const std::string& axis) override;
  Attempt<std::vector<StoppedAxis>> stop_all() override;
  Attempt<AxisReading> state(const std::string& axis) override;
  Attempt<void> watch(const std::string& axis, tmcl::Duration interval,
                      const ReadingHandler& on_reading) override;
  Attempt<Warnings> wait(const Wait& wait,
                         const std::function<void(const AxisReading&)>& on_reading) override;
  Attempt<void> watch_axes(const std::vector<std::string>& axes, tmcl::Duration interval,
                           const AxesWatcher& watcher) override;
  Attempt<void> reopen() override { return door_->reopen(); }
  Attempt<RawAnswer> raw(const RawCommand& command) override;
  Attempt<tmcl::FirmwareMatch> match_firmware(const ModuleName& module,
                                              const tmcl::firmware::Image& image) override;
  Attempt<tmcl::FirmwareReport> upload_firmware(const ModuleName& module,
                                                const tmcl::firmware::Image& image,
                                                const tmcl::FirmwareOptions& options) override;
  Attempt<void> hear_arrivals(const ModuleName& module, const std::function<Attempt<void>()>& ask,
                              const ArrivalHandler& on_arrival) override;
  Attempt<boost::json::object> perform(const std::string& method, boost::json::object params,
                                       const NewsHandler& on_news) override;
  Attempt<boost::json::object> perform_watched(const std::string& method,
                                               boost::json::object params, const std::string* text,
                                               const Watcher& watcher) override;
  void sleep(tmcl::Duration duration) override { door_->sleep(duration); }
  Attempt<void> see_through(bool tell, Output& output) override {
    return door_->see_through(tell, output);
  }
  std::string options() const override { return options_; }

 private:
  Attempt<std::vector<AxisRow>> found_axes();
  Attempt<std::vector<StoppedAxis>> stop_found();
  void stop_motors(const ModuleRow& module, std::vector<StoppedAxis>& stopped);
  Attempt<Warnings> await_standing(const Wait& wait);
  void add_reasons(std::vector<AxisRow>& axes);
  Attempt<boost::json::object> call(std::string_view method, boost::json::object params);
  AxisReading reading_from(const tmcl::api::axis::State& state) const;
  Attempt<tmcl::api::OnModule> params_for(const ModuleName& module);
  Attempt<tmcl::api::bus::Bus> bus_named(const std::string& name);

  std::unique_ptr<Door> door_;
  std::string options_;
  AxesFrom axes_from_;
  Host& host_;
};

}  // namespace tmclctl
