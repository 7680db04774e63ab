// The settings of a module: which parameters are some, their file, and how two of them differ.
#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "config/settings_file.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/intent.hpp"
#include "tmcl/settings.hpp"

namespace tmcl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using tmcld::parse_settings;

const Model& model(std::string_view name) { return *find_model(name); }

std::set<std::string> names_of(const std::vector<SettingInfo>& infos) {
  std::set<std::string> names;
  for (const auto& info : infos) names.insert(info.name);
  return names;
}

SettingKey key_of(const Model& of, std::string_view name) {
  const auto infos = settings_of(of);
  return std::ranges::find(infos, name, &SettingInfo::name)->key;
}

/// One value of each setting, within its range.
Settings some_settings(const Model& of, test::Random<>& random) {
  Settings settings{&of, "1.09"};
  for (const auto& info : settings_of(of))
    settings.values.push_back(
        {info.key, static_cast<std::int32_t>(random.between(info.minimum, info.maximum))});
  return settings;
}

TEST(SettingsOfAModule, MoveNoMotorOnAnyModel) {
  for (const auto& one : models())
    for (const auto& info : settings_of(one)) {
      if (info.key.scope != SettingScope::motor) continue;
      for (const std::int32_t value : {-1, 0, 1, 30000}) {
        const Request write{ModuleAddress{1}, Command::SAP, info.key.number, info.key.motor, value};
        EXPECT_FALSE(can_move(write)) << one.name << ' ' << info.name;
        EXPECT_EQ(intent_of(write, &one).sets, Setpoint::none) << one.name << ' ' << info.name;
      }
    }
}

TEST(SettingsOfAModule, AreNoStatesPositionsOrWaysToReachIt) {
  for (const auto& one : models()) {
    const auto names = names_of(settings_of(one));
    for (const char* name : {"target_position",
                             "actual_position",
                             "target_velocity",
                             "actual_velocity",
                             "ramp_mode",
                             "encoder_position",
                             "torque_mode",
                             "closed_loop_mode",
                             "step_direction_mode",
                             "serial_address",
                             "serial_baud_rate",
                             "serial_host_address",
                             "telegram_pause_time",
                             "can_id",
                             "can_reply_id",
                             "can_bit_rate",
                             "serial_heartbeat",
                             "can_heartbeat",
                             "eeprom_magic",
                             "eeprom_lock",
                             "code_protection",
                             "auto_start_mode",
                             "ascii_mode",
                             "suppress_reply",
                             "tick_timer",
                             "iit_exceed_counter",
                             "serial_secondary_address",
                             "can_secondary_address",
                             "interface_selection"})
      EXPECT_FALSE(names.contains(name)) << one.name << ' ' << name;
  }
}

TEST(SettingsOfAModule, AreAllElseThatItCanKeep) {
  for (const auto& one : models()) {
    const auto names = names_of(settings_of(one));
    const auto apart = names_of(kept_apart(one));
    for (const auto& row : axis_parameters(one)) {
      // That of a TMC457 sets two others at once.
      const bool sets_others = one.family == Family::tmc457 && row.name == "max_acceleration";
      const bool is_kept = row.stored && row.access == Access::read_write && !sets_others;
      EXPECT_EQ(names.contains(std::string(row.name)) || apart.contains(std::string(row.name)),
                is_kept)
          << one.name << ' ' << row.name;
    }
    for (const char* name :
         {"max_velocity", "max_current", "standby_current", "reference_search_speed"})
      EXPECT_TRUE(names.contains(name)) << one.name << ' ' << name;
    EXPECT_TRUE(names.contains("timer_2") && names.contains("input_7")) << one.name;
  }
}

TEST(SettingsOfAModule, HaveKeysInOrderAndNamesOfTheirOwnInASection) {
  for (const auto& one : models()) {
    const auto infos = settings_of(one);
    EXPECT_TRUE(std::ranges::is_sorted(infos, std::less_equal{}, &SettingInfo::key)) << one.name;
    std::set<std::string> seen;
    for (const auto& info : infos)
      EXPECT_TRUE(seen.insert(section_of(info.key) + info.name).second) << one.name << info.name;
  }
}

TEST(SettingsFile, IsReadAsItWasWrittenForEveryModel) {
  test::Random random(test::seed());
  for (const auto& one : models()) {
    const auto written = some_settings(one, random);
    const auto read = parse_settings(to_toml(written));
    ASSERT_TRUE(read) << describe(read.error().front()) << '\n' << to_toml(written);
    EXPECT_EQ(read->values, written.values) << one.name;
    EXPECT_EQ(read->model, written.model);
    EXPECT_EQ(read->firmware, "1.09");
    EXPECT_EQ(to_toml(*read), to_toml(written));
    EXPECT_TRUE(what_to_load(*read, written).empty());
  }
}

TEST(SettingsFile, HasALineForEachWithItsUnit) {
  const auto& of = model("TMCM-1110");
  Settings settings{&of, "1.09"};
  settings.values = {{key_of(of, "end_switch_polarity"), 1},
                     {key_of(of, "timer_0"), 500},
                     {key_of(of, "max_velocity"), 1500},
                     {key_of(of, "max_current"), 128}};
  settings.apart = {{{SettingScope::global, 0, global_parameter::serial_address}, 7}};
  EXPECT_EQ(to_toml(settings),
            "# Settings of a module: tmclctl settings load FILE MODULE\n"
            "model = \"TMCM-1110\"\n"
            "firmware = \"1.09\"\n"
            "\n[global]\n"
            "end_switch_polarity = 1\n"
            "\n[interrupts]\n"
            "timer_0 = 500                               # ms\n"
            "\n[motor.0]\n"
            "max_velocity = 1500                         # internal\n"
            "max_current = 128                           # 1/255\n"
            "\n# Of the module alone, and never loaded:\n"
            "# global: serial_address = 7\n");
}

TEST(SettingsFile, TellsTheUnitThatTheUnitModeMakes) {
  const auto& of = model("TMCM-142");
  const auto mode = key_of(of, "unit_mode");
  Settings settings{&of};
  settings.values = {{key_of(of, "max_velocity"), 1500}, {mode, 1}};
  EXPECT_THAT(to_toml(settings), HasSubstr("# pps\n"));
  settings.values.back().value = 0;
  EXPECT_THAT(to_toml(settings), HasSubstr("# internal\n"));
}

std::vector<std::string> problems_of(const std::string& text) {
  const auto read = parse_settings(text);
  std::vector<std::string> lines;
  if (!read)
    for (const auto& problem : read.error()) lines.push_back(describe(problem, "x.toml"));
  return lines;
}

TEST(SettingsFile, TellsEveryProblemWithItsLineAndKey) {
  EXPECT_THAT(
      problems_of("model = \"TMCM-1110\"\n"
                  "[motor.0]\n"
                  "max_velocty = 3\n"
                  "max_current = 300\n"
                  "target_position = 30000\n"
                  "a_max = 5\n"
                  "[motor.1]\n"
                  "[globals]\n"
                  "[global]\n"
                  "end_switch_polarity = true\n"
                  "serial_address = 2\n"),
      ElementsAre(HasSubstr("x.toml:3:1: there is no setting 'max_velocty'. Did you mean "
                            "'max_velocity'?"),
                  HasSubstr("x.toml:4:15: 'max_current' is 300, outside its range 0..255"),
                  HasSubstr("x.toml:5:1: 'target_position' is no setting that is loaded"),
                  HasSubstr("x.toml:6:1: 'a_max' is called 'max_acceleration'"),
                  HasSubstr("x.toml:7:8: a TMCM-1110 has no [motor.1]: its motors are 0 to 0"),
                  HasSubstr("x.toml:8:2: there is no section 'globals'. Did you mean 'global'"),
                  HasSubstr("x.toml:10:23: 'end_switch_polarity' must be a whole number"),
                  HasSubstr("x.toml:11:1: 'serial_address' is no setting")));
  EXPECT_THAT(problems_of("[motor.0]\nmax_velocity = 3\n"), ElementsAre(HasSubstr("no 'model'")));
  EXPECT_THAT(problems_of("model = \"TMCM-1111X\"\n"),
              ElementsAre(HasSubstr("x.toml:1:9: there is no module 'TMCM-1111X'")));
  EXPECT_THAT(problems_of("model = \"TMCM-1110\"\n[motor.0\n"),
              ElementsAre(HasSubstr("x.toml:2:")));
  EXPECT_THAT(problems_of(std::string(tmcld::max_settings_bytes + 1, '#')),
              ElementsAre(HasSubstr("longer than 262144 bytes")));
}

TEST(DifferenceOfSettings, IsWhatLoadingWouldChange) {
  const auto& of = model("TMCM-1110");
  const SettingKey a{SettingScope::motor, 0, 4};
  const SettingKey b{SettingScope::motor, 0, 5};
  const SettingKey c{SettingScope::motor, 0, 6};
  const Settings one{&of, "", {{a, 1}, {b, 2}}};
  const Settings other{&of, "", {{b, 3}, {c, 4}}};
  EXPECT_THAT(what_to_load(one, other),
              ElementsAre(SettingDifference{b, 2, 3}, SettingDifference{c, std::nullopt, 4}));
  EXPECT_TRUE(what_to_load(one, one).empty());
}

TEST(LoadingOrder, HasFirstWhatOthersAreCountedIn) {
  test::Random random(test::seed());
  for (const auto& one : models()) {
    const auto settings = some_settings(one, random);
    const auto ordered = in_loading_order(settings);
    EXPECT_EQ(ordered.size(), settings.values.size());
    const auto end_of_scales = std::ranges::find_if_not(
        ordered, [&](const SettingValue& value) { return is_scale(one, value.key); });
    EXPECT_TRUE(std::none_of(end_of_scales, ordered.end(),
                             [&](const SettingValue& value) { return is_scale(one, value.key); }));
    const auto place_of = [&](std::string_view name) {
      return std::ranges::find(ordered, key_of(one, name), &SettingValue::key) - ordered.begin();
    };
    for (const char* scale : {"unit_mode", "microstep_resolution", "pulse_divisor"}) {
      if (!names_of(settings_of(one)).contains(scale)) continue;
      EXPECT_LT(place_of(scale), place_of("max_velocity")) << one.name << ' ' << scale;
    }
  }
}

}  // namespace
}  // namespace tmcl
