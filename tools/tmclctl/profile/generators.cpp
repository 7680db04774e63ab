#include "profile/generators.hpp"

#include <algorithm>
#include <array>

#include "profile/player.hpp"
#include "tmcl/ramp/mc1451a.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmclctl::profile {
namespace {

using namespace tmcl::ramp;

// As the firmware of the modules writes it: without it a motor need not arrive.
constexpr Default tmc429_defaults[] = {{"v_min", 1}};
constexpr std::string_view tmc429_last[] = {"pmul",     "pdiv",     "mode",
                                            "v_target", "v_actual", "x_target"};

constexpr std::string_view tmc457_last[] = {"mode", "v_target", "x_target"};

constexpr std::string_view tmc4361_last[] = {"rampmode", "xtarget"};

// The data sheet asks for both: at least 10, and not below vstart.
constexpr Default sixpoint_defaults[] = {{"vstop", 10, "vstart"}};
constexpr std::string_view sixpoint_last[] = {"rampmode", "xtarget"};

constexpr Scale mc1451a_scales[] = {{"velocity", 16, "steps/cycle"},
                                    {"acceleration", 16, "steps/cycle^2"},
                                    {"jerk", 32, "steps/cycle^3"}};
constexpr std::string_view mc1451a_last[] = {"profile", "position"};

template <Generator G>
std::unique_ptr<Simulation> simulate(Script script) {
  return std::make_unique<SimulationOf<G>>(std::move(script));
}

template <Generator G>
GeneratorInfo info(std::span<const Default> defaults,
                   std::span<const std::string_view> written_last) {
  return {G::chip, G::registers(),      defaults,   written_last, "s", "microsteps",
          true,    G::ticks_per_second, simulate<G>};
}

}  // namespace

const Scale* GeneratorInfo::scale_of(std::string_view register_name) const {
  const auto found = std::ranges::find(scales, register_name, &Scale::register_name);
  return found == scales.end() ? nullptr : &*found;
}

std::span<const GeneratorInfo> generators() {
  static const auto all = [] {
    std::array rows{info<Tmc429>(tmc429_defaults, tmc429_last), info<Tmc457>({}, tmc457_last),
                    info<Tmc4361>({}, tmc4361_last),
                    info<SixPoint>(sixpoint_defaults, sixpoint_last),
                    info<Mc1451a>({}, mc1451a_last)};
    // Its data sheet counts in cycles and steps, however long a cycle is.
    rows.back().time_unit = "cycles";
    rows.back().length_unit = "steps";
    rows.back().clocked = false;
    rows.back().scales = mc1451a_scales;
    return rows;
  }();
  return all;
}

}  // namespace tmclctl::profile
