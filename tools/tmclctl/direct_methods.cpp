// The methods of tmcld, done without it: the same parameters, the same results.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "direct_target.hpp"
#include "json_read.hpp"
#include "method_words.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using tmcl::blocking::Axis;
using tmcl::blocking::Module;
using tmcl::program::Program;

template <class Integer>
std::optional<Integer> optional_at(const json::object& params, std::string_view key) {
  if (!params.contains(key)) return std::nullopt;
  return integer_at<Integer>(params, key);
}

std::uint8_t byte_at(const json::object& params, std::string_view key) {
  return integer_at<std::uint8_t>(params, key);
}
std::uint16_t place_at(const json::object& params, std::string_view key) {
  return integer_at<std::uint16_t>(params, key);
}

template <class Value>
json::value or_null(const std::optional<Value>& value) {
  if (!value) return nullptr;
  if constexpr (std::is_same_v<Value, tmcl::Microsteps>) {
    return value->value;
  } else {
    return *value;
  }
}

// ---- results, as tmcld gives them ----

json::object to_json(tmcl::Microsteps place) { return {{"position_microsteps", place.value}}; }
json::object to_json(std::int32_t value) { return {{"value", value}}; }
json::object to_json(const tmcl::Homed& homed) {
  return {{"correction_microsteps", or_null(homed.correction)},
          {"switch_distance_microsteps", or_null(homed.switch_distance)}};
}
json::object to_json(const tmcl::FirmwareInfo& info) {
  return {{"module_id", or_null(info.module_id)},
          {"version", or_null(info.version)},
          {"capabilities", or_null(info.capabilities)},
          {"release_type", or_null(info.release_type)},
          {"bootloader_id", or_null(info.bootloader_id)},
          {"bootloader_version", or_null(info.bootloader_version)},
          {"axis_parameter_width", or_null(info.axis_parameter_width)},
          {"register_address_width", or_null(info.register_address_width)},
          {"git_hash", or_null(info.git_hash)}};
}
json::object to_json(const tmcl::ProgramStatus& status) {
  constexpr std::array names{"stopped", "running", "stepping", "reset"};
  return {{"state", names.at(static_cast<std::size_t>(status.state))},
          {"next_address", or_null(status.next_address)},
          {"last_error", or_null(status.last_error)}};
}

template <class T>
Attempt<json::object> answer(tmcl::Result<T> result) {
  auto attempted = attempt(std::move(result));
  if (!attempted) return tl::unexpected(attempted.error());
  if constexpr (std::is_void_v<T>) {
    return json::object{};
  } else {
    return to_json(*attempted);
  }
}

// ---- verbs, with their words taken from the parameters ----

auto stop_home(Axis axis, const json::object&) { return axis.stop_reference_search(); }
auto get_coordinate(Axis axis, const json::object& params) {
  return axis.coordinate(byte_at(params, "number"));
}
auto set_coordinate(Axis axis, const json::object& params) {
  return axis.set_coordinate(byte_at(params, "number"),
                             {integer_at<std::int32_t>(params, "position_microsteps")});
}
auto capture_coordinate(Axis axis, const json::object& params) {
  return axis.capture_coordinate(byte_at(params, "number"));
}
auto move_to_coordinate(Axis axis, const json::object& params) {
  return axis.move_to_coordinate(byte_at(params, "number"));
}

std::uint32_t mask_at(const json::object& params, std::string_view key) {
  std::uint32_t mask = 0;
  for (const auto& number : array_at(params, key)) mask |= 1U << number.to_number<unsigned>();
  return mask;
}
auto start_coordinate(Module module, const json::object& params) {
  const tmcl::MotorMask motors{static_cast<std::uint8_t>(mask_at(params, "motors"))};
  const auto together = flag_at(params, "interpolated") ? tmcl::Together::interpolated
                                                        : tmcl::Together::each_for_itself;
  return module.move_motors_to_coordinate(motors, together, byte_at(params, "number"));
}
auto report_arrivals(Module module, const json::object& params) {
  const auto events =
      flag_at(params, "every") ? tmcl::ArrivalEvents::every_move : tmcl::ArrivalEvents::next_move;
  return module.request_arrival_events(events,
                                       static_cast<std::int32_t>(mask_at(params, "motors")));
}

auto store(Axis axis, std::uint8_t parameter) { return axis.store(parameter); }
auto restore(Axis axis, std::uint8_t parameter) { return axis.restore(parameter); }

struct Global {
  std::uint8_t bank;
  std::uint8_t number;
  std::int32_t value;
};
tmcl::Result<std::int32_t> get_global(Module module, Global global) {
  return module.get_global(global.bank, global.number);
}
tmcl::Result<std::int32_t> set_global(Module module, Global global) {
  return module.set_global(global.bank, global.number, global.value).map([&] {
    return global.value;
  });
}
tmcl::Result<void> store_global(Module module, Global global) {
  return module.store_global(global.bank, global.number);
}
tmcl::Result<void> restore_global(Module module, Global global) {
  return module.restore_global(global.bank, global.number);
}

auto get_io(Module module, const json::object& params) {
  return module.get_io(static_cast<tmcl::IoBank>(byte_at(params, "bank")), byte_at(params, "port"));
}
tmcl::Result<std::int32_t> set_io(Module module, const json::object& params) {
  const auto value = integer_at<std::int32_t>(params, "value");
  return module.set_output(byte_at(params, "port"), value).map([&] { return value; });
}
auto info(Module module, const json::object&) { return module.firmware_info(); }
auto reset(Module module, const json::object&) { return module.reset(); }
auto factory_reset(Module module, const json::object&) { return module.factory_reset(); }
auto run(Module module, const json::object& params) {
  return module.run_program(optional_at<std::uint16_t>(params, "first_address"));
}
auto end_program(Module module, const json::object&) { return module.stop_program(); }
auto step(Module module, const json::object&) { return module.step_program(); }
auto reset_program(Module module, const json::object&) { return module.reset_program(); }
auto status(Module module, const json::object&) { return module.program_status(); }
auto set_breakpoint(Module module, const json::object& params) {
  return module.add_breakpoint(place_at(params, "at"));
}
auto clear_breakpoint(Module module, const json::object& params) {
  return module.delete_breakpoint(place_at(params, "at"));
}
auto clear_breakpoints(Module module, const json::object&) {
  return module.delete_all_breakpoints();
}

// ---- those that take long ----

tmcl::OnLoadProgress progress_of(const NewsHandler& on_news) {
  return [on_news](const tmcl::LoadProgress& progress) {
    const bool writes = progress.phase == tmcl::LoadProgress::Phase::writing;
    return !on_news || on_news({{"phase", writes ? "writing" : "comparing"},
                                {"done", progress.done},
                                {"of", progress.of}});
  };
}

Attempt<Program> program_at(const json::object& params) {
  return tmcl::program::from_hex(text_at(params, "program"))
      .map_error([](const std::string& problem) { return usage_failure("bad_program", problem); });
}

json::object with_commands(const Program& program) { return {{"commands", program.size()}}; }

}  // namespace

template <auto Verb>
Attempt<json::object> DirectTarget::on_axis(const json::object& params, const NewsHandler&) {
  return axis_at(text_at(params, "axis")).and_then([&](Axis axis) {
    return answer(Verb(axis, params));
  });
}

template <auto Verb>
Attempt<json::object> DirectTarget::on_parameter(const json::object& params, const NewsHandler&) {
  auto axis = axis_at(text_at(params, "axis"));
  if (!axis) return tl::unexpected(axis.error());
  const auto name = parameter_of(axis->address().module, text_at(params, "parameter"));
  if (!name) return tl::unexpected(name.error());
  return attempt(Verb(*axis, name->number)).map([&] {
    return json::object{{"parameter", name->name}, {"number", name->number}};
  });
}

template <auto Verb>
Attempt<json::object> DirectTarget::on_global(const json::object& params, const NewsHandler&) {
  const auto bank = byte_at(params, "bank");
  const auto table =
      bank == 0 ? common_global_parameters() : std::span<const tmcl::ParameterInfo>{};
  const auto name = parse_parameter(table, text_at(params, "parameter"));
  if (!name) return tl::unexpected(name.error());
  auto module = bus_.module(tmcl::ModuleAddress{place_at(params, "address")});
  const Global global{bank, name->number, integer_at<std::int32_t>(params, "value")};
  return answer(Verb(module, global)).map([&](json::object result) {
    result["parameter"] = name->name;
    result["number"] = name->number;
    result["bank"] = bank;
    return result;
  });
}

template <auto Verb>
Attempt<json::object> DirectTarget::on_module(const json::object& params, const NewsHandler&) {
  return answer(Verb(bus_.module(tmcl::ModuleAddress{place_at(params, "address")}), params));
}

Attempt<json::object> DirectTarget::home(const json::object& params, const NewsHandler& on_news) {
  tmcl::HomeOptions options;
  options.mode = optional_at<std::int32_t>(params, "mode");
  options.timeout = std::chrono::milliseconds(integer_at<std::int32_t>(params, "timeout_ms"));
  options.progress = [&](std::int32_t step) { return !on_news || on_news({{"step", step}}); };
  auto axis = axis_at(text_at(params, "axis"));
  if (!axis) return tl::unexpected(axis.error());
  const auto allowed = check_mode(axis->address().module, options.mode);
  if (!allowed) return tl::unexpected(allowed.error());
  return answer(axis->home(options));
}

Attempt<void> DirectTarget::check_mode(tmcl::ModuleAddress module,
                                       std::optional<std::int32_t> mode) {
  constexpr auto search_mode = tmcl::number_of("reference_search_mode");
  return mode ? check(module, search_mode, *mode) : Attempt<void>{};
}

Attempt<json::object> DirectTarget::start_home(const json::object& params, const NewsHandler&) {
  auto axis = axis_at(text_at(params, "axis"));
  if (!axis) return tl::unexpected(axis.error());
  const auto mode = optional_at<std::int32_t>(params, "mode");
  const auto allowed = check_mode(axis->address().module, mode);
  if (!allowed) return tl::unexpected(allowed.error());
  return answer(axis->start_reference_search(mode));
}

Attempt<json::object> DirectTarget::load(const json::object& params, const NewsHandler& on_news) {
  const auto program = program_at(params);
  if (!program) return tl::unexpected(program.error());
  tmcl::LoadOptions options;
  options.first_address = place_at(params, "first_address");
  options.compare = !params.contains("compare") || flag_at(params, "compare");
  options.progress = progress_of(on_news);
  auto module = bus_.module(tmcl::ModuleAddress{place_at(params, "address")});
  return attempt(module.load_program(*program, options)).map([&] {
    return with_commands(*program);
  });
}

Attempt<json::object> DirectTarget::compare(const json::object& params,
                                            const NewsHandler& on_news) {
  const auto program = program_at(params);
  if (!program) return tl::unexpected(program.error());
  tmcl::LoadOptions options;
  options.first_address = place_at(params, "first_address");
  options.progress = progress_of(on_news);
  auto module = bus_.module(tmcl::ModuleAddress{place_at(params, "address")});
  return attempt(module.compare_program(*program, options)).map([&] {
    return with_commands(*program);
  });
}

Attempt<json::object> DirectTarget::read(const json::object& params, const NewsHandler& on_news) {
  tmcl::ReadOptions options;
  options.first_address = place_at(params, "first_address");
  options.length = optional_at<std::uint16_t>(params, "length");
  options.progress = progress_of(on_news);
  auto module = bus_.module(tmcl::ModuleAddress{place_at(params, "address")});
  return attempt(module.read_program(options)).map([](const Program& program) {
    auto result = with_commands(program);
    result["program"] = tmcl::program::to_hex(program);
    return result;
  });
}

namespace {

/// What is asked of all modules of the axis, not of the motor.
auto store_coordinates(Axis axis, const json::object& params, tmcl::blocking::Bus& bus) {
  return bus.module(axis.address().module)
      .store_coordinates(optional_at<std::uint8_t>(params, "number"));
}
auto load_coordinates(Axis axis, const json::object& params, tmcl::blocking::Bus& bus) {
  return bus.module(axis.address().module)
      .load_coordinates(optional_at<std::uint8_t>(params, "number"));
}

}  // namespace

Attempt<json::object> DirectTarget::store_all(const json::object& params, const NewsHandler&) {
  return axis_at(text_at(params, "axis")).and_then([&](Axis axis) {
    return answer(store_coordinates(axis, params, bus_));
  });
}

Attempt<json::object> DirectTarget::load_all(const json::object& params, const NewsHandler&) {
  return axis_at(text_at(params, "axis")).and_then([&](Axis axis) {
    return answer(load_coordinates(axis, params, bus_));
  });
}

std::span<const DirectTarget::DirectMethod> DirectTarget::methods() {
  using T = DirectTarget;
  static constexpr std::array all{
      DirectMethod{"axis.home", &T::home},
      DirectMethod{"axis.start_home", &T::start_home},
      DirectMethod{"axis.stop_home", &T::on_axis<stop_home>},
      DirectMethod{"parameter.store", &T::on_parameter<store>},
      DirectMethod{"parameter.restore", &T::on_parameter<restore>},
      DirectMethod{"coordinate.get", &T::on_axis<get_coordinate>},
      DirectMethod{"coordinate.set", &T::on_axis<set_coordinate>},
      DirectMethod{"coordinate.capture", &T::on_axis<capture_coordinate>},
      DirectMethod{"coordinate.move", &T::on_axis<move_to_coordinate>},
      DirectMethod{"coordinate.start", &T::on_module<start_coordinate>},
      DirectMethod{"coordinate.store", &T::store_all},
      DirectMethod{"coordinate.load", &T::load_all},
      DirectMethod{"global.get", &T::on_global<get_global>},
      DirectMethod{"global.set", &T::on_global<set_global>},
      DirectMethod{"global.store", &T::on_global<store_global>},
      DirectMethod{"global.restore", &T::on_global<restore_global>},
      DirectMethod{"io.get", &T::on_module<get_io>},
      DirectMethod{"io.set", &T::on_module<set_io>},
      DirectMethod{"module.info", &T::on_module<info>},
      DirectMethod{"module.report_arrivals", &T::on_module<report_arrivals>},
      DirectMethod{"module.reset", &T::on_module<reset>},
      DirectMethod{"module.factory_reset", &T::on_module<factory_reset>},
      DirectMethod{"program.load", &T::load},
      DirectMethod{"program.compare", &T::compare},
      DirectMethod{"program.read", &T::read},
      DirectMethod{"program.run", &T::on_module<run>},
      DirectMethod{"program.stop", &T::on_module<end_program>},
      DirectMethod{"program.step", &T::on_module<step>},
      DirectMethod{"program.reset", &T::on_module<reset_program>},
      DirectMethod{"program.status", &T::on_module<status>},
      DirectMethod{"program.set_breakpoint", &T::on_module<set_breakpoint>},
      DirectMethod{"program.clear_breakpoint", &T::on_module<clear_breakpoint>},
      DirectMethod{"program.clear_breakpoints", &T::on_module<clear_breakpoints>},
  };
  return all;
}

Attempt<json::object> DirectTarget::perform(const std::string& method, json::object params,
                                            const NewsHandler& on_news) {
  const auto named = address_of({text_at(params, "bus"), place_at(params, "address")});
  if (!named) return tl::unexpected(named.error());
  if (params.contains("position")) {
    const auto place = in_module(text_at(params, "position"), text_at(params, "axis"),
                                 tmcl::axis_parameter::target_position);
    if (!place) return tl::unexpected(place.error());
    params["position_microsteps"] = *place;
  }
  const auto known = methods();
  const auto found = std::ranges::find(known, method, &DirectMethod::name);
  if (found == known.end()) {
    return tl::unexpected(usage_failure(
        "method_not_found", fmt::format("{} needs a running tmcld", with_verbs(method))));
  }
  return (this->*found->run)(params, on_news);
}

}  // namespace tmclctl
