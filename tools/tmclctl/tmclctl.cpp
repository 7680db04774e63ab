#include "tmclctl.hpp"

#include <algorithm>
#include <memory>
#include <type_traits>
#include <utility>

#include "options.hpp"
#include "print.hpp"
#include "target.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

ExitCode complain(const Failure& failure, Output& output) {
  if (output.json) {
    print_json({{"error", to_json(failure)}}, output);
  } else {
    output.err << "tmclctl: " << describe(failure) << '\n';
  }
  return failure.exit;
}

bool waits(const Verb& verb) {
  const auto* move = std::get_if<verb::Move>(&verb);
  const auto* home = std::get_if<verb::Home>(&verb);
  if (home != nullptr) return !home->no_wait && !home->stop;
  if (std::holds_alternative<verb::RunPath>(verb) || std::holds_alternative<verb::RunMint>(verb))
    return true;
  if (std::holds_alternative<verb::Upload>(verb) || std::holds_alternative<verb::Download>(verb))
    return true;
  const auto* arrivals = std::get_if<verb::Arrivals>(&verb);
  if (arrivals != nullptr) return !arrivals->off;
  const auto* line = std::get_if<verb::Line>(&verb);
  return (move != nullptr && move->wait) || (line != nullptr && line->wait) ||
         std::holds_alternative<verb::Wait>(verb) || std::holds_alternative<verb::Watch>(verb) ||
         std::holds_alternative<verb::Plot>(verb);
}

bool acts(const Verb& verb) {
  const auto* ask = std::get_if<verb::Ask>(&verb);
  if (ask != nullptr) return !only_reads(ask->method);
  const auto* upload = std::get_if<verb::Upload>(&verb);
  if (upload != nullptr) return !upload->only_compare;
  return std::visit(
      []<class T>(const T&) {
        return std::is_same_v<T, verb::Set> || std::is_same_v<T, verb::Move> ||
               std::is_same_v<T, verb::Line> || std::is_same_v<T, verb::Rotate> ||
               std::is_same_v<T, verb::Stop> || std::is_same_v<T, verb::Plot> ||
               std::is_same_v<T, verb::Raw> || std::is_same_v<T, verb::Ramp> ||
               std::is_same_v<T, verb::Home>;
      },
      verb);
}

/// Whether it changes nothing, whatever becomes of it.
bool only_asks(const Verb& verb) {
  const auto* ask = std::get_if<verb::Ask>(&verb);
  if (ask != nullptr) return only_reads(ask->method);
  const auto* upload = std::get_if<verb::Upload>(&verb);
  if (upload != nullptr) return upload->only_compare;
  return std::visit(
      []<class T>(const T&) {
        return std::is_same_v<T, verb::Scan> || std::is_same_v<T, verb::Modules> ||
               std::is_same_v<T, verb::Axes> || std::is_same_v<T, verb::Params> ||
               std::is_same_v<T, verb::Get> || std::is_same_v<T, verb::State> ||
               std::is_same_v<T, verb::Watch> || std::is_same_v<T, verb::Wait> ||
               std::is_same_v<T, verb::Download> || std::is_same_v<T, verb::CheckFirmware>;
      },
      verb);
}

/// Where no answer leaves open whether something was done.
Failure with_doubt(Failure failure, const Verb& verb) {
  if (failure.outcome != tmcl::Outcome::unknown) return failure;
  if (acts(verb)) failure.message += "; it may or may not have been executed";
  if (only_asks(verb) && failure.exit == ExitCode::unknown) failure.exit = ExitCode::not_sent;
  return failure;
}

template <class V>
constexpr bool needs_no_target =
    std::is_same_v<V, verb::Simulate> || std::is_same_v<V, verb::SolveProfile> ||
    std::is_same_v<V, verb::CheckMint> || std::is_same_v<V, verb::CheckPath> ||
    std::is_same_v<V, verb::Assemble> || std::is_same_v<V, verb::Disassemble> ||
    std::is_same_v<V, verb::FirmwareInfo> || std::is_same_v<V, verb::Convert> ||
    std::is_same_v<V, verb::Models>;

template <class V>
constexpr tmcl::Duration wait_for_target() {
  if constexpr (std::is_same_v<V, verb::Stop>) return wait_before_stop;
  // The shell's completion must not hang.
  if constexpr (std::is_same_v<V, verb::Complete>) return {};
  return usual_wait;
}

/// `ready` stands for the target that the command line names, if it is there already.
template <class V>
VerbResult run_on_target(const V& verb, const Where& where, Output& output, Patience& patience,
                         Target* ready) {
  std::unique_ptr<Target> opened;
  if (ready == nullptr) {
    auto target = open_target(where, wait_for_target<V>(), patience);
    if (!target) return tl::unexpected(target.error());
    opened = std::move(*target);
    ready = opened.get();
  }
  Room room{*ready, output, patience};
  return run(verb, room);
}

VerbResult run(const Options& options, Output& output, Patience& patience, Target* ready) {
  if (waits(options.verb)) patience.catch_signals();
  const auto* params = std::get_if<verb::Params>(&options.verb);
  if (params != nullptr && !params->model.empty()) return run_on_model(*params, output);
  return std::visit(
      [&]<class V>(const V& verb) {
        if constexpr (needs_no_target<V>) {
          return run(verb, output);
        } else {
          return run_on_target(verb, options.where, output, patience, ready);
        }
      },
      options.verb);
}

ExitCode run_with(const std::vector<std::string>& arguments, Output& output, Patience& patience,
                  Target* ready) {
  // Also for the errors of a command line that cannot be read.
  output.json = std::ranges::find(arguments, "--json") != arguments.end();
  const auto parsed = parse_options(arguments);
  if (!parsed) return complain(parsed.error(), output);
  if (const auto* information = std::get_if<Information>(&*parsed)) {
    output.out << information->text;
    return ExitCode::done;
  }
  const auto& options = std::get<Options>(*parsed);
  const auto result = run(options, output, patience, ready);
  if (result) return *result;
  if (std::holds_alternative<verb::Complete>(options.verb)) return result.error().exit;
  return complain(with_doubt(result.error(), options.verb), output);
}

}  // namespace

ExitCode run(const std::vector<std::string>& arguments, Output& output, Patience& patience) {
  return run_with(arguments, output, patience, nullptr);
}

ExitCode run(const std::vector<std::string>& arguments, Output& output, Patience& patience,
             Target& target) {
  return run_with(arguments, output, patience, &target);
}

}  // namespace tmclctl
