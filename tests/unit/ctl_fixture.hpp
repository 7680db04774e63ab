// tmclctl without a process around it, on a gateway whose answers the test writes down.
#pragma once

#include <deque>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <boost/json.hpp>

#include "axis/axis_names.hpp"
#include "command_line/tmclctl.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/hex.hpp"
#include "unit/ctl_host.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl {

/// An error that ends with this exit code, where the outcome leaves that open.
inline Error error_of(ExitCode exit, std::string name, std::string message, std::string hint = {},
                      std::optional<tmcl::Outcome> outcome = {}) {
  using tmcl::Outcome;
  Error error{std::move(name), ErrorKind::failed, Outcome::unknown, std::move(message),
              std::move(hint)};
  if (exit == ExitCode::refused) error.outcome = Outcome::refused;
  if (exit == ExitCode::not_sent) error.outcome = Outcome::not_sent;
  if (exit == ExitCode::not_reached) error.kind = ErrorKind::ended_early;
  if (exit == ExitCode::interrupted) error.kind = ErrorKind::interrupted;
  if (exit == ExitCode::usage) error.kind = ErrorKind::bad_request;
  error.outcome = outcome.value_or(error.outcome);
  return error;
}

}  // namespace tmclctl

namespace tmclctl::test {

namespace api = tmcl::api;

/// A gateway with one bus "b" and one axis "x" that stands at 0. What its methods answer is written
/// down by the test; where a test can be on a real gateway, it is on a CtlBench.
class FakeGateway final : public tmcl::client::Channel {
 public:
  explicit FakeGateway(Host& host) : host_(host) {}

  // What the tests arrange.
  std::map<std::string, std::int32_t> values;  ///< Of parameters, as asked for.
  std::deque<boost::json::object> results;     ///< One after the other, before `result`.
  boost::json::object result;                  ///< Of every method that is none of the axis.
  std::vector<boost::json::object> news{
      boost::json::object{{"phase", "running"}, {"passed_s", 0.5}}};
  std::optional<Error> run_failure;
  std::optional<Error> plan_failure;
  boost::json::object plan;

  // What happened.
  std::vector<std::string> calls;
  std::string run_text;  ///< What was handed over last.

  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   const tmcl::client::CallOptions& options) override {
    const auto handler = handlers_.find(method);
    if (handler != handlers_.end()) return handler->second(params);
    if (method == api::path::Run::method.name || method == api::mint::Run::method.name)
      return run(method, params, options);
    return answer(method, params);
  }
  Result<void> listen(tmcl::Duration at_most) override {
    if (host_.signal() != 0) return tl::unexpected(cancelled());
    host_.sleep(at_most);
    return {};
  }
  void on_notification(Listener listener) override { listener_ = std::move(listener); }
  Result<void> reopen() override { return {}; }
  std::string version() const override { return {}; }

 private:
  static constexpr const char* bus_name = "b";
  using Handler = std::function<Result<boost::json::object>(const boost::json::object&)>;

  static Error cancelled() {
    return error_of(ExitCode::interrupted, std::string(tmcl::client::error_name::cancelled),
                    "interrupted");
  }

  template <class Method>
  std::pair<const std::string_view, Handler> on(
      Result<typename Method::Result> (FakeGateway::*handler)(const Method&)) {
    return {Method::method.name, [this, handler](const boost::json::object& params) {
              return (this->*handler)(api::from_json<Method>(params))
                  .map(api::to_json<typename Method::Result>);
            }};
  }

  void tell(std::string_view method, const boost::json::object& params) {
    // It may be another one afterwards.
    const auto listener = listener_;
    if (listener) listener(method, params);
  }
  Result<api::axis::Axes> axes(const api::axis::List&) {
    return api::axis::Axes{{{"x", "bench", 1, 0, "TMCM-1110", "ready", {}}}};
  }
  Result<boost::json::object> buses(const boost::json::object&) {
    const auto lists_buses = [](const auto& one) { return one.contains("buses"); };
    if (!results.empty() && lists_buses(results.front())) return next_result();
    if (lists_buses(result)) return result;
    api::bus::Bus bus;
    bus.name = bus_name;
    bus.link = "serial:/dev/none@115200";
    bus.state = "open";
    return api::to_json(api::bus::Buses{{bus}});
  }
  static std::string text_of(const api::NameOrNumber& parameter) {
    const auto* number = std::get_if<std::int32_t>(&parameter.said);
    return number != nullptr ? std::to_string(*number) : std::get<std::string>(parameter.said);
  }
  Result<api::parameter::Value> get(const api::parameter::Get& params) {
    const auto parameter = text_of(params.parameter);
    auto name = parse_parameter(common_parameters(), parameter);
    if (!name && values.contains(parameter)) name = ParameterName{0, parameter};
    if (!name) return tl::unexpected(name.error());
    calls.push_back("get " + params.axis + ' ' + name->name);
    api::parameter::Value value{{name->name, name->number}, -1500, {}, {}};
    if (!values.contains(parameter)) return value;
    value.value = values[parameter];
    return value;
  }
  Result<api::Nothing> stop(const api::axis::Stop& params) {
    calls.push_back("stop " + params.axis);
    return {};
  }
  Result<api::axis::State> state(const api::axis::GetState& params) {
    api::axis::State state;
    state.axis = params.axis;
    state.position_reached = true;
    return state;
  }
  Result<api::HandedOver> stage_path(const api::path::Stage& params) {
    if (params.offset == 0) run_text.clear();
    const auto bytes = tmcl::from_hex(params.data).value();
    run_text.append(bytes.begin(), bytes.end());
    return api::HandedOver{static_cast<std::int32_t>(run_text.size())};
  }
  Result<boost::json::object> plan_path(const boost::json::object& params) {
    calls.push_back("path.plan " + boost::json::serialize(params));
    if (plan_failure) return tl::unexpected(*plan_failure);
    return plan;
  }
  Result<boost::json::object> run(std::string_view method, const boost::json::object& params,
                                  const tmcl::client::CallOptions& options) {
    calls.push_back(std::string(method) + ' ' + boost::json::serialize(params));
    for (const auto& one : news) tell(api::progress_notification, one);
    for (int i = 0; i < 20; ++i) {
      host_.sleep(std::chrono::milliseconds(100));
      options.meanwhile();
    }
    if (run_failure) return tl::unexpected(*run_failure);
    return result;
  }
  boost::json::object next_result() {
    auto next = std::move(results.front());
    results.pop_front();
    return next;
  }
  Result<boost::json::object> answer(std::string_view method, const boost::json::object& params) {
    calls.push_back(std::string(method) + ' ' + boost::json::serialize(params));
    tell(api::progress_notification, {{"phase", "writing"}, {"done", 1}, {"of", 2}, {"step", 1}});
    if (host_.signal() != 0) return tl::unexpected(cancelled());
    if (results.empty()) return result;
    return next_result();
  }

  Host& host_;
  Listener listener_;
  const std::map<std::string_view, Handler> handlers_{
      on(&FakeGateway::axes),
      {api::bus::List::method.name, [this](const auto& params) { return buses(params); }},
      on(&FakeGateway::get),
      on(&FakeGateway::stop),
      on(&FakeGateway::state),
      on(&FakeGateway::stage_path),
      {api::path::Plan::method.name, [this](const auto& params) { return plan_path(params); }}};
};

/// Runs one command line against it.
class Ctl {
  FakeHost host_;
  std::unique_ptr<FakeGateway> channel_ = std::make_unique<FakeGateway>(host_);

 public:
  FakeHost& host = host_;
  FakeGateway& target = *channel_;
  Gateway gateway{tmcl::client::Caller(std::move(channel_))};
  Screen screen;  ///< Both streams'. A plain file, unless the test says otherwise.

  std::string out;
  std::string err;

  ExitCode run(const std::vector<std::string>& arguments) {
    std::ostringstream out_stream;
    std::ostringstream err_stream;
    Output output{out_stream, err_stream, screen, screen};
    output.gateway = " --direct can:can0";
    const auto exit = tmclctl::run(arguments, output, host, gateway);
    out = out_stream.str();
    err = err_stream.str();
    return exit;
  }
  /// Runs with --json and reads the one document.
  boost::json::object json(std::vector<std::string> arguments, ExitCode expected = ExitCode::done) {
    arguments.insert(arguments.begin(), "--json");
    const auto exit = run(arguments);
    if (exit != expected) throw std::runtime_error("unexpected exit code; output: " + out + err);
    return boost::json::parse(out).as_object();
  }
};

}  // namespace tmclctl::test
