/// What clients do to axes that turn, by every door, and the module that tells whether they do.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fronts/session.hpp"
#include "support/random.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter_number.hpp"
#include "unit/port_fixture.hpp"
#include "world/cable.hpp"

namespace tmcld::test {

constexpr std::array<std::string_view, 4> one_of_each_family{"TMCM-3110", "TMCM-6212", "TMCM-142",
                                                             "TMCM-3351"};

/// What a client can do: a call, which may be a raw command.
struct Write {
  std::string method;
  json::object params;
  std::optional<Request> raw{};
};

inline std::string said(const Write& write) {
  return write.method + " " + json::serialize(write.params);
}
inline std::string said(const std::vector<Write>& writes) {
  std::string text;
  for (const auto& write : writes) text += said(write) + "; ";
  return text;
}

inline Write call_of(const std::string& method, json::object params) {
  return {method, std::move(params)};
}
inline Write call_of_x(const std::string& method, json::object params) {
  params["axis"] = "x";
  return {method, std::move(params)};
}
inline Write set(std::uint8_t parameter, std::int32_t value) {
  return {"parameter.set",
          {{"axis", "x"}, {"parameter", parameter}, {"value", value}},
          request_of(Command::SAP, parameter, 0, value)};
}
inline Write raw(Command command, std::uint8_t type, std::int32_t value, std::uint8_t motor = 0) {
  return {"module.execute",
          {{"bus", "bench"},
           {"address", 1},
           {"command", static_cast<int>(command)},
           {"type", type},
           {"motor", motor},
           {"value", value}},
          request_of(command, type, motor, value)};
}

/// A module with its axes x and y, which reach positions soon.
class Scene : public CableBench {
 public:
  explicit Scene(std::string_view model, tmcl::VelocityTarget velocity_target = {})
      : CableBench(cable_config, model, tmcl::Framing::serial, settings_with(velocity_target)),
        model_(*tmcl::find_model(model)) {
    const auto table = tmcl::axis_parameters(model_);
    if (const auto mode = tmcl::mode_parameter(table)) ramp_mode = mode->number;
    for (const auto parameter : {ap::max_velocity, ap::max_acceleration}) {
      const auto greatest = find_parameter(table, parameter)->maximum;
      call("parameter.set",
           {{"axis", "x"}, {"parameter", parameter}, {"value", std::min(greatest, 200'000)}});
    }
    speed = find_parameter(table, ap::max_velocity)->maximum > 10'000 ? 20'000 : 500;
  }
  Result<boost::json::object> carry_out(const Write& write) {
    return call(write.method, write.params);
  }
  const tmcl::Model& model() const { return model_; }
  bool turns(std::uint8_t motor) { return get(motor, ap::actual_velocity) != 0; }
  /// Whether all its motors come to stand, and stay so. A move to a position goes on without its
  /// client, and takes an hour where a coordinate of two motors has left one a speed of 2 pps.
  bool stands() {
    using namespace std::chrono_literals;
    constexpr tmcl::Duration long_enough = 24h;
    for (tmcl::Duration pause = 500ms; pause < long_enough; pause += pause / 4) {
      time.run_for(pause);
      if (any_turns()) continue;
      time.run_for(200ms);
      if (!any_turns()) return true;
    }
    return false;
  }
  /// Nothing runs, and no target is far away.
  void begin_anew() {
    using namespace std::chrono_literals;
    other_master(request_of(Command::STOP_APPLICATION, 0));
    for (std::uint8_t motor = 0; motor < model_.axes; ++motor)
      other_master(request_of(Command::MST, 0, motor));
    time.run_for(5s);
    for (std::uint8_t motor = 0; motor < model_.axes; ++motor) {
      other_master(request_of(Command::SAP, ap::actual_position, motor, 0));
      for (std::uint8_t number = 0; number < 4; ++number)
        other_master(request_of(Command::SCO, number, motor, 0));
    }
  }
  std::string state(const char* field) {
    const auto state = call("axis.get_state", {{"axis", "x"}});
    return json::serialize(state.value().at(field));
  }
  std::int32_t speed = 0;
  /// Where a model has none, it refuses this one.
  std::uint8_t ramp_mode = tmcl::number_of(tmcl::Family::tmc429, "ramp_mode");

 private:
  static tmcl::sim::ModuleSettings settings_with(tmcl::VelocityTarget velocity_target) {
    tmcl::sim::ModuleSettings settings;
    settings.traits.set(tmcl::Trait::velocity_target, velocity_target);
    return settings;
  }
  bool any_turns() {
    for (std::uint8_t motor = 0; motor < model_.axes; ++motor)
      if (turns(motor)) return true;
    return false;
  }

  const tmcl::Model& model_;
};

/// A client behind HTTP: of a POST for that call only, of a WebSocket for many.
class WebClient final : public Session {
 public:
  static std::shared_ptr<WebClient> connect(Gateway& gateway) {
    Options options;
    options.name = "web";
    return std::make_shared<WebClient>(gateway, std::move(options));
  }
  WebClient(Gateway& gateway, Options options)
      : Session(gateway.buses().front()->executor(), gateway.shared_from_this(),
                std::move(options)) {}

  void say(const Write& write) {
    take(json::serialize(json::object{
        {"jsonrpc", "2.0"}, {"id", 1}, {"method", write.method}, {"params", write.params}}));
  }
  bool has_answer() { return next_answer().has_value(); }

 private:
  void disconnect() override {}
};

/// The clients of a scene: each says something by its door, and waits for the answer or does not.
class Doors {
 public:
  explicit Doors(Scene& scene)
      : scene_(scene),
        host_(scene, "a", Role::configure),
        web_(WebClient::connect(scene.gateway())) {
    scene.be_another_client();
  }
  Doors(const Doors&) = delete;
  Doors& operator=(const Doors&) = delete;
  ~Doors() { all_leave(); }

  /// Gives by which door, and whether it waited, in words.
  std::string carry_out(const Write& write, tmcl::test::Random<>& random) {
    const bool waits = !random.one_in(4);
    const auto words = (waits ? "" : "(no wait) ") + said(write) + "; ";
    switch (random.between(write.raw ? 0 : 1, 3)) {
      case 0: by_port(*write.raw, waits); return "port: " + words;
      case 1: by_web_socket(write, waits); return "web socket: " + words;
      case 2: by_post(write, waits, random); return "post: " + words;
      default: by_socket(write, waits); return words;
    }
  }
  void all_leave() {
    scene_.client_leaves();
    host_.go();
    web_->close();
  }

 private:
  void by_socket(const Write& write, bool waits) {
    auto answer = scene_.begin(write.method, write.params);
    if (waits) scene_.end(answer);
  }
  void by_port(const Request& request, bool waits) {
    if (waits) {
      host_.ask(request);
    } else {
      host_.say(request);
    }
  }
  void by_web_socket(const Write& write, bool waits) { say(*web_, write, waits); }
  /// One that does not wait hangs up, soon.
  void by_post(const Write& write, bool waits, tmcl::test::Random<>& random) {
    const auto client = WebClient::connect(scene_.gateway());
    say(*client, write, waits);
    if (!waits) scene_.time.run_for(std::chrono::milliseconds(random.between(0, 20)));
    client->close();
  }
  void say(WebClient& client, const Write& write, bool waits) {
    client.say(write);
    if (waits)
      scene_.time.run_while_not([&] { return client.has_answer(); }, std::chrono::hours(1));
  }

  Scene& scene_;
  PortHost host_;
  std::shared_ptr<WebClient> web_;
};

}  // namespace tmcld::test
