#include "options.hpp"

#include <charconv>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "help_text.hpp"
#include "profile/generators.hpp"
#include "profile/setup.hpp"
#include "tmcl/command.hpp"
#include "tmcl/nearest.hpp"
#include "tmcl/parameter.hpp"

namespace tmclctl {
namespace {

constexpr std::uint16_t greatest_address = 2047;
constexpr double longest_time_s = 1e6;
constexpr double longest_simulated_time = 1e9;
constexpr double shortest_csv_step = 1e-9;

// CLI11 would read 010 as octal and 2147483648 as something else.
template <class Number>
Number parse_number(std::string_view text, Number least, Number greatest) {
  auto digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = end == digits.data() + digits.size() && error != std::errc::invalid_argument;
  if (!whole)
    throw CLI::ValidationError(
        fmt::format("'{}' is no {}number", text, std::is_integral_v<Number> ? "whole " : ""));
  if (error != std::errc{} || !(value >= least && value <= greatest)) {
    throw CLI::ValidationError(fmt::format("{} is not within {} to {}", text, least, greatest));
  }
  return value;
}

template <class Number>
CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& description,
                        Number& into, Number least = std::numeric_limits<Number>::lowest(),
                        Number greatest = std::numeric_limits<Number>::max()) {
  const auto read = [&into, least, greatest](const std::string& text) {
    into = parse_number<Number>(text, least, greatest);
  };
  return app.add_option_function<std::string>(name, read, description)->type_name("");
}

template <class Number>
CLI::Option* add_optional(CLI::App& app, const std::string& name, const std::string& description,
                          std::optional<Number>& into,
                          Number least = std::numeric_limits<Number>::lowest(),
                          Number greatest = std::numeric_limits<Number>::max()) {
  const auto read = [&into, least, greatest](const std::string& text) {
    into = parse_number<Number>(text, least, greatest);
  };
  return app.add_option_function<std::string>(name, read, description);
}

void read_range(const std::string& text, ScanRange& range) {
  const auto dash = text.find('-');
  const auto first = text.substr(0, dash);
  const auto last = dash == std::string::npos ? first : text.substr(dash + 1);
  range.first = parse_number<std::uint16_t>(first, 0, greatest_address);
  range.last = parse_number<std::uint16_t>(last, range.first, greatest_address);
}

std::vector<double> read_times(const std::vector<std::string>& lists) {
  std::vector<double> times;
  for (const auto& list : lists) {
    for (std::size_t begin = 0; begin <= list.size();) {
      const auto comma = std::min(list.find(',', begin), list.size());
      times.push_back(parse_number<double>(std::string_view(list).substr(begin, comma - begin), 0,
                                           longest_simulated_time));
      begin = comma + 1;
    }
  }
  return times;
}

verb::Simulate::Change read_change(const std::string& text) {
  const auto colon = text.find(':');
  if (colon == std::string::npos)
    throw CLI::ValidationError(fmt::format("'{}' is no SECONDS:REGISTER=VALUE", text));
  return {parse_number<double>(std::string_view(text).substr(0, colon), 0, longest_simulated_time),
          text.substr(colon + 1)};
}

bool is_visible(const CLI::App* verb) { return !verb->get_group().empty(); }

/// The visible verbs under this one.
std::vector<const CLI::App*> verbs_under(const CLI::App& app) {
  return app.get_subcommands(is_visible);
}

/// As it is typed: "profile simulate".
std::string full_name(const CLI::App& verb) {
  const auto* parent = verb.get_parent();
  const bool outermost = parent == nullptr || parent->get_parent() == nullptr;
  return outermost ? verb.get_name() : full_name(*parent) + ' ' + verb.get_name();
}

/// The grammar of the command line, and where its values go.
class Parser {
 public:
  Parser();
  Attempt<std::variant<Options, Information>> parse(const std::vector<std::string>& arguments);

 private:
  CLI::App& add_group(CLI::App& parent, const std::string& name, const std::string& description,
                      const char* footer);
  template <class T>
  CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description,
                     T& values, const char* footer = "");
  template <class T>
  CLI::App& add_verb(const std::string& name, const std::string& description, T& values,
                     const char* footer = "") {
    return add_verb(app_, name, description, values, footer);
  }
  void add_axis(CLI::App& verb, std::string& into);
  void add_lists();
  void add_parameters();
  void add_motion();
  void add_watch();
  void add_plot();
  void add_raw();
  void add_profile();
  void add_program();
  void add_complete();

  Information complete() const;
  Failure failure_from(const CLI::ParseError& error) const;
  std::optional<Failure> unknown_word() const;
  std::optional<Failure> conflicting_options() const;
  const CLI::App& chosen() const;
  std::vector<std::string> verbs(const CLI::App& app) const;
  const CLI::App& complete_verb() const;
  std::vector<std::string> options_of(const CLI::App& app) const;

  CLI::App app_{help_text::description, "tmclctl"};
  Options options_;
  std::map<const CLI::App*, std::function<Verb()>> verbs_;
  verb::Scan scan_;
  verb::Modules modules_;
  verb::Axes axes_;
  verb::Params params_;
  verb::Get get_;
  verb::Set set_;
  verb::Move move_;
  verb::Rotate rotate_;
  verb::Stop stop_;
  verb::State state_;
  verb::Watch watch_;
  verb::Plot plot_;
  verb::Raw raw_;
  verb::Simulate simulate_;
  verb::Assemble assemble_;
  verb::Disassemble disassemble_;
  verb::Complete complete_;
  std::vector<std::string> complete_for_;
};

Parser::Parser() {
  app_.require_subcommand(1);
  app_.set_version_flag("--version", "tmclctl " TMCL_VERSION);
  app_.footer(help_text::footer);
  app_.get_formatter()->column_width(32);
  app_.get_formatter()->label("SUBCOMMAND", "VERB");
  app_.get_formatter()->label("REQUIRED", "");
  app_.add_option("--socket", options_.where.socket, "Socket of the tmcld to use")
      ->type_name("PATH")
      ->take_last();
  app_.add_option("--direct", options_.where.direct,
                  "Use a bus without tmcld: serial:DEVICE[@BAUD], can:INTERFACE or tcp:HOST:PORT")
      ->type_name("LINK")
      ->take_last();
  app_.add_flag("--json", options_.json, "One JSON document on standard output, for errors too");
  add_lists();
  add_parameters();
  add_motion();
  add_watch();
  add_plot();
  add_raw();
  add_profile();
  add_program();
  add_complete();
}

CLI::App& Parser::add_group(CLI::App& parent, const std::string& name,
                            const std::string& description, const char* footer) {
  auto* verb = parent.add_subcommand(name, description);
  verb->fallthrough();
  verb->group("Verbs");
  verb->footer(footer);
  return *verb;
}

template <class T>
CLI::App& Parser::add_verb(CLI::App& parent, const std::string& name,
                           const std::string& description, T& values, const char* footer) {
  auto& verb = add_group(parent, name, description, footer);
  verbs_[&verb] = [&values] { return Verb(values); };
  return verb;
}

void Parser::add_axis(CLI::App& verb, std::string& into) {
  verb.add_option("AXIS", into, "A configured name, or ADDRESS/MOTOR with --direct")
      ->required()
      ->type_name("");
}

void Parser::add_lists() {
  auto& scan = add_verb("scan", "Look for modules on all addresses", scan_, help_text::scan);
  scan.add_option_function<std::string>(
          "--addresses", [this](const std::string& text) { read_range(text, scan_.range); },
          "Only these addresses (default 1-255)")
      ->type_name("FIRST-LAST");
  add_verb("modules", "List the modules that tmcld serves", modules_);
  add_verb("axes", "List the axes and how they are called", axes_);
  auto& params = add_verb("params", "List the parameters of an axis", params_);
  add_axis(params, params_.axis);
  params.add_flag("--values", params_.values, "Read them all, too");
}

void Parser::add_parameters() {
  auto& get = add_verb("get", "Read a parameter: prints one bare value", get_, help_text::get);
  add_axis(get, get_.axis);
  get.add_option("PARAM", get_.parameter, "Number or standard name")->required()->type_name("");
  auto& set = add_verb("set", "Set a parameter", set_, help_text::set);
  add_axis(set, set_.axis);
  set.add_option("PARAM", set_.parameter, "Number or standard name")->required()->type_name("");
  add_number(set, "VALUE", "The new value", set_.value)->required();
}

void Parser::add_motion() {
  auto& move = add_verb("move", "Move to a position, or by a distance", move_, help_text::move);
  add_axis(move, move_.axis);
  add_number(move, "POSITION", "Where to go, in microsteps; may be negative", move_.position)
      ->required();
  move.add_flag("--by", move_.by, "POSITION is the distance from where the axis is now");
  move.add_flag("--wait", move_.wait, "Wait until the axis stands at its target");
  add_optional(move, "--timeout", "With --wait: give up after so long; the axis goes on",
               move_.timeout_s, 0.001, longest_time_s)
      ->type_name("SECONDS");
  auto& rotate = add_verb("rotate", "Turn without end", rotate_, help_text::rotate);
  add_axis(rotate, rotate_.axis);
  add_number(rotate, "VELOCITY", "In the module's unit; negative: to the left", rotate_.velocity)
      ->required();
  auto& stop = add_verb("stop", "Stop an axis, or all of them", stop_, help_text::stop);
  stop.add_option("AXIS", stop_.axis, "A configured name, or ADDRESS/MOTOR with --direct")
      ->type_name("");
  stop.add_flag("--all", stop_.all, "Every axis there is");
}

void Parser::add_watch() {
  auto& state = add_verb("state", "Show where an axis is and what it does", state_);
  add_axis(state, state_.axis);
  auto& watch = add_verb("watch", "Show every change of an axis", watch_, help_text::watch);
  add_axis(watch, watch_.axis);
  watch
      .add_option_function<std::string>(
          "--interval",
          [this](const std::string& text) {
            watch_.interval = std::chrono::milliseconds(parse_number<int>(text, 10, 60'000));
          },
          "At most one line in so many milliseconds (default 100)")
      ->type_name("MS");
  add_optional(watch, "--for", "End after so long", watch_.for_s, 0.001, longest_time_s)
      ->type_name("SECONDS");
}

void Parser::add_plot() {
  auto& plot =
      add_verb("plot", "Record a movement and draw position and velocity", plot_, help_text::plot);
  add_axis(plot, plot_.axis);
  add_optional(plot, "--to", "Start a move to this position", plot_.to)->type_name("POSITION");
  add_optional(plot, "--by", "Start a move by this distance", plot_.by)->type_name("DISTANCE");
  add_optional(plot, "--for", "Record for so long at most", plot_.for_s, 0.001, longest_time_s)
      ->type_name("SECONDS");
  plot.add_option("--svg", plot_.svg, "Write the drawing to this file, too")->type_name("FILE");
  plot.add_option("--csv", plot_.csv,
                  "Write the samples to this file, too; '-': to standard output instead")
      ->type_name("FILE");
}

void Parser::add_raw() {
  auto& raw = add_verb("raw", "Send one command as it is", raw_, help_text::raw);
  raw.add_option("--bus", raw_.bus, "Which of tmcld's buses; needed if there are several")
      ->type_name("NAME");
  add_number<std::uint16_t>(raw, "ADDRESS", "The module's address", raw_.address, 0,
                            greatest_address)
      ->required();
  raw.add_option("COMMAND", raw_.command, "Name such as GAP, or number")->required()->type_name("");
  raw.add_option("TYPE", raw_.type, "Name such as ABS or a parameter's, or number")
      ->required()
      ->type_name("");
  add_number<std::uint8_t>(raw, "MOTOR", "Motor or bank", raw_.motor)->required();
  add_number(raw, "VALUE", "May be negative", raw_.value)->required();
}

void Parser::add_profile() {
  auto& profile =
      add_group(app_, "profile", "Compute movements, without any module", help_text::profile);
  profile.require_subcommand(1);
  auto& simulate = add_verb(profile, "simulate", "What a chip's ramp generator makes of registers",
                            simulate_, help_text::simulate);
  std::vector<std::string_view> generators;
  for (const auto& generator : profile::generators()) generators.push_back(generator.name);
  simulate
      .add_option("--generator", simulate_.generator,
                  fmt::format("One of {}", fmt::join(generators, ", ")))
      ->required()
      ->type_name("NAME");
  simulate
      .add_option("REGISTER=VALUE", simulate_.settings,
                  "What is written before it starts; the others stay as at power-up")
      ->type_name("");
  simulate
      .add_option_function<std::vector<std::string>>(
          "--change",
          [this](const std::vector<std::string>& texts) {
            for (const auto& text : texts) simulate_.changes.push_back(read_change(text));
          },
          "Write a register at this time; may be given many times")
      ->allow_extra_args(false)
      ->type_name("SECONDS:REGISTER=VALUE");
  simulate
      .add_option_function<std::vector<std::string>>(
          "--sample",
          [this](const std::vector<std::string>& lists) { simulate_.samples = read_times(lists); },
          "With --json: the motion at these times")
      ->allow_extra_args(false)
      ->type_name("SECONDS,...");
  add_optional(simulate, "--until", "End then, and not when it stands on its target",
               simulate_.until, 0.0, longest_simulated_time)
      ->type_name("SECONDS");
  add_optional(simulate, "--csv", "Print t,x,v,a every so often instead of drawing",
               simulate_.csv_step, shortest_csv_step, longest_simulated_time)
      ->type_name("SECONDS");
  simulate.add_option("--svg", simulate_.svg, "Draw into this file, not on the screen")
      ->type_name("FILE");
}

void Parser::add_program() {
  auto& program = add_group(app_, "program", "Stand-alone programs: from text to bytes and back",
                            help_text::program);
  program.require_subcommand(1);
  auto& assemble = add_verb(program, "assemble", "Make a program file of a program's text",
                            assemble_, help_text::assemble);
  assemble.add_option("FILE", assemble_.file, "The text")->required()->type_name("");
  assemble.add_option("-o,--output", assemble_.output, "Write the program into this file")
      ->type_name("FILE");
  assemble.add_flag("--listing", assemble_.listing,
                    "Print the listing, too: addresses, bytes and text");
  auto& disassemble = add_verb(program, "disassemble", "Make text of a program file", disassemble_,
                               help_text::disassemble);
  disassemble.add_option("FILE", disassemble_.file, "The program file")->required()->type_name("");
  disassemble
      .add_option("-o,--output", disassemble_.output,
                  "Write the text into this file, do not print it")
      ->type_name("FILE");
}

void Parser::add_complete() {
  auto& complete = add_verb("__complete", "", complete_);
  complete.group("");
  complete.add_option("WHAT", complete_.what)->required();
  complete.add_option("FOR", complete_for_);
}

const CLI::App& Parser::chosen() const {
  const auto* verb = &app_;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  return *verb;
}

std::vector<std::string> Parser::verbs(const CLI::App& app) const {
  std::vector<std::string> names;
  for (const auto* verb : verbs_under(app)) names.push_back(verb->get_name());
  return names;
}

/// As far as the words are verbs.
const CLI::App& Parser::complete_verb() const {
  const auto* verb = &app_;
  for (const auto& word : complete_for_) {
    const auto under = verbs_under(*verb);
    const auto found = std::ranges::find(under, word, &CLI::App::get_name);
    if (found == under.end()) break;
    verb = *found;
  }
  return *verb;
}

std::vector<std::string> Parser::options_of(const CLI::App& app) const {
  std::vector<std::string> names;
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// The registers of a generator, as "v_max="; of one of them, the names of its values.
std::vector<std::string> register_words(const std::vector<std::string>& names) {
  const auto generators = profile::generators();
  const auto generator =
      std::ranges::find(generators, names.empty() ? "" : names[0], &profile::GeneratorInfo::name);
  if (generator == generators.end()) return {};
  std::vector<std::string> words;
  if (names.size() == 1) {
    for (const auto& info : generator->registers) words.push_back(fmt::format("{}=", info.name));
    if (generator->clocked) words.push_back(fmt::format("{}=", profile::clock_name));
    return words;
  }
  for (const auto& symbol : generator->symbols) {
    if (symbol.register_name == names[1]) words.emplace_back(symbol.name);
  }
  return words;
}

Information Parser::complete() const {
  std::vector<std::string> words;
  if (complete_.what == "verbs") words = verbs(complete_verb());
  if (complete_.what == "options") {
    words = options_of(app_);
    for (auto& name : options_of(complete_verb())) {
      if (std::ranges::find(words, name) == words.end()) words.push_back(std::move(name));
    }
  }
  if (complete_.what == "parameters") {
    for (const auto family : tmcl::families) {
      for (const auto& row : tmcl::axis_parameters(family)) {
        if (std::ranges::count(words, row.name) == 0) words.emplace_back(row.name);
      }
    }
  }
  if (complete_.what == "commands") {
    for (const auto& row : tmcl::command_table()) words.emplace_back(row.name);
  }
  if (complete_.what == "generators") {
    for (const auto& generator : profile::generators()) words.emplace_back(generator.name);
  }
  if (complete_.what == "registers") words = register_words(complete_for_);
  return {words.empty() ? std::string{} : fmt::format("{}\n", fmt::join(words, "\n"))};
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  const auto text = tmcl::did_you_mean(word, views);
  return text.empty() ? text : text.substr(1) + ' ';
}

std::optional<Failure> Parser::unknown_word() const {
  const auto words = app_.remaining(true);
  if (words.empty()) return std::nullopt;
  const auto& word = words.front();
  const auto& verb = chosen();
  const auto help = &verb == &app_
                        ? std::string("'tmclctl --help' lists them all")
                        : fmt::format("'tmclctl {} --help' explains it", full_name(verb));
  if (word.starts_with('-')) {
    auto known = options_of(app_);
    for (const auto& name : options_of(verb)) known.push_back(name);
    const auto option = word.substr(0, word.find('='));
    return usage_failure("unknown_option", fmt::format("there is no option '{}'", option),
                         did_you_mean(option, known) + help);
  }
  if (const auto names = verbs(verb); !names.empty()) {
    const auto outer = &verb == &app_ ? "" : full_name(verb) + ' ';
    return usage_failure("unknown_verb", fmt::format("there is no verb '{}{}'", outer, word),
                         did_you_mean(word, names) + help);
  }
  return usage_failure(
      "usage", fmt::format("'{}' is one word too many for '{}'", word, full_name(verb)), help);
}

Failure Parser::failure_from(const CLI::ParseError& error) const {
  if (auto unknown = unknown_word()) return *unknown;
  const auto& verb = chosen();
  if (&verb == &app_) {
    return usage_failure(
        "usage",
        dynamic_cast<const CLI::RequiredError*>(&error) != nullptr
            ? "what is to be done? A verb is missing, such as scan, axes, move or stop"
            : error.what(),
        "'tmclctl --help' lists them all, with examples");
  }
  const auto name = full_name(verb);
  const auto names = verbs(verb);
  return usage_failure("usage",
                       names.empty()
                           ? fmt::format("{}: {}", name, error.what())
                           : fmt::format("{}: a verb is missing: {}", name, fmt::join(names, ", ")),
                       fmt::format("'tmclctl {} --help' explains it, with examples", name));
}

// CLI11's own "excludes" and "needs" would clutter the help.
std::optional<Failure> Parser::conflicting_options() const {
  const auto name = full_name(chosen());
  if (!options_.where.socket.empty() && !options_.where.direct.empty()) {
    return usage_failure("usage",
                         "--socket and --direct exclude each other: through tmcld, or without it?");
  }
  if (name == "stop" && stop_.axis.empty() != stop_.all) {
    return usage_failure("usage", "stop: name one axis, or say --all",
                         "'tmclctl axes' lists the axes");
  }
  if (name == "move" && move_.timeout_s && !move_.wait) {
    return usage_failure("usage", "move: --timeout says how long to wait, and that needs --wait");
  }
  if (name == "plot" && plot_.to && plot_.by) {
    return usage_failure("usage", "plot: --to and --by exclude each other");
  }
  if (name == "plot" && options_.json && plot_.csv == "-") {
    return usage_failure("usage", "plot: --json and '--csv -' both want standard output");
  }
  const int forms =
      (options_.json ? 1 : 0) + (simulate_.csv_step ? 1 : 0) + (simulate_.svg.empty() ? 0 : 1);
  if (name == "profile simulate" && forms > 1) {
    return usage_failure("usage", "profile simulate: --json, --csv and --svg exclude each other");
  }
  if (name == "profile simulate" && !simulate_.samples.empty() && !options_.json) {
    return usage_failure("usage", "profile simulate: --sample needs --json");
  }
  return std::nullopt;
}

Attempt<std::variant<Options, Information>> Parser::parse(
    const std::vector<std::string>& arguments) {
  try {
    app_.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::Success& asked) {
    std::ostringstream text;
    app_.exit(asked, text, text);
    return Information{text.str()};
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(failure_from(error));
  }
  const auto& verb = chosen();
  if (verb.get_name() == "__complete" && complete_.what != "axes") return complete();
  if (auto conflict = conflicting_options()) return tl::unexpected(*conflict);
  options_.verb = verbs_.at(&verb)();
  return options_;
}

}  // namespace

Attempt<std::variant<Options, Information>> parse_options(
    const std::vector<std::string>& arguments) {
  return Parser().parse(arguments);
}

}  // namespace tmclctl
