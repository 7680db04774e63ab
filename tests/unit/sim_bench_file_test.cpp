// The file of tmclsim --bench, and the lines of its console.
#include <gmock/gmock.h>

#include <fstream>

#include "sim_fixture.hpp"
#include "support/temp_path.hpp"
#include "tools/tmclsim/bench_file.hpp"
#include "tools/tmclsim/console.hpp"

namespace tmclsim {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using tmcl::Command;
using tmcl::sim::Bytes;

std::string error_of(std::string_view text) {
  const auto file = parse_bench_file(text, "b.toml");
  return file ? "" : file.error();
}

TEST(BenchFile, DescribesModulesAndWhatTheirMotorsDrive) {
  const auto file = parse_bench_file(R"(
    [[module]]
    model = "TMCM-6110"
    address = 7
    firmware_version = "1.09"
    behaviour = "lite"
    range_check = "wrap"
    data_logger = true
    supply = 23.46
    temperature = 40
    [[module.axis]]
    motor = 2
    position = 5
    left_switch = -100
    right_switch = 200
    switch_tolerance = 3
    normally_closed = true
    home = [-10, 20]
    left_stop = -300
    encoder_counts_per_turn = 400
    encoder_sign = -1
    load = 50
    [[module]]
    model = "tmcm1110"
  )",
                                     "b.toml");
  ASSERT_TRUE(file) << file.error();
  ASSERT_EQ(file->size(), 2U);
  const auto& first = file->front();
  EXPECT_EQ(first.spec, "TMCM-6110@7");
  ASSERT_EQ(first.axes.size(), 6U);
  EXPECT_FALSE(first.axes[0].left_switch);
  const auto& stage = first.axes[2];
  EXPECT_EQ(stage.position, 5);
  EXPECT_EQ(stage.left_switch, -100);
  EXPECT_EQ(stage.right_switch, 200);
  EXPECT_EQ(stage.switch_tolerance, 3);
  EXPECT_TRUE(stage.limits_normally_closed);
  EXPECT_EQ(stage.home->from, -10);
  EXPECT_EQ(stage.home->to, 20);
  EXPECT_EQ(stage.left_stop, -300);
  EXPECT_FALSE(stage.right_stop);
  EXPECT_EQ(stage.encoder->counts_per_turn, 400);
  EXPECT_TRUE(stage.encoder->backwards);
  EXPECT_EQ(stage.load, 50);
  EXPECT_EQ(first.settings.firmware, (tmcl::sim::FirmwareRelease{1, 9}));
  EXPECT_EQ(first.settings.behaviour, tmcl::sim::Behaviour::lite);
  EXPECT_EQ(first.settings.traits.find(tmcl::Trait::range_check),
            tmcl::index_of(tmcl::RangeCheck::wrap));
  EXPECT_EQ(first.settings.data_logger, true);
  EXPECT_EQ(first.surroundings.supply_tenths, 235);
  EXPECT_EQ(first.surroundings.temperature, 40);
  const auto& second = file->back();
  EXPECT_EQ(second.spec, "TMCM-1110");
  EXPECT_EQ(second.settings.firmware, std::nullopt);
  EXPECT_EQ(second.settings.behaviour, tmcl::sim::Behaviour::manual);
  EXPECT_TRUE(second.settings.traits.empty());
  EXPECT_EQ(second.settings.data_logger, std::nullopt);
  EXPECT_EQ(second.surroundings.supply_tenths, std::nullopt);
}

TEST(BenchFile, SaysWhereAndWhatIsWrong) {
  EXPECT_THAT(error_of("[[modul]]\n"), "b.toml:1: there is no key 'modul'. Did you mean 'module'?");
  EXPECT_THAT(error_of("[[module]]\nmodel = 5\n"), StartsWith("b.toml:2: 'model' must be a name"));
  EXPECT_THAT(error_of("\n[[module]]\n"), "b.toml:2: this module has no 'model'");
  EXPECT_THAT(error_of("[[module]]\nmodel = \"TMCM-1111x\"\n"),
              StartsWith("b.toml:2: there is no module 'TMCM-1111x'."));
  EXPECT_THAT(error_of("[module]\nmodel = \"TMCM-1110\"\n"), HasSubstr("[[module]]"));
  EXPECT_THAT(error_of("[[module"), StartsWith("b.toml:1: "));
  const std::string module = "[[module]]\nmodel = \"TMCM-1110\"\n";
  EXPECT_THAT(error_of(module + "address = 256\n"),
              "b.toml:3: 'address' is 256, but must be 1 to 255");
  const auto axis = module + "[[module.axis]]\n";
  EXPECT_THAT(error_of(axis + "motor = 1\n"), "b.toml:4: 'motor' is 1, but must be 0 to 0");
  EXPECT_THAT(error_of(axis + "left_swich = 1\n"), HasSubstr("Did you mean 'left_switch'?"));
  EXPECT_THAT(error_of(axis + "left_switch = 1.5\n"),
              "b.toml:4: 'left_switch' must be a whole number");
  EXPECT_THAT(error_of(axis + "home = 5\n"), StartsWith("b.toml:4: 'home' must be"));
  EXPECT_THAT(error_of(axis + "home = [5, 4]\n"), "b.toml:4: 'home' ends before it begins");
  EXPECT_THAT(error_of(axis + "normally_closed = 1\n"), HasSubstr("true or false"));
  EXPECT_THAT(error_of(axis + "encoder_sign = 1\n"), HasSubstr("encoder_counts_per_turn"));
  EXPECT_THAT(error_of(axis + "encoder_counts_per_turn = 5\nencoder_sign = 0\n"),
              "b.toml:5: 'encoder_sign' is 1 or -1");
  EXPECT_THAT(error_of(axis + "left_stop = 5\nright_stop = 4\n"), StartsWith("b.toml:4: "));
  EXPECT_THAT(error_of(axis + "motor = 0\n[[module.axis]]\n"),
              "b.toml:5: motor 0 is described twice");
}

TEST(BenchFile, SaysWhatIsWrongAboutAFirmware) {
  const std::string module = "[[module]]\nmodel = \"TMCM-1110\"\n";
  for (const auto* wrong : {"", "1", "1.9", "1.095", "10.00", "256.00", "a.bc", "-1.0", "1,09"}) {
    EXPECT_THAT(error_of(module + "firmware_version = \"" + wrong + "\"\n"),
                StartsWith("b.toml:3: '" + std::string(wrong) + "' is not a version: "));
  }
  EXPECT_THAT(error_of(module + "firmware_version = 1.09\n"),
              "b.toml:3: 'firmware_version' must be a text in quotes, such as \"1.09\"");
  EXPECT_THAT(error_of(module + "firmware = \"1.09\"\n"), HasSubstr("no key 'firmware'"));
  EXPECT_THAT(error_of(module + "behaviour = \"lit\"\n"),
              "b.toml:3: 'behaviour' is 'lit', but must be manual or lite. Did you mean 'lite'?");
  EXPECT_THAT(error_of(module + "behavior = \"lite\"\n"), HasSubstr("Did you mean 'behaviour'?"));
  for (const auto* supply : {"-1", "1001", "nan", "\"24 V\""}) {
    EXPECT_THAT(error_of(module + "supply = " + supply + "\n"),
                "b.toml:3: 'supply' must be 0 to 1000, in volts, such as 23.5, or \"usb\"");
  }
  EXPECT_THAT(error_of(module + "temperature = 40.5\n"), HasSubstr("must be a whole number"));
  EXPECT_THAT(error_of(module + "data_loger = true\n"), HasSubstr("Did you mean 'data_logger'?"));
  EXPECT_EQ(error_of(module + "data_logger = \"yes\"\n"),
            "b.toml:3: 'data_logger' must be true or false");
  EXPECT_THAT(error_of(module + "behaviour = true\n"),
              StartsWith("b.toml:3: 'behaviour' must be a text in quotes"));
  EXPECT_THAT(error_of(module + "range_check = \"wrapp\"\n"),
              "b.toml:3: 'range_check' is 'wrapp', but must be manual or wrap. "
              "Did you mean 'wrap'?");
}

TEST(BenchFile, WrapsTheValuesOfModulesOnlyOfWhichItIsKnown) {
  const std::string module = "[[module]]\nmodel = \"TMCM-6212\"\n";
  EXPECT_THAT(error_of(module + "range_check = \"wrap\"\n"),
              "b.toml:3: a TMCM-6212 has no TMC429: 'range_check' can only be manual");
  EXPECT_EQ(error_of(module + "range_check = \"manual\"\n"), "");
}

TEST(BenchFile, HasTheTraitsOfAModule) {
  const std::string module = "[[module]]\nmodel = \"TMCM-1110\"\n";
  const auto file = parse_bench_file(module + "last_step = \"r2\"\nanswer_us = 1500\n", "b.toml");
  ASSERT_TRUE(file) << file.error();
  const auto& settings = file->front().settings;
  EXPECT_EQ(settings.traits.find(tmcl::Trait::last_step), 2);
  EXPECT_EQ(settings.to_answer, std::chrono::microseconds(1500));
  EXPECT_THAT(error_of(module + "last_step = \"r4\"\n"),
              StartsWith("b.toml:3: 'last_step' is 'r4', but must be r3, r1 or r2."));
  EXPECT_THAT(error_of(module + "as = \"/nowhere/m.toml\"\n"),
              "b.toml:3: /nowhere/m.toml: cannot be read, or is empty");
}

TEST(BenchFile, TakesWhatWasMeasuredOfAModuleOfTheSameModelOnly) {
  const auto measured = tmcl::test::temp_path("module.toml");
  std::ofstream(measured) << "[module]\nmodel = \"TMCM-1110\"\nfirmware_version = \"1.09\"\n"
                             "heartbeat = \"ignored\"\n";
  const auto as = "as = \"" + measured + "\"\n";
  const auto file = parse_bench_file(
      "[[module]]\nmodel = \"TMCM-1110\"\nfirmware_version = \"1.10\"\n" + as, "b.toml");
  ASSERT_TRUE(file) << file.error();
  const auto& settings = file->front().settings;
  EXPECT_EQ(settings.traits.find(tmcl::Trait::heartbeat), 1);
  EXPECT_EQ(settings.firmware->minor, 10) << "what the bench file says itself holds";
  EXPECT_THAT(error_of("[[module]]\nmodel = \"TMCM-6212\"\n" + as),
              "b.toml:3: " + measured + ":2: this is a TMCM-1110, not a TMCM-6212");
}

TEST(BenchFile, SaysWhichFileCannotBeRead) {
  EXPECT_THAT(read_bench_file("/no/such/file").error(), StartsWith("/no/such/file: "));
}

constexpr std::uint8_t left_switch = 11;

class Console : public tmcl::sim::SimTest {
 protected:
  std::string say(std::string_view words) { return run_console_line(bench, words); }
};

TEST_F(Console, DoesWhatItIsTold) {
  auto& module = add(1110, {.encoder = tmcl::sim::EncoderSettings{}});
  EXPECT_EQ(say("load 1/0 500"), "ok");
  EXPECT_EQ(module.stage(0).settings().load, 500);
  EXPECT_EQ(say("  slip  1/0  -200 \r"), "ok");
  EXPECT_EQ(module.stage(0).encoder_counts(), -200);
  EXPECT_EQ(say("press 1/0 left"), "ok");
  EXPECT_EQ(get(left_switch), 1);
  EXPECT_EQ(say("release 1/0 left"), "ok");
  EXPECT_EQ(get(left_switch), 0);
  EXPECT_EQ(say(""), "");
}

TEST_F(Console, SetsInputs) {
  auto& module = add(1110);
  EXPECT_EQ(say("input 1 2 1"), "ok");
  EXPECT_TRUE(module.io().input(2));
  EXPECT_EQ(say("analog 1 0 512"), "ok");
  EXPECT_EQ(module.io().get(tmcl::sim::Io::analog_bank, 0), 512);
  EXPECT_EQ(say("input 1 99 1"), "error: TMCM-1110 has no digital input 99");
  EXPECT_EQ(say("input 1 2 5"), "error: an input is 0 or 1");
  EXPECT_EQ(say("analog 1 99 1"), "error: TMCM-1110 has no analogue input 99");
  EXPECT_EQ(say("analog 1 0 65536"), "error: an analogue input is 0 to 65535");
  EXPECT_EQ(say("analog 9 0 1"), "error: there is no module with the address 9");
  EXPECT_EQ(say("analog x 0 1"), "error: there is no module with the address x");
  EXPECT_EQ(say("analog 1 -1 1"), "error: '-1' is not a port");
  EXPECT_EQ(say("analog 1 0 y"), "error: 'y' is not a number");
  EXPECT_EQ(say("input 1 0"), "error: it is: input ADDRESS PORT 0|1");
}

TEST_F(Console, SetsSupplyAndTemperature) {
  auto& module = add(1110);
  const auto analog = [&](std::uint8_t port) {
    return module.io().get(tmcl::sim::Io::analog_bank, port).value();
  };
  EXPECT_EQ(say("supply 1 23.5"), "ok");
  EXPECT_EQ(analog(8), 235);
  EXPECT_EQ(say("supply 1 12"), "ok");
  EXPECT_EQ(analog(8), 120);
  EXPECT_EQ(say("temperature 1 40"), "ok");
  EXPECT_EQ(analog(9), 40);
  for (const char* wrong : {"x", "-1", "1.25", "1.", ".5", "1001", "1.-5", "24V"})
    EXPECT_EQ(say("supply 1 " + std::string(wrong)),
              "error: '" + std::string(wrong) + "' is no voltage, such as 24 or 23.5, nor usb");
  EXPECT_THAT(say("temperature 1 -5"), HasSubstr("no temperature"));
  EXPECT_THAT(say("temperature 2 5"), HasSubstr("no module with the address 2"));
  EXPECT_EQ(analog(8), 120);
}

TEST_F(Console, TakesTheSupplyOfMotorsAway) {
  auto& module = add(1110);
  EXPECT_EQ(say("supply 1 usb"), "ok");
  EXPECT_EQ(module.io().supply(), 50);
  EXPECT_EQ(say("supply 1 24"), "ok");
  EXPECT_EQ(say("brown_out 1 200"), "ok");
  EXPECT_EQ(module.io().supply(), 60);
  for (const char* wrong : {"0", "-1", "x", "3600001"})
    EXPECT_THAT(say("brown_out 1 " + std::string(wrong)), HasSubstr("1 to 3600000 ms"));
}

TEST_F(Console, BreaksADriverAndMendsIt) {
  add(1110);
  EXPECT_EQ(say("driver 1/0 open_load_a on"), "ok");
  EXPECT_EQ(get(208), 0xA0);
  EXPECT_EQ(say("driver 1/0 open_load_a off"), "ok");
  EXPECT_EQ(get(208), 0x80);
  EXPECT_THAT(say("driver 1/0 open_laod_a on"), HasSubstr("'open_load_a'?"));
  EXPECT_THAT(say("driver 1/0 short_a yes"), HasSubstr("'yes' is not on or off"));
  EXPECT_THAT(say("driver 1/9 short_a on"), HasSubstr("has no motor 9"));
}

TEST(BenchFile, LimitsAMotor) {
  const auto file = parse_bench_file(R"(
    [[module]]
    model = "TMCM-1110"
    supply = "usb"
    [[module.axis]]
    pull = -150
    inertia = 400
    corner_speed = 600
    pull_in_speed = 0
    torque_follows_current = true
    load_value_slope = 700
    load_value_noise = 12
    backlash = 33
    driver_faults = ["short_a", "open_load_b"]
    encoder_counts_per_turn = 4000
    resonance = 12
    damping = 0.1
  )",
                                     "b.toml");
  ASSERT_TRUE(file) << file.error();
  const auto& stage = file->front().axes[0];
  EXPECT_EQ(stage.pull, -150);
  EXPECT_EQ(stage.inertia, 400);
  EXPECT_EQ(stage.corner_speed, 600);
  EXPECT_EQ(stage.pull_in_speed, 0);
  EXPECT_TRUE(stage.torque_follows_current);
  EXPECT_EQ(stage.load_value_slope, 700);
  EXPECT_EQ(stage.load_value_noise, 12);
  EXPECT_EQ(stage.backlash, 33);
  EXPECT_EQ(stage.faults.bits(), 0x48);
  EXPECT_EQ(stage.resonance.value().frequency_hz, 12);
  EXPECT_EQ(stage.resonance.value().damping, 0.1);
  EXPECT_EQ(file->front().surroundings.supply_tenths, 50);
  const std::string axis = "[[module]]\nmodel = \"TMCM-1110\"\n[[module.axis]]\n";
  EXPECT_THAT(error_of(axis + "corner_speed = 0\n"), HasSubstr("b.toml:4: 'corner_speed' is 0"));
  EXPECT_THAT(error_of(axis + "driver_faults = 3\n"), HasSubstr("must be a list"));
  EXPECT_THAT(error_of(axis + "resonance = 5\n"), HasSubstr("and there is none"));
  const auto with_encoder = axis + "encoder_counts_per_turn = 400\n";
  EXPECT_THAT(error_of(with_encoder + "resonance = 0\n"), HasSubstr("must be 0.01 to 1000"));
  EXPECT_THAT(error_of(with_encoder + "damping = 0.5\n"), HasSubstr("goes with 'resonance'"));
  EXPECT_THAT(error_of(axis + "driver_faults = [\"shrt_a\"]\n"), HasSubstr("'short_a'?"));
}

TEST_F(Console, TakesThePowerAwayAndGivesItBack) {
  add(1110);
  const auto is_heard = [this] { return ask(Command::GAP, 1, 0).has_value(); };
  ask(Command::ROR, 0, 0, 500);
  EXPECT_EQ(say("power 1 off"), "ok");
  pass(std::chrono::hours(1));
  EXPECT_FALSE(is_heard());
  auto wrong = tmcl::encode_serial({tmcl::ModuleAddress{1}, Command::GAP, 1, 0, 0});
  ++wrong.back();
  EXPECT_THAT(exchange(Bytes(wrong.begin(), wrong.end())), testing::IsEmpty());
  EXPECT_EQ(bench.modules().front()->axis(0).get(1), 0) << "it stands, and has forgotten where";
  EXPECT_EQ(say("power 1 on"), "ok");
  EXPECT_FALSE(is_heard());
  pass(tmcl::sim::Module::boot_time);
  EXPECT_TRUE(is_heard());
  EXPECT_EQ(say("power 1 on"), "ok");
  EXPECT_TRUE(is_heard()) << "it was on";
  EXPECT_EQ(say("power 1 cycle"), "ok");
  EXPECT_FALSE(is_heard());
  EXPECT_THAT(say("power 1 up"), HasSubstr("'up' is not off, on or cycle"));
}

TEST_F(Console, NoProgramRunsWithoutPower) {
  auto& module = add(1110);
  ask(Command::START_DOWNLOAD, 0, 0, 0);
  ask(Command::SGP, 1, 2, 77);
  ask(Command::STOP, 0, 0, 0);
  ask(Command::END_DOWNLOAD, 0, 0);
  ask(Command::SGP, tmcl::global_parameter::auto_start_mode, 0, 1);
  say("power 1 off");
  pass(std::chrono::seconds(1));
  EXPECT_EQ(module.globals().user_variable(1), 0);
  say("power 1 on");
  pass(std::chrono::seconds(1));
  EXPECT_EQ(module.globals().user_variable(1), 77);
}

TEST_F(Console, SaysWhatIsWrong) {
  add(1110);
  EXPECT_THAT(say("lod 1/0 5"), HasSubstr("Did you mean 'load'?"));
  EXPECT_EQ(say("load 1/0"), "error: it is: load ADDRESS/MOTOR LOAD");
  EXPECT_THAT(say("load 1 5"), HasSubstr("'1' is not ADDRESS/MOTOR"));
  EXPECT_THAT(say("load 2/0 5"), HasSubstr("no module with the address 2"));
  EXPECT_THAT(say("load 1/1 5"), HasSubstr("TMCM-1110 has no motor 1"));
  EXPECT_THAT(say("load 1/0 -5"), HasSubstr("'-5' is not a load"));
  EXPECT_THAT(say("slip 1/0 5"), HasSubstr("no encoder"));
  EXPECT_THAT(say("press 1/0 rigt"), HasSubstr("Did you mean 'right'?"));
}

}  // namespace
}  // namespace tmclsim
