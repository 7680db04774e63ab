/// Modules and axes, as a gateway lists them or a scan finds them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "axis_names.hpp"
#include "connection/gateway.hpp"
#include "tmcl/api/module.hpp"

namespace tmclctl {

struct ModuleRow {
  std::string bus;
  std::uint16_t address = 0;
  std::string model;  ///< Empty if it is not known.
  std::uint16_t model_number = 0;
  std::string firmware;
  std::uint8_t axes = 0;
  bool duplicate_suspected = false;
  std::string state;                 ///< Empty after a scan.
  bool in_bootloader = false;        ///< It answers, but runs no firmware.
  bool address_is_reply_id = false;  ///< On CAN: it takes every reply for a command.
  std::string watched_by{};      ///< Empty after a scan; else tick, variable:N, settings or none.
  boost::json::value deadman{};  ///< Null after a scan; else as module.list has it.
};
/// For people, of a module: its model, or its number where that has no name; 0: it does not tell.
std::string model_text(std::string_view name, unsigned number);
boost::json::object to_json(const ModuleRow& row);

struct AxisRow : tmcl::api::axis::Axis {
  std::string why{};  ///< It cannot be reached; empty if nothing is known to be wrong.
};
boost::json::object to_json(const AxisRow& row);

struct ScanRange {
  std::uint16_t first = 1;
  std::uint16_t last = 255;
};
struct UnscannedBus {
  std::string bus;
  Error error;
};
struct ScanResult {
  std::vector<ModuleRow> modules;
  std::vector<UnscannedBus> failed;
  std::vector<tmcl::api::bus::SilentBus> silent{};
};
/// What a scan tells while it goes on.
struct ScanNews {
  std::function<void(const std::string& bus, std::size_t asked, std::size_t of)> progress{};
  std::function<void(const ModuleRow& row)> found{};
};

Result<ScanResult> scan(ScanRange range, const ScanNews& news, Context& context);
Result<std::vector<ModuleRow>> modules_of(Context& context);
Result<std::vector<AxisRow>> axes_of(Context& context);
Result<tmcl::AxisUnits> units_of(const std::string& axis, Context& context);

/// An empty name: the only bus there is.
Result<tmcl::api::bus::Bus> bus_named(const std::string& name, Context& context);
/// A module as methods take it.
Result<tmcl::api::OnModule> on_module(const ModuleName& module, Context& context);
/// The same, as it was typed.
Result<tmcl::api::OnModule> on_module(std::string_view text, Context& context);

}  // namespace tmclctl
