/// A stand-alone program on a simulated module, command by command, forwards and back.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "sim/bench.hpp"
#include "tmcl/program_debugger.hpp"

namespace tmclsim {

/// Time is virtual: it passes while a command is executed, and stands still between two. What a
/// program does is the same every time, so going back is to do it anew, up to there.
class ProgramBench {
 public:
  /// Adds the one module; called again whenever it begins anew.
  using Build = std::function<void(tmcl::sim::Bench& bench)>;
  /// For one command: a WAIT for what never comes.
  static constexpr tmcl::Duration longest_wait = std::chrono::hours(1);

  ProgramBench(Build build, tmcl::program::Program program);
  ~ProgramBench();

  tmcl::program::Standing look() const;
  /// At most so many commands; it stands before one at a breakpoint, but executes the first anyhow.
  tmcl::program::Standing step(std::uint32_t steps, std::span<const std::uint16_t> breakpoints);
  /// To where it stood so many commands ago, or at its start.
  tmcl::program::Standing back(std::uint32_t steps);
  /// The module as it is switched on.
  tmcl::program::Standing restart();
  /// The program ends, and the motors stop, as soon as their ramps let them.
  tmcl::program::Standing stop();
  /// Errors: why the module does not tell it.
  tl::expected<std::int32_t, std::string> read(const tmcl::program::Watched& watched);

 private:
  struct World;

  tmcl::sim::Answer ask(const tmcl::Request& request);
  /// Until its command is over; false if that takes too long.
  bool step_once();
  void begin();

  Build build_;
  tmcl::program::Program program_;
  std::unique_ptr<World> world_;
  std::uint64_t done_ = 0;  ///< Commands since the start.
};

}  // namespace tmclsim
