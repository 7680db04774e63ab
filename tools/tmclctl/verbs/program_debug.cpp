// program debug: a program in a module, command by command.
#include <algorithm>

#include <fmt/format.h>

#include "axis/held_lease.hpp"
#include "output/print.hpp"
#include "program_file.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/program_debugger.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using tmcl::program::Debugger;
using tmcl::program::DebugOrder;
using tmcl::program::Standing;
using DebugKind = DebugOrder::Kind;
using Readings = std::vector<tmcl::program::Reading>;

constexpr tmcl::Duration line_look_interval = std::chrono::milliseconds(20);
/// Motors stop without it: it must outlast a computer that is busy.
constexpr std::int64_t debug_lease_ttl_ms = 5'000;
constexpr std::uint32_t most_commands_to_a_breakpoint = 10'000;
constexpr std::uint8_t bank_of_user_variables = 2;

/// A module, and its motors as axes.
struct DebuggedModule {
  api::OnModule place;
  const tmcl::Model* model = nullptr;
  std::vector<std::string> axes;
};

Result<DebuggedModule> look_at_module(const std::string& name, Context& context) {
  const auto place = on_module(name, context);
  if (!place) return tl::unexpected(place.error());
  const auto state = context.call(api::firmware::Status{{*place}});
  if (!state) return tl::unexpected(state.error());
  const auto program = context.call(api::program::Status{{*place}});
  if (!program) return tl::unexpected(program.error());
  if (program->state == "running")
    return tl::unexpected(
        Error{"program_runs", ErrorKind::failed, tmcl::Outcome::refused,
              fmt::format("a program is running on module {}", name),
              "'tmclctl program stop' ends it; motors that it has started go on"});
  DebuggedModule module{*place, tmcl::find_model(state->model_number), {}};
  const int motors = module.model == nullptr ? 1 : module.model->axes;
  for (int motor = 0; motor < motors; ++motor)
    module.axes.push_back(fmt::format("{}:{}/{}", place->bus, place->address, motor));
  return module;
}

json::object row_of(const Standing& now, const Debugger& debugger, const Readings& readings) {
  json::object row{{"state", now.state}, {"reason", now.reason}, {"steps", now.steps}};
  row["next_address"] = now.address ? json::value(*now.address) : json::value();
  row["last_error"] = now.last_error ? json::value(*now.last_error) : json::value();
  if (const auto at = debugger.map().at(now.address.value_or(-1))) {
    row["file"] = at->file;
    row["line"] = at->line;
    row["label"] = at->label;
    row["text"] = at->text;
  }
  json::array values;
  for (const auto& reading : readings) {
    json::object value{{"of", to_text(reading.watched)}};
    if (reading.value) {
      value["value"] = *reading.value;
    } else {
      value["error"] = reading.value.error();
    }
    values.push_back(std::move(value));
  }
  row["readings"] = std::move(values);
  return row;
}

class DebugSession {
 public:
  DebugSession(const verb::DebugProgram& verb, DebuggedModule module, Debugger debugger,
               HeldLease lease, Context& context)
      : verb_(verb),
        module_(std::move(module)),
        debugger_(std::move(debugger)),
        lease_(std::move(lease)),
        context_(context) {}

  Result<ExitCode> run() {
    auto ended = go_on();
    if (context_.host.signal() != 0) interrupted_ = context_.host.take_signal();
    // Whatever has ended it.
    const auto stopped = stop_all();
    const auto released = lease_.release(context_);
    if (interrupted_ != 0)
      return tl::unexpected(interrupted_error(
          interrupted_, stopped ? "the program and the motors were stopped" : "", ""));
    if (!ended) return tl::unexpected(ended.error());
    if (!stopped) return tl::unexpected(stopped.error());
    if (!released) return tl::unexpected(released.error());
    say(fmt::format("module {}: the program has ended, and its motors have stopped\n",
                    verb_.module));
    return ExitCode::done;
  }

 private:
  Result<void> go_on() {
    const auto reset = context_.call(api::program::Reset{{module_.place}});
    if (!reset) return tl::unexpected(reset.error());
    if (auto begun = carry_out({DebugKind::look, 0, {}, false}); !begun) return begun;
    while (interrupted_ == 0) {
      prompt();
      const auto line = next_line();
      if (!line) return tl::unexpected(line.error());
      if (!*line) return {};
      const auto order = debugger_.say(**line);
      say(order.text);
      if (order.kind == DebugKind::quit) return {};
      if (order.kind == DebugKind::none) continue;
      if (auto done = carry_out(order); !done) return done;
    }
    return {};
  }

  /// Nothing: there are no more.
  Result<std::optional<std::string>> next_line() {
    while (context_.host.signal() == 0) {
      if (auto line = context_.host.take_line()) return line;
      if (context_.host.has_input_ended()) break;
      if (auto kept = lease_.renew(context_); !kept) return tl::unexpected(kept.error());
      context_.sleep(line_look_interval);
    }
    return std::optional<std::string>();
  }

  /// What the module refuses is printed, and the session goes on.
  Result<void> carry_out(const DebugOrder& order) {
    auto now = execute(order);
    if (!now && interrupted_ == 0) {
      say(error_text(now.error(), context_.output.gateway) + '\n');
      now = look();
    }
    if (interrupted_ != 0) return {};
    if (!now) return tl::unexpected(now.error());
    const auto readings = read(debugger_.to_read(order.kind));
    const auto text = debugger_.stands(order.kind, *now, readings);
    if (context_.output.json) {
      auto row = row_of(*now, debugger_, readings);
      row["module"] = verb_.module;
      print_json(row, context_.output);
    } else {
      say(text);
    }
    return {};
  }

  Result<Standing> execute(const DebugOrder& order) {
    if (order.kind == DebugKind::step) return step(order.steps);
    if (order.kind == DebugKind::stop || order.kind == DebugKind::restart) {
      if (auto stopped = stop_all(); !stopped) return tl::unexpected(stopped.error());
    }
    if (order.kind == DebugKind::restart) {
      const auto reset = context_.call(api::program::Reset{{module_.place}});
      if (!reset) return tl::unexpected(reset.error());
    }
    return look();
  }

  Result<Standing> look() {
    const auto answer = context_.call(api::program::Status{{module_.place}});
    if (!answer) return tl::unexpected(answer.error());
    return Standing{answer->state, answer->next_address, answer->last_error, {}, 0, {}, {}};
  }

  Result<Standing> step(std::uint32_t steps) {
    api::program::StepTo order{{module_.place}, debugger_.breakpoints(), steps, {}};
    const auto stepped = context_.call(order, {.timeout = {}, .meanwhile = [this] { attend(); }});
    if (!stepped) return tl::unexpected(stepped.error());
    const auto reason = stepped->reason == "address" ? "breakpoint" : stepped->reason;
    return Standing{
        stepped->state, stepped->next_address, stepped->last_error, reason, stepped->steps, {}, {}};
  }

  /// While commands are executed.
  void attend() {
    if (context_.host.signal() != 0) {
      interrupted_ = context_.host.take_signal();
      stop_all();
    }
    lease_.renew(context_);
  }

  /// Motors first: a stop of one takes the right to go on from what is executed.
  Result<void> stop_all() {
    std::optional<Error> failed;
    const auto note = [&](const auto& result) {
      if (!result && !failed) failed = result.error();
    };
    for (const auto& axis : module_.axes) note(context_.call(api::axis::Stop{axis}));
    note(context_.call(api::program::Stop{{module_.place}}));
    // The program may have sent a motor somewhere before it ended.
    for (const auto& axis : module_.axes) note(context_.call(api::axis::Stop{axis}));
    if (failed) return tl::unexpected(std::move(*failed));
    return {};
  }

  Readings read(const std::vector<tmcl::program::Watched>& wanted) {
    Readings readings;
    for (const auto& one : wanted) {
      const auto value = one.motor ? parameter(one) : variable(one);
      if (value) {
        readings.push_back({one, *value});
      } else {
        readings.push_back({one, tl::unexpected(value.error().message)});
      }
    }
    return readings;
  }

  Result<std::int32_t> variable(const tmcl::program::Watched& one) {
    api::global::Get wanted;
    static_cast<api::OnModule&>(wanted) = module_.place;
    wanted.parameter.said = static_cast<std::int32_t>(std::stoi(one.name));
    wanted.bank = bank_of_user_variables;
    return context_.call(wanted).map([](const auto& answer) { return answer.value; });
  }
  Result<std::int32_t> parameter(const tmcl::program::Watched& one) {
    api::parameter::Get wanted;
    wanted.axis = module_.axes.at(*one.motor);
    wanted.parameter.said = one.name;
    return context_.call(wanted).map([](const auto& answer) { return answer.value; });
  }

  void prompt() {
    if (context_.output.json || !context_.output.out_screen.terminal) return;
    context_.output.out << "(debug) " << std::flush;
  }
  /// What is no row is no part of a document.
  void say(const std::string& text) {
    (context_.output.json ? context_.output.err : context_.output.out) << text << std::flush;
  }

  const verb::DebugProgram& verb_;
  DebuggedModule module_;
  Debugger debugger_;
  HeldLease lease_;
  Context& context_;
  int interrupted_ = 0;
};

/// The module is to hold what the file says.
Result<std::string> agree(const verb::DebugProgram& verb, const DebuggedModule& module,
                          const tmcl::program::Program& program, Context& context) {
  const auto text = tmcl::program::to_hex(program);
  if (verb.upload) {
    const auto loaded = context.call(api::program::Load{{module.place}, text, {}, {}});
    if (!loaded) return tl::unexpected(loaded.error());
    return fmt::format("module {}: {} was loaded, {} commands, compared\n", verb.module, verb.file,
                       loaded->commands);
  }
  auto same = context.call(api::program::Compare{{module.place}, text, {}});
  if (!same) {
    auto& error = same.error();
    if (error.name == name_of(tmcl::Errc::unexpected_value))
      error.hint = "'tmclctl program debug --upload' loads the file first";
    return tl::unexpected(error);
  }
  return fmt::format("module {} holds the program of {}\n", verb.module, verb.file);
}

Result<ExitCode> run(const verb::DebugProgram& verb, Context& context) {
  auto module = look_at_module(verb.module, context);
  if (!module) return tl::unexpected(module.error());
  auto assembly = assembly_from(verb.file, context.output, module->model);
  if (!assembly) return tl::unexpected(assembly.error());
  if (assembly->program.empty())
    return tl::unexpected(usage_error("bad_program", verb.file + " has no command"));
  auto lease = HeldLease::take(module->axes, debug_lease_ttl_ms, context);
  if (!lease) return tl::unexpected(lease.error());
  const auto agreed = agree(verb, *module, assembly->program, context);
  if (!agreed) {
    lease->release(context);
    return tl::unexpected(agreed.error());
  }
  auto& stream = context.output.json ? context.output.err : context.output.out;
  stream << *agreed
         << "What a command moves does move; the motors stop at the end, or with Ctrl-C.\n"
            "Not told by modules: accumulator, X, flags, stack. 'help' shows what can be typed.\n"
         << std::flush;
  tmcl::program::DebuggerOptions options;
  options.most_steps = most_commands_to_a_breakpoint;
  options.motors = static_cast<std::uint8_t>(module->axes.size());
  return DebugSession(verb, std::move(*module), {std::move(*assembly), options}, std::move(*lease),
                      context)
      .run();
}

constexpr const char* program_debug_help = R"(
Executes the program of FILE in MODULE command by command, and shows the line of the text at which it
stands. It moves motors as the program says. The module must hold the program of the file, which is
compared, or is loaded first with --upload. It begins at its first command. Lines on standard input say
what is done: 'step', 'continue', 'break LABEL', 'variables', 'watch 3', 'watch 0 actual_position' ...;
'help' shows all. Between two commands the program stands, and motors go on.

'continue' has each command executed by itself, until the next one has a breakpoint: the program goes
slower than it runs by itself. A WAIT takes its time. Accumulator, X register, flags and stack are not
told by modules: 'tmclsim --debug FILE' shows them, and goes back.

All motors of the module are leased. At the end of the input, with 'quit', Ctrl-C, or when this program
or its connection is gone, the program ends and they stop.
--json prints a row wherever the program stands; all else goes to standard error.

  tmclctl program debug loop.tmc 1
  printf 'break Loop\ncontinue\nvariables\n' | tmclctl program debug loop.tmc 1 --upload
)";

}  // namespace

void add_program_debug(Grammar& grammar, const Form& program) {
  auto debug = grammar.verb<verb::DebugProgram>(program, "debug", access::acts,
                                                "Execute a program command by command",
                                                program_debug_help, run);
  debug.word("FILE", "A program's text, or a program file (*.bin)", text(debug->file));
  debug.module(debug->module);
  debug.flag("--upload", "Load it into the module first", debug->upload);
}

}  // namespace tmclctl
