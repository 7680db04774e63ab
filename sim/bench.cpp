#include "sim/bench.hpp"

#include <algorithm>
#include <utility>

namespace tmcl::sim {

Module& Bench::add(const Model& model, ModuleAddress address, const ModuleSettings& settings) {
  return *modules_.emplace_back(std::make_unique<Module>(model, address, *clock_, settings));
}

Module& Bench::add(const Model& model, Eeprom eeprom, const ModuleSettings& settings) {
  return *modules_.emplace_back(
      std::make_unique<Module>(model, std::move(eeprom), *clock_, settings));
}

void Bench::detach(Line& line) {
  for (const auto& module : modules_) module->forget(line);
  std::erase(lines_, &line);
}

TimePoint Bench::next_due() const {
  auto due = never;
  for (const auto& module : modules_) due = std::min(due, module->next_due());
  for (const auto* line : lines_) due = std::min(due, line->next_due());
  return due;
}

void Bench::run_due() {
  for (const auto& module : modules_) module->run_due();
  for (auto* line : lines_) line->run_due();
}

}  // namespace tmcl::sim
