/// Modules of the simulator behind a FakeWire.
#pragma once

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/bench.hpp"
#include "sim/wire/serial_line.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

class SimulatedModules {
 public:
  explicit SimulatedModules(const tmcl::Clock& clock) : bench_(clock) {}

  /// The module on the wire asks this one, and so must not outlive it.
  void add(FakeWire& wire, std::string_view model, std::uint16_t address) {
    bench_.add(*tmcl::find_model(model), tmcl::ModuleAddress{address});
    const auto number = static_cast<std::uint8_t>(address);
    wire.modules.emplace(number, FakeModule(number)).first->second.play =
        [this](const tmcl::Request& request) {
          auto reply = carry_out(request);
          if (on_request) on_request();
          return std::optional(reply);
        };
  }
  /// Called on the daemon's thread, after each.
  std::function<void()> on_request;
  /// Of a motor, as it is now.
  std::int32_t get(std::uint16_t address, std::uint8_t parameter, std::uint8_t motor) {
    return carry_out({tmcl::ModuleAddress{address}, tmcl::Command::GAP, parameter, motor, 0}).value;
  }
  tmcl::Reply carry_out(const tmcl::Request& request) {
    bench_.run_due();
    answer_.clear();
    line_.receive(tmcl::encode_serial(request));
    return *tmcl::decode_serial_reply(std::span<const std::uint8_t, 9>(answer_.data(), 9));
  }

 private:
  tmcl::sim::Bench bench_;
  std::vector<std::uint8_t> answer_;
  tmcl::sim::SerialLine line_{bench_,
                              [this](auto bytes) { answer_.assign(bytes.begin(), bytes.end()); }};
};

}  // namespace tmcld::test
