#include "completion.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <CLI/App.hpp>

#include "grammar.hpp"
#include "profile/generators.hpp"
#include "profile/setup.hpp"
#include "tmcl/command.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/profile.hpp"

namespace tmclctl {
namespace {

using Words = std::vector<std::string>;

// ---- kinds --------------------------------------------------------------------------------------

Words names_in(std::function<std::span<const tmcl::ParameterInfo>(const tmcl::Model&)> table_of) {
  Words words;
  for (const auto& model : tmcl::models())
    for (const auto& row : table_of(model))
      if (std::ranges::count(words, row.name) == 0) words.emplace_back(row.name);
  return words;
}

/// The registers of a generator, as "v_max="; of one of them, the names of its values.
Words register_words(const Words& names) {
  const auto generators = profile::generators();
  const auto generator =
      std::ranges::find(generators, names.empty() ? "" : names[0], &profile::GeneratorInfo::name);
  if (generator == generators.end()) return {};
  Words words;
  if (names.size() == 1) {
    for (const auto& info : generator->registers) words.push_back(fmt::format("{}=", info.name));
    if (generator->clocked) words.push_back(fmt::format("{}=", profile::clock_name));
    return words;
  }
  const auto index = tmcl::ramp::find_register(generator->registers, names[1]);
  if (!index) return {};
  const auto& of_values = generator->registers[*index].names;
  words.assign(of_values.begin(), of_values.end());
  std::erase(words, "");
  return words;
}

/// What profile solve is told.
Words quantity_words() {
  using tmcl::plan::Assumption;
  Words words;
  for (const auto quantity : tmcl::plan::quantities)
    words.push_back(fmt::format("{}=", name_of(quantity)));
  for (const auto quantity : tmcl::plan::side_quantities)
    words.push_back(fmt::format("{}=", name_of(quantity)));
  for (const auto assumption : {Assumption::symmetric, Assumption::thirds})
    words.emplace_back(name_of(assumption));
  return words;
}

/// By the placeholder of a word, or of the value of an option.
struct Kind {
  std::string_view placeholder;
  std::string_view kind;
};
constexpr auto kinds = std::to_array<Kind>({
    {"AXIS", "axes"},
    {"MODULE", "modules"},
    {"BUS", "buses"},
    {"FILE", ":files"},
    {"FOLDER", ":files"},
    {"PATH", ":files"},
    {"MODEL", "models"},
    {"PARAM", "parameters"},
    {"COMMAND", "commands"},
    {"GENERATOR", "generators"},
    {"A", ":files"},
    {"B", ":files"},
});

/// By the option, where its placeholder says less.
struct Choice {
  std::string_view verb;  ///< Empty: of all.
  std::string_view option;
  std::string_view kind;   ///< Empty: `words`.
  std::string_view words;  ///< With blanks between them.
};
constexpr auto choices = std::to_array<Choice>({
    {"", "--bus", "buses", ""},
    {"", "--also", "parameters", ""},
    {"", "--channel", "parameters", ""},
    {"", "--generator", "generators", ""},
    {"", "--model", "models", ""},
    {"", "--role", "", "observe operate configure"},
    {"", "--as", "", "sap tmc c json"},
    {"", "--show", "", "x,v x,v,a v,a v,a,j x,v,a,j"},
    {"", "--direct", "", "serial:/dev/ usb: can: tcp: auto"},
    {"path run", "--mode", "", "velocity segments position"},
});

Words split(std::string_view text) {
  Words words;
  while (!text.empty()) {
    const auto end = std::min(text.find(' '), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

Completion of_kind(std::string_view kind) {
  Completion completion;
  if (kind == ":files") {
    completion.words = {":files"};
  } else if (kind == "axes" || kind == "modules" || kind == "buses") {
    completion.of_gateway = kind;
  } else {
    completion.words = words_of_kind(std::string(kind));
  }
  return completion;
}

Completion of_placeholder(std::string_view placeholder) {
  const auto found = std::ranges::find(kinds, placeholder, &Kind::placeholder);
  return found == kinds.end() ? Completion{} : of_kind(found->kind);
}

// ---- the line -----------------------------------------------------------------------------------

bool is_visible(const CLI::App* app) { return !app->get_group().empty(); }

std::vector<const CLI::App*> verbs_under(const CLI::App& app) {
  return app.get_subcommands(is_visible);
}

Words names_of(const std::vector<const CLI::App*>& verbs) {
  Words words;
  for (const auto* verb : verbs) words.push_back(verb->get_name());
  return words;
}

const CLI::App* verb_named(const CLI::App& app, const std::string& word) {
  const auto under = verbs_under(app);
  const auto found = std::ranges::find(under, word, &CLI::App::get_name);
  return found == under.end() ? nullptr : *found;
}

/// As it is typed: "path run".
std::string full_name_of(const CLI::App& app) {
  const auto* parent = app.get_parent();
  if (parent == nullptr) return {};
  const auto outer = full_name_of(*parent);
  return outer.empty() ? app.get_name() : outer + ' ' + app.get_name();
}

/// What stands before the cursor.
class Line {
 public:
  Line(const CLI::App& program, Where& where)
      : program_(&program), verb_(&program), where_(where) {}

  void take(const std::string& word);
  Completion at_cursor(const std::string& word) const;

 private:
  const CLI::Option* option_named(const std::string& name) const;
  void note(const std::string& option, const std::string& value);
  Completion value_at_cursor(const std::string& word) const;
  Completion word_at_cursor(const std::string& word) const;
  Completion registers_at_cursor(const std::string& word) const;
  Words option_names() const;

  const CLI::App* program_;
  const CLI::App* verb_;
  Where& where_;
  std::string option_;  ///< Whose value comes next; empty: none.
  std::string generator_;
  bool has_model_ = false;
  Words said_;
};

const CLI::Option* Line::option_named(const std::string& name) const {
  for (const auto* app : {verb_, program_})
    for (const auto* option : app->get_options())
      if (option->check_name(name)) return option;
  return nullptr;
}

void Line::note(const std::string& option, const std::string& value) {
  if (option == "--socket") where_.socket = value;
  if (option == "--url") where_.web.url = value;
  if (option == "--token-file") where_.web.token_file = value;
  if (option == "--ca") where_.web.ca_file = value;
  if (option == "--direct") where_.direct = value;
  if (option == "--config") where_.config = value;
  if (option == "--generator") generator_ = value;
  if (option == "--model") has_model_ = true;
}

void Line::take(const std::string& word) {
  if (!option_.empty()) {
    note(option_, word);
    option_.clear();
  } else if (word.starts_with('-') && word.size() > 1) {
    const auto* option = option_named(word);
    if (option != nullptr && option->get_items_expected_max() > 0) option_ = word;
  } else if (const auto* verb = verb_named(*verb_, word)) {
    verb_ = verb;
  } else {
    said_.push_back(word);
  }
}

Words Line::option_names() const {
  Words names;
  for (const auto* app : {program_, verb_})
    for (const auto* option : app->get_options())
      for (const auto& name : option->get_lnames())
        if (std::ranges::count(names, "--" + name) == 0) names.push_back("--" + name);
  return names;
}

Completion Line::value_at_cursor(const std::string& word) const {
  const auto verb = full_name_of(*verb_);
  for (const auto& choice : choices) {
    if (choice.option != option_ || (!choice.verb.empty() && choice.verb != verb)) continue;
    if (!choice.kind.empty()) return of_kind(choice.kind);
    Completion completion;
    completion.words = split(choice.words);
    return completion;
  }
  if (option_ == "--change") {
    // TIME:REGISTER=VALUE
    const auto colon = word.find(':');
    if (colon == word.npos) return {};
    auto registers = registers_at_cursor(word.substr(colon + 1));
    registers.prefix.insert(0, word, 0, colon + 1);
    return registers;
  }
  const auto* option = option_named(option_);
  const auto placeholder = option == nullptr ? std::string() : option->get_type_name();
  if (const auto equals = word.find('='); placeholder.ends_with("=AXIS") && equals != word.npos) {
    auto axes = of_kind("axes");
    axes.prefix = word.substr(0, equals + 1);
    return axes;
  }
  return of_placeholder(placeholder);
}

Completion Line::registers_at_cursor(const std::string& word) const {
  Completion completion;
  const auto equals = word.find('=');
  if (has_model_) {
    // Its value may be in any unit.
    if (equals == word.npos) completion = of_kind("parameters");
    completion.suffix = "=";
  } else if (equals != word.npos) {
    completion.words = words_of_kind("registers", {generator_, word.substr(0, equals)});
    completion.prefix = word.substr(0, equals + 1);
  } else {
    completion.words = words_of_kind("registers", {generator_});
  }
  return completion;
}

Completion Line::word_at_cursor(const std::string& word) const {
  const auto verb = full_name_of(*verb_);
  if (verb == "doctor") return of_kind("axes");
  std::vector<const CLI::Option*> words;
  for (const auto* option : verb_->get_options())
    if (option->get_positional()) words.push_back(option);
  if (words.empty()) return {};
  const auto* option = words[std::min(said_.size(), words.size() - 1)];
  if (said_.size() >= words.size() && option->get_items_expected_max() <= 1) return {};
  const auto placeholder = name_of_word(*option);
  if (placeholder == "REGISTER=VALUE") return registers_at_cursor(word);
  // The number behind the = cannot be known.
  if (placeholder.find('=') != placeholder.npos && word.find('=') != word.npos) return {};
  if (placeholder.starts_with("QUANTITY=")) return of_kind("quantities");
  if (placeholder == "AXIS=POSITION") {
    auto axes = of_kind("axes");
    axes.suffix = "=";
    return axes;
  }
  const bool of_module = verb.starts_with("global ") && placeholder == "PARAM";
  return of_module ? of_kind("globals") : of_placeholder(placeholder);
}

Completion Line::at_cursor(const std::string& word) const {
  Completion completion;
  if (!option_.empty()) return value_at_cursor(word);
  if (word.starts_with('-')) {
    completion.words = option_names();
    return completion;
  }
  if (verb_->get_name() == "help") {
    const auto* verb = program_;
    for (const auto& said : said_)
      if (const auto* next = verb_named(*verb, said)) verb = next;
    completion.words = names_of(verbs_under(*verb));
    return completion;
  }
  completion.words = names_of(verbs_under(*verb_));
  return completion.words.empty() ? word_at_cursor(word) : completion;
}

}  // namespace

Words words_of_kind(const std::string& kind, const Words& of) {
  Words words;
  if (kind == "parameters") return names_in(tmcl::axis_parameters);
  if (kind == "globals") return names_in(tmcl::global_parameters);
  if (kind == "registers") return register_words(of);
  if (kind == "quantities") return quantity_words();
  if (kind == "commands")
    for (const auto& row : tmcl::command_table()) words.emplace_back(row.name);
  if (kind == "models")
    for (const auto& model : tmcl::models()) words.emplace_back(model.name);
  if (kind == "generators")
    for (const auto& generator : profile::generators()) words.emplace_back(generator.name);
  return words;
}

Completion complete_line(const CLI::App& program, const Words& typed, Where& where) {
  Line line(program, where);
  if (typed.empty()) return line.at_cursor({});
  for (std::size_t i = 0; i + 1 < typed.size(); ++i) line.take(typed[i]);
  return line.at_cursor(typed.back());
}

}  // namespace tmclctl
