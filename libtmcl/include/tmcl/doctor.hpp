/// What a person looks at in front of a machine that does not work, in this order: each question,
/// and what to do where its answer is wrong. `tmclctl doctor` asks them, and
/// docs/TROUBLESHOOTING.md has them as a table.
///
/// Does no I/O.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl {

enum class Check : std::uint8_t {
  // Of the computer.
  port,
  access,
  holder,
  modem_manager,
  latency,
  gateway,
  clock,
  stalls,
  journal,
  // Of a bus.
  bus,
  replies,
  noise,
  // Of a module.
  module,
  address,
  model,
  program,
  restart,
  settings,
  deadman,
  // Of an axis.
  motor,
  supply,
  temperature,
  driver,
  current,
  velocity,
  acceleration,
  resolution,
  latch,
  reference,
  limits,
  switches,
  restored,
  stop,
};

struct CheckInfo {
  Check check;
  std::string_view name;
  std::string_view question;
  std::string_view cure;  ///< What to do where it is wrong; {} is a name, such as of the axis.
};
/// By their numbers.
std::span<const CheckInfo> checks();
const CheckInfo& info_of(Check check);

/// The answer to a question.
struct Finding {
  Check check{};
  std::string subject{};  ///< "x", "bench", "bench:1" or "/dev/ttyUSB0"; empty: tmcld itself.
  bool wrong = false;
  std::string text{};  ///< A sentence without a full stop.
  std::string cure{};  ///< Of what was found; empty: that of its check.
};

/// Its own cure, or that of its check, for its subject.
std::string cure_of(const Finding& finding);

}  // namespace tmcl
