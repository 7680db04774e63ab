/// The simulated table: modules on it, and the lines that lead to them.
#pragma once

#include <memory>
#include <vector>

#include "sim/module/module.hpp"
#include "sim/wire/line.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::sim {

/// Every line reaches every module, so that one module can be asked over several ports at once.
/// Nothing here does I/O or waits: the owner calls run_due() at next_due() and after each input.
class Bench {
 public:
  /// The clock, real or virtual, must outlive the bench.
  explicit Bench(const Clock& clock) : clock_(&clock) {}

  Module& add(const Model& model, ModuleAddress address, const ModuleSettings& settings = {});
  /// One that remembers; its address is in the memory.
  Module& add(const Model& model, Eeprom eeprom, const ModuleSettings& settings = {});
  const std::vector<std::unique_ptr<Module>>& modules() const { return modules_; }
  const Clock& clock() const { return *clock_; }

  TimePoint next_due() const;
  void run_due();

 private:
  friend class Line;
  void attach(Line& line) { lines_.push_back(&line); }
  void detach(Line& line);

  const Clock* clock_;
  std::vector<std::unique_ptr<Module>> modules_;
  std::vector<Line*> lines_;
};

}  // namespace tmcl::sim
