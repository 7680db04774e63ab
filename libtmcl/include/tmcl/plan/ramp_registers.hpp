/// Axis parameters as the registers of a ramp generator, by the tables of the model: for what is
/// computed of an axis that need not be there.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/conversion.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/unit_mode.hpp"

namespace tmcl::plan {

struct RegisterWrite {
  std::size_t index = 0;  ///< Of the generator's registers.
  std::int64_t value = 0;
  bool operator==(const RegisterWrite&) const = default;
};

class RampRegisters {
 public:
  /// In the units that a module starts with. Nothing for a model whose firmware makes the ramps.
  static std::optional<RampRegisters> of(const Model& model);

  /// What its generator is called: "tmc429".
  std::string_view chip() const { return chip_; }
  std::span<const ramp::RegisterInfo> registers() const { return registers_; }
  const UnitMode& unit_mode() const { return unit_mode_; }
  /// As parameter 255 does: what is written from now on counts so.
  void count_in_pps(bool pps) { unit_mode_.set(pps); }

  /// What sets the ramp and the place to go to; a velocity is turned at in the mode for that.
  /// Empty for a parameter that is in no register of the generator, and for what does not fit.
  std::vector<RegisterWrite> writes_of(const ParameterInfo& row, std::int32_t value) const;
  /// What a module writes when it starts.
  std::vector<RegisterWrite> initial_writes() const;
  /// What a velocity or an acceleration in its register is, in microsteps and seconds; `units`: of
  /// the module, whose dividers count on a TMC429.
  double in_microsteps(const ParameterInfo& row, std::int64_t value,
                       const ModuleUnits& units) const;
  /// The parameter that is in this register; null where there is none.
  const ParameterInfo* row_of(std::size_t index) const;

 private:
  RampRegisters(const Model& model, std::string_view chip,
                std::span<const ramp::RegisterInfo> registers, UnitMode unit_mode)
      : model_(&model), chip_(chip), registers_(registers), unit_mode_(unit_mode) {}
  std::optional<std::size_t> index_of(const ParameterInfo& row) const;
  std::vector<RegisterWrite> turning(std::int64_t velocity) const;
  RegisterWrite named(std::string_view name, std::int64_t value) const;

  const Model* model_;
  std::string_view chip_;
  std::span<const ramp::RegisterInfo> registers_;
  UnitMode unit_mode_;
};

}  // namespace tmcl::plan
