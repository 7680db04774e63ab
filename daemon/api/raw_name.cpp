#include "api/raw_name.hpp"

#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "api/suggest.hpp"

namespace tmcld {
namespace {

constexpr std::uint32_t greatest_serial_address = 255;
constexpr std::uint32_t greatest_can_address = 2047;
constexpr std::uint32_t most_motors = 256;

struct RawName {
  std::string_view bus;  ///< Empty if it is not named.
  std::uint32_t address = 0;
  std::uint32_t motor = 0;
};

std::optional<std::uint32_t> whole(std::string_view text) {
  // As many digits as it can have: a name stands in lines of the audit, which have an end.
  if (text.size() > std::numeric_limits<std::uint32_t>::digits10 + 1) return std::nullopt;
  std::uint32_t number = 0;
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc{} || read.ptr != end) return std::nullopt;
  return number;
}

std::optional<RawName> parse(std::string_view name) {
  const auto slash = name.rfind('/');
  const auto colon = name.rfind(':');
  const auto first_digit = colon == std::string_view::npos ? 0 : colon + 1;
  if (slash < first_digit || colon == 0) return std::nullopt;
  const auto address = whole(name.substr(first_digit, slash - first_digit));
  const auto motor = whole(name.substr(slash + 1));
  if (!address || !motor) return std::nullopt;
  return RawName{name.substr(0, first_digit == 0 ? 0 : colon), *address, *motor};
}

/// Refuses names, with why in them.
class Refuse {
 public:
  Refuse(std::string_view param, const std::string& name) : param_(param), name_(name) {}
  tl::unexpected<Error> operator()(std::string_view error, const std::string& why,
                                   std::string hint) const {
    return tl::unexpected(
        param_error(error, param_, "there is no axis '" + name_ + "': " + why, std::move(hint)));
  }

 private:
  std::string_view param_;
  const std::string& name_;
};

Result<std::shared_ptr<GatewayBus>> bus_of(const Gateway& gateway, const RawName& raw,
                                           const Refuse& refuse) {
  const auto buses = gateway.buses();
  std::vector<std::string_view> names;
  for (const auto& bus : buses) {
    if (bus->name() == raw.bus || (raw.bus.empty() && buses.size() == 1)) return bus;
    names.push_back(bus->name());
  }
  if (raw.bus.empty())
    return refuse("unknown_axis", fmt::format("{} buses have such an address", buses.size()),
                  "name one of them, too, as in BUS:ADDRESS/MOTOR; see bus.list");
  return refuse("unknown_axis", fmt::format("there is no bus '{}'", raw.bus),
                suggest(raw.bus, names, "see bus.list for what there is"));
}

std::optional<std::string> fault_of(const GatewayBus& bus, const RawName& raw) {
  const auto greatest = bus.is_can() ? greatest_can_address : greatest_serial_address;
  if (raw.address == 0 || raw.address > greatest)
    return fmt::format("the address {} is outside 1..{}, which modules on bus '{}' can have",
                       raw.address, greatest, bus.name());
  const auto* module =
      bus.find_module(tmcl::ModuleAddress{static_cast<std::uint16_t>(raw.address)});
  const auto* model = module == nullptr ? nullptr : module->model();
  if (raw.motor < (model == nullptr ? most_motors : model->axes)) return std::nullopt;
  if (model == nullptr) return fmt::format("the motor {} is outside 0..255", raw.motor);
  return fmt::format("there is no motor {}: module {} is a {} and has {}", raw.motor, raw.address,
                     model->name, model->axes);
}

}  // namespace

Result<std::shared_ptr<GatewayAxis>> find_raw_axis(Gateway& gateway, std::string_view param,
                                                   const std::string& name) {
  const Refuse refuse(param, name);
  const auto raw = parse(name);
  if (!raw)
    return refuse("unknown_axis", "no motor is named so",
                  "BUS:ADDRESS/MOTOR names one, as 'bench:1/0'; see axis.list for other names");
  const auto bus = bus_of(gateway, *raw, refuse);
  if (!bus) return tl::unexpected(bus.error());
  const tmcl::AxisAddress address{tmcl::ModuleAddress{static_cast<std::uint16_t>(raw->address)},
                                  static_cast<std::uint8_t>(raw->motor)};
  const bool fits = raw->address <= greatest_can_address && raw->motor < most_motors;
  auto known = fits ? gateway.find_axis(**bus, address) : nullptr;
  if (known) return known;
  const auto fault = fault_of(**bus, *raw);
  if (fault) return refuse("out_of_range", *fault, "see bus.scan for what answers");
  auto added = gateway.add_axis(*bus, address);
  if (added) return added;
  return tl::unexpected(
      failed("too_many_axes",
             fmt::format("{} motors have been named by their address already", most_added_axes),
             "put the axes that are in use into the configuration"));
}

}  // namespace tmcld
