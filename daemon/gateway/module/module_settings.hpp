/// The settings of a module in one go: read, written, kept in its EEPROM.
///
/// They are written while all of its axes are claimed and stand where they were sent to: what is
/// written may let a motor go on that a limit, a current of 0 or a velocity of 0 keeps. What others
/// are counted in is written first, and then only what still differs.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gateway/axis/axis.hpp"
#include "tmcl/settings.hpp"

namespace tmcld {

class Gateway;

/// Whose settings, and for whom.
struct SettingsTask {
  std::shared_ptr<Gateway> gateway;
  std::shared_ptr<GatewayBus> bus;
  tmcl::ModuleAddress address{};
  Permit permit{};         ///< Of the call; see Gateway::admit().
  bool by_itself = false;  ///< The gateway does so, for no client: also to axes that are leased.
  std::function<void(const std::string& what)> tell = [](const std::string&) {};
};

struct RefusedSetting {
  tmcl::SettingValue setting;
  tmcl::Error error;
};
struct LoadedSettings {
  /// Why nothing was written: a motor could move, or a program runs. Of a call that was allowed.
  std::optional<tmcl::Error> objection{};
  std::vector<tmcl::SettingDifference> written{};  ///< `present`: before that.
  std::vector<RefusedSetting> refused{};
  /// From what was wanted, when all was written.
  std::vector<tmcl::SettingDifference> differing{};
};
struct KeptSettings {
  std::size_t stored = 0;
  std::vector<RefusedSetting> refused{};
};

template <class T>
using SettingsAnswer = GatewayAxis::Awaitable<T>;

/// All of a module, and what is told only. Errors: those of the exchanges; Errc::bad_argument for a
/// model that is not known.
SettingsAnswer<tmcl::Settings> read_settings(SettingsTask task);
/// What loading these would change.
/// Errors: the same; Errc::bad_argument where they are of another model.
SettingsAnswer<std::vector<tmcl::SettingDifference>> compare_settings(
    SettingsTask task, std::shared_ptr<const tmcl::Settings> wanted);
/// Errors: the same; Errc::axis_claimed and Errc::leased as for a movement. When the module falls
/// silent, some may have been written: Outcome::unknown.
SettingsAnswer<LoadedSettings> load_settings(SettingsTask task,
                                             std::shared_ptr<const tmcl::Settings> wanted);
/// Copies what the module has now to its EEPROM: of one motor, or all.
SettingsAnswer<KeptSettings> store_settings(SettingsTask task, std::vector<tmcl::SettingKey> keys);

/// "max_current of motor 0 is 128, not 100"; `of`: the model.
std::string describe(const tmcl::SettingDifference& difference, const tmcl::Model& of);

}  // namespace tmcld
