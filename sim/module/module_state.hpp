/// What a module is made of, for those who carry out its commands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "sim/module/answer.hpp"
#include "sim/module/axis.hpp"
#include "sim/module/bootloader.hpp"
#include "sim/module/coordinates.hpp"
#include "sim/module/data_logger.hpp"
#include "sim/module/eeprom.hpp"
#include "sim/module/globals.hpp"
#include "sim/module/heartbeat.hpp"
#include "sim/module/io.hpp"
#include "sim/module/module_settings.hpp"
#include "sim/module/target_events.hpp"
#include "sim/stage/stage.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {

/// Where the EEPROM keeps a parameter of an axis.
EepromCell axis_cell(std::size_t motor, std::uint8_t number);

struct ModuleState {
  ModuleState(const Model& of, Eeprom memory, const Clock& time, const ModuleSettings& made);

  bool has_motor(const Request& request) const { return request.motor < axes.size(); }
  /// Motors begin anew, with what is in the EEPROM.
  void build_axes();
  void restore_axis(std::size_t motor);
  /// As the global parameters say that are about all motors.
  void wire_axes();
  void stop_motor(std::size_t motor);
  void stop_all_motors();
  /// The motors that an MVP of this one moves: bit n for motor n.
  std::uint32_t companions(std::size_t motor) const;
  bool shut_down() const;
  bool has_letter() const;
  bool keeps_coordinates() const;
  /// Of the firmware that it came with.
  FirmwareVersion delivered_version() const;
  /// Of its firmware or, while it is in there, of its bootloader.
  FirmwareVersion version() const { return in_bootloader ? bootloader.version() : firmware; }
  /// What a wrong code is answered by, where the manual's firmware refuses it so.
  Status wrong_code(Status refusal) const {
    return settings.behaviour == Behaviour::lite ? Status::ok : refusal;
  }

  const Model* model;
  const Clock* clock;
  ModuleSettings settings;
  TimePoint now;  ///< How far the module has come: never later than the clock.
  TimePoint deaf_until;
  Eeprom eeprom;
  Globals globals;
  Io io;
  Coordinates coordinates;
  std::vector<Stage> stages;  ///< What is bolted on stays, whatever happens to the module.
  std::deque<Axis> axes;
  TargetEvents events;
  DataLogger logger;
  std::optional<bool> shutdown_input;  ///< Nothing connected: it does not act.
  Heartbeat serial;
  Heartbeat can;
  Bootloader bootloader;
  FirmwareVersion firmware;
  bool in_bootloader = false;
  bool in_ascii_mode = false;
  bool bootloader_wanted = false;  ///< At the next start.
  bool restarts = false;           ///< As soon as the present command is answered.
};

}  // namespace tmcl::sim
