// The part of the configuration that clients set: taken over and kept, or nothing of both.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <pwd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include "config/load.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string clients_bus = "[[bus]]\nname = \"other\"\nlink = \"serial:/dev/other@115200\"\n";

std::string with_axis(const std::string& name) {
  return clients_bus + "[[axis]]\nname = \"" + name +
         "\"\nbus = \"other\"\naddress = 1\nmotor = 0\n";
}

class ManagedFolder {
 public:
  ManagedFolder() {
    auto name = (std::filesystem::temp_directory_path() / "managed-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ManagedFolder(const ManagedFolder&) = delete;
  ManagedFolder& operator=(const ManagedFolder&) = delete;
  ~ManagedFolder() { std::filesystem::remove_all(path); }

  std::string file() const { return path + "/managed.toml"; }
  std::string config() const { return path + "/tmcld.toml"; }

  std::string path;
};

/// A daemon with the axes x and y, and with u on a bus of its own, which clients may set.
class ManagedDaemon : public testing::Test {
 protected:
  explicit ManagedDaemon(const std::string& more = {})
      : daemon_(managed() + more + axes_x_and_y(Limits::none) + with_axis("u"), reactor_) {
    module_.be_played_by(daemon_.wire().modules.at(1));
    other_module_.be_played_by(daemon_.wire("other").modules.at(1));
    write(folder_.file(), with_axis("u"));
    write_config(managed() + more);
    daemon_.daemon().load_by(
        [path = folder_.config()](const auto& text) { return load_config_with(path, text); });
    daemon_.daemon().end_on_signals();
    daemon_.start();
    client_ = std::make_unique<RpcClient>(daemon_.socket());
  }

  std::string managed() const { return "managed = \"" + folder_.file() + "\"\n"; }
  static void write(const std::string& path, const std::string& text) {
    std::ofstream(path) << text;
  }
  void write_config(const std::string& keys) const {
    write(folder_.config(), "[daemon]\nsocket = \"" + daemon_.socket().path + "\"\n" + keys +
                                axes_x_and_y(Limits::none));
  }
  std::string kept() const {
    std::ifstream file(folder_.file());
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path))
      names.insert(entry.path().filename());
    return names;
  }

  static json::object wish(const std::string& toml, bool dry_run = false) {
    json::object params{{"toml", toml}};
    if (dry_run) params["dry_run"] = true;
    return params;
  }
  json::object set(const std::string& toml, bool dry_run = false) {
    return client_->result("configuration.set", wish(toml, dry_run));
  }
  json::object refusal(const std::string& toml, bool dry_run = false) {
    return client_->error("configuration.set", wish(toml, dry_run));
  }
  static std::string name_of(const json::object& error) {
    return text(error.at("data").at("name"));
  }
  static std::string message_of(const json::object& error) { return text(error.at("message")); }
  std::set<std::string> axes() {
    std::set<std::string> names;
    for (const auto& axis : daemon_.daemon().gateway().axes()) names.insert(axis->name());
    return names;
  }
  void expect_nothing_has_changed() {
    EXPECT_EQ(kept(), with_axis("u"));
    EXPECT_EQ(axes(), (std::set<std::string>{"x", "y", "u"}));
    EXPECT_EQ(files(), (std::set<std::string>{"managed.toml", "tmcld.toml"}));
  }

 private:
  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModule module_{reactor_->clock};
  SimulatedModule other_module_{reactor_->clock};

 protected:
  ManagedFolder folder_;
  TestDaemon daemon_;
  std::unique_ptr<RpcClient> client_;
};

TEST_F(ManagedDaemon, GoesByWhatIsSetAndKeepsIt) {
  client_->result("subscribe", {{"axes", json::array{"x"}}});
  const auto taken = set(with_axis("v"));
  EXPECT_EQ(taken.at("changed"), true);
  EXPECT_EQ(text(taken.at("buses")), "buses: 1 as before, 1 opened anew, 0 new, 0 gone; axes: 3");
  EXPECT_EQ(axes(), (std::set<std::string>{"x", "y", "v"}));
  EXPECT_EQ(kept(), with_axis("v"));
  EXPECT_EQ(files(), (std::set<std::string>{"managed.toml", "tmcld.toml"}));
  struct stat status {};
  ASSERT_EQ(::stat(folder_.file().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0137U, 0U) << "for the owner to write, and its group to read";
  auto event = client_->notification("notify_event");
  while (event.at("kind") != "configuration_loaded") event = client_->notification("notify_event");
  EXPECT_EQ(event.at("text"), taken.at("buses"));
}

TEST_F(ManagedDaemon, TellsWhatIsSet) {
  auto managed = client_->result("configuration.get");
  EXPECT_EQ(text(managed.at("file")), folder_.file());
  EXPECT_EQ(text(managed.at("toml")), with_axis("u"));
  std::filesystem::remove(folder_.file());
  managed = client_->result("configuration.get");
  EXPECT_EQ(text(managed.at("file")), folder_.file());
  EXPECT_TRUE(managed.at("toml").is_null());
  EXPECT_EQ(set("").at("changed"), true) << "an empty file is one";
  EXPECT_EQ(text(client_->result("configuration.get").at("toml")), "");
}

TEST_F(ManagedDaemon, GoesByItWhenItIsStartedAgain) {
  set(with_axis("v"));
  const auto again = load_config(folder_.config());
  ASSERT_TRUE(again) << again.error().front();
  ASSERT_EQ(again->config.axes.size(), 3U);
  EXPECT_EQ(again->config.axes.back().name, "v");
  EXPECT_TRUE(daemon_.daemon().gateway().changed_by(again->config).empty());
}

TEST_F(ManagedDaemon, TakesTheSameTextAgain) {
  client_->result("axis.move_to", {{"axis", "u"}, {"position_microsteps", 10'000'000}});
  daemon_.run_for(100ms);
  for (const bool dry_run : {true, false}) {
    const auto taken = set(with_axis("u"), dry_run);
    EXPECT_EQ(taken.at("changed"), false);
    EXPECT_EQ(text(taken.at("buses")), "buses: 2 as before, 0 opened anew, 0 new, 0 gone; axes: 3");
  }
  EXPECT_EQ(client_->result("axis.get_state", {{"axis", "u"}}).at("moving"), true);
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, OnlySaysInADryRunWhatItWouldDo) {
  const auto taken = set("", true);
  EXPECT_EQ(taken.at("changed"), true);
  EXPECT_EQ(text(taken.at("buses")), "buses: 1 as before, 0 opened anew, 0 new, 1 gone; axes: 2");
  expect_nothing_has_changed();
  const auto lines = [&] { return client_->result("audit.tail").at("lines").as_array(); };
  EXPECT_EQ(lines().size(), 0U);
  set("");
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_THAT(text(lines().at(0).at("text")),
              HasSubstr(R"(method=configuration.set params={"toml":""} outcome=done)"));
}

TEST_F(ManagedDaemon, RefusesABadTextWithAllItsProblems) {
  for (const bool dry_run : {true, false}) {
    const auto error = refusal(with_axis("x") + "moter = 2\n", dry_run);
    EXPECT_EQ(error.at("code"), -32602);
    EXPECT_EQ(name_of(error), "bad_configuration");
    EXPECT_EQ(text(error.at("data").at("param")), "toml");
    EXPECT_EQ(message_of(error), folder_.file() + ":5:8: the name 'x' is given twice in [[axis]]");
    const auto& problems = error.at("data").at("problems").as_array();
    ASSERT_EQ(problems.size(), 2U);
    EXPECT_EQ(problems[1].at("line"), 9);
    EXPECT_EQ(text(problems[1].at("file")), folder_.file());
    EXPECT_THAT(text(problems[1].at("message")), HasSubstr("unknown key 'moter' in [[axis]]"));
  }
  EXPECT_EQ(name_of(refusal("[[bus")), "bad_configuration");
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, LeavesRightsToTheAdministrator) {
  for (const std::string section :
       {"[daemon]\nmoves_need_lease = true\n", "[http]\nlisten = [\"0.0.0.0:4143\"]\n",
        "[[access]]\nrole = \"configure\"\nusers = [\"root\"]\n",
        "[[port]]\nname = \"a\"\nbus = \"bench\"\ntcp = \"0.0.0.0:1\"\nmay = [\"configure\"]\n"}) {
    const auto error = refusal(with_axis("u") + section);
    EXPECT_EQ(name_of(error), "bad_configuration");
    EXPECT_THAT(message_of(error), HasSubstr(folder_.file() + ":9:"));
    EXPECT_THAT(message_of(error), HasSubstr("cannot stand in the file that clients may set"));
  }
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, TellsAHundredProblemsAtMost) {
  std::string bad;
  for (int i = 0; i < 5000; ++i) bad += "k" + std::to_string(i) + "=1\n";
  EXPECT_EQ(refusal(bad).at("data").at("problems").as_array().size(), 100U);
  EXPECT_EQ(name_of(refusal("#" + std::string(48 << 10, 'x'))), "bad_argument");
  EXPECT_EQ(text(refusal("#" + std::string(48 << 10, 'x')).at("data").at("param")), "toml");
}

TEST_F(ManagedDaemon, ChangesNothingWhileAnAxisMovesThatItWouldChange) {
  client_->result("axis.move_to", {{"axis", "u"}, {"position_microsteps", 10'000'000}});
  daemon_.run_for(100ms);
  for (const bool dry_run : {true, false}) {
    const auto error = refusal(with_axis("v"), dry_run);
    EXPECT_EQ(error.at("code"), -32003);
    EXPECT_EQ(name_of(error), "cannot_reload");
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
    EXPECT_THAT(message_of(error), HasSubstr("axis 'u' moves"));
  }
  EXPECT_EQ(client_->result("axis.get_state", {{"axis", "u"}}).at("moving"), true);
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, ChangesNothingThatAnotherClientLeases) {
  RpcClient other(daemon_.socket());
  other.result("lease.acquire", {{"axes", json::array{"u"}}, {"ttl_ms", 60'000}});
  EXPECT_THAT(message_of(refusal("")), HasSubstr("axis 'u' is leased by process"));
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, ChangesNothingWhereTheFileCannotBeMade) {
  const auto gone = folder_.path + ".gone";
  std::filesystem::rename(folder_.path, gone);
  std::filesystem::create_directory(folder_.path);
  std::filesystem::copy(gone + "/tmcld.toml", folder_.config());
  // Where the text would be written.
  std::filesystem::create_directory(folder_.file() + ".new");
  const auto error = refusal(with_axis("v"));
  EXPECT_EQ(name_of(error), "not_kept");
  EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
  EXPECT_THAT(message_of(error), HasSubstr("cannot create " + folder_.file() + ".new"));
  std::filesystem::remove_all(folder_.path);
  std::filesystem::rename(gone, folder_.path);
  expect_nothing_has_changed();
}

TEST_F(ManagedDaemon, ChangesNothingOnAFullDisk) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  for (const rlim_t room : {0U, 10U}) {
    const rlimit full{room, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    const auto error = refusal(with_axis("v"));
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(name_of(error), "not_kept");
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent");
    EXPECT_THAT(message_of(error), HasSubstr("cannot write " + folder_.file() + ".new"));
    expect_nothing_has_changed();
  }
}

TEST_F(ManagedDaemon, SaysThatItIsDoneWhereTheFileCannotBeReplacedAfterThat) {
  std::filesystem::remove(folder_.file());
  std::filesystem::create_directory(folder_.file());
  const auto error = refusal(with_axis("v"));
  EXPECT_EQ(name_of(error), "not_kept");
  EXPECT_EQ(text(error.at("data").at("outcome")), "done");
  EXPECT_THAT(message_of(error), HasSubstr("cannot replace " + folder_.file()));
  EXPECT_EQ(axes(), (std::set<std::string>{"x", "y", "v"}));
}

TEST_F(ManagedDaemon, TakesNoTextForAFileThatIsNamedSince) {
  write_config("managed = \"" + folder_.path + "/elsewhere.toml\"\n");
  EXPECT_THAT(message_of(refusal(with_axis("v"))), HasSubstr("'managed' in [daemon] has changed"));
  write_config("");
  EXPECT_THAT(message_of(refusal("")), HasSubstr("'managed' in [daemon] has changed"));
  expect_nothing_has_changed();
  ::raise(SIGHUP);
  daemon_.run_for(1s);
  EXPECT_EQ(axes(), (std::set<std::string>{"x", "y"}));
  EXPECT_EQ(name_of(refusal("")), "not_managed");
  EXPECT_TRUE(client_->result("configuration.get").at("file").is_null());
}

TEST_F(ManagedDaemon, TellsWhatIsWrongWithOtherFiles) {
  std::filesystem::remove(folder_.config());
  EXPECT_EQ(name_of(refusal("")), "cannot_reload");
  EXPECT_EQ(kept(), with_axis("u"));
}

// Whatever comes meanwhile, the daemon and its file agree in the end.
TEST_F(ManagedDaemon, GoesByItsFileWhateverIsSetAtOnce) {
  tmcl::test::Random random(tmcl::test::seed());
  RpcClient others[] = {RpcClient(daemon_.socket()), RpcClient(daemon_.socket()),
                        RpcClient(daemon_.socket())};
  for (int round = 0; round < 30; ++round) {
    SCOPED_TRACE(round);
    std::vector<std::pair<RpcClient*, int>> asked;
    for (auto& client : others) {
      for (auto i = random.between(0, 2); i > 0; --i) {
        const auto toml = random.one_in(4) ? std::string("[[bus")
                                           : with_axis("v" + std::to_string(random.between(0, 9)));
        asked.emplace_back(&client, client.send("configuration.set", wish(toml, random.one_in(5))));
      }
      if (random.one_in(3)) ::raise(SIGHUP);
      if (random.one_in(3)) daemon_.run_for(std::chrono::milliseconds(random.between(0, 20)));
    }
    for (const auto& [client, id] : asked) client->answer_to(id);
    daemon_.run_for(1s);
    const auto files = load_config(folder_.config());
    ASSERT_TRUE(files) << files.error().front();
    EXPECT_TRUE(daemon_.daemon().gateway().changed_by(files->config).empty());
    EXPECT_EQ(axes().size(), 3U);
  }
}

class ManagedByRelay : public ManagedDaemon {
 protected:
  ManagedByRelay()
      : ManagedDaemon("[[access]]\nrole = \"configure\"\nrelay = true\nusers = [\"" +
                      std::string(::getpwuid(::geteuid())->pw_name) + "\"]\n") {}
};

TEST_F(ManagedByRelay, IsSetByTheRoleConfigureOnly) {
  for (const auto* role : {"stop", "observe", "operate"}) {
    RpcClient client(daemon_.socket());
    client.result("speak_for", {{"user", "anna"}, {"role", role}});
    EXPECT_EQ(name_of(client.error("configuration.set", wish(""))), "not_permitted");
    EXPECT_EQ(name_of(client.error("configuration.set", wish("", true))), "not_permitted");
    EXPECT_EQ(name_of(client.error("configuration.get")), "not_permitted");
  }
  expect_nothing_has_changed();
  RpcClient client(daemon_.socket());
  client.result("speak_for", {{"user", "anna"}, {"role", "configure"}});
  client.result("configuration.set", wish(""));
  const auto lines = client.result("audit.tail").at("lines").as_array();
  EXPECT_THAT(text(lines.back().at("text")), HasSubstr("client=\"anna through process"));
}

TEST_F(DaemonTest, HasNoConfigurationForClientsUnlessAFileIsNamed) {
  EXPECT_EQ(client.result("configuration.get"),
            (json::object{{"file", nullptr}, {"toml", nullptr}}));
  const auto error = client.error("configuration.set", {{"toml", ""}});
  EXPECT_EQ(error.at("code"), -32003);
  EXPECT_EQ(text(error.at("data").at("name")), "not_managed");
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("'managed' in [daemon]"));
}

}  // namespace
}  // namespace tmcld::test
