// Whatever the settings of axes and the limits of their configuration: no line and no path exceeds
// them at any time, and however it ends, everything is set as it was before.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/parameter_number.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using Random = tmcl::test::Random<std::int32_t>;

/// What a parameter is drawn from.
struct Draw {
  std::string name;
  std::int32_t least = 0;
  std::int32_t greatest = 0;
};
/// A generator, and all parameters that limit it.
struct Family {
  std::string name;
  std::string model;
  std::vector<Draw> draws;
};
void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

// The start and stop speeds, and the stages below V1, are in no relation to the others but that of
// the data sheets: VSTART is not above VSTOP, and no stage is without an acceleration.
const Family families[] = {
    {"Tmc429",
     "TMCM-3110",
     {{"pulse_divisor", 2, 4},
      {"ramp_divisor", 4, 6},
      {"max_velocity", 300, 2047},
      {"max_acceleration", 60, 500},
      {"minimum_velocity", 1, 40}}},
    {"Tmc457",
     "TMCM-142",
     {{"max_velocity", 1'000'000, 5'000'000},
      {"acceleration", 3000, 30'000},
      {"max_deceleration", 3000, 30'000},
      {"stop_deceleration", 3000, 30'000},
      {"max_bow", 0, 11}}},
    {"SixPoint",
     "TMCM-6212",
     {{"max_velocity", 20'000, 100'000},
      {"max_acceleration", 50'000, 400'000},
      {"max_deceleration", 50'000, 400'000},
      {"acceleration_a1", 50'000, 400'000},
      {"deceleration_d1", 50'000, 400'000},
      {"velocity_v1", 0, 20'000},
      {"start_velocity", 0, 200},
      {"stop_velocity", 200, 500},
      {"ramp_wait_time", 0, 200}}},
    {"Tmc4361",
     "TMCM-3351",
     {{"max_velocity", 20'000, 100'000},
      {"max_acceleration", 50'000, 400'000},
      {"max_deceleration", 50'000, 400'000},
      {"start_acceleration", 50'000, 400'000},
      {"final_deceleration", 50'000, 400'000},
      {"break_velocity", 0, 20'000},
      {"start_velocity", 0, 200},
      {"stop_velocity", 200, 500},
      {"stop_deceleration", 50'000, 400'000}}},
    {"Firmware",
     "TMCM-1021",
     {{"max_velocity", 20'000, 100'000}, {"max_acceleration", 50'000, 400'000}}},
};

constexpr double microsteps_per_mm = 51'200 / 5.0;

/// In microsteps and seconds.
struct Limits {
  double velocity = 0;
  double acceleration = 0;
  double deceleration = 0;
};

std::string config_of(const tmcl::Model& model, const std::optional<Limits>& limits) {
  std::string text =
      "[daemon]\nsocket = \"/none\"\n[[bus]]\nname = \"bench\"\n"
      "link = \"serial:/dev/none@115200\"\n";
  for (int motor = 0; motor < std::min<int>(2, model.axes); ++motor) {
    text += fmt::format(
        "[[axis]]\nname = \"{}\"\nbus = \"bench\"\naddress = 1\nmotor = {}\nunit = \"mm\"\n"
        "units_per_revolution = 5\n",
        "xy"[motor], motor);
    if (!limits) continue;
    text +=
        fmt::format("max_velocity = {:.6f}\nmax_acceleration = {:.6f}\nmax_deceleration = {:.6f}\n",
                    limits->velocity / microsteps_per_mm, limits->acceleration / microsteps_per_mm,
                    limits->deceleration / microsteps_per_mm);
  }
  return text;
}

/// The axes of one module, and somebody who looks at its motors every millisecond.
class LimitsBench : public CableBench {
 public:
  using Settings = std::map<std::string, std::int32_t>;

  LimitsBench(const Family& family, const Settings& settings,
              const std::optional<Limits>& limits = std::nullopt)
      : CableBench(config_of(*tmcl::find_model(family.model), limits), family.model),
        model_(*tmcl::find_model(family.model)) {
    std::filesystem::create_directory(folder_);
    end_gateway();
    set(family.draws, settings);
    start_gateway(journal_);
  }
  ~LimitsBench() { std::filesystem::remove_all(folder_); }

  const tmcl::Model& model() const { return model_; }
  json::array axes() const { return model_.axes > 1 ? json::array{"x", "y"} : json::array{"x"}; }
  void set(const std::vector<Draw>& order, const Settings& settings) {
    for (std::uint8_t motor = 0; motor < axes().size(); ++motor) {
      for (const auto& [name, least, greatest] : order) {
        const auto& row = *find_parameter(axis_parameters(model_), name);
        other_master(
            {tmcl::ModuleAddress{1}, tmcl::Command::SAP, row.number, motor, settings.at(name)});
        EXPECT_NEAR(get(motor, name), settings.at(name), 200) << name << ", but for rounding";
      }
      // No limit is below them.
      for (const auto* name : {"reference_search_speed", "reference_switch_speed"})
        if (const auto* row = find_parameter(axis_parameters(model_), name))
          other_master({tmcl::ModuleAddress{1}, tmcl::Command::SAP, row->number, motor, 100});
    }
  }
  std::int32_t get(std::uint8_t motor, std::string_view name) {
    const auto* row = find_parameter(axis_parameters(model_), name);
    return row == nullptr ? 0 : CableBench::get(motor, row->number);
  }
  /// All that a module may keep in its EEPROM, but for what a movement is.
  std::vector<std::map<std::string_view, std::int32_t>> settings() {
    std::vector<std::map<std::string_view, std::int32_t>> all(axes().size());
    for (std::uint8_t motor = 0; motor < all.size(); ++motor)
      for (const auto& row : axis_parameters(model_))
        if (row.stored && row.name != "ramp_mode") all[motor][row.name] = get(motor, row.name);
    return all;
  }
  bool moves() {
    for (std::uint8_t motor = 0; motor < axes().size(); ++motor)
      if (get(motor, "actual_velocity") != 0) return true;
    return false;
  }
  tmcl::ModuleUnits units(std::uint8_t motor) {
    std::vector<std::int32_t> values;
    for (const auto parameter : tmcl::unit_parameters(model_))
      values.push_back(CableBench::get(motor, parameter));
    return module_units(model_, values).value();
  }
  double pps(std::uint8_t motor, std::string_view velocity) {
    return to_pps(tmcl::InternalVelocity{get(motor, velocity)}, units(motor)).value;
  }
  double pps2(std::uint8_t motor, std::string_view acceleration) {
    return to_pps2(tmcl::InternalAcceleration{get(motor, acceleration)}, units(motor)).value;
  }

  /// What it would still have written is not there.
  void kill() {
    std::ostringstream left;
    left << std::ifstream(journal_).rdbuf();
    end_gateway();
    if (!left.str().empty()) std::ofstream(journal_) << left.str();
  }
  void start_again() { start_gateway(journal_); }

 private:
  const tmcl::Model& model_;
  const std::string folder_ =
      std::filesystem::temp_directory_path() / ("tmcl-limits-" + std::to_string(::getpid()));
  const std::string journal_ = folder_ + "/journal";
};

constexpr int usual_rounds = 60;
constexpr tmcl::Duration look = 1ms;

/// Sees what the motors do at most.
class Watch {
 public:
  Watch(LimitsBench& bench, std::vector<Limits> limits)
      : bench_(bench), limits_(std::move(limits)), before_(limits_.size()) {}

  void pass(tmcl::Duration time) {
    for (; time > 0ms; time -= look) {
      bench_.time.run_for(look);
      for (std::uint8_t motor = 0; motor < limits_.size(); ++motor) look_at(motor);
    }
  }
  /// What happens until now it does not see.
  void go_on() {
    for (std::uint8_t motor = 0; motor < limits_.size(); ++motor)
      before_[motor] = bench_.pps(motor, "actual_velocity");
  }
  /// By what a limit was exceeded at most; and what was reached at most, as a part of it.
  double velocity_beyond = -1e9, change_beyond = -1e9;
  double velocity_reached = 0, acceleration_reached = 0;

 private:
  /// A generator changes its velocity at its ticks alone, so there may be one more of them between
  /// two looks.
  double seconds_between_looks(std::uint8_t motor) {
    constexpr double clock_hz = 16e6;
    const bool is_tmc429 = bench_.model().family == tmcl::Family::tmc429;
    const double tick = is_tmc429 ? std::ldexp(32, bench_.get(motor, "ramp_divisor")) : 512;
    return std::chrono::duration<double>(look).count() + tick / clock_hz;
  }
  /// At which it may begin, and from which it may stop.
  double jump(std::uint8_t motor) {
    double most = 0;
    for (const auto* name : {"start_velocity", "stop_velocity", "minimum_velocity"})
      most = std::max(most, bench_.pps(motor, name));
    return most;
  }
  void look_at(std::uint8_t motor) {
    const auto& limit = limits_[motor];
    const double unit = bench_.units(motor).velocity.value;  // to which a reading is rounded
    const double now = bench_.pps(motor, "actual_velocity");
    const double before = std::exchange(before_[motor], now);
    velocity_beyond = std::max(velocity_beyond, std::abs(now) - unit - limit.velocity);
    velocity_reached = std::max(velocity_reached, std::abs(now) / limit.velocity);
    const bool through_zero = now * before <= 0;
    const bool faster = std::abs(now) > std::abs(before);
    const double steepest = through_zero ? std::max(limit.acceleration, limit.deceleration)
                            : faster     ? limit.acceleration
                                         : limit.deceleration;
    const double change = std::abs(now - before) - 2 * unit - (through_zero ? jump(motor) : 0);
    const double time = seconds_between_looks(motor);
    change_beyond = std::max(change_beyond, change - steepest * time);
    acceleration_reached = std::max(acceleration_reached, change / time / steepest);
  }

  LimitsBench& bench_;
  std::vector<Limits> limits_;
  std::vector<double> before_;
};

enum class End : std::uint8_t { done, stopped, refused, client_gone, killed };
constexpr const char* names_of_ends[] = {"done", "stopped", "refused", "client gone", "killed"};

class LimitsOf : public testing::TestWithParam<Family> {
 protected:
  using Settings = LimitsBench::Settings;

  static Settings drawn(Random& random) {
    Settings settings;
    for (const auto& [name, least, greatest] : GetParam().draws)
      settings[name] = random.between(least, greatest);
    return settings;
  }

  /// Of the axes' own settings, as they are now.
  static std::vector<Limits> own_limits(LimitsBench& bench) {
    std::vector<Limits> limits;
    for (std::uint8_t motor = 0; motor < bench.axes().size(); ++motor) {
      const bool is_tmc457 = bench.model().family == tmcl::Family::tmc457;
      const auto up = bench.pps2(motor, is_tmc457 ? "acceleration" : "max_acceleration");
      const auto down = bench.pps2(motor, "max_deceleration");
      limits.push_back({bench.pps(motor, "max_velocity"), up, down > 0 ? down : up});
    }
    return limits;
  }

  /// A configuration that these settings keep, and that leaves a stream a little more.
  static Limits limits_above(const Settings& settings, Random& random) {
    const auto& model = *tmcl::find_model(GetParam().model);
    auto units = initial_units(model);
    if (settings.contains("pulse_divisor")) {
      const std::int32_t dividers[] = {settings.at("pulse_divisor"), settings.at("ramp_divisor")};
      units = module_units(model, dividers).value();
    }
    std::int32_t velocity = 0, acceleration = 0;
    for (const auto& [name, value] : settings) {
      const auto& row = *find_parameter(axis_parameters(model), name);
      const auto dimension = dimension_of(row);
      if (dimension == tmcl::Dimension::velocity) velocity = std::max(velocity, value);
      if (dimension == tmcl::Dimension::acceleration) acceleration = std::max(acceleration, value);
    }
    const auto more = [&] { return 1 + random.between(1, 50) / 100.0; };
    const double steepness = to_pps2(tmcl::InternalAcceleration{acceleration}, units).value;
    return {to_pps(tmcl::InternalVelocity{velocity}, units).value * more(), steepness * more(),
            steepness * more()};
  }

  static void let_end(LimitsBench& bench, Watch& watch, const CableBench::Answer& journey, End end,
                      Random& random) {
    watch.pass(std::chrono::milliseconds(random.between(0, 2000)));
    switch (end) {
      case End::done:
      case End::refused: break;
      case End::stopped: bench.call("axis.stop", {{"axis", "x"}}); break;
      case End::client_gone:
        bench.client_leaves();
        bench.be_another_client();
        break;
      case End::killed:
        bench.kill();
        watch.go_on();
        watch.pass(std::chrono::milliseconds(random.between(0, 1000)));
        bench.start_again();
        break;
    }
    watch.go_on();
    for (int s = 0; s < 300 && (bench.moves() || (end != End::killed && !journey->has_value()));
         ++s)
      watch.pass(1s);
    watch.pass(2s);
    EXPECT_FALSE(bench.moves());
  }

  /// A random one of the values that the settings do not have already.
  static void refuse_one(LimitsBench& bench, Random& random) {
    auto left = std::make_shared<int>(random.between(1, 12));
    auto had = std::make_shared<std::map<std::pair<int, int>, std::int32_t>>();
    bench.wire.refuses = [&bench, left, had](const tmcl::Request& request) {
      if (request.command != tmcl::Command::SAP) return false;
      const auto own = bench.module.axis(request.motor).get(request.type).value_or(0);
      return request.value != had->try_emplace({request.motor, request.type}, own).first->second &&
             --*left == 0;
    };
  }

  static void run(LimitsBench& bench, Watch& watch, const char* method, json::object params,
                  Random& random) {
    const auto end = static_cast<End>(random.between(0, 4));
    SCOPED_TRACE(names_of_ends[static_cast<int>(end)]);
    const auto before = bench.settings();
    if (end == End::refused) refuse_one(bench, random);
    const auto journey = bench.begin(method, std::move(params));
    let_end(bench, watch, journey, end, random);
    EXPECT_EQ(bench.settings(), before);
    if (end != End::done) return;
    ASSERT_TRUE(**journey) << (*journey)->error().message;
    EXPECT_GT(watch.velocity_reached, 0);
  }

  template <class Once>
  static void repeat(int usual, Once once) {
    for (int round = 0; round < tmcl::test::rounds(usual); ++round) {
      const auto seed = tmcl::test::seed() + static_cast<unsigned>(round);
      SCOPED_TRACE(testing::Message() << "TMCL_ROUNDS=1 TMCL_SEED=" << seed);
      Random random(seed);
      once(random);
      if (testing::Test::HasFailure()) break;
    }
  }
  void note(const Watch& watch) {
    EXPECT_LE(watch.velocity_beyond, 0);
    EXPECT_LE(watch.change_beyond, 0);
    fastest_ = std::max(fastest_, watch.velocity_reached);
    steepest_ = std::max(steepest_, watch.acceleration_reached);
  }
  /// Not in a replay of one round.
  void expect_tried() const {
    if (tmcl::test::rounds(usual_rounds) < usual_rounds) return;
    EXPECT_GT(fastest_, 0.99) << "no limit was tried";
    EXPECT_GT(steepest_, 0.9) << "no limit was tried";
  }
  double fastest_ = 0, steepest_ = 0;

  static json::object line(const LimitsBench& bench, Random& random) {
    json::array targets;
    for (std::size_t i = 0; i < bench.axes().size(); ++i)
      targets.push_back(random.either_way(random.between(500, 60'000)));
    return {{"axes", bench.axes()}, {"positions_microsteps", targets}};
  }
  static json::object path(const LimitsBench& bench, Random& random, const char* mode) {
    std::string text;
    for (int leg = random.between(1, 4); leg > 0; --leg) {
      text += fmt::format("G1 X{:.3f}", random.between(-8000, 8000) / 1000.0);
      if (bench.axes().size() > 1)
        text += fmt::format(" Y{:.3f}", random.between(-8000, 8000) / 1000.0);
      text += fmt::format(" F{}\n", random.between(60, 2000));
    }
    // At its greatest velocity an axis makes up for nothing, and may be late by some millimetres.
    return {{"axes", bench.axes()}, {"text", text}, {"mode", mode}, {"deviation", 50}};
  }
};

class LimitsOfLines : public LimitsOf {};

TEST_P(LimitsOfLines, NoneExceedsThoseOfItsAxes) {
  repeat(usual_rounds, [&](Random& random) {
    LimitsBench bench(GetParam(), drawn(random));
    Watch watch(bench, own_limits(bench));
    run(bench, watch, "line.move", line(bench, random), random);
    note(watch);
  });
  expect_tried();
}

class LimitsOfUnknownRamps : public LimitsOf {};

TEST_P(LimitsOfUnknownRamps, ALineIsRefusedAndChangesNothing) {
  repeat(5, [&](Random& random) {
    LimitsBench bench(GetParam(), drawn(random));
    const auto before = bench.settings();
    const auto refused = bench.call("line.move", line(bench, random));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, testing::HasSubstr("cannot be foreseen"));
    EXPECT_FALSE(bench.moves());
    EXPECT_EQ(bench.settings(), before);
  });
}

// Within an update, or where a leg begins, an axis changes its speed faster than its own settings
// have it: what limits that is the configuration.
class LimitsOfPaths : public LimitsOf {};

TEST_P(LimitsOfPaths, NoneExceedsTheVelocityOfItsAxesAndWhatTheConfigurationSays) {
  repeat(usual_rounds, [&](Random& random) {
    const auto settings = drawn(random);
    auto limits = limits_above(settings, random);
    LimitsBench bench(GetParam(), settings, limits);
    auto own = own_limits(bench);
    for (auto& axis : own) axis = {axis.velocity, limits.acceleration, limits.deceleration};
    Watch watch(bench, own);
    const char* modes[] = {"velocity", "segments", "position"};
    const auto* mode = modes[random.between(0, GetParam().name == "SixPoint" ? 2 : 1)];
    SCOPED_TRACE(mode);
    run(bench, watch, "path.run", path(bench, random, mode), random);
    note(watch);
  });
  expect_tried();
}

constexpr auto name_of_family = [](const auto& one) { return one.param.name; };
constexpr std::size_t foreseen = 3;
INSTANTIATE_TEST_SUITE_P(Families, LimitsOfLines,
                         testing::ValuesIn(std::begin(families), std::begin(families) + foreseen),
                         name_of_family);
INSTANTIATE_TEST_SUITE_P(Families, LimitsOfUnknownRamps,
                         testing::ValuesIn(std::begin(families) + foreseen, std::end(families)),
                         name_of_family);
INSTANTIATE_TEST_SUITE_P(Families, LimitsOfPaths, testing::ValuesIn(families), name_of_family);

}  // namespace
}  // namespace tmcld::test
