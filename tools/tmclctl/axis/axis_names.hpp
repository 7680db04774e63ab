/// Reading what a person typed: axes and parameters, with a suggestion when it is not understood.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "output/errors.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmclctl {

/// "1/0": motor 0 of module 1, as axes without names are called.
std::string axis_name(tmcl::AxisAddress axis);

struct ModuleName {
  std::string bus;  ///< Empty: the only one there is.
  std::uint16_t address = 0;
};
/// "1", or "bench:1" where tmcld has several buses.
Result<ModuleName> parse_module(std::string_view text);

struct AxisPlace {
  ModuleName module;
  std::uint8_t motor = 0;
};
/// "1/0" or "bench:1/0"; nothing for a configured name.
std::optional<AxisPlace> parse_axis_place(std::string_view text);

struct ParameterName {
  std::uint8_t number = 0;
  std::string name;  ///< The standard name, or the number as text.
};

/// A number 0..255, or a name or an alias from the table.
Result<ParameterName> parse_parameter(std::span<const tmcl::ParameterInfo> table,
                                      std::string_view text);

/// "TMCM-1110", "tmcm1110" or "1110".
Result<const tmcl::Model*> parse_model(std::string_view name);

/// The axis parameters of modules whose model is not known: those that mean the same wherever they
/// exist, with the names that do.
std::span<const tmcl::ParameterInfo> common_parameters();
/// The same of the global parameters of bank 0.
std::span<const tmcl::ParameterInfo> common_global_parameters();

}  // namespace tmclctl
