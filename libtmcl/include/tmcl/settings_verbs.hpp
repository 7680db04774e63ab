/// Reading, writing and keeping the settings of a module: see tmcl/settings.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tmcl/script.hpp"
#include "tmcl/settings.hpp"

namespace tmcl {

/// Called after each few of them.
using OnSettingsRead = std::function<void(std::size_t done, std::size_t of)>;

namespace verbs {

/// The values of these settings, in their order; those that the module refuses are left out, as
/// older firmware does.
/// Errors: those of the exchanges, but not refusals.
Script<Result<std::vector<SettingValue>>> read_settings(ModuleAddress module,
                                                        std::vector<SettingKey> keys,
                                                        OnSettingsRead progress = {});
/// Copies the value that a setting has now to the EEPROM. Global parameters of bank 0 need none:
/// the module keeps those from 64 to 127 by itself.
/// Errors: those of the exchange.
Script<Result<void>> store_setting(ModuleAddress module, SettingKey key);

}  // namespace verbs
}  // namespace tmcl
