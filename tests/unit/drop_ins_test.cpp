// A configuration of several files: one by name, and those in the directory beside it.
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "config/files.hpp"
#include "config/load.hpp"
#include "tmcl/link_name.hpp"

namespace tmcld {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class DropIns : public testing::Test {
 protected:
  DropIns() {
    auto name = (std::filesystem::temp_directory_path() / "drop-ins-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    std::filesystem::create_directory(path("tmcld.d"));
    write("tmcld.toml", "[daemon]\nsocket = \"s\"\n");
  }
  ~DropIns() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
  }
  auto load() const { return load_config(path("tmcld.toml")); }
  std::vector<std::string> problems() const {
    auto loaded = load();
    return loaded ? std::vector<std::string>{} : loaded.error();
  }

 private:
  std::string folder_;
};

constexpr auto bus = "[[bus]]\nname = \"bench\"\nlink = \"serial:/dev/a\"\n";

std::string axis(const std::string& name, int motor) {
  return "[[axis]]\nname = \"" + name +
         "\"\nbus = \"bench\"\naddress = 1\nmotor = " + std::to_string(motor) + "\n";
}

TEST_F(DropIns, NoBusAtAllIsAConfiguration) {
  const auto loaded = load();
  ASSERT_TRUE(loaded) << loaded.error().front();
  EXPECT_TRUE(loaded->config.buses.empty());
  EXPECT_EQ(loaded->files, 1U);
}

TEST_F(DropIns, AddSectionsInTheOrderOfTheirNames) {
  write("tmcld.d/20-b.toml", axis("second", 0));
  write("tmcld.d/10-a.toml", std::string(bus) + axis("first", 1));
  const auto loaded = load();
  ASSERT_TRUE(loaded) << loaded.error().front();
  EXPECT_EQ(loaded->files, 3U);
  ASSERT_EQ(loaded->config.axes.size(), 2U);
  EXPECT_EQ(loaded->config.axes[0].name, "first");
  EXPECT_EQ(loaded->config.axes[1].name, "second");
}

TEST_F(DropIns, MistakesAreToldWithTheirFile) {
  write("tmcld.d/10-bus.toml", std::string(bus) + "speed = 1\n");
  write("tmcld.d/20-axis.toml", axis("x", 0) + axis("x", 1) + "moter = 2\n");
  EXPECT_THAT(
      problems(),
      ElementsAre(HasSubstr("tmcld.d/10-bus.toml:4:1: unknown key 'speed' in [[bus]]"),
                  HasSubstr("tmcld.d/20-axis.toml:7:8: the name 'x' is given twice in [[axis]]"),
                  HasSubstr("tmcld.d/20-axis.toml:11:1: unknown key 'moter' in [[axis]]")));
}

TEST_F(DropIns, AFileThatIsNoTomlIsTheOnlyMistakeTold) {
  write("tmcld.d/a.toml", "[[bus\n");
  write("tmcld.d/b.toml", axis("x", 0));
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("tmcld.d/a.toml:1:")));
}

TEST_F(DropIns, DaemonSectionIsForOneFile) {
  write("tmcld.d/a.toml", "\n[daemon]\nsocket = \"t\"\n");
  EXPECT_THAT(problems(), ElementsAre(path("tmcld.d/a.toml") + ":2:1: [daemon] stands in " +
                                      path("tmcld.toml") + " already: it is for one file"));
  write("tmcld.toml", "");
  const auto loaded = load();
  ASSERT_TRUE(loaded) << loaded.error().front();
  EXPECT_EQ(loaded->config.daemon.socket, "t");
  std::filesystem::remove(path("tmcld.d/a.toml"));
  EXPECT_THAT(problems(),
              ElementsAre(HasSubstr("tmcld.toml:1:1: the section [daemon] with its key")));
}

TEST_F(DropIns, OtherFilesAreLeftAlone) {
  for (const std::string name : {"README", "a.toml.dpkg-old", "a.toml~", ".#a.toml"})
    write("tmcld.d/" + name, "this is no TOML");
  EXPECT_THAT(problems(), ElementsAre());
}

TEST_F(DropIns, DirectoryHasTheNameOfTheFile) {
  write("tmcld.d/a.toml", bus);
  std::filesystem::rename(path("tmcld.toml"), path("other.toml"));
  EXPECT_EQ(load_config(path("other.toml"))->files, 1U);
  std::filesystem::rename(path("tmcld.d"), path("other.d"));
  EXPECT_EQ(load_config(path("other.toml"))->files, 2U);
}

TEST_F(DropIns, AreRefusedWhereOthersMayAddSome) {
  std::filesystem::permissions(path("tmcld.d"), std::filesystem::perms(0777));
  EXPECT_THAT(problems(), ElementsAre(AllOf(HasSubstr("tmcld.d: everybody may write to it"),
                                            Not(HasSubstr("chmod")))));
}

TEST_F(DropIns, AFolderIsNoConfiguration) {
  for (const auto mode : {0777, 0755}) {
    ::chmod(path("tmcld.d").c_str(), static_cast<mode_t>(mode));
    const auto read = read_config_files(path("tmcld.d"));
    ASSERT_FALSE(read);
    EXPECT_EQ(describe(read.error()), path("tmcld.d") +
                                          ": is a folder; a configuration is a file, such as "
                                          "/etc/tmcl/tmcld.toml");
  }
}

TEST_F(DropIns, ThereAreNotTooMany) {
  for (std::size_t i = 0; i <= max_drop_ins; ++i)
    write("tmcld.d/" + std::to_string(i) + ".toml", "");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("tmcld.d: has more than 64 files")));
}

TEST_F(DropIns, CountForAGatewayOfOneCallToo) {
  write("tmcld.d/a.toml", std::string(bus) + axis("x", 0));
  const auto config =
      load_config_for_link(path("tmcld.toml"), *tmcl::parse_link_name("tcp:far:4001"));
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_EQ(config->axes.at(0).name, "x");
}

// ---- the file that clients may set --------------------------------------------------------------

class ManagedFile : public DropIns {
 protected:
  ManagedFile() {
    write("tmcld.toml", "[daemon]\nsocket = \"s\"\nmanaged = \"" + path("managed.toml") + "\"\n");
  }
  auto load_with(const std::optional<std::string>& text) const {
    return load_config_with(path("tmcld.toml"), text);
  }
};

TEST_F(ManagedFile, ComesLast) {
  EXPECT_THAT(problems(), ElementsAre()) << "it need not be there";
  write("managed.toml", axis("second", 0) + "[path]\ng54 = {x = 1}\n");
  write("tmcld.d/z.toml", std::string(bus) + axis("first", 1));
  const auto loaded = load();
  ASSERT_TRUE(loaded) << loaded.error().front();
  EXPECT_EQ(loaded->files, 3U);
  ASSERT_EQ(loaded->config.axes.size(), 2U);
  EXPECT_EQ(loaded->config.axes[1].name, "second");
  EXPECT_TRUE(loaded->config.path.origins[0]);
}

TEST_F(ManagedFile, AddsToOthersAndChangesNothingOfThem) {
  write("tmcld.d/a.toml", std::string(bus) + axis("x", 0) + "[path]\n");
  write("managed.toml", std::string(bus) + axis("x", 1) + "[path]\n");
  EXPECT_THAT(problems(),
              ElementsAre(HasSubstr("managed.toml:2:8: the name 'bench' is given twice in [[bus]]"),
                          HasSubstr("managed.toml:3:8: bus 'bench' already uses this link"),
                          HasSubstr("managed.toml:5:8: the name 'x' is given twice in [[axis]]"),
                          HasSubstr("managed.toml:9:1: [path] stands in ")));
}

TEST_F(ManagedFile, HasNoRightsInIt) {
  write("managed.toml",
        "daemon = {managed = \"/m\"}\naccess = []\nport = 1\n[http]\nlisten = [\"0.0.0.0:1\"]\n");
  std::vector<testing::Matcher<std::string>> expected;
  for (const auto* one : {"1:1: [daemon]", "2:1: [[access]]", "3:1: [[port]]", "4:2: [http]"}) {
    expected.push_back(HasSubstr(std::string("managed.toml:") + one +
                                 " cannot stand in the file that clients may set"));
  }
  EXPECT_THAT(problems(), testing::ElementsAreArray(expected));
}

TEST_F(ManagedFile, IsReplacedByATextThatIsTried) {
  write("tmcld.d/a.toml", bus);
  write("managed.toml", "this is no TOML");
  const auto tried = load_with(axis("x", 0));
  ASSERT_TRUE(tried) << lines_of(tried.error()).front();
  EXPECT_EQ(tried->axes.at(0).name, "x");
  EXPECT_FALSE(load_with(std::nullopt));
  const auto bad = load_with("\n[[port]]\n");
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().at(0).file, path("managed.toml"));
  EXPECT_EQ(bad.error().at(0).line, 2U);
}

TEST_F(ManagedFile, IsNoMoreThanATextWhereNoneIsNamed) {
  write("tmcld.toml", "[daemon]\nsocket = \"s\"\n");
  const auto tried = load_with("this is no TOML");
  ASSERT_TRUE(tried) << lines_of(tried.error()).front();
  EXPECT_EQ(tried->daemon.managed, "");
}

TEST_F(ManagedFile, HasAWholePath) {
  write("tmcld.toml", "[daemon]\nsocket = \"s\"\nmanaged = \"managed.toml\"\n");
  EXPECT_THAT(problems(),
              ElementsAre(HasSubstr("tmcld.toml:3:11: 'managed' must be a whole path")));
}

using ManagedFileAsRoot = ManagedFile;
TEST_F(ManagedFileAsRoot, IsWrittenByTheOwnerOfItsFolderOnly) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  write("managed.toml", "");
  ASSERT_EQ(::chown(path("managed.toml").c_str(), 12345, 0), 0);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("belongs to another user (uid 12345)")));
  ASSERT_EQ(::chown(path(".").c_str(), 12345, 0), 0);
  EXPECT_THAT(problems(), ElementsAre());
  std::filesystem::permissions(path("managed.toml"), std::filesystem::perms(0666));
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("everybody may write to it")));
}

TEST_F(ManagedFile, IsNotReadForAGatewayOfOneCall) {
  write("managed.toml", axis("y", 1));
  write("tmcld.d/a.toml", std::string(bus) + axis("x", 0));
  const auto config =
      load_config_for_link(path("tmcld.toml"), *tmcl::parse_link_name("tcp:far:4001"));
  ASSERT_TRUE(config) << config.error().front();
  EXPECT_EQ(config->axes.size(), 1U);
}

}  // namespace
}  // namespace tmcld
