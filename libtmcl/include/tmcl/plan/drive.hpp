/// Several axes that are moved together: what to tell which of them when, without I/O.
///
/// Its runner asks for the next step, carries it out, and reports the result:
///
///     while (true) {
///       const auto step = drive.next(clock.now());
///       if (std::holds_alternative<DriveEnd>(step)) break;
///       if (const auto* wait = std::get_if<DriveWait>(&step)) sleep until wait->until;
///       if (const auto* commands = std::get_if<DriveCommands>(&step))
///         for (const auto& command : *commands)
///           drive.answered(clock.now(), command.axis, do(command));
///     }
///
/// The commands of one step may be under way at the same time; each is told as soon as it has been
/// answered, and further ones may follow before the others are. An axis has one at a time.
///
/// What goes wrong on the way ends a drive: all axes are stopped, and the settings that it has
/// changed are set back, the last one first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/error.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

struct DriveCommand {
  enum class Kind : std::uint8_t {
    get,             ///< Read an axis parameter.
    set,             ///< Write one.
    rotate,          ///< ROR, or ROL for a negative value.
    move_to,         ///< MVP ABS.
    stop,            ///< MST.
    set_coordinate,  ///< SCO of a coordinate that the runner chooses.
    move_motors,     ///< MVP COORD to that one, of the motors of the axis' module in `value`.
    carry_out,       ///< The M word of this number, or nothing if none is there for it.
  };
  Kind kind = Kind::get;
  std::size_t axis = 0;        ///< Of carry_out their number: it is for none of them.
  std::uint8_t parameter = 0;  ///< Of get and set.
  std::int32_t value = 0;      ///< Of all but get and stop.
  /// May be given more than once, and late: a link that is lost for a moment may be waited for.
  bool may_wait = false;
  /// Of set: as it was before the drive, which sets it back in the end.
  std::optional<std::int32_t> before{};
  bool operator==(const DriveCommand&) const = default;
};
using DriveCommands = std::vector<DriveCommand>;
/// Until then, or until an answer comes.
struct DriveWait {
  TimePoint until;
};
struct DriveEnd {};
using DriveStep = std::variant<DriveCommands, DriveWait, DriveEnd>;

/// Why axes did not get to the end of their way.
struct DriveFault {
  enum class Kind : std::uint8_t {
    asked,         ///< stop() was called without a reason of its own.
    refused,       ///< A command failed.
    foreign,       ///< An axis does not do what it was told.
    starved,       ///< Updates came too late.
    off_course,    ///< A reading was too far off.
    not_at_start,  ///< Nothing has moved.
    unsuited,      ///< The course or an axis is not for this mode. Nothing has moved.
    slow_bus,      ///< The bus does not carry this course in this mode. Nothing has moved.
    no_end,        ///< An axis did not come to its end, or to rest.
  };
  Kind kind = Kind::asked;
  std::optional<std::size_t> axis{};  ///< Of what concerns one axis.
  /// What is said of that axis, "is moving"; without one, a sentence without a full stop. Empty
  /// where the error says it all.
  std::string message{};
  std::optional<Error> error{};           ///< What a command came to.
  std::optional<Microsteps> stands_at{};  ///< Of an axis that stands short of its end.
};

/// An axis that could not be stopped, or was not seen to stand after that, and may still move.
struct Unstopped {
  std::size_t axis = 0;
  Error why;
};
/// A setting that could not be set back, or was not, because the axis may still move.
struct Unrestored {
  std::size_t axis = 0;
  Setting before;
  Error why;
};

/// An M word that was to switch something off when the drive ended early.
struct Unswitched {
  std::uint8_t word = 0;
  Error why;
};

struct DriveReport {
  std::optional<DriveFault> fault;
  std::vector<Unstopped> unstopped;
  std::vector<Unrestored> unrestored;
  std::vector<Unswitched> unswitched{};
};

/// So long an axis may be seen standing short of its end before it counts as stopped.
constexpr Duration most_standing = std::chrono::milliseconds(60);
/// So long it may stand before it begins, and so long a reading may be older than its start.
constexpr Duration time_to_begin = std::chrono::milliseconds(200);

class DriveRunner;

class Drive {
 public:
  virtual ~Drive();

  DriveStep next(TimePoint now);
  /// A command of the axis has been answered, by what was read or 0.
  void answered(TimePoint now, std::size_t axis, Result<std::int32_t> answer);
  /// Ends it early. `why` becomes the report's fault, unless there is one already.
  void stop(DriveFault why = {DriveFault::Kind::asked, {}, "stopped"});

 protected:
  explicit Drive(std::unique_ptr<DriveRunner> runner);
  Drive(Drive&&) noexcept;
  Drive& operator=(Drive&&) noexcept;

  std::unique_ptr<DriveRunner> runner_;
};

}  // namespace tmcl::plan
