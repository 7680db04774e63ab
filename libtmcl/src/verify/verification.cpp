#include "tmcl/verification.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "motion/twin/divisors.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/verbs.hpp"
#include "verify/chip_trials.hpp"
#include "verify/inquiry.hpp"
#include "verify/watched_axis.hpp"

namespace tmcl {
namespace verbs {
namespace {

namespace ap = axis_parameter;
namespace gp = global_parameter;
using namespace std::chrono_literals;
using plan::Experiment;

/// What a divider is written to has four bits.
constexpr std::int32_t beyond_divider = 16;

// For the relative move: some 40 microsteps a second, for a second and a half.
constexpr Experiment stroll{168, 500, 1, {10, 7}, 1};
constexpr double stroll_pps = 40;
constexpr std::int32_t stroll_distance = 60;
constexpr std::int32_t least_stroll = 10;
constexpr int strolls = 3;
constexpr Duration longest_stroll = 20s;

/// A late answer to another address has come by then.
constexpr Duration stray_time = 200ms;

class Verifier {
 public:
  Verifier(AxisAddress axis, VerifyOptions options)
      : axis_(axis), inquiry_(std::move(options)), watched_(axis, inquiry_.options().settings) {}

  Script<Result<Verification>> run();

 private:
  Script<Result<void>> course();
  Script<Result<void>> questions();
  Script<Result<void>> movements();
  Script<Result<void>> ask_version();
  Script<Result<void>> ask_another_address();
  Script<Result<void>> ask_program_state();
  Script<Result<void>> set_beyond_range();
  Script<Result<std::int32_t>> set_slow();
  Script<Result<void>> move_relatively();
  Script<Result<bool>> move_relatively_once(std::int32_t target);
  Script<Result<std::int32_t>> leave_home();
  Script<Result<void>> give_target_while_it_turns();
  Script<Result<std::optional<VelocityTarget>>> watch_turning_with_target();

  const VerifyOptions& options() const { return inquiry_.options(); }
  const Model& model() const { return *options().model; }
  bool has_tmc429() const { return model().family == Family::tmc429; }

  AxisAddress axis_;
  Inquiry inquiry_;
  WatchedAxis watched_;
  Room room_;
  bool runs_program_ = false;
};

// ---- questions --------------------------------------------------------------------------------

Script<Result<void>> Verifier::ask_version() {
  const Request request{axis_.module, Command::GET_FIRMWARE_VERSION,
                        static_cast<std::uint8_t>(VersionForm::binary), 0, 0};
  const auto value = co_await must(ask(request));
  inquiry_.found().version = version_from_value(value);
  co_return Result<void>{};
}

// What answers is another module's reply, which the bus counts and drops.
Script<Result<void>> Verifier::ask_another_address() {
  if (!options().free_address || !options().strays) {
    inquiry_.not_measured(Trait::addressing, "there is no address here that is certainly free");
    co_return Result<void>{};
  }
  inquiry_.tell("asks another address");
  const auto before = options().strays();
  CallOptions once;
  once.attempts = 1;
  const Request request{*options().free_address, Command::GGP, gp::application_status, 0, 0};
  const auto answer = co_await exchange(request, once);
  co_await pause(stray_time);
  const auto who = fmt::format("address {}", number(*options().free_address));
  if (answer || answer.error().outcome == Outcome::refused) {
    inquiry_.not_measured(Trait::addressing, "another module has " + who);
  } else if (!is_silence(answer.error())) {
    co_return tl::unexpected(answer.error());
  } else if (options().strays() != before) {
    inquiry_.finding(Trait::addressing, std::optional(Addressing::any),
                     "asked for " + who + ", it answered");
  } else {
    inquiry_.finding(Trait::addressing, std::optional(Addressing::own),
                     "asked for " + who + ", it did not answer");
  }
  co_return Result<void>{};
}

Script<Result<void>> Verifier::ask_program_state() {
  constexpr auto trait = Trait::program_state;
  constexpr unsigned high_byte = 24;
  const auto state =
      co_await must(unless_refused(watched_.ask(Command::GGP, gp::application_status)));
  if (!state) {
    inquiry_.not_measured(trait, "the module does not tell global parameter 128");
    co_return Result<void>{};
  }
  runs_program_ = *state == 1;
  const auto said = co_await must(unless_refused(watched_.ask(Command::GET_APPLICATION_STATUS, 0)));
  if (!said) {
    inquiry_.not_measured(trait, "the module does not know command 135");
  } else if (*state == 0) {
    inquiry_.not_measured(trait, "its program is stopped: the state is 0 wherever it stands");
  } else {
    std::optional<ProgramState> where;
    if (static_cast<std::uint32_t>(*said) >> high_byte == static_cast<std::uint32_t>(*state))
      where = ProgramState::high_byte;
    if (*said == *state) where = ProgramState::low_byte;
    inquiry_.finding(trait, where,
                     fmt::format("command 135 says {:#x} in state {}", *said, *state));
  }
  co_return Result<void>{};
}

// A module that cuts a divider to four bits keeps what it has.
Script<Result<void>> Verifier::set_beyond_range() {
  constexpr auto trait = Trait::range_check;
  inquiry_.tell("sets a value out of range");
  const auto parameter = has_tmc429() ? plan::pulse_divisor : ap::max_velocity;
  const auto present = co_await must(watched_.get(parameter));
  const auto* row = find_parameter(axis_parameters(model()), parameter);
  const auto beyond = has_tmc429() ? std::int64_t{present} + beyond_divider
                                   : std::int64_t{row == nullptr ? INT32_MAX : row->maximum} + 1;
  const bool is_limited = options().greatest_velocity || options().greatest_acceleration;
  if (is_limited || beyond > INT32_MAX) {
    inquiry_.not_measured(trait, is_limited ? "the limits of the axis forbid to try"
                                            : "there is no harmless value that is out of range");
    co_return Result<void>{};
  }
  watched_.forget(parameter);
  const auto value = static_cast<std::int32_t>(beyond);
  const auto answer =
      co_await exchange({axis_.module, Command::SAP, parameter, axis_.motor, value});
  if (!answer && answer.error().outcome != Outcome::refused)
    co_return tl::unexpected(answer.error());
  const auto kept = co_await must(watched_.get(parameter));
  co_await must(watched_.set(plan::Setting{parameter, present}));
  std::optional<RangeCheck> check;
  if (!answer && kept == present) check = RangeCheck::manual;
  if (answer && kept == present && has_tmc429()) check = RangeCheck::wrap;
  inquiry_.finding(
      trait, check,
      answer ? fmt::format("it took {} for parameter {}, and has {}", value, parameter, kept)
             : fmt::format("it refused {} for parameter {}", value, parameter));
  co_return Result<void>{};
}

// ---- a relative move --------------------------------------------------------------------------

/// Gives the velocity, as the module counts it.
Script<Result<std::int32_t>> Verifier::set_slow() {
  if (has_tmc429()) {
    co_await must(watched_.set(stroll));
    co_return stroll.velocity;
  }
  const auto values = co_await must(get_all(axis_, unit_parameters(model())));
  const auto units = module_units(model(), values);
  const auto unit = units ? units->velocity.value : 1;
  const auto velocity = std::max(1, static_cast<std::int32_t>(stroll_pps / unit));
  co_await must(watched_.set(plan::Setting{ap::max_velocity, velocity}));
  co_return velocity;
}

/// Until it is seen to have gone somewhere; gives where that is.
Script<Result<std::int32_t>> Verifier::leave_home() {
  const auto home = watched_.home().value;
  const auto begin = co_await current_time();
  auto here = home;
  while (std::abs(std::int64_t{here} - home) < 2) {
    here = co_await must(watched_.get(ap::actual_position));
    const auto now = co_await current_time();
    if (now - begin > longest_stroll)
      co_return tl::unexpected(watched_.interrupted(home + room_.sign * least_stroll, here));
  }
  co_return here;
}

// On its way the motor is not where it goes. A distance of 0 takes it no farther than that,
// whatever it is added to, and however often.
Script<Result<bool>> Verifier::move_relatively_once(std::int32_t target) {
  co_await must(watched_.ask(Command::MVP, move_type::absolute, target));
  const auto here = co_await must(leave_home());
  const auto answer = co_await must(watched_.ask(Command::MVP, move_type::relative, 0));
  const auto aim = co_await must(watched_.get(ap::target_position));
  const auto later = co_await must(watched_.get(ap::actual_position));
  // It was there already, or what it says can mean both.
  if (here == target || aim == 0) co_return false;
  std::optional<RelativeFrom> from;
  if (aim == target) from = RelativeFrom::target;
  const auto [least, most] = std::minmax(here, later);
  if (aim != target && aim >= least - 2 && aim <= most + 2) from = RelativeFrom::actual;
  inquiry_.finding(Trait::relative_from, from,
                   fmt::format("0 from {} on the way to {} led to {}", here, target, aim));
  std::optional<RelativeAnswer> said;
  if (answer == 0) said = RelativeAnswer::distance;
  if (answer == aim) said = RelativeAnswer::target;
  inquiry_.finding(Trait::relative_answer, said,
                   fmt::format("0 led to {}; the answer was {}", aim, answer));
  co_return true;
}

Script<Result<void>> Verifier::move_relatively() {
  const auto not_done = [&](const std::string& why) {
    inquiry_.not_measured(Trait::relative_from, why);
    inquiry_.not_measured(Trait::relative_answer, why);
  };
  const auto distance = std::min<std::int64_t>(room_.distance, stroll_distance);
  if (distance < least_stroll) {
    not_done(fmt::format("it needs a travel of {} microsteps", least_stroll));
  } else if (!inquiry_.allows({stroll_pps})) {
    not_done(fmt::format("it needs {} microsteps a second", stroll_pps));
  } else {
    inquiry_.tell("moves by a distance of 0 on its way");
    co_await must(set_slow());
    bool is_done = false;
    for (auto i = 0; i < strolls && !is_done; ++i) {
      const auto by = room_.sign * static_cast<std::int32_t>(distance - i);
      is_done = co_await must(move_relatively_once(watched_.home().value + by));
      co_await must(watched_.return_home());
    }
    if (!is_done) not_done("the axis was not seen on its way");
  }
  co_return Result<void>{};
}

// ---- a target while it turns ------------------------------------------------------------------

/// The target is behind it: where it goes on turning it gets away from there.
Script<Result<std::optional<VelocityTarget>>> Verifier::watch_turning_with_target() {
  constexpr std::int64_t far_enough = 16;
  const auto home = watched_.home().value;
  const auto gone = [&](std::int32_t here) { return room_.sign * (std::int64_t{here} - home); };
  const auto first = gone(co_await must(leave_home()));
  co_await must(watched_.ask(Command::SAP, ap::target_position, home));
  const auto begin = co_await current_time();
  auto farthest = first;
  while (co_await current_time() - begin < longest_stroll) {
    const auto now = gone(co_await must(watched_.get(ap::actual_position)));
    farthest = std::max(farthest, now);
    if (now <= farthest - 2 || now <= 0) co_return std::optional(VelocityTarget::goes_there);
    if (now >= first + far_enough) co_return std::optional(VelocityTarget::turns_on);
  }
  co_return std::optional<VelocityTarget>();
}

Script<Result<void>> Verifier::give_target_while_it_turns() {
  constexpr auto trait = Trait::velocity_target;
  if (room_.distance < stroll_distance) {
    inquiry_.not_measured(trait,
                          fmt::format("it needs a travel of {} microsteps", stroll_distance));
    co_return Result<void>{};
  }
  if (!inquiry_.allows({stroll_pps})) {
    inquiry_.not_measured(trait, fmt::format("it needs {} microsteps a second", stroll_pps));
    co_return Result<void>{};
  }
  inquiry_.tell("turns slowly, and is given a target behind it");
  const auto velocity = co_await must(set_slow());
  co_await must(watched_.ask(room_.sign > 0 ? Command::ROR : Command::ROL, 0, velocity));
  const auto does = co_await must(watch_turning_with_target());
  co_await must(watched_.stop());
  inquiry_.finding(trait, does,
                   !does                               ? "it neither turned on nor went there"
                   : *does == VelocityTarget::turns_on ? "it turned on, away from its new target"
                                                       : "it turned round, to its new target");
  co_await must(watched_.return_home());
  co_return Result<void>{};
}

// ---- all of it --------------------------------------------------------------------------------

Script<Result<void>> Verifier::questions() {
  co_await must(ask_version());
  co_await must(watched_.begin());
  co_await must(ask_another_address());
  co_await must(ask_program_state());
  co_await must(set_beyond_range());
  inquiry_.not_measured(Trait::limit_stop, "it needs a limit switch within the travel");
  inquiry_.not_measured(Trait::heartbeat, "a test of the deadman tells");
  co_return Result<void>{};
}

Script<Result<void>> Verifier::movements() {
  const auto home = std::int64_t{watched_.home().value};
  const auto above = options().travel.greatest - home;
  const auto below = home - options().travel.least;
  room_ = above >= below ? Room{above, 1} : Room{below, -1};
  co_await must(move_relatively());
  co_await must(give_target_while_it_turns());
  if (has_tmc429()) {
    ChipTrials trials(inquiry_, watched_, room_);
    co_await must(trials.run());
  }
  co_return Result<void>{};
}

Script<Result<void>> Verifier::course() {
  co_await must(questions());
  if (runs_program_) {
    for (const auto& info : trait_table()) {
      const bool is_of_moves =
          info.trait <= Trait::velocity_target && concerns(info.trait, model());
      if (is_of_moves)
        inquiry_.not_measured(info.trait, "a program runs in the module: end it first");
    }
  } else {
    co_await must(movements());
  }
  co_return Result<void>{};
}

Script<Result<Verification>> Verifier::run() {
  inquiry_.found().model = options().model;
  auto done = co_await course();
  co_await must(watched_.end(std::move(done)));
  const auto quickest = watched_.quickest_exchange();
  // What comes sooner than its bytes can was on no wire.
  inquiry_.found().answer =
      quickest > options().wire_time ? quickest - options().wire_time : quickest;
  std::ranges::sort(inquiry_.found().traits, {}, &TraitFinding::trait);
  co_return std::move(inquiry_.found());
}

}  // namespace

Script<Result<Verification>> verify(AxisAddress axis, VerifyOptions options) {
  Verifier verifier(axis, std::move(options));
  auto result = co_await verifier.run();
  co_return result;
}

}  // namespace verbs

std::vector<std::uint8_t> verify_parameters(const Model& model) {
  if (model.family == Family::tmc429) return plan::AxisTwin::parameters(model);
  return {axis_parameter::max_velocity};
}

ModuleTraits Verification::found() const {
  ModuleTraits all;
  for (const auto& finding : traits) {
    if (const auto variant = finding.found()) all.set(finding.trait, *variant);
  }
  return all;
}

}  // namespace tmcl
