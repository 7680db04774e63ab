#include "verbs/position_scan.hpp"

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "command_line/child_process.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

constexpr std::size_t most_bytes_of_file = std::size_t{1} << 28;
constexpr std::int64_t scan_lease_ttl_ms = 5'000;
constexpr tmcl::Duration scan_look_interval = std::chrono::milliseconds(20);
constexpr const char* resume_hint = "The same command with --resume goes on behind the last row";

std::string about(const verb::ScanPositions& verb, const ScannedAxis& axis) {
  return fmt::format("# scan of {} from {} to {} in {} positions, {} times{}; reached: {}\n",
                     axis.recording.axis, verb.from, verb.to, verb.steps, verb.repeat,
                     verb.both_ways ? ", both ways" : "",
                     axis.has_encoder ? "as the encoder says" : "as commanded, without an encoder");
}

/// For the command: "TMCL_INDEX=3".
void set_for_command(const char* name, const std::string& value) {
  ::setenv(name, value.c_str(), 1);
}

}  // namespace

tmcl::Quantity Span::at(std::int32_t index, std::int32_t steps) const {
  const auto part = static_cast<double>(index) / (steps - 1);
  auto number = from + part * (to - from);
  // What has no unit is counted.
  if (unit.empty()) number = std::round(number);
  return {number, unit};
}
std::string text_of_target(const tmcl::Quantity& quantity) {
  return tmcl::plain_number(quantity.number, digits_of_targets) + quantity.unit;
}

Result<void> PositionScan::open_file() {
  if (verb_.csv.empty() || verb_.csv == "-") return {};
  // An empty one was left by a scan that did not begin.
  std::error_code unknown;
  const auto bytes = std::filesystem::file_size(verb_.csv, unknown);
  if (unknown || bytes == 0) return file_.open(verb_.csv);
  if (!verb_.resume)
    return tl::unexpected(usage_error("file_exists", verb_.csv + " is there already",
                                      "--resume goes on with the scan that it is of"));
  const auto text = read_file(verb_.csv, most_bytes_of_file);
  if (!text) return tl::unexpected(usage_error("cannot_read", verb_.csv + ": " + text.error()));
  auto found = read_scan(*text, about(verb_, axis_), scan_columns(axis_.unit()), visits_);
  if (!found)
    return tl::unexpected(usage_error("other_scan",
                                      "cannot go on with " + verb_.csv + ": " + found.error(),
                                      "name another file, or repeat the command that began it"));
  reached_ = std::move(found->visits);
  begins_file_ = found->bytes == 0;
  return file_.open_behind(verb_.csv, found->bytes);
}

Result<void> PositionScan::begin_file() {
  if (verb_.csv.empty()) return {};
  if (!begins_file_) return write("# resumed " + tmcl::to_text(context_.host.utc()) + '\n');
  return write(csv_comments({axis_.recording}, context_) + about(verb_, axis_) +
               scan_columns(axis_.unit()));
}

Result<void> PositionScan::write(const std::string& text) {
  if (verb_.csv != "-") return file_.append(text);
  context_.output.out << text << std::flush;
  return {};
}

Result<void> PositionScan::run() {
  if (reached_.size() == visits_.size()) return {};
  auto lease = HeldLease::take({verb_.axis}, scan_lease_ttl_ms, context_);
  if (!lease) return tl::unexpected(lease.error());
  lease_ = std::move(*lease);
  lease_.pass_on();
  auto ended = go_on();
  line_.clear();
  if (!ended) return tl::unexpected(ended_by(std::move(ended.error())));
  return lease_.release(context_);
}

Result<void> PositionScan::go_on() {
  const auto now = state_of(verb_.axis, context_);
  if (!now) return tl::unexpected(now.error());
  last_stop_ = now->last_stop;
  if (auto begun = begin_file(); !begun) return begun;
  while (reached_.size() < visits_.size()) {
    const auto& next = visits_[reached_.size()];
    line_.show(fmt::format("{}: position {} of {}, pass {} of {}", axis_.recording.axis,
                           next.index + 1, verb_.steps, next.pass, verb_.repeat));
    if (auto visited = visit(next); !visited) return visited;
  }
  return {};
}

Result<void> PositionScan::visit(const Visit& visit) {
  if (auto attended = attend(); !attended) return attended;
  const auto before = state_of(verb_.axis, context_);
  if (!before) return tl::unexpected(before.error());
  if (before->last_stop != last_stop_) return tl::unexpected(stopped_meanwhile());
  const auto quantity = span_.at(visit.index, verb_.steps);
  const auto move = move_to(quantity);
  if (move || move.error().outcome != tmcl::Outcome::not_sent) was_sent_ = true;
  if (!move) return tl::unexpected(move.error());
  if (auto stands = wait(*move); !stands) return stands;
  if (auto rested = rest(); !rested) return rested;
  const auto reading = state_of(verb_.axis, context_);
  if (!reading) return tl::unexpected(reading.error());
  if (reading->last_stop != last_stop_) return tl::unexpected(stopped_meanwhile());
  const auto encoder = read_encoder();
  if (!encoder) return tl::unexpected(encoder.error());
  const auto way = std::int64_t{move->target_microsteps} - before->position_microsteps;
  // In the unit of the axis, which may count the other way.
  const bool is_reverse = axis_.has_unit && axis_.units.scale->reverse;
  const auto approach = way == 0                   ? Approach::none
                        : (way > 0) == !is_reverse ? Approach::up
                                                   : Approach::down;
  const auto reached = reached_of(visit, approach, target_of(quantity, *move), *reading, *encoder);
  if (auto done = run_command(visit, reached); !done) return done;
  RowContext row{tmcl::to_text(context_.host.utc()), move->target_microsteps,
                 reading->position_microsteps};
  if (*encoder) row.encoder = (*encoder)->value;
  return note(reached, std::move(row));
}

Result<api::axis::StartedMove> PositionScan::move_to(const tmcl::Quantity& target) {
  return start_move(verb_.axis, {text_of_target(target), verb_.internal}, false, context_);
}

Result<void> PositionScan::wait(const api::axis::StartedMove& move) {
  Journey journey{verb_.axis, {move.target_microsteps}, context_.host.now(), follow_interval};
  if (axis_.has_unit) journey.goal_in_unit = in_unit(move.target, move.unit);
  std::optional<Error> lost;
  journey.meanwhile = [&] {
    auto kept = keep_lease();
    if (!kept) lost = kept.error();
    return kept;
  };
  const auto stands = follow(journey, context_, [](const AxisReading&) {});
  if (lost) return tl::unexpected(*lost);
  if (!stands) return tl::unexpected(stands.error());
  return {};
}

Result<void> PositionScan::keep_lease() {
  auto kept = lease_.renew(context_);
  if (!kept) kept.error().kind = ErrorKind::ended_early;
  return kept;
}

Result<void> PositionScan::attend() {
  if (context_.host.signal() != 0)
    return tl::unexpected(interrupted_error(context_.host.signal(), "interrupted", ""));
  return keep_lease();
}

Result<void> PositionScan::rest() {
  const auto end = context_.host.now() + std::chrono::duration_cast<tmcl::Duration>(
                                             std::chrono::duration<double>(verb_.dwell_s));
  while (context_.host.now() < end) {
    if (auto attended = attend(); !attended) return attended;
    context_.sleep(std::min<tmcl::Duration>(scan_look_interval, end - context_.host.now()));
  }
  return {};
}

Result<std::optional<api::parameter::Value>> PositionScan::read_encoder() {
  using Encoder = std::optional<api::parameter::Value>;
  if (!axis_.has_encoder) return Encoder();
  return context_.call(api::parameter::Get{{verb_.axis, encoder_of_scan}})
      .map([](api::parameter::Value value) { return Encoder(std::move(value)); });
}

double PositionScan::target_of(const tmcl::Quantity& quantity,
                               const api::axis::StartedMove& move) const {
  if (!axis_.has_unit) return move.target_microsteps;
  // What the position was rounded by is a deviation, too.
  const auto wanted = in_own_unit(quantity, axis_.units);
  return wanted.value_or(move.target.value_or(0));
}

Reached PositionScan::reached_of(const Visit& visit, Approach approach, double target,
                                 const AxisReading& reading,
                                 const std::optional<api::parameter::Value>& encoder) const {
  Reached reached{visit, approach, target};
  if (encoder) {
    reached.reached = axis_.has_unit ? encoder->value_in_unit.value_or(0) : encoder->value;
  } else {
    reached.reached = axis_.has_unit ? reading.position.value_or(0) : reading.position_microsteps;
  }
  return reached;
}

Result<void> PositionScan::run_command(const Visit& visit, const Reached& reached) {
  if (verb_.command.empty()) return {};
  set_for_command("TMCL_AXIS", axis_.recording.axis);
  set_for_command("TMCL_INDEX", std::to_string(visit.index));
  set_for_command("TMCL_PASS", std::to_string(visit.pass));
  set_for_command("TMCL_APPROACH", std::string(name_of(reached.approach)));
  set_for_command("TMCL_TARGET", tmcl::plain_number(reached.target, digits_of_targets));
  set_for_command("TMCL_POSITION", tmcl::plain_number(reached.reached, digits_of_targets));
  set_for_command("TMCL_UNIT", axis_.unit());
  const bool is_output_taken = context_.output.json || verb_.csv == "-";
  line_.clear();
  context_.output.out << std::flush;
  auto program = ChildProcess::start({"/bin/sh", "-c", verb_.command},
                                     is_output_taken ? ChildProcess::Prints::to_standard_error
                                                     : ChildProcess::Prints::as_this_one);
  if (!program) return tl::unexpected(program.error());
  while (!program->exit_code()) {
    if (auto attended = attend(); !attended) {
      program->send(SIGTERM);
      return attended;
    }
    context_.sleep(scan_look_interval);
  }
  const int code = *program->exit_code();
  if (code == 0) return {};
  Error failure{"command_failed", ErrorKind::ended_early, tmcl::Outcome::done,
                fmt::format("'{}' ended with exit code {}", verb_.command, code), ""};
  failure.subject = {{"axis", axis_.recording.axis}, {"command_exit_code", code}};
  return tl::unexpected(std::move(failure));
}

Result<void> PositionScan::note(const Reached& reached, RowContext row) {
  reached_.push_back(reached);
  auto written = write(scan_row(reached, row));
  if (!written) reached_.pop_back();
  return written;
}

Error PositionScan::stopped_meanwhile() const {
  Error failure{"move_interrupted", ErrorKind::ended_early, tmcl::Outcome::done,
                axis_.recording.axis + " was stopped by another program; cause: client",
                "Nothing has moved it since"};
  failure.subject = {{"axis", axis_.recording.axis}, {"stop_cause", "client"}};
  return failure;
}

Error PositionScan::ended_by(Error failure) {
  const auto done = fmt::format("the scan of {} was ended behind {} of {} positions",
                                axis_.recording.axis, reached_.size(), visits_.size());
  const int signal = context_.host.take_signal();
  // Also where the lease is not this program's own, or is lost.
  const bool stopped = !was_sent_ || context_.call(api::axis::Stop{verb_.axis});
  (void)lease_.release(context_);
  const auto hint = file_.is_open() ? std::string(resume_hint) : std::string();
  if (signal != 0) {
    auto interrupted = interrupted_error(
        signal, done + (stopped ? ", and it was stopped" : ", and it may still move"), hint);
    return interrupted;
  }
  failure.message = done + ": " + failure.message;
  if (!failure.hint.empty() && !hint.empty()) failure.hint += ". ";
  failure.hint += hint;
  return failure;
}

}  // namespace tmclctl
