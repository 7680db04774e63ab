// scan and modules: who is there.
#include <algorithm>

#include <fmt/format.h>

#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

json::array modules_document(const std::vector<ModuleRow>& rows) {
  json::array array;
  for (const auto& row : rows) array.push_back(to_json(row));
  return array;
}

std::string remark_on(const ModuleRow& row) {
  if (row.address_is_reply_id)
    return "DANGER: its address is the identifier of all replies, so it takes them for commands "
           "and moves. Give it another address (global parameter 71)";
  if (row.duplicate_suspected)
    return "DUPLICATE: several modules answer at this address, or another program asks";
  if (row.in_bootloader)
    return "NO FIRMWARE runs, only its bootloader: see tmclctl firmware upload";
  if (row.watched_by == "none") return "UNWATCHED: it is not noticed when it starts again";
  return "";
}

Table::Cells headings(bool with_state) {
  Table::Cells names{"BUS", "ADDRESS", "MODEL", "FIRMWARE", "AXES"};
  if (with_state) names.emplace_back("STATE");
  names.emplace_back("");
  return names;
}

Table::Cells cells_of(const ModuleRow& row, bool with_state) {
  Table::Cells cells{row.bus, std::to_string(row.address), model_text(row.model, row.model_number),
                     row.firmware, row.axes != 0 ? std::to_string(row.axes) : "?"};
  if (with_state) cells.push_back(row.state);
  cells.push_back(remark_on(row));
  return cells;
}

void print_modules(const std::vector<ModuleRow>& rows, bool with_state, std::ostream& out) {
  Table table(headings(with_state));
  for (const auto& row : rows) table.add(cells_of(row, with_state));
  table.print(out);
}

/// On a terminal each at once; the rest, and elsewhere all together, at the end.
class FoundModules {
 public:
  explicit FoundModules(const Output& output)
      : output_(output),
        at_once_(output.out_screen.terminal && !output.json && !output.tables.tsv &&
                 output.tables.columns.empty()) {}

  void add(const ModuleRow& row) {
    if (at_once_) table_.add(cells_of(row, false), output_.out);
  }
  /// What was not told on the way, since news may be dropped, comes last.
  void end(const std::vector<ModuleRow>& all, const std::vector<ModuleRow>& told) {
    if (!at_once_) return print_modules(all, false, output_.out);
    for (const auto& row : all) {
      const auto is_same = [&row](const ModuleRow& other) {
        return other.bus == row.bus && other.address == row.address;
      };
      if (std::ranges::none_of(told, is_same)) add(row);
    }
  }

 private:
  const Output& output_;
  bool at_once_;
  GrowingTable table_{headings(false), {8, 7, 10, 8, 4, 0}};
};

void print_silence(const tmcl::api::bus::SilentBus& silent, Output& output) {
  output.err << fmt::format("No module answered on {}", silent.bus);
  if (!silent.heard) {
    output.err << ".\n  Check the supply, the cabling, the termination and the bit rate.\n";
    return;
  }
  output.err << fmt::format(": {}.\n", silent.heard->meaning);
  if (silent.heard->hint) output.err << fmt::format("  Try: {}.\n", *silent.heard->hint);
}

void print_silence(const ScanResult& result, Output& output) {
  for (const auto& silent : result.silent) print_silence(silent, output);
  // An older tmcld does not say what it heard.
  if (result.silent.empty() && result.modules.empty() && result.failed.empty())
    output.err << "No module answered.\n  Check the supply, the cabling and the baud rate: new "
                  "modules speak 9600.\n";
}

ExitCode exit_of(const ScanResult& result) {
  auto exit = ExitCode::done;
  if (result.modules.empty() && result.failed.empty()) exit = ExitCode::not_sent;
  for (const auto& [bus, failure] : result.failed) exit = std::max(exit, exit_code_of(failure));
  return exit;
}

json::object document_of(const ScanResult& result) {
  json::object document{{"modules", modules_document(result.modules)}};
  json::array failed, silent;
  for (const auto& [bus, failure] : result.failed)
    failed.push_back(json::object{{"bus", bus}, {"error", error_document(failure)}});
  for (const auto& bus : result.silent) silent.push_back(tmcl::api::to_json(bus));
  if (!failed.empty()) document["failed"] = std::move(failed);
  document["silent"] = std::move(silent);
  return document;
}

Result<ExitCode> run(const verb::Scan& verb, Context& context) {
  auto& output = context.output;
  ProgressLine line(output);
  FoundModules found(output);
  std::vector<ModuleRow> told;
  ScanNews news;
  news.progress = [&](const std::string& bus, std::size_t asked, std::size_t of) {
    line.show(fmt::format("scanning {}: {} of {} addresses", bus, asked, of));
  };
  news.found = [&](const ModuleRow& row) {
    line.clear();
    told.push_back(row);
    found.add(row);
  };
  const auto result = scan(verb.range, news, context);
  line.clear();
  if (!result) return tl::unexpected(result.error());
  if (output.json) {
    print_json(document_of(*result), output);
    return exit_of(*result);
  }
  for (const auto& [bus, failure] : result->failed)
    output.err << "tmclctl: " << bus << " was not scanned: " << error_text(failure, output.gateway)
               << '\n';
  if (!result->modules.empty()) found.end(result->modules, told);
  print_silence(*result, output);
  return exit_of(*result);
}

Result<ExitCode> run(const verb::Modules&, Context& context) {
  const auto rows = modules_of(context);
  if (!rows) return tl::unexpected(rows.error());
  if (context.output.json) {
    print_json({{"modules", modules_document(*rows)}}, context.output);
  } else {
    print_modules(*rows, true, context.output.out);
  }
  return ExitCode::done;
}

Reading read_range(const std::string& text, ScanRange& range) {
  const auto dash = text.find('-');
  const auto first = text.substr(0, dash);
  const auto last = dash == std::string::npos ? first : text.substr(dash + 1);
  return number(range.first, 0, greatest_address)(first)
      .and_then([&] { return number(range.last, 0, greatest_address)(last); })
      .and_then([&]() -> Reading {
        if (range.first <= range.last) return {};
        return tl::unexpected(
            fmt::format("{} goes down; meant is perhaps {}-{}", text, range.last, range.first));
      });
}

constexpr const char* scan_help = R"(
Asks every address who is there: through tmcld on all its buses, with --direct on that one.
One row for each module that answers, as it is found; exit code 3 if none does. Takes some seconds on a
slow serial line. NO FIRMWARE marks a module whose bootloader answers, as after an upload that was cut
short. Where no module answers it says what came instead: an echo, text, wrong checksums ...

  tmclctl scan
  tmclctl --direct can:can0 scan --addresses 1-20
  tmclctl --direct tcp:10.0.0.7:4001 --reply-timeout 1000 scan     far away, so answers take long

With --bauds it looks for the baud rate, too: it asks address 1 at all rates of global parameter 65, then
the others, until modules answer, and says how long that may take. The questions are such that a module of
another rate cannot take them for a command that moves or sets anything. With --auto it does so on each
serial port that 'tmclctl ports' lists and no program holds; other devices there get the bytes as well.

  tmclctl --direct serial:/dev/ttyUSB0 scan --bauds
  tmclctl scan --auto --addresses 1-10
)";

constexpr const char* modules_help = R"(
Those of the axes in tmcld's configuration, and how they are: ready, silent (they do not answer), or
unknown (their bus is not open, or they were not asked yet). With --direct it is a scan.

  tmclctl modules
  tmclctl --json modules
)";

}  // namespace

void add_scan(Grammar& grammar) {
  auto scan = grammar.verb<verb::Scan>("scan", access::reads, "Look for modules on all addresses",
                                       scan_help, run);
  auto& range = scan->range;
  scan.option("--addresses", "FIRST-LAST", "Only these addresses (default 1-255)",
              [&range](const std::string& text) { return read_range(text, range); });
  scan.flag("--bauds", "With --direct serial:DEVICE: at all baud rates of modules", scan->bauds);
  scan.flag("--auto", "At all baud rates on all serial ports that are free", scan->all_ports);
  scan.on_ports([](const verb::Scan& said) { return said.bauds || said.all_ports; }, scan_ports);
  grammar.verb<verb::Modules>("modules", access::reads, "List the modules that tmcld serves",
                              modules_help, run);
}

}  // namespace tmclctl
