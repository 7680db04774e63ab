// The settings of modules in one go: read, loaded without a movement, kept, and compared with their
// file after a restart.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include <gmock/gmock.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/settings.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::Settings;
using tmcl::SettingScope;

const json::object first_module{{"bus", "line"}, {"address", 1}};

json::object with_toml(json::object object, const std::string& toml) {
  object["toml"] = toml;
  return object;
}

std::string toml_of(JourneyBench& bench, const json::object& module = first_module) {
  const auto read = bench.call("settings.read", module);
  if (!read) throw std::runtime_error(read.error().message);
  return std::string(read->at("toml").as_string());
}

Result<json::object> load(JourneyBench& bench, const std::string& toml, bool store = false) {
  auto params = with_toml(first_module, toml);
  params["store"] = store;
  return bench.call("settings.load", std::move(params));
}

std::string name_of_load(JourneyBench& bench, const std::string& toml) {
  const auto loaded = load(bench, toml);
  return loaded ? "none" : loaded.error().message;
}

std::size_t count(const Result<json::object>& result, const char* list) {
  return result->at(list).as_array().size();
}

/// A value of each setting, within its range; microsteps and units among them.
Settings drawn(const tmcl::Model& model, tmcl::test::Random<>& random) {
  Settings settings{&model, {}, {}, {}};
  for (const auto& info : settings_of(model))
    settings.values.push_back(
        {info.key, static_cast<std::int32_t>(random.between(info.minimum, info.maximum))});
  return settings;
}

const tmcl::sim::Module& module_of(JourneyBench& bench) {
  return *bench.wire.bench().modules().front();
}

std::vector<std::int64_t> positions(JourneyBench& bench) {
  std::vector<std::int64_t> all;
  const auto& module = module_of(bench);
  for (std::size_t motor = 0; motor < module.model().axes; ++motor)
    all.push_back(module.axis(motor).get(tmcl::axis_parameter::actual_position).value());
  return all;
}

/// What differs afterwards although it was not refused, and by more than a chip rounds.
std::vector<std::string> unexplained(const json::object& loaded) {
  constexpr std::int64_t greatest_step = 120;  // of an acceleration in pps/s, on a sixPoint chip
  const auto place = [](const json::value& one) {
    return json::serialize(one.at("section")) + json::serialize(one.at("parameter"));
  };
  std::set<std::string> refused;
  for (const auto& one : loaded.at("refused").as_array()) refused.insert(place(one));
  std::vector<std::string> all;
  for (const auto& one : loaded.at("differing").as_array()) {
    const auto present = one.at("present").to_number<std::int64_t>();
    const auto off = std::abs(present - one.at("wanted").to_number<std::int64_t>());
    if (off > greatest_step && !refused.contains(place(one))) all.push_back(json::serialize(one));
  }
  return all;
}

/// The kind: whatever a file says, no motor of any model moves.
TEST(SettingsOfModules, AreLoadedWithoutAMovementOnEveryModel) {
  tmcl::test::Random random(tmcl::test::seed());
  for (const auto& model : tmcl::models()) {
    JourneyBench bench(model.name);
    ASSERT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1000}}));
    ASSERT_TRUE(bench.call("axis.wait", {{"axis", "x"}, {"timeout_ms", 60'000}})) << model.name;
    const auto before = positions(bench);
    std::vector<std::int64_t> moved;
    bench.on_request = [&](const tmcl::Request&) {
      if (positions(bench) != before) moved = positions(bench);
    };
    const auto wanted = drawn(model, random);
    const auto loaded = load(bench, to_toml(wanted));
    ASSERT_TRUE(loaded) << model.name << ": " << loaded.error().message;
    bench.time.run_for(5s);
    EXPECT_THAT(moved, IsEmpty()) << model.name;
    EXPECT_EQ(positions(bench), before) << model.name;
    EXPECT_THAT(unexplained(*loaded), IsEmpty()) << model.name;
    const auto again = bench.call("settings.compare", with_toml(first_module, to_toml(wanted)));
    EXPECT_EQ(count(again, "differences"), count(loaded, "differing")) << model.name;
  }
}

/// An old module has gone; a new one gets what it had.
TEST(SettingsOfModules, OfOneAreThoseOfAnother) {
  tmcl::test::Random random(tmcl::test::seed());
  for (const auto* name : {"TMCM-1110", "TMCM-142", "TMCM-6212", "TMCM-351"}) {
    const auto& model = *tmcl::find_model(name);
    JourneyBench old(name);
    ASSERT_TRUE(load(old, to_toml(drawn(model, random))));
    const auto kept = toml_of(old);
    JourneyBench other(name);
    const auto loaded = load(other, kept, true);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(count(loaded, "differing"), 0U) << name;
    EXPECT_EQ(count(loaded, "refused"), 0U) << name;
    EXPECT_EQ(toml_of(other), kept) << name;
    // Also after its supply has failed.
    other.wire.bench().modules().front()->power_cycle();
    other.time.run_for(1s);
    ASSERT_TRUE(other.call("axis.recover", {{"axis", "x"}}));
    EXPECT_EQ(toml_of(other), kept) << name;
  }
}

TEST(SettingsOfModules, ThatAreThereAreNotWrittenAgain) {
  JourneyBench bench;
  const auto toml = toml_of(bench);
  bench.requests.clear();
  const auto loaded = load(bench, toml);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(count(loaded, "written"), 0U);
  EXPECT_THAT(bench.sent(tmcl::Command::SAP), IsEmpty());
  EXPECT_THAT(bench.sent(tmcl::Command::SGP), IsEmpty());
}

TEST(SettingsOfModules, AreReadNoMoreOftenThanTheyCanHaveChanged) {
  JourneyBench bench;
  const auto toml = toml_of(bench);
  const auto reads_of_current = [&] {
    return std::ranges::count_if(bench.requests, [](const tmcl::Request& request) {
      return request.command == tmcl::Command::GAP && request.type == 6 && request.motor == 1;
    });
  };
  bench.requests.clear();
  ASSERT_TRUE(load(bench, toml));
  EXPECT_EQ(reads_of_current(), 1);
  ASSERT_TRUE(
      bench.call("parameter.set", {{"axis", "y"}, {"parameter", "max_current"}, {"value", 9}}));
  bench.requests.clear();
  ASSERT_TRUE(load(bench, toml));
  EXPECT_EQ(reads_of_current(), 2);
}

constexpr const char* of_3110 = "model = \"TMCM-3110\"\n";

TEST(SettingsOfModules, LeaveOthersAsTheyAre) {
  JourneyBench bench;
  const auto loaded = load(bench, std::string(of_3110) + "[motor.1]\nmax_current = 77\n");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(count(loaded, "written"), 1U);
  EXPECT_EQ(bench.get("y", 6), 77);
  EXPECT_NE(bench.get("x", 6), 77);
}

TEST(SettingsOfModules, OfAnotherModelAreRefused) {
  JourneyBench bench;
  EXPECT_THAT(name_of_load(bench, "model = \"TMCM-1110\"\n[motor.0]\nmax_current = 7\n"),
              HasSubstr("the settings are of a TMCM-1110, and module 1 of bus 'line' is a "
                        "TMCM-3110"));
}

TEST(SettingsOfModules, ThatAreWrongAreToldWithTheirLines) {
  JourneyBench bench;
  const auto loaded =
      load(bench, std::string(of_3110) + "[motor.0]\nmax_curent = 7\ntarget_position = 30000\n");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().name, "bad_settings");
  EXPECT_THAT(loaded.error().message, HasSubstr("line 3: there is no setting 'max_curent'"));
  EXPECT_EQ(loaded.error().subject.at("problems").as_array().size(), 2U);
}

// ---- while something could move -----------------------------------------------------------------

const auto some_current = std::string(of_3110) + "[motor.0]\nmax_current = 7\n";

TEST(SettingsOfModules, AreNotLoadedWhileAMotorMoves) {
  JourneyBench bench;
  ASSERT_TRUE(bench.call("axis.rotate", {{"axis", "y"}, {"velocity_internal", 100}}));
  bench.time.run_for(1s);
  EXPECT_THAT(name_of_load(bench, some_current), HasSubstr("axis 'y' moves"));
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "y"}}));
  bench.time.run_for(1s);
  EXPECT_EQ(name_of_load(bench, some_current), "none");
}

/// It stands because its greatest velocity is 0: the file would set it off.
TEST(SettingsOfModules, AreNotLoadedWhereTheyWouldSetAMotorOff) {
  JourneyBench bench;
  ASSERT_TRUE(
      bench.call("parameter.set", {{"axis", "x"}, {"parameter", "max_velocity"}, {"value", 0}}));
  ASSERT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5000}}));
  bench.time.run_for(1s);
  const auto before = positions(bench);
  EXPECT_THAT(name_of_load(bench, std::string(of_3110) + "[motor.0]\nmax_velocity = 1000\n"),
              HasSubstr("stands short of its target"));
  bench.time.run_for(1s);
  EXPECT_EQ(positions(bench), before);
}

TEST(SettingsOfModules, AreNotLoadedOnALeasedAxis) {
  JourneyBench bench;
  const auto axis = bench.gateway->find_axis("x");
  axis->bus().motors().lease(axis->address(), {99, 1, "another program"});
  EXPECT_THAT(name_of_load(bench, some_current), HasSubstr("another program"));
}

TEST(SettingsOfModules, KeepOthersFromMovingMeanwhile) {
  JourneyBench bench;
  const auto loading = bench.begin("settings.load", with_toml(first_module, toml_of(bench)));
  bench.time.run_for(20ms);
  const auto moved = bench.call("axis.move_to", {{"axis", "z"}, {"position_microsteps", 5000}});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().name, "axis_claimed");
  EXPECT_THAT(moved.error().message, HasSubstr("settings of its module are loaded"));
  ASSERT_TRUE(bench.end_of(loading));
  EXPECT_TRUE(bench.call("axis.move_to", {{"axis", "z"}, {"position_microsteps", 5000}}));
}

TEST(SettingsOfModules, AreLoadedOnAxesThatAreLatched) {
  JourneyBench bench;
  bench.wire.bench().modules().front()->power_cycle();
  bench.time.run_for(1s);
  const auto moved = bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5000}});
  ASSERT_FALSE(moved);
  ASSERT_EQ(moved.error().name, "latched");
  EXPECT_EQ(name_of_load(bench, some_current), "none");
}

/// Whatever comes of it, the axes are free afterwards.
TEST(SettingsOfModules, FreeTheAxesWhereverTheModuleFallsSilent) {
  const auto toml = toml_of(*std::make_unique<JourneyBench>());
  for (int asked = 1; asked < 600; asked += 37) {
    JourneyBench bench;
    ASSERT_TRUE(load(bench, some_current));
    int left = asked;
    bench.on_request = [&](const tmcl::Request&) { bench.wire.is_cut = --left <= 0; };
    const auto loaded = load(bench, toml);
    bench.on_request = {};
    bench.wire.is_cut = false;
    bench.time.run_for(5s);
    EXPECT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 500}})) << asked;
    if (!loaded) continue;
    EXPECT_EQ(count(loaded, "differing"), 0U);
  }
}

// ---- kept in the EEPROM -------------------------------------------------------------------------

TEST(SettingsOfAnAxis, AreStoredTogether) {
  JourneyBench bench;
  ASSERT_TRUE(load(
      bench, std::string(of_3110) + "[motor.0]\nmax_current = 7\n[motor.1]\nmax_current = 8\n"));
  const auto stored = bench.call("settings.store", {{"axis", "x"}});
  ASSERT_TRUE(stored) << stored.error().message;
  EXPECT_GT(stored->at("stored").to_number<int>(), 20);
  EXPECT_EQ(count(stored, "refused"), 0U);
  bench.wire.bench().modules().front()->power_cycle();
  bench.time.run_for(1s);
  EXPECT_EQ(bench.get("x", 6), 7);
  EXPECT_NE(bench.get("y", 6), 8);
}

TEST(RampOfAnAxis, IsStoredWithTheWord) {
  JourneyBench bench;
  json::object wish{{"axis", "x"}, {"velocity", "50000pps"}, {"acceleration", "200000pps/s"}};
  wish["store"] = true;
  ASSERT_TRUE(bench.call("axis.set_ramp", wish));
  const auto velocity = bench.get("x", 4);
  bench.wire.bench().modules().front()->power_cycle();
  bench.time.run_for(1s);
  EXPECT_EQ(bench.get("x", 4), velocity);
}

// ---- compared with their file -------------------------------------------------------------------

class SettingsFileOfAModule : public testing::Test {
 protected:
  SettingsFileOfAModule() { std::ofstream(path) << some_current; }
  ~SettingsFileOfAModule() override { std::filesystem::remove(path); }

  std::string configured(const std::string& more = {}) const {
    return "settings = \"" + path + "\"\n" + more;
  }
  static std::vector<std::string> drifts(const JourneyBench& bench) {
    std::vector<std::string> all;
    for (const auto& event : bench.events)
      if (event.kind == GatewayEvent::Kind::settings_drift)
        all.push_back(event.reason + ": " + event.text);
    return all;
  }
  static std::string state(JourneyBench& bench) {
    const auto list = bench.call("module.list", {});
    return std::string(list->at("modules").as_array().front().at("settings").as_string());
  }
  static void restart(JourneyBench& bench) {
    bench.events.clear();
    bench.wire.bench().modules().front()->power_cycle();
    bench.time.run_for(1s);
    // A look finds out that it has started again.
    bench.call("axis.get_state", {{"axis", "x"}});
    bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5000}});
    bench.time.run_for(1s);
  }

  const std::string path =
      testing::TempDir() + "settings_of_a_module_" + std::to_string(::getpid()) + ".toml";
};

TEST_F(SettingsFileOfAModule, IsComparedAtTheStartAndAfterARestart) {
  JourneyBench bench("TMCM-3110", {}, configured());
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("report: its settings are not as in " + path +
                                                   ": max_current of motor 0 is 255, not 7")));
  EXPECT_EQ(state(bench), "differ");
  EXPECT_EQ(count(bench.call("settings.compare", first_module), "differences"), 1U);
  ASSERT_TRUE(load(bench, some_current));
  EXPECT_EQ(bench.get("x", 6), 7);
  restart(bench);
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("report: ")));
  EXPECT_EQ(bench.get("x", 6), 255);
}

TEST_F(SettingsFileOfAModule, IsNoNewsWhereNothingDiffers) {
  std::ofstream(path) << of_3110 << "[motor.0]\nmax_current = 255\n";
  JourneyBench bench("TMCM-3110", {}, configured());
  EXPECT_THAT(drifts(bench), IsEmpty());
  EXPECT_EQ(state(bench), "as_file");
}

TEST_F(SettingsFileOfAModule, IsRestoredWhereItIsToBe) {
  JourneyBench bench("TMCM-3110", {}, configured("settings_at_reset = \"restore\"\n"));
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("restored: ")));
  EXPECT_EQ(bench.get("x", 6), 7);
  restart(bench);
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("restored: ")));
  EXPECT_EQ(bench.get("x", 6), 7);
  EXPECT_EQ(state(bench), "as_file");
  // It is as latched as without.
  EXPECT_EQ(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5}}).error().name,
            "latched");
  EXPECT_EQ(positions(bench).front(), 0);
}

TEST_F(SettingsFileOfAModule, IsRestoredAlsoForAClientThatHasALease) {
  JourneyBench bench("TMCM-3110", {}, configured("settings_at_reset = \"restore\"\n"));
  const auto axis = bench.gateway->find_axis("x");
  axis->bus().motors().lease(axis->address(), {99, 1, "another program"});
  restart(bench);
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("restored: ")));
}

TEST_F(SettingsFileOfAModule, OfAnotherModelIsReported) {
  JourneyBench bench("TMCM-1110", {}, configured("settings_at_reset = \"restore\"\n"));
  EXPECT_THAT(drifts(bench), ElementsAre(HasSubstr("the settings are of a TMCM-3110")));
}

TEST_F(SettingsFileOfAModule, IsCheckedWithTheConfiguration) {
  const auto problem = [&](const std::string& of_module) {
    const auto config = parse_config(
        "[daemon]\nsocket = \"/none\"\n[[bus]]\nname = \"line\"\n"
        "link = \"serial:/dev/none\"\n[[module]]\nbus = \"line\"\n"
        "address = 1\n" +
        of_module);
    return config ? "none" : config.error().front().message;
  };
  EXPECT_EQ(problem(configured()), "none");
  EXPECT_THAT(problem("settings = \"/nowhere.toml\"\n"), HasSubstr("/nowhere.toml"));
  EXPECT_THAT(problem(configured("settings_at_reset = \"restor\"\n")),
              HasSubstr("Did you mean 'restore'?"));
  EXPECT_THAT(problem("settings_at_reset = \"report\"\n"), HasSubstr("needs 'settings'"));
  std::ofstream(path) << of_3110 << "[motor.0]\nmax_curent = 7\n";
  EXPECT_THAT(problem(configured()), HasSubstr(":3:1: there is no setting 'max_curent'"));
}

}  // namespace
}  // namespace tmcld::test
