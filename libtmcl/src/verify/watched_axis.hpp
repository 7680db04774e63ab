/// An axis that is moved a little to see what it does: sent, watched, set, and left as it was.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "tmcl/verification.hpp"
#include "verify/chip_candidates.hpp"

namespace tmcl::verbs {

class WatchedAxis {
 public:
  /// `settings`: what it has, and is given back.
  WatchedAxis(AxisAddress axis, std::vector<plan::Setting> settings)
      : axis_(axis), settings_(std::move(settings)) {}

  /// Where it stands is where it ends. Errors: Errc::bad_argument if it moves.
  Script<Result<void>> begin();
  Microsteps home() const { return {home_}; }

  Script<Result<std::int32_t>> ask(Command command, std::uint8_t type, std::int32_t value = 0);
  Script<Result<std::int32_t>> get(std::uint8_t parameter) { return ask(Command::GAP, parameter); }
  /// One exchange, with its times.
  Script<Result<Answer>> exchange_once(Command command, std::uint8_t type, std::int32_t value);
  /// What its module has already is not set again.
  Script<Result<void>> set(plan::Setting setting);
  /// It may have another value than it was set to.
  void forget(std::uint8_t parameter) { held_.erase(parameter); }
  Script<Result<void>> set(const plan::Experiment& experiment);

  /// Sends it there, and watches it until it has arrived.
  /// Errors: Errc::move_interrupted if it has not within `limit`.
  Script<Result<plan::WatchedMove>> move_to(std::int32_t target, Duration limit);
  /// Sends it to where it was in the beginning, unless it stands there.
  Script<Result<void>> go_home();
  /// The same for an axis that may be anywhere.
  Script<Result<void>> return_home();
  /// Stops it.
  Script<Result<void>> stop();
  /// What was done with it has come to this: it is stopped if it failed, and has again what it had
  /// before. Errors: of `done`; of the last setting that could not be given back.
  Script<Result<void>> end(Result<void> done);

  /// It is there when it should be on its target.
  Error interrupted(std::int32_t target, std::int32_t here) const;
  /// What an exchange takes as a rule, and the least that one has taken.
  Duration usual_exchange() const;
  Duration quickest_exchange() const;

 private:
  Script<Result<void>> put_back();
  Script<Result<void>> stand(std::int32_t target, TimePoint limit);
  Script<Result<void>> set_all(std::vector<plan::Setting> settings);

  AxisAddress axis_;
  std::vector<plan::Setting> settings_;
  std::map<std::uint8_t, std::int32_t> held_;
  std::int32_t home_ = 0;
  std::int32_t here_ = 0;  ///< Where it stood last.
  std::vector<Duration> exchanges_;
};

}  // namespace tmcl::verbs
