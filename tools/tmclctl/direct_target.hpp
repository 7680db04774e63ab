/// Axes straight on a bus that this program opens for itself.
#pragma once

#include <map>
#include <span>
#include <string>

#include "names.hpp"
#include "target.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmclctl {

class DirectTarget final : public Target {
 public:
  static Attempt<std::unique_ptr<Target>> open(const std::string& link_name,
                                               std::int32_t full_steps, tmcl::Duration wait,
                                               Patience& patience);
  DirectTarget(tmcl::blocking::Bus bus, tmcl::Framing framing, std::int32_t full_steps,
               Patience& patience);

  Attempt<ScanResult> scan(ScanRange range, const Progress& progress) override;
  Attempt<std::vector<ModuleRow>> modules() override;
  Attempt<std::vector<AxisRow>> axes() override;
  Attempt<std::vector<ParameterRow>> parameters(const std::string& axis) override;
  Attempt<ParameterValue> get(const std::string& axis, const std::string& parameter) override;
  using Target::set;
  Attempt<ParameterValue> set(const std::string& axis, const std::string& parameter,
                              const Typed& value) override;
  Attempt<AxisUnits> units(const std::string& axis) override;
  Attempt<StartedMove> move_to(const std::string& axis, const Typed& position) override;
  Attempt<StartedMove> move_by(const std::string& axis, const Typed& distance) override;
  Attempt<Turning> rotate(const std::string& axis, const Typed& velocity) override;
  Attempt<void> stop(const std::string& axis) override;
  Attempt<std::vector<StoppedAxis>> stop_all() override;
  Attempt<AxisReading> state(const std::string& axis) override;
  Attempt<void> watch(const std::string& axis, tmcl::Duration interval,
                      const ReadingHandler& on_reading) override;
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
  std::string options() const override;

 private:
  /// What direct_methods.cpp has: what one method does.
  using Do = Attempt<boost::json::object> (DirectTarget::*)(const boost::json::object& params,
                                                            const NewsHandler& on_news);
  struct DirectMethod {
    std::string_view name;
    Do run;
  };
  static std::span<const DirectMethod> methods();
  Attempt<boost::json::object> home(const boost::json::object& params, const NewsHandler& on_news);
  Attempt<boost::json::object> start_home(const boost::json::object& params, const NewsHandler&);
  Attempt<boost::json::object> load(const boost::json::object& params, const NewsHandler& on_news);
  Attempt<boost::json::object> compare(const boost::json::object& params,
                                       const NewsHandler& on_news);
  Attempt<boost::json::object> read(const boost::json::object& params, const NewsHandler& on_news);
  Attempt<boost::json::object> store_all(const boost::json::object& params, const NewsHandler&);
  Attempt<boost::json::object> load_all(const boost::json::object& params, const NewsHandler&);
  /// Verbs of an axis, of a parameter of it, and of a module.
  template <auto Verb>
  Attempt<boost::json::object> on_axis(const boost::json::object& params, const NewsHandler&);
  template <auto Verb>
  Attempt<boost::json::object> on_parameter(const boost::json::object& params, const NewsHandler&);
  template <auto Verb>
  Attempt<boost::json::object> on_global(const boost::json::object& params, const NewsHandler&);
  template <auto Verb>
  Attempt<boost::json::object> on_module(const boost::json::object& params, const NewsHandler&);

  /// Errors: the name of a bus.
  static Attempt<tmcl::ModuleAddress> address_of(const ModuleName& module);
  Attempt<tmcl::blocking::Axis> axis_at(const std::string& name);
  /// What the module of an axis is to hold in a parameter.
  Attempt<std::int32_t> in_module(const std::string& text, const std::string& axis,
                                  std::uint8_t parameter);
  /// Null for a model that is not known.
  Attempt<const tmcl::Model*> model_of(tmcl::ModuleAddress module);
  std::optional<tmcl::plan::AxisTwin> twin_of(tmcl::blocking::Axis& at);
  template <class Move>
  Attempt<StartedMove> start(const std::string& axis, Move move);
  /// Whether a value may be written, as far as the table of the model tells.
  Attempt<void> check(tmcl::ModuleAddress module, std::uint8_t parameter, std::int32_t value);
  Attempt<void> check_mode(tmcl::ModuleAddress module, std::optional<std::int32_t> mode);
  Attempt<std::span<const tmcl::ParameterInfo>> table_of(tmcl::ModuleAddress module);
  Attempt<ParameterName> parameter_of(tmcl::ModuleAddress module, const std::string& text);
  void stop_motors(const tmcl::FoundModule& module, std::vector<StoppedAxis>& stopped);

  tmcl::blocking::Bus bus_;
  tmcl::Framing framing_;
  std::int32_t full_steps_;
  Patience& patience_;
  /// Of the modules that were asked what they are.
  std::map<tmcl::ModuleAddress, const tmcl::Model*> models_;
};

}  // namespace tmclctl
