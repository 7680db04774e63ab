/// Which modules to simulate: "TMCM-1110" or "TMCM-1110@3".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "sim/module/module_settings.hpp"
#include "sim/stage/stage.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"

namespace tmclsim {

/// What a module measures of its surroundings; nothing: what it measures without being told.
struct Surroundings {
  std::optional<std::int32_t> supply_tenths{};  ///< Of the motors: volts, in tenths.
  std::optional<std::int32_t> temperature{};    ///< Degrees centigrade.
};

struct ModuleSpec {
  const tmcl::Model* model = nullptr;
  tmcl::ModuleAddress address{1};
  std::vector<tmcl::sim::StageSettings> stages{};  ///< For as many of its motors as there are.
  tmcl::sim::ModuleSettings settings{};
  Surroundings surroundings{};
};

/// One spec for each text. Without an address a module gets the lowest, from 1 on, that no other
/// one has. Two modules may be given the same address: hosts have to cope with that too. The error
/// is a sentence that names the offender.
tl::expected<std::vector<ModuleSpec>, std::string> parse_modules(
    const std::vector<std::string>& texts);

/// A sentence for every address that several modules share.
std::vector<std::string> shared_addresses(const std::vector<ModuleSpec>& modules);

}  // namespace tmclsim
