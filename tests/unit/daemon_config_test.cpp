// Every mistake in a configuration file is told with its place and, where there is one, the word
// that was probably meant.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>

#include "config/load.hpp"
#include "config/sections.hpp"
#include "support/build_paths.hpp"
#include "support/temp_path.hpp"

namespace tmcld {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto good = R"([daemon]
socket = "/run/tmcld/tmcld.sock"

[[bus]]
name = "bench"
link = "serial:/dev/ttyACM0@115200"

[[axis]]
name = "x"
bus = "bench"
address = 1
motor = 0
)";

// The good file with one line replaced: its number, and what stands there instead.
std::string with_line(int line, const std::string& replacement) {
  std::string text;
  std::string_view rest = good;
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    text += number == line ? replacement : std::string(rest.substr(0, end));
    text += '\n';
    rest.remove_prefix(end + 1);
  }
  return text;
}

std::vector<std::string> problems(const std::string& toml) {
  const auto config = parse_config(toml);
  std::vector<std::string> lines;
  if (config) return lines;
  for (const auto& problem : config.error()) lines.push_back(describe(problem, "f"));
  return lines;
}

TEST(DaemonConfig, ReadsTheLeastFile) {
  const auto config = parse_config(good);
  ASSERT_TRUE(config) << config.error().front().message;
  EXPECT_EQ(config->daemon.socket, "/run/tmcld/tmcld.sock");
  ASSERT_EQ(config->buses.size(), 1U);
  EXPECT_EQ(to_string(config->buses[0].link), "serial:/dev/ttyACM0@115200");
  EXPECT_EQ(config->buses[0].bus_options.name, "bench");
  ASSERT_EQ(config->axes.size(), 1U);
  EXPECT_EQ(config->axes[0].address, (tmcl::AxisAddress{tmcl::ModuleAddress{1}, 0}));
}

TEST(DaemonConfig, ReadsEveryOption) {
  const auto config = parse_config(R"([daemon]
socket = "s"
log_level = "debug"
[[bus]]
name = "a"
link = "can:can0"
reply_timeout_ms = 7
attempts = 2
quiet_time_ms = 3
silence_time_ms = 4
can_reply_id = 0x7F
can_extended = true
[[bus]]
name = "b"
link = "tcp:127.0.0.1:4001"
telegram_pause_ms = 5
host_address = 9
connect_timeout_ms = 11
[[axis]]
name = "far"
bus = "a"
address = 2047
motor = 5
)");
  ASSERT_TRUE(config) << config.error().front().message;
  using std::chrono::milliseconds;
  EXPECT_EQ(config->daemon.log_level, LogLevel::debug);
  const auto& a = config->buses[0];
  EXPECT_EQ(a.bus_options.reply_timeout, milliseconds(7));
  EXPECT_EQ(a.bus_options.attempts, 2U);
  EXPECT_EQ(a.bus_options.quiet_time, milliseconds(3));
  EXPECT_EQ(a.bus_options.silence_time, milliseconds(4));
  EXPECT_EQ(a.link_options.can_reply_id, 0x7FU);
  EXPECT_TRUE(a.link_options.can_extended);
  const auto& b = config->buses[1];
  EXPECT_EQ(b.bus_options.telegram_pause, milliseconds(5));
  EXPECT_EQ(b.bus_options.host_address, 9);
  EXPECT_EQ(b.link_options.connect_timeout, milliseconds(11));
}

TEST(DaemonConfig, NoModuleHasTheIdentifierOfTheReplies) {
  const auto with = [](const std::string& link, const std::string& bus_lines, int address) {
    return problems("[daemon]\nsocket = \"s\"\n[[bus]]\nname = \"cell\"\nlink = \"" + link +
                    "\"\n" + bus_lines + "[[axis]]\nname = \"z\"\nbus = \"cell\"\naddress = " +
                    std::to_string(address) + "\nmotor = 0\n");
  };
  EXPECT_THAT(with("can:can0", "", 2),
              ElementsAre(testing::AllOf(
                  HasSubstr("f:9:11: axis 'z' has the address 2, but replies on bus "
                            "'cell' come with the identifier 2"),
                  HasSubstr("would take every reply for a command"), HasSubstr("'can_reply_id'"))));
  EXPECT_THAT(with("can:can0", "can_reply_id = 9\n", 9), ElementsAre(HasSubstr("identifier 9")));
  EXPECT_THAT(with("can:can0", "can_reply_id = 9\n", 2), testing::IsEmpty());
  EXPECT_THAT(with("serial:/dev/x", "", 2), testing::IsEmpty());
}

TEST(DaemonConfig, ReadsTheScaleOfAnAxis) {
  const auto plain = parse_config(good);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->axes[0].scale.unit, "");
  EXPECT_EQ(plain->axes[0].scale.full_steps, 200);
  EXPECT_FALSE(plain->axes[0].scale.reverse);
  EXPECT_FALSE(plain->axes[0].scale.microstep_resolution);
  const auto config = parse_config(std::string(good) +
                                   "unit = \"mm\"\nunits_per_revolution = 5.5\nreverse = true\n"
                                   "full_steps = 400\nmicrosteps = 64\n");
  ASSERT_TRUE(config) << config.error().front().message;
  const auto& scale = config->axes[0].scale;
  EXPECT_EQ(scale.unit, "mm");
  EXPECT_EQ(scale.units_per_revolution, 5.5);
  EXPECT_TRUE(scale.reverse);
  EXPECT_EQ(scale.full_steps, 400);
  EXPECT_EQ(scale.microstep_resolution, 6);
  const auto whole = parse_config(std::string(good) + "unit = \"µm\"\nunits_per_revolution = 5\n");
  ASSERT_TRUE(whole) << whole.error().front().message;
  EXPECT_EQ(whole->axes[0].scale.units_per_revolution, 5);
}

TEST(DaemonConfig, ReadsWhatAnAxisDrives) {
  const auto screw =
      parse_config(std::string(good) +
                   "unit = \"mm\"\nscrew_pitch = 10\ngear_ratio = 3\nsoft_limits = [-2.5, 300]\n"
                   "encoder_lines = 1000\n");
  ASSERT_TRUE(screw) << screw.error().front().message;
  const auto& scale = screw->axes[0].scale;
  EXPECT_EQ(scale.units_per_revolution, 10);
  EXPECT_EQ(scale.gear_ratio, 3);
  ASSERT_TRUE(scale.limits);
  EXPECT_EQ(*scale.limits, (tmcl::SoftLimits{{-2.5}, {300}}));
  EXPECT_EQ(scale.encoder_counts_per_unit, 1200);
  const auto single = parse_config(std::string(good) +
                                   "unit = \"deg\"\nunits_per_revolution = 360\n"
                                   "encoder_lines = 900\nencoder_quadrature = false\n");
  ASSERT_TRUE(single) << single.error().front().message;
  EXPECT_EQ(single->axes[0].scale.encoder_counts_per_unit, 2.5);
  const auto linear = parse_config(
      std::string(good) + "unit = \"mm\"\nscrew_pitch = 10\nencoder_counts_per_unit = 1000\n");
  ASSERT_TRUE(linear) << linear.error().front().message;
  EXPECT_EQ(linear->axes[0].scale.encoder_counts_per_unit, 1000);
  EXPECT_FALSE(linear->axes[0].scale.limits);
}

TEST(DaemonConfig, SoftLimitsNeedNoUnit) {
  const auto bare = parse_config(std::string(good) + "soft_limits = [-1000, 2000]\n");
  ASSERT_TRUE(bare) << bare.error().front().message;
  EXPECT_EQ(bare->axes[0].scale.limits, (tmcl::SoftLimits{{-1000}, {2000}}));
  EXPECT_THAT(problems(std::string(good) + "soft_limits = [5, 5]\n"),
              ElementsAre(HasSubstr("the first must be less than the second")));
}

TEST(DaemonConfig, MechanicsThatMakeNoSenseAreRefused) {
  const auto with = [](const std::string& lines) {
    return problems(std::string(good) + "unit = \"mm\"\nscrew_pitch = 10\n" + lines);
  };
  const auto one = [](std::string_view message) {
    return ElementsAre(HasSubstr(std::string(message)));
  };
  EXPECT_THAT(with("gear_ratio = 0\n"),
              ElementsAre("f:15:14: 'gear_ratio' is 0, but must be greater than 0; for the other "
                          "direction say reverse = true"));
  EXPECT_THAT(with("gear_ratio = nan\n"), one("'gear_ratio' is nan"));
  EXPECT_THAT(with("units_per_revolution = 10\n"), one("give one"));
  EXPECT_THAT(with("soft_limits = [5, 5]\n"),
              ElementsAre("f:15:15: 'soft_limits' is [5, 5], but the first must be less than the "
                          "second"));
  EXPECT_THAT(with("soft_limits = [0, inf]\n"), one("[0, inf]"));
  for (const auto* list : {"5", "[5]", "[1, 2, 3]", "[1, \"2\"]", "[]"}) {
    EXPECT_THAT(with("soft_limits = " + std::string(list) + "\n"),
                ElementsAre("f:15:15: 'soft_limits' must be two numbers in brackets, [least, "
                            "greatest]"))
        << list;
  }
  EXPECT_THAT(with("encoder_lines = 0\n"), one("outside 1.."));
  EXPECT_THAT(with("encoder_quadrature = true\n"), one("without 'encoder_lines'"));
  EXPECT_THAT(with("encoder_counts_per_unit = -1\n"), one("greater than 0"));
  EXPECT_THAT(with("encoder_counts_per_unit = 1\nencoder_lines = 1\n"), one("give one"));
  for (const auto* line : {"gear_ratio = 2", "encoder_lines = 5", "encoder_counts_per_unit = 5"}) {
    EXPECT_THAT(problems(std::string(good) + line + '\n'), one("means nothing without 'unit'"));
  }
  EXPECT_THAT(problems(std::string(good) + "screw_pitch = 10\n"), one("belong together"));
}

TEST(DaemonConfig, AScaleThatMakesNoSenseIsRefused) {
  const auto with = [](const std::string& lines) {
    const auto all = problems(good + lines);
    return all.size() == 1 ? all.front() : std::to_string(all.size()) + " problems";
  };
  EXPECT_THAT(with("unit = \"mm\"\n"), HasSubstr("belong together"));
  EXPECT_THAT(with("units_per_revolution = 5\n"), HasSubstr("belong together"));
  EXPECT_THAT(with("unit = \"mm\"\nunits_per_revolution = 0\n"), HasSubstr("greater than 0"));
  EXPECT_THAT(with("unit = \"mm\"\nunits_per_revolution = -5\n"), HasSubstr("reverse = true"));
  EXPECT_THAT(with("unit = \"mm\"\nunits_per_revolution = inf\n"), HasSubstr("greater than 0"));
  EXPECT_THAT(with("unit = \"mm\"\nunits_per_revolution = nan\n"), HasSubstr("greater than 0"));
  EXPECT_THAT(problems(std::string(good) + "unit = \"mm\"\nunits_per_revolution = \"5\"\n"),
              testing::Contains(HasSubstr("must be a number")));
  EXPECT_THAT(with("unit = \"pps\"\nunits_per_revolution = 5\n"), HasSubstr("already"));
  EXPECT_THAT(with("unit = \"mm2\"\nunits_per_revolution = 5\n"), HasSubstr("digits"));
  EXPECT_THAT(with("unit = \"\"\nunits_per_revolution = 5\n"), HasSubstr("is empty"));
  EXPECT_THAT(with("unit = \"abcdefghijklmnopq\"\nunits_per_revolution = 5\n"),
              HasSubstr("more than 16"));
  EXPECT_THAT(with("microsteps = 48\n"), HasSubstr("power of two"));
  EXPECT_THAT(with("microsteps = 512\n"), HasSubstr("outside 1..256"));
  EXPECT_THAT(with("full_steps = 0\n"), HasSubstr("outside 1.."));
  EXPECT_THAT(with("reverse = 1\n"), HasSubstr("true or false"));
}

struct Mistake {
  int line;
  std::string instead;
  std::string message;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.instead; }

class DaemonConfigMistake : public testing::TestWithParam<Mistake> {};

TEST_P(DaemonConfigMistake, IsToldWithItsPlace) {
  const auto& mistake = GetParam();
  EXPECT_THAT(problems(with_line(mistake.line, mistake.instead)), ElementsAre(mistake.message));
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, DaemonConfigMistake,
    testing::Values(
        Mistake{11, "adress = 1\naddress = 1",
                "f:11:1: unknown key 'adress' in [[axis]]. Did you mean 'address'?"},
        Mistake{3, "log_levle = \"info\"",
                "f:3:1: unknown key 'log_levle' in [daemon]. Did you mean 'log_level'?"},
        Mistake{3, "log_level = \"inof\"",
                "f:3:13: 'log_level' is 'inof', but must be error, warning, info or debug. Did "
                "you mean 'info'?"},
        Mistake{3, "[deamon]", "f:3:2: unknown section 'deamon'. Did you mean 'daemon'?"},
        Mistake{2, "socket = 5", "f:2:10: 'socket' must be a text in quotes"},
        Mistake{2, "socket = \"\"", "f:2:10: 'socket' must be a path of 1..107 bytes"},
        Mistake{2, "",
                "f:1:1: [daemon] needs the key 'socket': path of the unix socket that clients use"},
        Mistake{5, "", "f:4:1: [[bus]] needs the key 'name': how axes and clients call this bus"},
        Mistake{5, "name = \"bench\"\nattempts = 11", "f:6:12: 'attempts' is 11, outside 1..10"},
        Mistake{5, "name = \"bench\"\nreply_timeout_ms = 1.5",
                "f:6:20: 'reply_timeout_ms' must be a whole number"},
        Mistake{5, "name = \"bench\"\ncan_extended = true",
                "f:6:16: 'can_extended' means nothing here: it is for can: links"},
        Mistake{5, "name = \"bench\"\nconnect_timeout_ms = 5",
                "f:6:22: 'connect_timeout_ms' means nothing here: it is for tcp: links"},
        Mistake{8, "[[bus]]\nname = \"bench\"\nlink = \"serial:/dev/ttyACM1\"\n[[axis]]",
                "f:9:8: the name 'bench' is given twice in [[bus]]"},
        Mistake{8, "[[bus]]\nname = \"b\"\nlink = \"serial:/dev/ttyACM0@115200\"\n[[axis]]",
                "f:10:8: bus 'bench' already uses this link"},
        Mistake{9, "name = \"1/0\"",
                "f:9:8: the name '1/0' must start with a letter and have at most 32 letters, "
                "digits, '_', '-', '.'"},
        Mistake{10, "bus = \"bensh\"", "f:10:7: there is no bus 'bensh'. Did you mean 'bench'?"},
        Mistake{11, "address = 256",
                "f:11:11: 'address' is 256, but bus 'bench' is no CAN bus: modules there have "
                "addresses 0..255"},
        Mistake{11, "address = 2048", "f:11:11: 'address' is 2048, outside 0..2047"},
        Mistake{12, "motor = -1", "f:12:9: 'motor' is -1, outside 0..255"},
        Mistake{12, "motor = 0\n[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 1\nmotor = 1",
                "f:14:8: the name 'x' is given twice in [[axis]]"},
        Mistake{12, "motor = 0\n[[axis]]\nname = \"y\"\nbus = \"bench\"\naddress = 1\nmotor = 0",
                "f:17:9: axis 'x' already is motor 0 of module 1 on bus 'bench'"},
        Mistake{12, "motor = 0\nreference = \"yes\"",
                "f:13:13: 'reference' is 'yes', but must be required or optional"},
        Mistake{12,
                "motor = 0\n[[module]]\nbus = \"bench\"\naddress = 1\nsentinel = \"variable:55\"",
                "f:16:12: 'sentinel' is 'variable:55', but must be auto, tick, settings, none or "
                "variable:N with N from 56 to 255"},
        Mistake{12,
                "motor = 0\n[[module]]\nbus = \"bench\"\naddress = 1\nsentinel = \"variable:256\"",
                "f:16:12: 'sentinel' is 'variable:256', but must be auto, tick, settings, none or "
                "variable:N with N from 56 to 255"},
        Mistake{12, "motor = 0\n[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 99",
                "f:16:14: 'deadman_ms' is 99, but must be 0 (off) or 100..65535"},
        Mistake{12, "motor = 0\n[[module]]\nbus = \"bench\"\naddress = 1\ndeadman_ms = 65536",
                "f:16:14: 'deadman_ms' is 65536, outside 0..65535"},
        Mistake{12,
                "motor = 0\n[[module]]\nbus = \"bench\"\naddress = 1\n"
                "[[module]]\nbus = \"bench\"\naddress = 1",
                "f:18:11: module 1 on bus 'bench' is given twice"}));

TEST(DaemonConfig, TellsOfALinkThatCannotBe) {
  const auto found = problems(with_line(6, "link = \"seriel:/dev/ttyACM0\""));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], testing::AllOf(HasSubstr("f:6:8: "), HasSubstr("serial")));
}

TEST(DaemonConfig, TellsEverythingAtOnceInTheOrderOfTheText) {
  EXPECT_THAT(problems("[daemon]\nsoket = 1\n[[axis]]\nname = \"x\"\nmotor = 999\n"),
              ElementsAre(HasSubstr("f:1:1: [daemon] needs the key 'socket'"),
                          HasSubstr("f:2:1: unknown key 'soket'"),
                          HasSubstr("f:3:1: [[axis]] needs the key 'bus'"),
                          HasSubstr("f:3:1: [[axis]] needs the key 'address'"),
                          HasSubstr("f:5:9: 'motor' is 999")));
}

TEST(DaemonConfig, TellsWhereTextIsNoToml) {
  const auto found = problems("[daemon]\nsocket = \n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], HasSubstr("f:2:"));
}

TEST(DaemonConfig, TellsOfKeysOutsideOfSections) {
  EXPECT_THAT(problems("socket = \"s\"\n[daemon]\nsocket = \"s\"\n"),
              ElementsAre("f:1:1: 'socket' stands outside of any section"));
}

TEST(DaemonConfig, NeedsItsDaemonSection) {
  EXPECT_THAT(problems(""),
              ElementsAre("f:1:1: the section [daemon] with its key 'socket' is missing"));
}

TEST(DaemonConfig, NamesTheFileThatCannotBeRead) {
  const auto config = load_config("/nowhere/tmcld.toml");
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error(),
              ElementsAre("/nowhere/tmcld.toml: cannot be read: No such file or directory"));
}

TEST(DaemonConfig, IsRefusedWhereOthersMayWriteIt) {
  const auto path = tmcl::test::temp_path("config");
  std::ofstream(path) << "[daemon]\nsocket = \"s\"\n";
  std::filesystem::permissions(path, std::filesystem::perms(0666));
  const auto config = load_config(path);
  std::filesystem::permissions(path, std::filesystem::perms(0664));
  const auto of_a_group = load_config(path);
  std::filesystem::remove(path);
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error(), ElementsAre(path +
                                          ": everybody may write to it, and so change "
                                          "limits of axes; try `chmod o-w " +
                                          path + "`"));
  EXPECT_TRUE(of_a_group) << of_a_group.error().front();
}

TEST(DaemonConfigAsRoot, IsRefusedIfItBelongsToAnotherUser) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  const auto path = tmcl::test::temp_path("config");
  std::ofstream(path) << "[daemon]\nsocket = \"s\"\n";
  ASSERT_EQ(::chown(path.c_str(), 12345, 0), 0);
  const auto config = load_config(path);
  std::filesystem::remove(path);
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error(), ElementsAre(HasSubstr("belongs to another user (uid 12345)")));
}

class DaemonConfigForLink : public testing::Test {
 protected:
  ~DaemonConfigForLink() override { std::filesystem::remove(path); }
  auto load(const std::string& toml, const std::string& link) {
    std::ofstream(path) << toml;
    return load_config_for_link(path, *tmcl::parse_link_name(link));
  }
  std::vector<std::string> problems_of(const std::string& toml, const std::string& link) {
    auto config = load(toml, link);
    return config ? std::vector<std::string>{} : config.error();
  }
  const std::string path = tmcl::test::temp_path("config");
};

constexpr auto bus_a = "[[bus]]\nname = \"a\"\nlink = \"serial:/dev/a\"\nattempts = 2\n";
constexpr auto bus_b = "[[bus]]\nname = \"b\"\nlink = \"can:can0\"\n";
constexpr auto axis_of_a = "[[axis]]\nname = \"x\"\nbus = \"a\"\naddress = 1\nmotor = 0\n";
constexpr auto axis_of_b = "[[axis]]\nname = \"y\"\nbus = \"b\"\naddress = 300\nmotor = 0\n";

TEST_F(DaemonConfigForLink, TakesThePlaceOfTheOnlyOne) {
  const auto config = load(std::string(bus_a) + axis_of_a, "tcp:far:4001");
  ASSERT_TRUE(config) << config.error().front();
  ASSERT_EQ(config->buses.size(), 1U);
  EXPECT_EQ(to_string(config->buses[0].link), "tcp:far:4001");
  EXPECT_EQ(config->buses[0].name, "a");
  EXPECT_EQ(config->buses[0].bus_options.attempts, 2);
  EXPECT_EQ(config->axes.at(0).name, "x");
}

TEST_F(DaemonConfigForLink, KeepsOnlyTheBusThatHasIt) {
  const auto both = std::string(bus_a) + bus_b + axis_of_a + axis_of_b;
  const auto config = load(both, "can:can0");
  ASSERT_TRUE(config) << config.error().front();
  ASSERT_EQ(config->buses.size(), 1U);
  EXPECT_EQ(config->buses[0].name, "b");
  ASSERT_EQ(config->axes.size(), 1U);
  EXPECT_EQ(config->axes[0].name, "y");
  EXPECT_EQ(load(both, "serial:/dev/a@9600")->buses.at(0).name, "a");
}

TEST_F(DaemonConfigForLink, SaysWhichBusesThereAreIfNoneHasIt) {
  EXPECT_THAT(problems_of(std::string(bus_a) + bus_b, "can:can1"),
              ElementsAre(path + ": there are several buses, and none of them is on can:can1: a on "
                                 "serial:/dev/a, b on can:can0"));
  EXPECT_THAT(problems_of("", "can:can1"), ElementsAre(path + ": there is no bus"));
}

TEST_F(DaemonConfigForLink, IgnoresTheDaemonAndNothingElse) {
  EXPECT_TRUE(load(std::string("[daemon]\nport = 1\n") + bus_a, "serial:/dev/b"));
  EXPECT_THAT(problems_of(std::string(bus_a) + "speed = 1\n", "serial:/dev/b"),
              ElementsAre(HasSubstr(":5:1: unknown key 'speed' in [[bus]]")));
  EXPECT_THAT(problems_of(std::string(bus_b) + axis_of_b, "serial:/dev/b"),
              ElementsAre(HasSubstr("'address' is 300, but bus 'b' is no CAN bus")));
}

TEST_F(DaemonConfigForLink, LeavesSettingsAlone) {
  const auto settings = tmcl::test::temp_path("settings.toml");
  std::ofstream(settings) << "model = \"TMCM-1110\"\n[motor.0]\nmax_current = 7\n";
  const auto config =
      load(std::string(bus_a) + "[[module]]\nbus = \"a\"\naddress = 1\nsettings = \"" + settings +
               "\"\nsettings_at_reset = \"restore\"\n",
           "serial:/dev/a");
  std::filesystem::remove(settings);
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_EQ(config->buses.at(0).modules.at(0).settings.wanted, nullptr);
}

TEST_F(DaemonConfigForLink, LeavesDeadmenAlone) {
  const auto config =
      load(std::string(bus_a) + "[[module]]\nbus = \"a\"\naddress = 1\ndeadman_ms = 1000\n",
           "serial:/dev/a");
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_EQ(config->buses.at(0).modules.at(0).deadman_ms, std::nullopt);
}

TEST(DaemonConfig, TellsOfALimitThatNoDoubleIs) {
  EXPECT_THAT(
      problems(std::string(good) + "soft_limits = [0, 9223372036854775807]\n"),
      ElementsAre("f:13:15: 'soft_limits' must be two numbers in brackets, [least, greatest]"));
}

TEST(DaemonConfig, OfALinkAloneHasOneBus) {
  const auto config = config_for_link(tmcl::CanName{"can0"});
  ASSERT_EQ(config.buses.size(), 1U);
  EXPECT_EQ(config.buses[0].name, "direct");
  EXPECT_EQ(config.buses[0].bus_options.name, "direct");
  EXPECT_EQ(to_string(config.buses[0].link), "can:can0");
}

// ---- who may do what ----

TEST(DaemonConfig, KnowsWhoMayDoWhat) {
  const auto config =
      parse_config(std::string(good) +
                   "[[access]]\nrole = \"operate\"\nusers = [\"root\"]\n"
                   "[[access]]\nrole = \"observe\"\ngroups = [\"root\", \"daemon\"]\n");
  ASSERT_TRUE(config) << config.error().front().message;
  ASSERT_EQ(config->access.size(), 2U);
  EXPECT_EQ(config->access[0].role, Role::operate);
  ASSERT_EQ(config->access[0].users.size(), 1U);
  EXPECT_EQ(config->access[0].users[0].id, 0U);
  EXPECT_EQ(config->access[1].role, Role::observe);
  ASSERT_EQ(config->access[1].groups.size(), 2U);
  EXPECT_EQ(config->access[1].groups[1].name, "daemon");
}

TEST(DaemonConfig, NamesUsersThatThereAreNot) {
  const auto with = [](const std::string& lines) {
    return problems(std::string(good) + "[[access]]\n" + lines);
  };
  EXPECT_THAT(with("role = \"operate\"\nusers = [\"root\", \"no-such-user\"]\n"),
              ElementsAre("f:15:9: there is no user 'no-such-user' on this computer"));
  EXPECT_THAT(with("role = \"operate\"\ngroups = [\"no-such-group\"]\n"),
              ElementsAre("f:15:10: there is no group 'no-such-group' on this computer"));
  EXPECT_THAT(with("role = \"operate\"\n"),
              ElementsAre("f:13:1: [[access]] needs 'users' or 'groups': who has the role"));
  EXPECT_THAT(
      with("role = \"operator\"\nusers = [\"root\"]\n"),
      ElementsAre("f:14:8: 'role' is 'operator', but must be observe, operate or configure. "
                  "Did you mean 'operate'?"));
  EXPECT_THAT(with("role = \"stop\"\nusers = [\"root\"]\n"),
              ElementsAre(HasSubstr("must be observe, operate or configure")));
  EXPECT_THAT(
      with("role = \"operate\"\nusers = \"root\"\n"),
      testing::Contains(HasSubstr("'users' must be a list of texts, [\"one\", \"another\"]")));
}

TEST(DaemonConfig, KnowsTheLimitsOfAnAxis) {
  const auto config =
      parse_config(std::string(good) +
                   "max_velocity = 20\nmax_acceleration = 0.5\nmax_deceleration = 0.4\n"
                   "max_current = 100\nmax_corner_jump = 2\nmax_jerk = 30\n");
  ASSERT_TRUE(config) << config.error().front().message;
  const auto& limits = config->axes[0].motion_limits;
  EXPECT_EQ(limits.velocity, 20);
  EXPECT_EQ(limits.acceleration, 0.5);
  EXPECT_EQ(limits.deceleration, 0.4);
  EXPECT_EQ(limits.current, 100);
  EXPECT_EQ(limits.corner_jump, 2);
  EXPECT_EQ(limits.jerk, 30);
  EXPECT_THAT(problems(std::string(good) + "max_velocity = -1\n"),
              ElementsAre("f:13:16: 'max_velocity' is -1, but must be greater than 0"));
}

// ---- what paths of G-code switch

TEST(DaemonConfig, KnowsWhatMWordsOfPathsSwitch) {
  const auto config = parse_config(std::string(good) +
                                   "[path]\nm3 = \"bench:1 output 0 1\"\n"
                                   "m9 = \"bench:2047 output 255 0\"\n");
  ASSERT_TRUE(config) << config.error().front().message;
  const auto& words = config->path.words;
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(to_string(words.at(3)), "bench:1 output 0 1");
  EXPECT_EQ(to_string(words.at(9)), "bench:2047 output 255 0");
  EXPECT_EQ(words.at(9).module, tmcl::ModuleAddress{2047});
  EXPECT_TRUE(parse_config(good)->path.words.empty());
}

TEST(DaemonConfig, RefusesWhatMWordsCannotSwitch) {
  for (const std::string wrong :
       {"", "bench", "bench:1", "bench:1 output 0", "bench:1 output 0 2", "bench:1 output 256 1",
        "bench:2048 output 0 1", "bench:1 outpt 0 1", "bench:1 output 0 1 ", "1 output 0 1",
        ":1 output 0 1", "bench:-1 output 0 1", "bench:1 output  0 1", "bench:x output 0 1"}) {
    EXPECT_THAT(problems(std::string(good) + "[path]\nm7 = \"" + wrong + "\"\n"),
                ElementsAre("f:14:6: 'm7' is '" + wrong +
                            "', but must be BUS:ADDRESS output PORT VALUE with 0 or 1 as VALUE, "
                            "such as \"bench:1 output 0 1\""));
  }
  EXPECT_THAT(problems(std::string(good) + "[path]\nm3 = \"bensh:1 output 0 1\"\n"),
              ElementsAre("f:14:6: 'm3': there is no bus 'bensh'. Did you mean 'bench'?"));
  EXPECT_THAT(problems(std::string(good) + "[path]\nm3 = 1\n"),
              ElementsAre("f:14:6: 'm3' must be a text in quotes"));
  EXPECT_THAT(problems(std::string(good) + "[path]\nm6 = \"bench:1 output 0 1\"\n"),
              ElementsAre(HasSubstr("f:14:1: unknown key 'm6' in [path].")));
  EXPECT_THAT(problems(std::string(good) + "[[path]]\n"),
              ElementsAre(HasSubstr("there is one such section, written [path]")));
}

TEST(DaemonConfig, KnowsOriginsAndTools) {
  const auto config =
      parse_config(std::string(good) +
                   "[path]\ng54 = {x = 1, z = -2.5}\ng59 = {a = 90}\ntools = {1 = 12.5, 20 = 3}\n");
  ASSERT_TRUE(config) << config.error().front().message;
  const auto& path = config->path;
  EXPECT_EQ(path.origins[0], (std::array<double, 6>{1, 0, -2.5, 0, 0, 0}));
  EXPECT_EQ(path.origins[5], (std::array<double, 6>{0, 0, 0, 90, 0, 0}));
  EXPECT_FALSE(path.origins[1]);
  EXPECT_EQ(path.tools, (std::map<int, double>{{1, 12.5}, {20, 3}}));
}

TEST(DaemonConfig, RefusesOriginsAndToolsThatAreNone) {
  const auto told = [](const std::string& line) {
    return problems(std::string(good) + "[path]\n" + line + "\n");
  };
  EXPECT_THAT(told("g55 = {X = 1}"),
              ElementsAre("f:14:7: 'g55' has 'X', but its names are x, y, z, a, b and c"));
  EXPECT_THAT(told("g55 = {xy = 1}"), ElementsAre(HasSubstr("'g55' has 'xy'")));
  EXPECT_THAT(told("g55 = {x = \"1\"}"),
              ElementsAre("f:14:7: 'g55' must be numbers with names, {x = 1.5, y = 2}"));
  EXPECT_THAT(told("g55 = 5"), ElementsAre(HasSubstr("'g55' must be numbers with names")));
  EXPECT_THAT(told("g55 = {x = inf}"),
              ElementsAre("f:14:7: 'x' of 'g55' is inf, and no finite number"));
  EXPECT_THAT(
      told("tools = {a = 1}"),
      ElementsAre("f:14:9: 'tools' has 'a', but its names are numbers of tools, 1 to 99999"));
  EXPECT_THAT(told("tools = {0 = 1}"), ElementsAre(HasSubstr("'tools' has '0'")));
  EXPECT_THAT(told("tools = {100000 = 1}"), ElementsAre(HasSubstr("'tools' has '100000'")));
  EXPECT_THAT(told("tools = {1 = nan}"), ElementsAre(HasSubstr("'1' of 'tools' is nan")));
}

// With --direct there is one bus: what is on others is not switched.
TEST(DaemonConfig, OfOneLinkThereIsWhatItsBusSwitches) {
  const auto path = tmcl::test::temp_path("switches.toml");
  std::ofstream(path) << good
                      << "[[bus]]\nname = \"other\"\nlink = \"can:can0\"\n[path]\n"
                         "m3 = \"bench:1 output 0 1\"\nm5 = \"other:1 output 0 0\"\n";
  const auto config =
      load_config_for_link(path, *tmcl::parse_link_name("serial:/dev/ttyACM0@115200"));
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_EQ(config->path.words.size(), 1U);
  EXPECT_TRUE(config->path.words.contains(3));
}

TEST(DaemonConfig, ExampleFileIsGoodAndMentionsEveryKey) {
  const std::string path = TMCL_SOURCE_DIR "/config/tmcld.toml";
  const auto config = load_config(path);
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_FALSE(config->config.axes.empty());
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const auto& key : config_keys()) {
    EXPECT_THAT(text, HasSubstr(std::string(key.name) + " = "));
  }
}

}  // namespace
}  // namespace tmcld
