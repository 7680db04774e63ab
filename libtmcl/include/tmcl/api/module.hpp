/// The methods of buses and modules, of global parameters and of ports.
#pragma once

#include "tmcl/api/axis.hpp"
#include "tmcl/api/deadman.hpp"

namespace tmcl::api {

constexpr std::string_view bus_summary = "name of the bus";
constexpr std::string_view address_summary = "address of the module";
constexpr Bounds addresses{0, 2047};
constexpr std::string_view model_summary = "model of the module; null if it has no name";

/// A module, whether an axis is configured there or not.
struct OnModule {
  TMCL_STRUCT(OnModule);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::uint16_t, address, address_summary, addresses);
};
/// The same for what can be refused because it is late.
struct SoonOnModule : OnModule {
  TMCL_STRUCT(SoonOnModule, OnModule);
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, axis::deadline_summary, axis::milliseconds);
};

namespace bus {

struct Counters {
  TMCL_STRUCT(Counters);
  TMCL_FIELD(std::uint64_t, requests, "datagrams sent");
  TMCL_FIELD(std::uint64_t, replies, "answers accepted");
  TMCL_FIELD(std::uint64_t, timeouts, "requests without an answer in time");
  TMCL_FIELD(std::uint64_t, late_replies, "answers to requests that had been given up; dropped");
  TMCL_FIELD(std::uint64_t, unexpected_replies,
             "answers to nothing that was asked, or from another module; dropped");
  TMCL_FIELD(std::uint64_t, garbage_bytes, "bytes that belong to no datagram");
  TMCL_FIELD(std::uint64_t, fences,
             "exchanges that proved that a module is in step, or that what it had answered before "
             "was right");
  TMCL_FIELD(std::uint64_t, surplus, "replies beyond what a module was asked for; dropped");
  TMCL_FIELD(std::uint64_t, suspect,
             "answers that were given out only when a further exchange had proven them: on a line "
             "that loses, doubles or delays replies, and wherever a movement depends on the value");
};
/// What a serial line brought (tmcl/heard.hpp).
struct Heard {
  TMCL_STRUCT(Heard);
  static constexpr bool omits_absent = true;
  TMCL_FIELD(std::string, kind,
             "nothing, answers, wrong_checksums, foreign, echo, text, other_baud_rate, noise");
  TMCL_FIELD(std::uint64_t, bytes, "how many came in");
  TMCL_FIELD(std::optional<std::string>, text, "the first whole line of it, up to 40 characters");
  TMCL_FIELD(std::string, meaning, "the same in a sentence");
  TMCL_FIELD(std::optional<std::string>, hint, "what to try; absent after answers");
};
struct Bus {
  TMCL_STRUCT(Bus);
  TMCL_FIELD(std::string, name, bus_summary);
  TMCL_FIELD(std::string, link, "how it is reached");
  TMCL_FIELD(std::string, state, "opening, open, lost");
  TMCL_FIELD(std::optional<std::string>, error, "why it is not open");
  TMCL_FIELD(std::optional<std::uint32_t>, bit_rate,
             "bits a second on its wire; null where it is unknown: TCP, USB, virtual CAN");
  TMCL_FIELD(Counters, counters, "since the daemon started");
  TMCL_FIELD(std::optional<Heard>, heard,
             "what came in since it was opened or scanned last; null on CAN");
};
struct Buses {
  TMCL_STRUCT(Buses);
  TMCL_FIELD(std::vector<Bus>, buses, "the buses");
};
struct List {
  TMCL_METHOD("bus.list", reads, Buses, "the configured buses and how they are", List);
};

struct Datagram {
  TMCL_STRUCT(Datagram);
  static constexpr bool omits_absent = true;
  TMCL_FIELD(std::uint64_t, number, "counts what went over the bus, from 1 on");
  TMCL_FIELD(std::int64_t, utc_us, "when, in microseconds since 1970");
  TMCL_FIELD(std::string, direction, "out: to the modules; in: from them");
  TMCL_FIELD(std::string, bytes, "in hexadecimal, as they were on the wire");
  TMCL_FIELD(std::optional<std::uint32_t>, can_id, "identifier of the frame, on CAN");
  TMCL_FIELD(std::optional<bool>, can_extended, "true: that has 29 bits");
  TMCL_FIELD(std::optional<bool>, garbage, "true: they belong to no datagram");
  TMCL_FIELD(std::optional<std::string>, client,
             "who asked, or whose question it seems to answer; absent: the daemon itself");
};
struct Traffic {
  TMCL_STRUCT(Traffic);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::uint64_t, last, "number of the newest one that there is");
  TMCL_FIELD(std::uint64_t, dropped, "how many after 'after' are not remembered any more");
  TMCL_FIELD(std::vector<Datagram>, datagrams, "the oldest first");
};
struct Trace {
  TMCL_METHOD("bus.trace", reads, Traffic, "what went over a bus lately: the last 4096 datagrams",
              Trace);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::optional<std::uint64_t>, after,
             "those behind the one of this number; the newest if absent");
  TMCL_FIELD(std::optional<std::int32_t>, limit, "how many at most; 256 if absent", {1, 1024});
};

struct FoundModule {
  TMCL_STRUCT(FoundModule);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::uint16_t, address, address_summary);
  TMCL_FIELD(std::optional<std::string>, model, model_summary);
  TMCL_FIELD(std::optional<std::uint16_t>, model_number, "its number");
  TMCL_FIELD(std::optional<std::string>, firmware, "its version");
  TMCL_FIELD(std::optional<std::uint8_t>, axes, "how many motors it has");
  TMCL_FIELD(bool, in_bootloader, "no firmware runs");
  TMCL_FIELD(bool, duplicate_suspected, "several have this address");
  TMCL_FIELD(bool, address_is_reply_id, "it takes replies for commands");
};
struct UnscannedBus {
  TMCL_STRUCT(UnscannedBus);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(boost::json::object, error, "why it could not be scanned");
};
struct SilentBus {
  TMCL_STRUCT(SilentBus);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::optional<Heard>, heard, "what came in meanwhile; null on CAN");
};
struct FoundModules {
  TMCL_STRUCT(FoundModules);
  TMCL_FIELD(std::vector<FoundModule>, modules, "who has answered");
  TMCL_FIELD(std::vector<UnscannedBus>, failed, "buses that could not be scanned");
  TMCL_FIELD(std::vector<SilentBus>, silent, "buses on which no module was found");
};
struct Scan {
  TMCL_METHOD("bus.scan", reads, FoundModules,
              "asks every address who is there; tells its progress by notify_progress", Scan);
  TMCL_FIELD(std::optional<std::string>, bus, "name of the bus; all buses if absent");
  TMCL_FIELD(std::optional<std::uint16_t>, first, "first address; 1 if absent", addresses);
  TMCL_FIELD(std::optional<std::uint16_t>, last,
             "last address; 255 if absent, and at most on serial lines", addresses);
};

}  // namespace bus

namespace module {

struct Module {
  TMCL_STRUCT(Module);
  TMCL_FIELD(std::string, bus, bus_summary);
  TMCL_FIELD(std::uint16_t, address, address_summary);
  TMCL_FIELD(std::optional<std::string>, model, model_summary);
  TMCL_FIELD(std::optional<std::uint16_t>, model_number, "its number");
  TMCL_FIELD(std::optional<std::string>, firmware, "its version");
  TMCL_FIELD(std::optional<std::uint8_t>, axes, "how many motors it has");
  TMCL_FIELD(std::string, state, "unknown, ready, silent, in_bootloader");
  TMCL_FIELD(bool, duplicate_suspected, "several have this address");
  TMCL_FIELD(
      std::string, watched_by,
      "by what it is noticed that it has started again: tick, variable:N, settings, or none");
  TMCL_FIELD(WordOr<axis::Deadman>, deadman,
             "whether it stops its motors when no host sends it anything: unknown, none, or what "
             "a test has found");
  TMCL_FIELD(std::string, settings,
             "whether they are as in the file that is configured: none (no file), unknown, "
             "as_file, differ");
};
struct Modules {
  TMCL_STRUCT(Modules);
  TMCL_FIELD(std::vector<Module>, modules, "the modules");
};
struct List {
  TMCL_METHOD("module.list", reads, Modules, "the configured modules and how they are", List);
};

struct Reply {
  TMCL_STRUCT(Reply);
  TMCL_FIELD(std::uint8_t, status, "status byte of the reply");
  TMCL_FIELD(std::string, status_name, "its standard name");
  TMCL_FIELD(std::uint8_t, command, "command byte of the reply");
  TMCL_FIELD(std::int32_t, value, "value of the reply");
  TMCL_FIELD(std::optional<std::string>, text, "the firmware version where it came as text");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings,
             "such as that an axis turns for this connection only; null if there are none");
};
struct Execute : SoonOnModule {
  TMCL_METHOD("module.execute", moves, Reply, "any TMCL command, exactly as given", Execute,
              SoonOnModule);
  TMCL_FIELD(NameOrNumber, command, "TMCL mnemonic or number", {0, 255});
  TMCL_FIELD(std::optional<NameOrNumber>, type, "type field; 0 if absent", {0, 255});
  TMCL_FIELD(std::optional<std::uint8_t>, motor, "motor or bank; 0 if absent");
  TMCL_FIELD(std::optional<std::int32_t>, value, "value field; 0 if absent");
};

struct FirmwareInfo {
  TMCL_STRUCT(FirmwareInfo);
  TMCL_FIELD(std::optional<std::int32_t>, module_id, "what the firmware is for");
  TMCL_FIELD(std::optional<std::int32_t>, version, "its version");
  TMCL_FIELD(std::optional<std::int32_t>, capabilities,
             "1 bootloader, 2 stand-alone programs, 4 CANopen, 8 EtherCAT, 16 IO-Link");
  TMCL_FIELD(std::optional<std::int32_t>, release_type, "kind of release");
  TMCL_FIELD(std::optional<std::int32_t>, bootloader_id, "what the bootloader is for");
  TMCL_FIELD(std::optional<std::int32_t>, bootloader_version, "its version");
  TMCL_FIELD(std::optional<std::int32_t>, axis_parameter_width,
             "bits of an axis parameter's number");
  TMCL_FIELD(std::optional<std::int32_t>, register_address_width, "bits of a register's address");
  TMCL_FIELD(std::optional<std::int32_t>, git_hash, "what it was built from");
};
struct Info : SoonOnModule {
  TMCL_METHOD("module.info", reads, FirmwareInfo, "what a module's firmware says of itself", Info,
              SoonOnModule);
};
struct ReportArrivals : SoonOnModule {
  TMCL_METHOD("module.report_arrivals", writes, Nothing,
              "lets a module tell when motors arrive: events of the kind target_reached",
              ReportArrivals, SoonOnModule);
  TMCL_FIELD(std::vector<std::uint8_t>, motors, "which motors; none of them if empty", {0, 30});
  TMCL_FIELD(std::optional<bool>, every, "every move from now on; only the next one if absent");
};
struct Reset : SoonOnModule {
  TMCL_METHOD("module.reset", moves, Nothing, "restarts a module", Reset, SoonOnModule);
};
struct FactoryReset : SoonOnModule {
  TMCL_METHOD("module.factory_reset", moves, Nothing,
              "restores everything in a module to how it was delivered", FactoryReset,
              SoonOnModule);
};

}  // namespace module

namespace global {

/// A global parameter of a module.
struct OnGlobal : SoonOnModule {
  TMCL_STRUCT(OnGlobal, SoonOnModule);
  TMCL_FIELD(NameOrNumber, parameter, "standard name or number of the global parameter", {0, 255});
  TMCL_FIELD(std::optional<std::uint8_t>, bank, "bank of the parameter; 0 if absent");
};

struct Global {
  TMCL_STRUCT(Global);
  TMCL_FIELD(std::optional<std::string>, parameter,
             "standard name; null if it was given by number");
  TMCL_FIELD(std::uint8_t, number, "number of the global parameter");
  TMCL_FIELD(std::uint8_t, bank, "its bank");
};
struct GlobalValue : Global {
  TMCL_STRUCT(GlobalValue, Global);
  TMCL_FIELD(std::int32_t, value, "its value");
};

struct Get : OnGlobal {
  TMCL_METHOD("global.get", reads, GlobalValue, "reads a global parameter", Get, OnGlobal);
};
struct Set : OnGlobal {
  TMCL_METHOD("global.set", writes, GlobalValue, "sets a global parameter", Set, OnGlobal);
  TMCL_FIELD(std::int32_t, value, "what to set it to");
};
struct Store : OnGlobal {
  TMCL_METHOD("global.store", writes, Global, "copies a global parameter to the EEPROM", Store,
              OnGlobal);
};
struct Restore : OnGlobal {
  TMCL_METHOD("global.restore", writes, Global, "copies a global parameter back from the EEPROM",
              Restore, OnGlobal);
};

}  // namespace global

namespace io {

constexpr std::string_view port_summary = "number of the port";

struct PortValue {
  TMCL_STRUCT(PortValue);
  TMCL_FIELD(std::int32_t, value, "value of the port");
};
struct Get : SoonOnModule {
  TMCL_METHOD("io.get", reads, PortValue, "reads an input or output", Get, SoonOnModule);
  TMCL_FIELD(std::uint8_t, port, port_summary);
  TMCL_FIELD(std::optional<std::uint8_t>, bank,
             "0 digital inputs, 1 analog inputs, 2 digital outputs; 0 if absent", {0, 2});
};
struct Set : SoonOnModule {
  TMCL_METHOD("io.set", writes, PortValue, "sets a digital output", Set, SoonOnModule);
  TMCL_FIELD(std::uint8_t, port, port_summary);
  TMCL_FIELD(std::int32_t, value, "what to set it to");
};

}  // namespace io
}  // namespace tmcl::api
