// buses
#include <map>

#include <fmt/format.h>

#include "output/print.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/datagram.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// A start bit, eight bits of data and a stop bit.
constexpr double bits_per_byte = 10;
constexpr auto bits_per_can_frame =
    static_cast<double>(tmcl::most_bits_of_frame(tmcl::can_datagram_size));
constexpr double percent = 100;

std::uint64_t datagrams(const api::bus::Counters& counters) {
  // Those in `surplus` are among the unexpected ones.
  return counters.requests + counters.replies + counters.late_replies + counters.unexpected_replies;
}

/// How much of the time the wire was busy; nothing where its speed is not known.
std::optional<double> load_percent(const api::bus::Bus& before, const api::bus::Bus& after,
                                   double passed_s) {
  if (!after.bit_rate || passed_s <= 0 || datagrams(after.counters) < datagrams(before.counters))
    return std::nullopt;
  const auto passed = static_cast<double>(datagrams(after.counters) - datagrams(before.counters));
  const auto garbage = static_cast<double>(after.counters.garbage_bytes) -
                       static_cast<double>(before.counters.garbage_bytes);
  const bool is_can = after.link.starts_with("can:");
  const auto bits = is_can ? passed * bits_per_can_frame
                           : (passed * tmcl::serial_datagram_size + garbage) * bits_per_byte;
  return percent * bits / *after.bit_rate / passed_s;
}

struct Row {
  api::bus::Bus bus;
  std::optional<double> load;
};

json::object to_json(const Row& row) {
  auto object = api::to_json(row.bus);
  object["load_percent"] = row.load ? json::value(*row.load) : json::value(nullptr);
  return object;
}

/// `asked`: what was asked just now, for a bus of this process.
void print(const std::string& bus, const api::bus::Heard& heard, std::string_view asked,
           Output& output) {
  if (!heard.hint) return;
  output.err << fmt::format("bus {}: {}{}.\n  Try: {}.\n", bus, asked, heard.meaning, *heard.hint);
}

void print(const std::vector<Row>& rows, std::string_view asked, Output& output) {
  Table table({"BUS", "LINK", "STATE", "LOAD", "REQUESTS", "TIMEOUTS", "LATE", "GARBAGE", "SURPLUS",
               "SUSPECT"});
  for (const auto& [bus, load] : rows) {
    const auto& counters = bus.counters;
    table.add({bus.name, bus.link, bus.state, load ? fmt::format("{:.1f} %", *load) : "-",
               std::to_string(counters.requests), std::to_string(counters.timeouts),
               std::to_string(counters.late_replies), std::to_string(counters.garbage_bytes),
               std::to_string(counters.surplus), std::to_string(counters.suspect)});
  }
  table.print(output);
  for (const auto& row : rows) {
    if (row.bus.error)
      output.err << fmt::format("bus {} is not open: {}\n", row.bus.name, *row.bus.error);
    if (row.bus.counters.requests != 0 && row.bus.heard)
      print(row.bus.name, *row.bus.heard, asked, output);
  }
}

/// The counters of this process are nothing until it has asked. Gives what it has, in words.
std::string_view ask_first(Context& context) {
  if (context.gateway.own == nullptr) return "";
  const auto scanned = scan({1, 1}, {}, context);
  if (!scanned) warn(error_text(scanned.error()), context.output);
  return "address 1 was asked ('tmclctl scan' asks all): ";
}

Result<ExitCode> run(const verb::Buses& verb, Context& context) {
  const auto asked = ask_first(context);
  const auto first = context.call(api::bus::List{});
  if (!first) return tl::unexpected(first.error());
  const auto begin = context.host.now();
  context.sleep(std::chrono::round<tmcl::Duration>(std::chrono::duration<double>(verb.for_s)));
  const auto second = context.call(api::bus::List{});
  if (!second) return tl::unexpected(second.error());
  const std::chrono::duration<double> passed = context.host.now() - begin;
  std::map<std::string, api::bus::Bus> before;
  for (const auto& bus : first->buses) before.emplace(bus.name, bus);
  std::vector<Row> rows;
  for (const auto& bus : second->buses)
    rows.push_back({bus, load_percent(before[bus.name], bus, passed.count())});
  if (!context.output.json) {
    print(rows, asked, context.output);
    return ExitCode::done;
  }
  json::array buses;
  for (const auto& row : rows) buses.push_back(to_json(row));
  print_json({{"buses", std::move(buses)}}, context.output);
  return ExitCode::done;
}

constexpr double shortest_load_s = 0.1;

constexpr const char* buses_help = R"(
One row for each bus: its link, whether it is open, how much of what the wire carries was used while it
looked (only for serial lines, whose baud rate says that; the rate of a USB port means nothing), and since
tmcld started: requests without an answer in time (TIMEOUTS), answers that came too late (LATE), bytes that
belong to no datagram (GARBAGE), replies to no request (SURPLUS), and answers that were given out
only when they had been proven (SUSPECT). A bus that is not open says why, and
where no module answers it says what came in instead. With --direct it asks address 1 first, and all of
it is what this command has seen, since another program's counters are not told.

  tmclctl buses
  tmclctl buses --for 10
  tmclctl --json buses
)";

}  // namespace

void add_buses(Grammar& grammar) {
  auto buses = grammar.verb<verb::Buses>(
      "buses", access::reads, "Show the buses, their load and what went wrong", buses_help, run);
  buses.option("--for", "SECONDS", "Measure the load for so long (default 1)",
               number(buses->for_s, shortest_load_s, longest_time_s));
}

}  // namespace tmclctl
