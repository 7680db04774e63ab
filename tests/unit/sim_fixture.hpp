/// A bench in virtual time with one serial line and one CAN bus, and a host's hands on both.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "sim/bench.hpp"
#include "sim/wire/can_line.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {

using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

class SimTest : public testing::Test {
 protected:
  Module& add(std::uint16_t model, std::uint16_t address = 1) {
    return bench.add(*find_model(model), ModuleAddress{address});
  }
  // With a stage for its first motor.
  Module& add(std::uint16_t model, const StageSettings& stage) {
    auto& module = add(model);
    module.mount(0, stage);
    return module;
  }

  // Lets time pass, with the bench awake whenever it asked to be.
  void pass(Duration duration) {
    const auto until = clock.now() + duration;
    bench.run_due();
    for (auto due = bench.next_due(); due <= until; due = bench.next_due()) {
      clock.advance_to(std::max(due, clock.now()));
      bench.run_due();
    }
    clock.advance_to(until);
    bench.run_due();
  }

  // All bytes that the line has sent since the last call.
  Bytes heard() { return std::exchange(sent, {}); }
  std::vector<CanFrame> frames() { return std::exchange(can_sent, {}); }

  Bytes exchange(const Bytes& bytes) {
    heard();
    line.receive(bytes);
    return heard();
  }

  // The reply to a request; none if there was silence. More than one is an error.
  std::optional<Reply> ask(const Request& request) {
    const auto request_bytes = encode_serial(request);
    const auto bytes = exchange(Bytes(request_bytes.begin(), request_bytes.end()));
    if (bytes.empty()) return std::nullopt;
    return reply_in(bytes);
  }
  std::optional<Reply> ask(Command command, std::uint8_t type, std::uint8_t motor,
                           std::int32_t value = 0) {
    return ask({ModuleAddress{1}, command, type, motor, value});
  }

  std::optional<Reply> reply_in(const Bytes& bytes) {
    if (bytes.size() != serial_datagram_size) {
      ADD_FAILURE() << bytes.size() << " bytes are no reply";
      return std::nullopt;
    }
    return decode_serial_reply(std::span<const std::uint8_t, 9>(bytes.data(), 9));
  }

  Status status_of(Command command, std::uint8_t type, std::uint8_t motor, std::int32_t value = 0) {
    return ask(command, type, motor, value).value_or(Reply{.status = Status{0}}).status;
  }
  std::int32_t get(std::uint8_t parameter, std::uint8_t motor = 0) {
    return ask(Command::GAP, parameter, motor).value_or(Reply{.value = INT32_MIN}).value;
  }

  VirtualClock clock;
  Bench bench{clock};
  Bytes sent;
  std::vector<CanFrame> can_sent;
  SerialLine line{bench, [this](std::span<const std::uint8_t> bytes) {
                    sent.insert(sent.end(), bytes.begin(), bytes.end());
                  }};
  CanLine can{bench, [this](const CanFrame& frame) { can_sent.push_back(frame); }};
};

/// With hands on the stage of the first motor of the first module, too.
class SimStageTest : public SimTest {
 protected:
  void set(std::uint8_t parameter, std::int32_t value) {
    EXPECT_EQ(status_of(Command::SAP, parameter, 0, value), Status::ok) << int{parameter};
  }
  void at_stage(const std::function<void(Stage&)>& change) {
    bench.modules().front()->at_stage(0, change);
  }
  void load(std::int32_t value) {
    at_stage([&](Stage& stage) { stage.set_load(value); });
  }
};

}  // namespace tmcl::sim
