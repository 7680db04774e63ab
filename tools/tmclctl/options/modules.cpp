// Everything that is said of modules as a whole.
#include "config/feeding.hpp"
#include "grammar.hpp"
#include "help_text.hpp"

namespace tmclctl {

namespace {

using AskForm = VerbForm<verb::Ask>;

constexpr std::int32_t greatest_bank = 255;
constexpr std::int32_t greatest_port = 255;
constexpr std::int32_t greatest_coordinate = 20;
constexpr std::int32_t greatest_place = 2047;
constexpr std::int32_t most_lines = 2048;
constexpr std::int32_t greatest_mode = 255;
constexpr std::uint8_t last_motor_to_start = 5;
constexpr std::uint8_t last_motor_to_tell = 30;

AskForm ask(Grammar& grammar, const Form& group, const std::string& name, const char* method,
            const std::string& description, const char* footer = "") {
  auto form = grammar.verb<verb::Ask>(group, name, description, footer);
  form->method = method;
  return form;
}

AskForm ask(Grammar& grammar, const std::string& name, const char* method,
            const std::string& description, const char* footer = "") {
  auto form = grammar.verb<verb::Ask>(name, description, footer);
  form->method = method;
  return form;
}

void add_parameter(AskForm& form) {
  form.word("PARAM", "Number or standard name", text(form->parameter));
}

AskForm add_global(Grammar& grammar, const Form& group, const std::string& name, const char* method,
                   const std::string& description) {
  auto form = ask(grammar, group, name, method, description, help_text::global);
  form.module(form->module);
  add_parameter(form);
  form.option("--bank", "N", "Bank of the parameter (default 0); user variables are in bank 2",
              number(form->bank, 0, greatest_bank));
  return form;
}

AskForm add_coordinate(Grammar& grammar, const Form& group, const std::string& name,
                       const char* method, const std::string& description) {
  auto form = ask(grammar, group, name, method, description, help_text::coordinate);
  form.axis(form->axis);
  form.word("NUMBER", "Of the coordinate, 0 to 20", number(form->number, 0, greatest_coordinate));
  return form;
}

void add_all_coordinates(Grammar& grammar, const Form& group, const std::string& name,
                         const char* method, const std::string& description) {
  auto form = ask(grammar, group, name, method, description, help_text::coordinate);
  form.axis(form->axis);
  form.optional_word("NUMBER", "Only this one, 1 to 20",
                     number(form->number, 1, greatest_coordinate));
}

void add_program_verb(Grammar& grammar, const Form& program, const std::string& name,
                      const char* method, const std::string& description, const char* footer) {
  auto form = ask(grammar, program, name, method, description, footer);
  form.module(form->module);
}

}  // namespace

void add_home(Grammar& grammar) {
  auto home = grammar.verb<verb::Home>("home", "Search the reference position", help_text::home);
  home.axis(home->axis);
  home.option("--mode", "N", "Which switches are searched how (parameter 193)",
              number(home->mode, 1, greatest_mode));
  home.option("--max-travel", "WAY",
              "Stop the search where it goes further one way, such as 120mm or 3rev",
              text(home->max_travel));
  home.option("--timeout", "SECONDS", "Stop the search after so long, and give up",
              number(home->timeout_s, shortest_time_s, longest_time_s));
  home.flag("--leave", "Let the search go on after --timeout", home->leave);
  home.flag("--no-wait", "Come back as soon as the search has begun", home->no_wait);
  home.flag("--stop", "End a search", home->stop);
  home.internal(home->internal);
  home.object([](const verb::Home& said, bool) {
    if (said.stop &&
        (said.mode || said.timeout_s || said.no_wait || !said.max_travel.empty() || said.leave))
      return "--stop goes with no other option";
    if (said.leave && !said.timeout_s)
      return "--leave says what becomes of the search after --timeout: give that, too";
    return said.no_wait && said.timeout_s ? "--no-wait and --timeout exclude each other" : "";
  });
}

void add_recover(Grammar& grammar) {
  auto recover = grammar.verb<verb::Recover>(
      "recover", "Let an axis move again whose module restarted", help_text::recover);
  recover.optional_word("AXIS", axis_meaning, text(recover->axis));
  recover.flag("--all", "Every axis there is", recover->all);
  recover.object(
      [](const verb::Recover& said, bool) {
        return said.axis.empty() != said.all ? "name one axis, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
}

void add_errors(Grammar& grammar) {
  auto errors =
      grammar.verb<verb::Errors>("errors", "Say what modules report as wrong", help_text::errors);
  errors.optional_word("AXIS", axis_meaning, text(errors->axis));
}

void add_deadman(Grammar& grammar) {
  const auto group = grammar.group("deadman", "Modules that stop their motors when nobody is there",
                                   help_text::deadman);
  auto set = grammar.verb<verb::SetDeadman>(group, "set", "Switch it on, in the module's EEPROM",
                                            help_text::deadman);
  set.axis(set->axis);
  set.word("MS", "How long after the last command it stops them, 100 to 65535",
           number(set->ms, tmcld::shortest_deadman_ms, tmcld::longest_deadman_ms));
  auto off = grammar.verb<verb::SetDeadman>(group, "off", "Switch it off, in the module's EEPROM",
                                            help_text::deadman);
  off.axis(off->axis);
  auto test = grammar.verb<verb::TestDeadman>(
      group, "test", "Move the axis slowly, send its module nothing, and see when it stops",
      help_text::deadman);
  test.axis(test->axis);
}

namespace {

/// "-2mm..2mm"
tl::expected<void, std::string> read_travel(const std::string& said, verb::Verify& verb) {
  constexpr std::string_view between = "..";
  const auto at = said.find(between);
  const auto end = at == std::string::npos ? at : at + between.size();
  if (at == std::string::npos || at == 0 || end == said.size())
    return tl::unexpected("'" + said + "' is no travel, such as -2mm..2mm");
  verb.travel_from = said.substr(0, at);
  verb.travel_to = said.substr(end);
  return {};
}

}  // namespace

void add_verify(Grammar& grammar) {
  auto verify = grammar.verb<verb::Verify>(
      "verify", "Find out in what a module is not like its twin", help_text::verify_module);
  verify.axis(verify->axis);
  auto& values = *verify.operator->();
  verify.option("--travel", "FROM..TO",
                "How far it may go from where it stands; without it, to its soft limits",
                [&values](const std::string& said) { return read_travel(said, values); });
  verify.option("--report", "FILE", "Write what was found; '-': to standard output",
                text(verify->report));
  verify.flag("--yes", "Do not ask whether the axis may move", verify->yes);
  verify.internal(verify->internal);
  verify.object([](const verb::Verify& said, bool json) {
    return json && said.report == "-" ? "--json and '--report -' both want standard output" : "";
  });
}

void add_coordinates(Grammar& grammar) {
  const auto group = grammar.group("coordinate", "Positions that modules remember by number",
                                   help_text::coordinate);
  auto set = add_coordinate(grammar, group, "set", "coordinate.set", "Remember a position");
  set.word("POSITION", "With a unit, or microsteps where there is none; may be negative",
           text(set->position));
  set.internal(set->internal);
  auto get = add_coordinate(grammar, group, "get", "coordinate.get", "Print a coordinate");
  get.internal(get->internal);
  auto capture =
      add_coordinate(grammar, group, "capture", "coordinate.capture", "Remember where the axis is");
  capture.internal(capture->internal);
  add_coordinate(grammar, group, "move", "coordinate.move", "Start a move to a coordinate");
  auto start = ask(grammar, group, "start", "coordinate.start",
                   "Start several motors of a module together", help_text::coordinate_start);
  start.module(start->module);
  start.word("NUMBER", "Of the coordinate, 0 to 20", number(start->number, 0, greatest_coordinate));
  start.words("MOTOR", "One or more, 0 to 5", numbers(start->motors, 0, last_motor_to_start));
  start.flag("--arrive-together", "The nearer ones go slower, so that all arrive at once",
             start->interpolated);
  start.object([](const verb::Ask& said, bool) {
    return said.motors.empty() ? "name at least one motor" : "";
  });
  add_all_coordinates(grammar, group, "store", "coordinate.store",
                      "Copy those of the axis's module to its EEPROM");
  add_all_coordinates(grammar, group, "load", "coordinate.load", "And back");
}

void add_arrivals(Grammar& grammar) {
  auto arrivals = grammar.verb<verb::Arrivals>("arrivals", "Let a module tell when motors arrive",
                                               help_text::arrivals);
  arrivals.module(arrivals->module);
  arrivals.words("MOTOR", "One or more", numbers(arrivals->motors, 0, last_motor_to_tell));
  arrivals.flag("--next", "Only of the next move of each", arrivals->next);
  arrivals.flag("--off", "Let it tell no more", arrivals->off);
  arrivals.option("--for", "SECONDS", "End after so long",
                  number(arrivals->for_s, shortest_time_s, longest_time_s));
  arrivals.object([](const verb::Arrivals& said, bool) {
    if (!said.off) return said.motors.empty() ? "name at least one motor, or say --off" : "";
    const bool says_more = !said.motors.empty() || said.next || said.for_s;
    return says_more ? "--off goes with nothing else" : "";
  });
}

void add_eeprom(Grammar& grammar) {
  auto store = ask(grammar, "store", "parameter.store",
                   "Keep a parameter's value when the module loses power", help_text::store);
  store.axis(store->axis);
  add_parameter(store);
  auto restore =
      ask(grammar, "restore", "parameter.restore", "Take back what was stored", help_text::restore);
  restore.axis(restore->axis);
  add_parameter(restore);
}

void add_modules(Grammar& grammar) {
  const auto global =
      grammar.group("global", "Parameters of modules as a whole", help_text::global);
  add_global(grammar, global, "get", "global.get", "Print one bare value");
  auto set = add_global(grammar, global, "set", "global.set", "Set it");
  set.word("VALUE", "The new value", number(set->value));
  add_global(grammar, global, "store", "global.store", "Keep it when the module loses power");
  add_global(grammar, global, "restore", "global.restore", "Take back what was stored");

  auto input = ask(grammar, "input", "io.get", "Read an input of a module", help_text::input);
  input.module(input->module);
  input.word("PORT", "Its number", number(input->port, 0, greatest_port));
  input.option("--bank", "N", "0 digital (default), 1 analog, 2 the state of an output",
               number(input->bank, 0, 2));
  auto output =
      ask(grammar, "output", "io.get", "Set an output of a module, or read it", help_text::output);
  constexpr std::int32_t digital_outputs = 2;
  output->bank = digital_outputs;
  output.module(output->module);
  output.word("PORT", "Its number", number(output->port, 0, greatest_port));
  output.optional_word("VALUE", "0 or 1; without it, the output is read",
                       [output](const std::string& text) {
                         output->method = "io.set";
                         output->bank.reset();
                         return number(output->value)(text);
                       });
  auto info = ask(grammar, "info", "module.info", "Show what a module's firmware says of itself",
                  help_text::info);
  info.module(info->module);
  auto reset = ask(grammar, "reset", "module.reset", "Restart a module", help_text::reset);
  reset.module(reset->module);
  auto factory =
      ask(grammar, "factory-reset", "module.factory_reset",
          "Set everything in a module back to how it was delivered", help_text::factory_reset);
  factory.module(factory->module);
  factory.flag("--yes", "Really", factory->sure);
  factory.object(
      [](const verb::Ask& said, bool) {
        return said.sure ? "" : "all that is stored in the module would be lost: say --yes";
      },
      "Its address and its baud rate change too");
}

void add_module_programs(Grammar& grammar, const Form& program) {
  for (const bool compares : {false, true}) {
    auto upload = grammar.verb<verb::Upload>(
        program, compares ? "verify" : "upload",
        compares ? "Compare a file with the program in a module" : "Load a program into a module",
        compares ? help_text::verify : help_text::upload);
    upload->only_compare = compares;
    upload.word("FILE", "A program's text, or a program file (*.bin)", text(upload->file));
    upload.module(upload->module);
    upload.option("--start", "ADDRESS", "Where its first command is (default 0)",
                  number(upload->first_address, 0, greatest_place));
    if (compares) continue;
    upload.flag("--no-verify", "Do not read it back and compare", upload->no_compare);
    upload.flag("--run", "Run it then", upload->run);
  }
  auto download = grammar.verb<verb::Download>(program, "download", "Read a module's program",
                                               help_text::download);
  download.module(download->module);
  download.option("-o,--output", "FILE", "Write it there: text, or a program file (*.bin)",
                  text(download->output));
  download.option("--start", "ADDRESS", "From here on (default 0)",
                  number(download->first_address, 0, greatest_place));
  download.option("--length", "N", "So many commands; otherwise up to its end",
                  number(download->length, 1, most_lines));
  auto run = ask(grammar, program, "run", "program.run", "Run the program in a module",
                 help_text::program_run);
  run.module(run->module);
  run.option("--start", "ADDRESS", "From there; otherwise from where it stands",
             number(run->first_address, 0, greatest_place));
  add_program_verb(grammar, program, "stop", "program.stop", "End it; motors go on",
                   help_text::program_stop);
  add_program_verb(grammar, program, "step", "program.step", "Execute one command of it",
                   help_text::program_step);
  add_program_verb(grammar, program, "reset", "program.reset", "End it, and back to its start",
                   help_text::program_reset);
  add_program_verb(grammar, program, "status", "program.status", "Show what it does",
                   help_text::program_status);
  auto set = ask(grammar, program, "breakpoint", "program.set_breakpoint", "Stop it somewhere",
                 help_text::breakpoint);
  set.module(set->module);
  set.word("ADDRESS", "Where", number(set->at, 0, greatest_place));
  auto clear = ask(grammar, program, "clear-breakpoint", "program.clear_breakpoint",
                   "Do not stop it there any more", help_text::breakpoint);
  clear.module(clear->module);
  clear.word("ADDRESS", "Where", number(clear->at, 0, greatest_place));
  add_program_verb(grammar, program, "clear-breakpoints", "program.clear_breakpoints",
                   "Do not stop it anywhere any more", help_text::breakpoint);
}

void add_raw(Grammar& grammar) {
  auto raw = grammar.verb<verb::Raw>("raw", "Send one command as it is", help_text::raw);
  raw.option("--bus", "NAME", "Which of tmcld's buses; needed if there are several",
             text(raw->bus));
  raw.word("ADDRESS", "The module's address", number(raw->address, 0, greatest_address));
  raw.word("COMMAND", "Name such as GAP, or number", text(raw->command));
  raw.word("TYPE", "Name such as ABS or a parameter's, or number", text(raw->type));
  raw.word("MOTOR", "Motor or bank", number(raw->motor));
  raw.word("VALUE", "May be negative", number(raw->value));
}

void add_firmware(Grammar& grammar) {
  const auto firmware = grammar.group("firmware", "Firmware files, and new firmware for a module",
                                      help_text::firmware);
  auto info = grammar.verb<verb::FirmwareInfo>(firmware, "info", "What is in a firmware file",
                                               help_text::firmware_info);
  info.word("FILE", "An Intel HEX file", text(info->file));
  auto check = grammar.verb<verb::CheckFirmware>(
      firmware, "check", "Does a firmware file belong to a module?", help_text::firmware_check);
  check.word("FILE", "An Intel HEX file", text(check->file));
  check.module(check->module);
  auto upload = grammar.verb<verb::UploadFirmware>(
      firmware, "upload", "Exchange the firmware of a module", help_text::firmware_upload);
  upload.word("FILE", "An Intel HEX file", text(upload->file));
  upload.module(upload->module);
  upload.flag("--force", "Also a file that does not say that it is for this model", upload->force);
}

}  // namespace tmclctl
