/// The data logger of a simulated module in a module that a test plays.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sim/module/data_logger.hpp"
#include "support/fake_module.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::test {

/// Whose channels read the milliseconds that have passed, and a thousand for each parameter number.
inline sim::DataLogger::Probe logged_at(TimePoint time) {
  return [time](const sim::DataLogger::Channel& channel) {
    const auto passed = time.time_since_epoch() / std::chrono::milliseconds(1);
    return static_cast<std::uint32_t>(passed) + 1000 * (channel.select & 0xFFU);
  };
}

/// Answers RAM_DEBUG from now on. The clock must outlive the module.
inline void give_data_logger(FakeModule& module, const Clock& clock) {
  auto logger = std::make_shared<sim::DataLogger>(TimePoint{});
  module.play = [logger, &clock](const Request& request) -> std::optional<Reply> {
    if (request.command != Command::RAM_DEBUG) return std::nullopt;
    for (auto due = logger->next_due(); due <= clock.now(); due = logger->next_due())
      logger->run_due(due, logged_at(due));
    const auto answer = logger->execute(request, clock.now(), logged_at(clock.now()));
    return Reply{default_host_address, reply_byte(request.address), answer.status, request.command,
                 answer.value};
  };
}

}  // namespace tmcl::test
