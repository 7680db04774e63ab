#include "options.hpp"

#include <algorithm>
#include <array>
#include <sstream>

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "axis/arrival_wait.hpp"
#include "completion.hpp"
#include "grammar.hpp"
#include "tmcl/spelling.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl {
namespace {

// As reply_timeout_ms of a bus.
constexpr std::int32_t longest_reply_timeout_ms = 60'000;

constexpr const char* program_description =
    "Moves and inspects the axes of TMCM modules, through a running tmcld or straight on a bus.";

constexpr const char* program_help = R"(
An AXIS is a name from tmcld's configuration, or the module's address and the motor's number, such as
1/0, or bench:1/0 where there are several buses. With --direct, names come from --config FILE.
A PARAM is a number or a standard name, such as max_velocity: 'tmclctl params AXIS' lists them.
A position, distance, velocity or acceleration has a unit behind its number: 51200microsteps, 1.5rev,
2rps, 120rpm, 61035pps, 100000pps/s, and, if tmcld's configuration gives the axis a unit such as mm:
10mm, 100um, 1in, 5mm/s, 50mm/s^2 (or 50mm/s2). On an axis without such a unit a bare number is what
the module counts in: microsteps; for velocities see 'tmclctl params AXIS'. On an axis with one, a
bare number other than 0 is refused, unless --internal says that it is what the module counts. The
VALUE of 'set' is always that if it is bare. With --direct, turns are counted by the module's
microsteps (parameter 140) and --full-steps. What is told of an axis with a unit is in that unit; with
--internal it is what the module counts.

Examples:
  tmclctl scan                                   which modules are there?
  tmclctl axes                                   which axes does tmcld know?
  tmclctl move x 51200 --wait                    go to 51200 and wait until it stands there
  tmclctl move x -1000 --by                      go back by 1000
  tmclctl rotate x -500                          turn left until Ctrl-C
  tmclctl stop x                                 stop
  tmclctl stop --all                             stop everything
  tmclctl set x max_velocity 1500                until the module loses power ...
  tmclctl store x max_velocity                   ... or for good
  tmclctl home x                                 search the reference position
  tmclctl plot x --by 51200 --svg move.svg       move and draw how it went
  tmclctl --direct serial:/dev/ttyACM0@115200 get 1/0 actual_position
  tmclctl --direct can:can0 --config tmcld.toml move x 12.5mm --wait
  tmclctl --url https://gateway.example:4143 --token-file lab.token stop --all
  tmclctl --json state x                         for scripts: one JSON document
  tmclctl profile simulate --help                how would a chip move?
  tmclctl program upload loop.tmc 1 --run        programs that modules run by themselves

Exit codes:
    0  done
    1  the module or tmcld refused, and nothing changed; or it was done, and the output could not be
       written
    2  the command line asks for something that does not exist or is out of range, or a file that it
       names is wrong or cannot be written; nothing was sent
    3  not sent: no connection, no answer from the module lately; or a reading without an answer;
       nothing changed
    4  outcome unknown: sent, but no answer; it may have been executed
    5  the wait ended early: the move was interrupted, or --timeout passed
  130  Ctrl-C while waiting: the axis goes on moving (143 for SIGTERM)
With --json an error is a JSON document on standard output, too:
  {"error": {"name": ..., "message": ..., "hint": ..., "outcome": ..., "exit_code": ...}}

Environment:
  TMCLD_SOCKET  the daemon's socket, if --socket is not given (otherwise /run/tmcld/tmcld.sock)
  NO_COLOR      no colours, if set
)";

constexpr const char* help_help = R"(
  tmclctl help move
  tmclctl help program upload
)";

bool is_visible(const CLI::App* verb) { return !verb->get_group().empty(); }

/// The visible verbs under this one.
std::vector<const CLI::App*> verbs_under(const CLI::App& app) {
  return app.get_subcommands(is_visible);
}

/// The grammar of the command line, and where its values go.
class Parser {
 public:
  Parser();
  Result<std::variant<Options, Information>> parse(const std::vector<std::string>& arguments);
  std::vector<VerbInfo> verb_table() const { return grammar_.infos(); }

 private:
  void add_help();
  Result<std::variant<Options, Information>> help() const;
  void add_complete();
  Information complete() const;
  std::variant<Options, Information> complete_line_of(const std::vector<std::string>& arguments);
  Error error_from(const CLI::ParseError& error) const;
  std::optional<Error> unknown_word() const;
  std::optional<Error> unknown_verb(const CLI::App& outer, const std::string& word) const;
  std::string how_to_help(const CLI::App& verb) const;
  std::optional<Error> conflicting_options() const;
  const CLI::App& chosen() const;
  std::vector<std::string> verbs(const CLI::App& app) const;
  std::vector<const CLI::App*> path_of(const std::vector<std::string>& words) const;
  const CLI::App& complete_verb() const { return *path_of(complete_for_).back(); }
  std::vector<std::string> options_of(const CLI::App& app) const;

  CLI::App app_{program_description, "tmclctl"};
  Options options_;
  Grammar grammar_{app_};
  verb::Complete complete_;
  std::vector<std::string> complete_for_;
  std::vector<std::string> help_for_;
};

/// Help has words by their own names.
class HelpForm final : public CLI::Formatter {
  std::string make_option_name(const CLI::Option* option, bool is_word) const override {
    return is_word ? name_of_word(*option) : CLI::Formatter::make_option_name(option, is_word);
  }
};

Parser::Parser() {
  app_.formatter(std::make_shared<HelpForm>());
  app_.require_subcommand(1);
  app_.set_version_flag("--version", "tmclctl " TMCL_VERSION);
  app_.footer(program_help);
  app_.get_formatter()->column_width(32);
  app_.get_formatter()->label("SUBCOMMAND", "VERB");
  app_.get_formatter()->label("REQUIRED", "");
  app_.add_option("--socket", options_.where.socket, "Socket of the tmcld to use")
      ->type_name("PATH")
      ->take_last();
  app_.add_option("--url", options_.where.web.url,
                  "The tmcld on another computer: https://HOST:PORT, or http://HOST:PORT")
      ->type_name("URL")
      ->take_last();
  app_.add_option("--token-file", options_.where.web.token_file,
                  "With --url: file with the token that lets this program in")
      ->type_name("FILE")
      ->take_last();
  app_.add_option("--ca", options_.where.web.ca_file,
                  "With --url or --fleet: certificate that vouches for that of tmcld or the broker")
      ->type_name("FILE")
      ->take_last();
  app_.add_option("--fleet", options_.where.fleet.url,
                  "Many gateways, on this broker: mqtts://[USER@]HOST[:PORT], or mqtt://...")
      ->type_name("URL")
      ->take_last();
  Form(app_).option("-g,--gateways", "NAMES", "With --fleet: only these, such as hall1,'hall3-*'",
                    list(options_.where.fleet.gateways));
  app_.add_option("--cert", options_.where.fleet.certificate_file,
                  "With --fleet: certificate that says who this is")
      ->type_name("FILE")
      ->take_last();
  app_.add_option("--key", options_.where.fleet.key_file, "With --fleet: key of that")
      ->type_name("FILE")
      ->take_last();
  app_.add_option("--password-file", options_.where.fleet.password_file,
                  "With --fleet: file with the password of USER")
      ->type_name("FILE")
      ->take_last();
  app_.add_option("--direct", options_.where.direct,
                  "Use a bus without tmcld: serial:DEVICE[@BAUD], usb:PORT, can:INTERFACE or "
                  "tcp:HOST:PORT; auto: the only module by USB")
      ->type_name("LINK")
      ->take_last();
  app_.add_option("--config", options_.where.config,
                  "With --direct: name the axes as in this configuration of tmcld")
      ->type_name("FILE")
      ->take_last();
  Form(app_).option("--reply-timeout", "MS",
                    "With --direct: how long a module may take to answer (default 100)",
                    number(options_.where.reply_timeout_ms, 1, longest_reply_timeout_ms));
  Form(app_).option("--full-steps", "N",
                    "With --direct: full steps of a turn, for rev and rps (default 200)",
                    number(options_.where.full_steps, 1, tmcl::max_full_steps));
  app_.add_flag("--json", options_.json, "One JSON document on standard output, for errors too");
  Form(app_).flag("--wide", "Do not cut tables to the width of the terminal", options_.tables.wide);
  Form(app_).flag("--tsv", "Tables with a tab between their cells, for programs",
                  options_.tables.tsv);
  Form(app_).option("--columns", "NAMES", "Only these columns of tables, such as AXIS,STATE",
                    list(options_.tables.columns));
  add_verbs(grammar_);
  add_help();
  add_complete();
}

void Parser::add_help() {
  auto* help = app_.add_subcommand("help", "Explain a verb: as --help behind it");
  help->fallthrough();
  help->group("Verbs");
  help->footer(help_help);
  help->add_option("VERB", help_for_, "Such as move, or program upload")->type_name("");
}

void Parser::add_complete() {
  auto* complete = app_.add_subcommand("__complete");
  complete->fallthrough();
  complete->group("");
  complete->add_option("WHAT", complete_.what)->required();
  complete->add_option("FOR", complete_for_);
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

/// From the outermost on, as far as the words are verbs.
std::vector<const CLI::App*> Parser::path_of(const std::vector<std::string>& words) const {
  std::vector<const CLI::App*> path{&app_};
  for (const auto& word : words) {
    const auto under = verbs_under(*path.back());
    const auto found = std::ranges::find(under, word, &CLI::App::get_name);
    if (found == under.end()) break;
    path.push_back(*found);
  }
  return path;
}

std::vector<std::string> Parser::options_of(const CLI::App& app) const {
  std::vector<std::string> names;
  for (const auto* option : app.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// One a line.
Information lines_of(const std::vector<std::string>& words) {
  return {words.empty() ? std::string{} : fmt::format("{}\n", fmt::join(words, "\n"))};
}

Information Parser::complete() const {
  if (complete_.what == "verbs") return lines_of(verbs(complete_verb()));
  if (complete_.what != "options") return lines_of(words_of_kind(complete_.what, complete_for_));
  auto words = options_of(app_);
  for (auto& name : options_of(complete_verb())) {
    if (std::ranges::find(words, name) == words.end()) words.push_back(std::move(name));
  }
  return lines_of(words);
}

/// "__complete line -- WORDS": what may stand where the last of these words is begun.
std::variant<Options, Information> Parser::complete_line_of(
    const std::vector<std::string>& arguments) {
  constexpr std::size_t words_before = 3;
  const std::vector<std::string> typed(
      arguments.begin() + static_cast<std::ptrdiff_t>(std::min(words_before, arguments.size())),
      arguments.end());
  auto completion = complete_line(app_, typed, options_.where);
  for (auto& word : completion.words) word = completion.prefix + word + completion.suffix;
  if (completion.of_gateway.empty()) return lines_of(completion.words);
  options_.verb.run = [completion](Context& context) {
    return complete_by_gateway(completion, context);
  };
  return options_;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  const auto text = tmcl::did_you_mean(word, views);
  return text.empty() ? text : text.substr(1) + ' ';
}

/// What other programs call a verb of this one, or what people expect of it.
std::string related_verb(const std::string& word) {
  struct Related {
    std::string_view word;
    std::string_view verb;
  };
  constexpr std::array<Related, 9> related{{{"version", "--version"},
                                            {"list", "axes"},
                                            {"ls", "axes"},
                                            {"status", "state"},
                                            {"position", "state"},
                                            {"halt", "stop --all"},
                                            {"abort", "stop --all"},
                                            {"estop", "stop --all"},
                                            {"goto", "move"}}};
  const auto* found = std::ranges::find(related, word, &Related::word);
  return found == related.end() ? "" : fmt::format("That is 'tmclctl {}'. ", found->verb);
}

std::optional<Error> Parser::unknown_verb(const CLI::App& outer, const std::string& word) const {
  const auto names = verbs(outer);
  if (names.empty()) return std::nullopt;
  const bool outermost = &outer == &app_;
  const auto related = outermost ? related_verb(word) : std::string{};
  return usage_error(
      "unknown_verb",
      fmt::format("there is no verb '{}{}'", outermost ? "" : full_name(outer) + ' ', word),
      (related.empty() ? did_you_mean(word, names) : related) + how_to_help(outer));
}

std::string Parser::how_to_help(const CLI::App& verb) const {
  if (&verb == &app_) return "'tmclctl --help' lists them all";
  // Who mistypes a stop must not think that it was one.
  const bool stops = full_name(verb) == "stop";
  return fmt::format("{}'tmclctl {} --help' explains it", stops ? everything_moves : "",
                     full_name(verb));
}

Result<std::variant<Options, Information>> Parser::help() const {
  const auto path = path_of(help_for_);
  if (path.size() <= help_for_.size()) {
    const auto& word = help_for_[path.size() - 1];
    if (auto unknown = unknown_verb(*path.back(), word)) return tl::unexpected(*unknown);
  }
  auto words = help_for_;
  words.resize(path.size() - 1);
  words.emplace_back("--help");
  return Parser().parse(words);
}

std::optional<Error> Parser::unknown_word() const {
  const auto words = app_.remaining(true);
  if (words.empty()) return std::nullopt;
  const auto& word = words.front();
  const auto& verb = chosen();
  const auto help = how_to_help(verb);
  if (word.starts_with('-')) {
    const auto option = word.substr(0, word.find('='));
    const auto of_verb = options_of(verb);
    if (std::ranges::find(of_verb, option) != of_verb.end()) {
      return usage_error(
          "usage",
          fmt::format("{} is an option of '{}': write it behind that", option, full_name(verb)),
          help);
    }
    auto known = options_of(app_);
    known.insert(known.end(), of_verb.begin(), of_verb.end());
    return usage_error("unknown_option", fmt::format("there is no option '{}'", option),
                       did_you_mean(option, known) + help);
  }
  if (auto unknown = unknown_verb(verb, word)) return unknown;
  return usage_error(
      "usage", fmt::format("'{}' is one word too many for '{}'", word, full_name(verb)), help);
}

Error Parser::error_from(const CLI::ParseError& error) const {
  if (auto unknown = unknown_word()) return *unknown;
  const auto& verb = chosen();
  if (&verb == &app_) {
    return usage_error(
        "usage",
        dynamic_cast<const CLI::RequiredError*>(&error) != nullptr
            ? "what is to be done? A verb is missing, such as scan, axes, move or stop"
            : error.what(),
        "'tmclctl --help' lists them all, with examples");
  }
  const auto name = full_name(verb);
  const auto names = verbs(verb);
  return usage_error("usage",
                     names.empty()
                         ? fmt::format("{}: {}", name, error.what())
                         : fmt::format("{}: a verb is missing: {}", name, fmt::join(names, ", ")),
                     how_to_help(verb) + ", with examples");
}

// CLI11's own "excludes" and "needs" would clutter the help.
std::optional<Error> Parser::conflicting_options() const {
  if (!options_.where.socket.empty() && !options_.where.direct.empty()) {
    return usage_error("usage",
                       "--socket and --direct exclude each other: through tmcld, or without it?");
  }
  const auto& web = options_.where.web;
  if (!web.url.empty() && !(options_.where.socket.empty() && options_.where.direct.empty()))
    return usage_error("usage", "--url goes with neither --socket nor --direct");
  const auto& fleet = options_.where.fleet;
  if (!fleet.url.empty() && !(web.url.empty() && options_.where.socket.empty() &&
                              options_.where.direct.empty() && web.token_file.empty()))
    return usage_error("usage", "--fleet goes with neither --socket, --direct nor --url");
  if (web.url.empty() && !web.token_file.empty())
    return usage_error("usage", "--token-file goes with --url");
  if (web.url.empty() && fleet.url.empty() && !web.ca_file.empty())
    return usage_error("usage", "--ca goes with --url or --fleet");
  if (fleet.url.empty() && !(fleet.gateways.empty() && fleet.certificate_file.empty() &&
                             fleet.key_file.empty() && fleet.password_file.empty()))
    return usage_error("usage", "--gateways, --cert, --key and --password-file go with --fleet");
  if (fleet.certificate_file.empty() != fleet.key_file.empty())
    return usage_error("usage", "--cert and --key go together");
  if (!options_.where.config.empty() && options_.where.direct.empty()) {
    return usage_error("usage",
                       "--config goes with --direct: a running tmcld has read its own file");
  }
  if (options_.where.reply_timeout_ms && options_.where.direct.empty()) {
    return usage_error("usage",
                       "--reply-timeout goes with --direct: tmcld has reply_timeout_ms of its bus");
  }
  return grammar_.objection(chosen(), options_.json);
}

/// What stands behind "--" is a command of its own, whatever its words look like.
std::vector<std::string> take_command(std::vector<std::string>& words) {
  constexpr std::array<std::string_view, 2> verb{"lease", "run"};
  const auto end = std::ranges::find(words, "--");
  if (end == words.end() ||
      std::ranges::search(words.begin(), end, verb.begin(), verb.end()).empty())
    return {};
  std::vector<std::string> command(end + 1, words.end());
  words.erase(end, words.end());
  return command;
}

Result<std::variant<Options, Information>> Parser::parse(
    const std::vector<std::string>& arguments) {
  const auto is_line =
      arguments.size() > 1 && arguments[0] == "__complete" && arguments[1] == "line";
  if (is_line) return complete_line_of(arguments);
  auto words = arguments;
  auto command = take_command(words);
  try {
    app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::Success& asked) {
    std::ostringstream text;
    app_.exit(asked, text, text);
    return Information{text.str()};
  } catch (const CLI::ParseError& error) {
    return tl::unexpected(error_from(error));
  }
  const auto& verb = chosen();
  const bool completes = verb.get_name() == "__complete";
  if (completes && complete_.what != "axes") return complete();
  if (verb.get_name() == "help") return help();
  if (auto conflict = conflicting_options()) return tl::unexpected(*conflict);
  if (completes) {
    options_.verb.run = [](Context& context) {
      Completion axes;
      axes.of_gateway = "axes";
      return complete_by_gateway(axes, context);
    };
    return options_;
  }
  options_.verb = grammar_.said(verb, std::move(command));
  if (const auto* info = grammar_.info(verb)) options_.info = *info;
  return options_;
}

}  // namespace

Result<std::variant<Options, Information>> parse_options(
    const std::vector<std::string>& arguments) {
  return Parser().parse(arguments);
}

std::vector<VerbInfo> verb_table() { return Parser().verb_table(); }

}  // namespace tmclctl
