/// What happens on the buses without anyone having asked.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tmcld {

/// A setting that is not what it was before a line or path, and is set back later.
struct UnrestoredSetting {
  std::string parameter;
  std::uint8_t number = 0;
  std::int32_t before = 0;
  bool operator==(const UnrestoredSetting&) const = default;
};

struct GatewayEvent {
  enum class Kind : std::uint8_t {
    target_reached,
    duplicate_address,
    link_condition,
    link_lost,
    link_restored,
    module_silent,    ///< A module that answered before does not any more.
    line_broken,      ///< Axes that moved together were stopped, because one did not go as planned.
    path_broken,      ///< The same of axes on a path; also when it was asked for.
    mint_broken,      ///< The same of axes that a Mint program moves.
    jog_broken,       ///< The same of an axis that is jogged.
    approach_broken,  ///< The same of one that comes to its targets from one side.
    lease_lost,       ///< A client has lost the right to move an axis alone.
    owner_lost,       ///< The client has gone for which an axis turned, and it is stopped.
    journal_failed,   ///< What would have to be put in order if the daemon is killed is not kept.
    axis_stopped,     ///< An axis that could not be stopped before stands now, or one that
                      ///< stopped by itself: see cause.
    axis_fault,       ///< The driver of an axis, or its supply, has failed, or works again.
    orphan_stopped,   ///< An axis that another run of the daemon led when it was killed.
    module_answers,   ///< A module was identified, for the first time or again.
    module_in_bootloader,  ///< The same, but no firmware runs in it.
    module_reset,          ///< A module has started again: its axes are latched.
    module_replaced,       ///< A module is another one than before: its axes are latched.
    settings_drift,        ///< The settings of a module are not as in their file: see reason.
    configuration_loaded,  ///< Another one holds: axes may be new, others or gone.
  };
  Kind kind;
  std::string bus;
  std::optional<std::uint16_t> address{};  ///< Where it is about one module.
  std::int32_t value = 0;                  ///< A bit for each motor, where it is about motors.
  std::string text{};
  std::string reason{};      ///< lease_lost: expired, closed or broken; settings_drift: report,
                             ///< restored or not_restored.
  std::string_view cause{};  ///< axis_stopped: the name of a StopCause.
  /// line_broken, path_broken, mint_broken, jog_broken, approach_broken: of the axis.
  std::vector<UnrestoredSetting> unrestored{};
};

/// snake_case; part of the stable interface.
std::string_view name_of(GatewayEvent::Kind kind);

using OnGatewayEvent = std::function<void(const GatewayEvent&)>;

}  // namespace tmcld
