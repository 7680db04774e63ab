// trace
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include <unistd.h>

#include <fmt/format.h>

#include "axis/axis_names.hpp"
#include "output/print.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/hex.hpp"
#include "tmcl/trace_file.hpp"
#include "tmcl/utc_text.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using std::chrono::microseconds;
using tmcl::TracedDatagram;
using tmcl::Traffic;

constexpr tmcl::Duration pause_between_looks = std::chrono::milliseconds(100);
constexpr std::int32_t most_at_once = 1024;

TracedDatagram datagram_of(const api::bus::Datagram& told) {
  TracedDatagram datagram;
  datagram.at = tmcl::UtcTime(microseconds(told.utc_us));
  datagram.direction = told.direction == "in" ? Traffic::Direction::in : Traffic::Direction::out;
  datagram.on_can = told.can_id.has_value();
  datagram.can_id = told.can_id.value_or(0);
  datagram.can_extended = told.can_extended.value_or(false);
  datagram.is_garbage = told.garbage.value_or(false);
  datagram.bytes = tmcl::from_hex(told.bytes).value_or(std::vector<std::uint8_t>());
  datagram.client = told.client.value_or("");
  return datagram;
}

void print(const TracedDatagram& datagram, Output& output) {
  const auto time = tmcl::to_text(datagram.at);
  const bool is_in = datagram.direction == Traffic::Direction::in;
  const auto text = describe(datagram, common_parameters());
  if (!output.json) {
    // "10:12:01.123456" of "2026-11-25T10:12:01.123456Z"
    constexpr std::size_t clock_begin = 11;
    constexpr std::size_t clock_size = 15;
    const auto id = datagram.on_can ? fmt::format("{:03x} ", datagram.can_id) : std::string();
    output.out << fmt::format("{} {} {}{:<26}  {:<40}{}", time.substr(clock_begin, clock_size),
                              is_in ? "<-" : "->", id,
                              fmt::format("{:02x}", fmt::join(datagram.bytes, " ")), text,
                              datagram.client.empty() ? "" : "  " + datagram.client)
               << '\n';
    return;
  }
  boost::json::object document{{"utc", time},
                               {"direction", is_in ? "in" : "out"},
                               {"bytes", tmcl::to_hex(datagram.bytes)},
                               {"text", text}};
  if (datagram.on_can) document["can_id"] = datagram.can_id;
  if (datagram.is_garbage) document["garbage"] = true;
  if (!datagram.client.empty()) document["client"] = datagram.client;
  print_json(document, output);
}

/// "process 4711" or "tmclctl (process 4711)": 4711; 0 where no process is named.
pid_t process_in(const std::string& client) {
  constexpr std::string_view before = "process ";
  const auto begin = client.find(before);
  return begin == std::string::npos ? 0 : std::atoi(client.c_str() + begin + before.size());
}

/// Of the programs that were started in the terminal that this one was.
bool is_of_this_terminal(const std::string& client) {
  const auto process = process_in(client);
  return process > 0 && ::getsid(process) == ::getsid(0);
}

/// Which datagrams are shown.
class Filter {
 public:
  explicit Filter(const verb::Trace& verb) : only_(verb.only), not_mine_(verb.not_mine) {}

  bool lets_through(const TracedDatagram& datagram) {
    if (not_mine_ && is_mine(datagram.client)) return false;
    if (only_.empty()) return true;
    const auto command = command_of(datagram);
    return command && std::ranges::count(only_, *command) > 0;
  }

 private:
  bool is_mine(const std::string& client) {
    if (client.empty()) return false;
    const auto [known, is_new] = mine_.try_emplace(client, false);
    // Remembered: a program may have ended by the time of its last answer.
    if (is_new) known->second = is_of_this_terminal(client);
    return known->second;
  }

  std::vector<tmcl::Command> only_;
  bool not_mine_;
  std::map<std::string, bool> mine_;
};

/// Where datagrams go: lines, documents, or a file for Wireshark.
class Sink {
 public:
  Sink(const verb::Trace& verb, Output& output) : filter_(verb), output_(output) {}

  /// An empty path: lines or documents; "-": as a file, on standard output.
  Result<void> open(const std::string& path, const std::string& bus) {
    path_ = path;
    if (path.empty()) return {};
    if (path != "-") file_.open(path, std::ios::binary | std::ios::trunc);
    stream() << tmcl::trace_file_header(bus);
    return flush();
  }
  void put(const TracedDatagram& datagram) {
    if (!filter_.lets_through(datagram)) return;
    ++count_;
    if (path_.empty()) return print(datagram, output_);
    stream() << tmcl::trace_file_packet(datagram);
  }
  Result<void> flush() {
    if (stream().flush()) return {};
    return tl::unexpected(
        usage_error("cannot_write", path_.empty() || path_ == "-"
                                        ? std::string("cannot write to standard output")
                                        : "cannot write " + path_));
  }
  void tell_end() {
    if (!path_.empty() && path_ != "-")
      output_.err << fmt::format("{} datagrams are in {}\n", count_, path_);
  }

 private:
  std::ostream& stream() { return path_.empty() || path_ == "-" ? output_.out : file_; }

  Filter filter_;
  Output& output_;
  std::string path_;
  std::ofstream file_;
  std::size_t count_ = 0;
};

Result<std::string> bus_of(const verb::Trace& verb, Context& context) {
  const auto listed = context.call(api::bus::List{});
  if (!listed) return tl::unexpected(listed.error());
  std::vector<std::string> names;
  for (const auto& bus : listed->buses) names.push_back(bus.name);
  if (verb.bus.empty() && names.size() == 1) return names.front();
  if (std::ranges::count(names, verb.bus) > 0) return verb.bus;
  const auto hint = fmt::format("It has: {}", fmt::join(names, ", "));
  if (verb.bus.empty())
    return tl::unexpected(usage_error("missing_bus", "which bus of tmcld?", hint));
  return tl::unexpected(
      usage_error("unknown_bus", fmt::format("there is no bus '{}'", verb.bus), hint));
}

/// What goes over the bus from now on, until a signal ends it.
Result<void> follow(const std::string& bus, std::uint64_t last, const verb::Trace& verb, Sink& sink,
                    Context& context) {
  const auto begin = context.host.now();
  const auto is_wanted = [&] {
    const std::chrono::duration<double> passed = context.host.now() - begin;
    return context.host.signal() == 0 && !(verb.for_s && passed.count() >= *verb.for_s);
  };
  bool ends = false;
  while (true) {
    ends = ends || !is_wanted();
    // What has passed until then is wanted as well.
    if (ends) context.host.take_signal();
    const auto traffic = context.call(api::bus::Trace{bus, last, most_at_once});
    if (!traffic && !ends && context.host.signal() != 0) continue;
    if (!traffic) return tl::unexpected(traffic.error());
    if (traffic->dropped > 0 && traffic->last >= last) {
      warn(fmt::format("{} datagrams went by too fast and are missing", traffic->dropped),
           context.output);
    }
    for (const auto& datagram : traffic->datagrams) sink.put(datagram_of(datagram));
    if (auto flushed = sink.flush(); !flushed) return flushed;
    last = traffic->datagrams.empty() ? traffic->last : traffic->datagrams.back().number;
    if (last < traffic->last) continue;
    if (ends) return {};
    context.sleep(pause_between_looks);
  }
}

Result<ExitCode> run(const verb::Trace& verb, Context& context) {
  const auto bus = bus_of(verb, context);
  if (!bus) return tl::unexpected(bus.error());
  const auto before = context.call(api::bus::Trace{*bus, std::nullopt, verb.last.value_or(1)});
  if (!before) return tl::unexpected(before.error());
  Sink sink(verb, context.output);
  if (const auto opened = sink.open(verb.file, *bus); !opened)
    return tl::unexpected(opened.error());
  if (verb.last)
    for (const auto& datagram : before->datagrams) sink.put(datagram_of(datagram));
  const auto followed = follow(*bus, before->last, verb, sink, context);
  if (!followed) return tl::unexpected(followed.error());
  sink.tell_end();
  return ExitCode::done;
}

Result<ExitCode> run_on_file(const verb::Trace& verb, Output& output) {
  const auto trace = tmcl::read_trace_file(verb.read);
  if (!trace) {
    return tl::unexpected(
        usage_error("bad_trace", trace.error(), "'tmclctl trace BUS -w FILE' writes such files"));
  }
  Filter filter(verb);
  for (const auto& datagram : trace->datagrams)
    if (filter.lets_through(datagram)) print(datagram, output);
  return ExitCode::done;
}

/// "MVP,MST"
Reading read_commands(const std::string& text, std::vector<tmcl::Command>& into) {
  std::vector<std::string> names;
  if (auto read = list(names)(text); !read) return read;
  for (const auto& name : names) {
    const auto command = tmcl::parse_command(name);
    if (!command) return tl::unexpected("there is no command '" + name + "', such as MVP or MST");
    into.push_back(*command);
  }
  return {};
}

// Of what bus.trace gives at once.
constexpr std::int32_t most_remembered = 1024;

constexpr const char* trace_help = R"(
One line for each datagram that tmcld sends over a bus or gets from it, for whichever client: when (UTC),
-> to the modules or <- from them, the bytes as they were on the wire, what they mean (beginning with the
address of the module), and who asked: a process, a token, a port; without one, tmcld itself. On CAN, the
identifier of the frame comes first. What belongs to no datagram is shown as garbage.

tmcld remembers the last 4096 datagrams of each bus at any time: after something went wrong, --last shows
what was before. -w writes a pcapng file (link type USER0) that Wireshark shows with tmcl.lua, which is in
the folder wireshark beside the examples; --read shows such a file here, and 'tmclsim --replay' asks
virtual modules the same. Ctrl-C ends it (exit code 0).

  tmclctl trace bench
  tmclctl trace bench --last 200 --for 0.1
  tmclctl trace bench -w bench.pcapng --for 60
  tmclctl trace --read bench.pcapng
  tmclctl trace bench --only MVP,MST --not-mine
  tmclctl trace bench -w -                     for a pipe: | wireshark -k -i -
)";

}  // namespace

void add_trace(Grammar& grammar) {
  auto trace = grammar.verb<verb::Trace>(
      "trace", access::tmcld_only(VerbEffect::reads, "with --direct there is no other client"),
      "Show what goes over a bus", trace_help, run);
  trace.optional_word("BUS", "Its name; not needed where there is one", text(trace->bus));
  trace.option("--last", "N", "Begin with the last N datagrams that tmcld remembers",
               number(trace->last, 1, most_remembered));
  trace.option("--for", "SECONDS", "End after so long",
               number(trace->for_s, shortest_time_s, longest_time_s));
  trace.option("-w,--write", "FILE", "Write a file for Wireshark instead; '-': to standard output",
               text(trace->file));
  trace.option("-r,--read", "FILE", "Show what is in such a file", text(trace->read));
  auto& values = *trace.operator->();
  trace.option("--only", "COMMANDS", "Only these, with their answers, such as MVP,MST",
               [&values](const std::string& text) { return read_commands(text, values.only); });
  trace.flag("--not-mine", "Nothing that programs of this terminal have asked", trace->not_mine);
  trace.alone([](const verb::Trace& said) { return !said.read.empty(); }, run_on_file);
  trace.object(
      [](const verb::Trace& said, bool) {
        const bool more = !said.bus.empty() || !said.file.empty() || said.last || said.for_s;
        return !said.read.empty() && more ? "--read takes nothing beside it" : "";
      },
      "'tmclctl trace --read FILE'");
}

}  // namespace tmclctl
