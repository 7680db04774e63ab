#include "tmcl/assembler.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/text.hpp"
#include "program/encoding.hpp"
#include "program/source.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl::program {
namespace {

// So many names are considered for "Did you mean ...?".
constexpr std::size_t most_candidates = 500;

using Names = std::vector<std::string_view>;

std::string suggest(std::string message, std::string_view word, const Names& candidates) {
  const auto question = did_you_mean(word, candidates);
  return question.empty() ? message : message + '.' + question;
}

struct Symbol {
  std::string name;  ///< As it is written where it is defined.
  std::int64_t value = 0;
  std::size_t line = 0;  ///< Where it is defined, counted through all files.
  bool is_label = false;
};

/// The names of axis parameters, as constants: those of a model, or of all.
class ParameterNames {
 public:
  explicit ParameterNames(const Model* model)
      : models_(model != nullptr ? std::span(model, 1) : models()) {}

  /// Empty: there is no such name. Several: it is another parameter on other models.
  struct Numbered {
    std::uint8_t number;
    std::string_view model;  ///< The first one.
  };
  std::vector<Numbered> numbers_of(std::string_view name) const {
    std::vector<Numbered> numbers;
    for (const auto& model : models_) {
      const auto* row = find_parameter(axis_parameters(model), name);
      if (row != nullptr && !std::ranges::count(numbers, row->number, &Numbered::number))
        numbers.push_back({row->number, model.name});
    }
    return numbers;
  }

  Names all() const {
    std::set<std::string_view> names;
    for (const auto& model : models_) {
      for (const auto& row : axis_parameters(model)) names.insert(row.name);
    }
    return {names.begin(), names.end()};
  }

 private:
  std::span<const Model> models_;
};

/// What other assemblers call a command of this one: the nearest word would be another command.
std::string_view related_command(std::string_view mnemonic) {
  struct Related {
    std::string_view word;
    std::string_view hint;
  };
  constexpr auto related =
      std::to_array<Related>({{"RET", "RSUB returns from CSUB and CALL, RETI from an interrupt"},
                              {"RETURN", "RSUB returns from CSUB and CALL, RETI from an interrupt"},
                              {"JMP", "JA jumps always, JC on a condition"},
                              {"GOTO", "JA jumps always, JC on a condition"},
                              {"GOSUB", "CSUB calls a subroutine"},
                              {"HALT", "STOP ends the program, MST stops a motor"},
                              {"END", "STOP ends the program, MST stops a motor"},
                              {"MOV", "CALC computes, and SAP, SGP and SIO set"}});
  const auto* found = std::ranges::find_if(
      related, [&](const Related& one) { return text::equal_ignoring_case(one.word, mnemonic); });
  return found == related.end() ? std::string_view{} : found->hint;
}

/// Labels and constants.
class Symbols {
 public:
  /// From now on, names of axis parameters are constants, too: of a model, or of all if it is null.
  void name_parameters(const Model* model) { parameters_.emplace(model); }
  const Symbol* find(std::string_view name) const {
    const auto found = all_.find(lower(name));
    return found == all_.end() ? nullptr : &found->second;
  }
  void add(Symbol symbol) { all_.emplace(lower(symbol.name), std::move(symbol)); }

  tl::expected<std::int64_t, std::string> value_of(std::string_view name) const {
    if (const auto* symbol = find(name)) return symbol->value;
    const auto numbers =
        parameters_ ? parameters_->numbers_of(name) : std::vector<ParameterNames::Numbered>{};
    if (numbers.size() == 1) return numbers.front().number;
    if (numbers.size() > 1) return tl::unexpected(ambiguous(name, numbers));
    auto names = parameters_ ? parameters_->all() : Names{};
    const auto most = names.size() + most_candidates;
    for (const auto& [key, symbol] : all_) {
      if (names.size() < most) names.push_back(symbol.name);
    }
    const auto message =
        "'" + printable(name) + "' is not defined" + (parameters_ ? ", nor an axis parameter" : "");
    return tl::unexpected(suggest(message, name, names));
  }

 private:
  static std::string lower(std::string_view name) {
    std::string key(name);
    for (auto& c : key) c = text::lower(c);
    return key;
  }

  static std::string ambiguous(std::string_view name,
                               std::span<const ParameterNames::Numbered> numbers) {
    auto text = "'" + printable(name) + "' is";
    for (const auto& [number, model] : numbers) {
      text += (number == numbers.front().number ? " " : ", ") + std::to_string(number) + " on a " +
              std::string(model);
    }
    return text + ": write the number, or name the model of the module";
  }

  std::map<std::string, Symbol> all_;
  std::optional<ParameterNames> parameters_;
};

/// A command as it is written: parts of a line.
struct Statement {
  std::size_t line = 0;
  std::size_t at = 0;
  std::string_view mnemonic;
  std::vector<Cursor> operands;
};

/// The parts between the commas, without the blanks before them; none if there is nothing.
std::vector<Cursor> split(std::string_view code, std::size_t begin) {
  std::vector<Cursor> parts;
  Cursor rest(code, begin, code.size());
  rest.skip_blanks();
  if (rest.at_end()) return parts;
  do {
    rest.skip_blanks();
    const auto from = rest.at();
    rest.take_while([](char c) { return c != ','; });
    parts.emplace_back(code, from, rest.at());
  } while (rest.take(','));
  return parts;
}

/// What the lines say: names at once, commands for later, as they may use names that follow.
class Parser {
 public:
  Parser(Source& source, Problems& problems, const Model* model)
      : source_(source), problems_(problems), model_(model) {}

  void run() {
    if (source_.names_parameters()) symbols_.name_parameters(model_);
    for (line_ = 0; line_ < source_.lines().size() && !problems_.full(); ++line_) take_line();
  }
  const Symbols& symbols() const { return symbols_; }
  const std::vector<Statement>& statements() const { return statements_; }
  const std::vector<Label>& labels() const { return labels_; }

 private:
  void take_line() {
    const auto code = source_.lines()[line_].code;
    Cursor cursor(code);
    cursor.skip_blanks();
    while (!cursor.at_end()) {
      const auto where = cursor;
      const bool directive = cursor.take('.');
      const auto name = cursor.take_while(is_in_name);
      if (!directive && !(!name.empty() && begins_name(name.front())))
        return fault(where, "'" + where.word() + "' begins no command, label or constant");
      cursor.skip_blanks();
      if (!directive && cursor.take(':')) {
        define_label(where, name);
        cursor.skip_blanks();
        continue;
      }
      if (!directive && cursor.take('=')) return define_constant(where, name, cursor);
      const auto word = code.substr(where.at(), name.size() + (directive ? 1 : 0));
      return take_command({line_, where.at(), word, split(code, where.at() + word.size())});
    }
  }

  void define_label(const Cursor& where, std::string_view name) {
    if (!may_define(where, name)) return;
    const auto address = statements_.size();
    symbols_.add({std::string(name), static_cast<std::int64_t>(address), line_, true});
    labels_.push_back({std::string(name), address});
  }

  void define_constant(const Cursor& where, std::string_view name, const Cursor& expression) {
    const auto value = evaluate(expression, [&](std::string_view other) { return known(other); });
    if (!value) source_.report(line_, value.error());
    // Also if its value is wrong: it is defined, and that is not to be complained of.
    if (may_define(where, name)) symbols_.add({std::string(name), value.value_or(0), line_});
  }

  /// What a constant may be made of.
  tl::expected<std::int64_t, std::string> known(std::string_view name) const {
    const auto* symbol = symbols_.find(name);
    if (symbol != nullptr && symbol->is_label)
      return tl::unexpected("'" + printable(name) +
                            "' is a label; constants are made of constants only");
    return symbols_.value_of(name);
  }

  bool may_define(const Cursor& where, std::string_view name) {
    if (name.size() > longest_name) {
      fault(where, "a name has at most " + std::to_string(longest_name) + " letters");
      return false;
    }
    const auto* other = symbols_.find(name);
    if (other == nullptr) return true;
    const auto& line = source_.lines()[other->line];
    fault(where, "'" + printable(name) + "' is defined already, in " + source_.files()[line.file] +
                     ':' + std::to_string(line.number));
    return false;
  }

  void take_command(Statement statement) {
    if (statements_.size() == most_commands && !too_long_) {
      too_long_ = true;
      source_.report(line_, within_line(statement.at, printable(statement.mnemonic),
                                        "a program has at most " + std::to_string(most_commands) +
                                            " commands; this is one more"));
    }
    if (!too_long_) statements_.push_back(std::move(statement));
  }

  void fault(const Cursor& where, std::string message) {
    source_.report(line_, within_line(where.at(), where.word(), std::move(message)));
  }

  Source& source_;
  Problems& problems_;
  const Model* model_;
  std::size_t line_ = 0;
  Symbols symbols_;
  std::vector<Statement> statements_;
  std::vector<Label> labels_;
  bool too_long_ = false;
};

struct Range {
  std::int64_t least;
  std::int64_t greatest;
};

constexpr Range range_of(Field field) {
  switch (field) {
    case Field::type:
    case Field::motor: return {0, UINT8_MAX};
    case Field::value: return {INT32_MIN, INT32_MAX};
    case Field::address: return {0, most_commands - 1};
  }
  return {0, 0};
}

// Of the directive that takes a command by its numbers; the first of them stands in the type's
// place.
constexpr Operand raw_operands[] = {{Field::type, "command"},
                                    {Field::type, "type"},
                                    {Field::motor, "motor"},
                                    {Field::value, "value"}};

std::string names_of(std::span<const Operand> operands) {
  std::string names;
  for (const auto& operand : operands) {
    if (!names.empty()) names += ", ";
    names += operand.name;
  }
  return names;
}

std::size_t required(std::span<const Operand> operands) {
  std::size_t count = 0;
  while (count < operands.size() && !operands[count].optional) ++count;
  return count;
}

/// Makes a command of a statement.
class Encoder {
 public:
  Encoder(const Statement& statement, const Symbols& symbols)
      : statement_(statement), symbols_(symbols) {}

  tl::expected<Instruction, TextProblem> encode() const {
    if (text::equal_ignoring_case(statement_.mnemonic, raw_directive)) return encode_raw();
    const auto* row = row_of(statement_.mnemonic);
    if (row == nullptr) return wrong(unknown_command());
    if (!row->operands) return wrong(std::string(row->name) + " is for hosts, not for programs");
    return encode(row->command, *row->operands);
  }

 private:
  static const CommandInfo* row_of(std::string_view mnemonic) {
    for (const auto& row : command_table()) {
      if (text::equal_ignoring_case(row.name, mnemonic)) return &row;
    }
    return nullptr;
  }

  std::string unknown_command() const {
    const auto none = "there is no command '" + printable(statement_.mnemonic) + "'";
    if (const auto hint = related_command(statement_.mnemonic); !hint.empty())
      return none + ". " + std::string(hint);
    Names names{raw_directive};
    for (const auto& row : command_table()) {
      if (row.operands) names.push_back(row.name);
    }
    return suggest(none, statement_.mnemonic, names);
  }

  tl::expected<Instruction, TextProblem> encode_raw() const {
    if (auto fault = wrong_count(raw_operands)) return tl::unexpected(std::move(*fault));
    const std::span<const Operand> operands(raw_operands);
    return value_of(operands[0], 0, {}).and_then([&](std::int64_t number) {
      return fill({static_cast<Command>(number)}, operands, 1);
    });
  }

  tl::expected<Instruction, TextProblem> encode(Command command,
                                                std::span<const Operand> operands) const {
    if (auto fault = wrong_count(operands)) return tl::unexpected(std::move(*fault));
    return fill({command}, operands, 0);
  }

  /// Sets the fields of the operands from this one on, as far as they are written.
  tl::expected<Instruction, TextProblem> fill(Instruction instruction,
                                              std::span<const Operand> operands,
                                              std::size_t first) const {
    for (auto i = first; i < statement_.operands.size(); ++i) {
      const auto value = value_of(operands[i], i, instruction.command);
      if (!value) return tl::unexpected(value.error());
      set_field(instruction, operands[i].field, *value);
    }
    return instruction;
  }

  tl::expected<std::int64_t, TextProblem> value_of(const Operand& operand, std::size_t index,
                                                   Command command) const {
    auto written = statement_.operands[index];
    const auto lookup = [&](std::string_view name) {
      return operand.field == Field::type ? type_of(command, name) : symbols_.value_of(name);
    };
    const auto value = evaluate(written, lookup);
    const auto range = range_of(operand.field);
    if (!value || (*value >= range.least && *value <= range.greatest)) return value;
    const auto at = written.at();
    return tl::unexpected(
        within_line(at, printable(written.take_rest()),
                    std::string(operand.name) + " is " + std::to_string(range.least) + ".." +
                        std::to_string(range.greatest) + ", not " + std::to_string(*value)));
  }

  /// A standard name of the command's types, or any other name.
  tl::expected<std::int64_t, std::string> type_of(Command command, std::string_view name) const {
    if (const auto type = parse_subtype(command, name)) return *type;
    Names names;
    for (const auto& row : subtype_table()) {
      if (row.command == command && !row.name.empty()) names.push_back(row.name);
    }
    if (names.empty() || symbols_.find(name) != nullptr) return symbols_.value_of(name);
    const auto message = std::string(name_of(command)) + " has no type '" + printable(name) + "'";
    return tl::unexpected(suggest(message, name, names));
  }

  std::optional<TextProblem> wrong_count(std::span<const Operand> operands) const {
    const auto count = statement_.operands.size();
    const auto least = required(operands);
    if (count >= least && count <= operands.size()) return std::nullopt;
    auto message = printable(statement_.mnemonic) + " takes " +
                   (operands.empty() ? "no operands"
                    : least == operands.size()
                        ? std::to_string(least)
                        : std::to_string(least) + " to " + std::to_string(operands.size())) +
                   (operands.empty()       ? ""
                    : operands.size() == 1 ? " operand"
                                           : " operands");
    if (!operands.empty()) message += " (" + names_of(operands) + ')';
    return fault(message + ", not " + std::to_string(count));
  }

  TextProblem fault(std::string message) const {
    return within_line(statement_.at, printable(statement_.mnemonic), std::move(message));
  }
  tl::unexpected<TextProblem> wrong(std::string message) const {
    return tl::unexpected(fault(std::move(message)));
  }

  const Statement& statement_;
  const Symbols& symbols_;
};

std::vector<SourceLine> lines_of(const Source& source, const std::vector<Statement>& statements) {
  std::vector<SourceLine> lines;
  for (const auto& line : source.lines())
    lines.push_back({line.file, line.number, std::string(line.text), std::nullopt});
  for (std::size_t address = 0; address < statements.size(); ++address)
    lines[statements[address].line].address = address;
  return lines;
}

}  // namespace

tl::expected<Assembly, TextProblems> assemble(const std::string& path, const ReadFile& read,
                                              const Model* model) {
  Problems problems;
  Source source(path, read, problems);
  Parser parser(source, problems, model);
  parser.run();
  Program program;
  for (const auto& statement : parser.statements()) {
    const auto instruction = Encoder(statement, parser.symbols()).encode();
    if (!instruction) source.report(statement.line, instruction.error());
    if (problems.full()) break;
    program.push_back(instruction.value_or(Instruction{}));
  }
  if (!problems.empty()) return tl::unexpected(problems.in_order());
  return Assembly{std::move(program), source.files(), lines_of(source, parser.statements()),
                  parser.labels()};
}

}  // namespace tmcl::program
