// The configuration file of tmcld-mqtt, and what is said of mistakes in it.
#include "mqtt_config.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "broker/address.hpp"
#include "broker/password_file.hpp"
#include "broker/random_text.hpp"
#include "protocol/topics.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "support/temp_path.hpp"

namespace tmclmqtt {
namespace {

using testing::HasSubstr;

const std::string least =
    "[mqtt]\nbroker = \"localhost\"\ngateway = \"hall-1\"\nsocket = \"/run/s\"\n";

std::string problem(const std::string& toml) {
  const auto config = parse_mqtt_config(toml);
  return config ? "" : describe(config.error().front(), "f");
}
std::string problem_of(const std::string& line) { return problem(least + line + '\n'); }

TEST(MqttConfig, NeedsThreeKeys) {
  const auto config = parse_mqtt_config(least).value();
  EXPECT_EQ(config.host, "localhost");
  EXPECT_EQ(config.port, 1883);
  EXPECT_EQ(config.gateway, "hall-1");
  EXPECT_EQ(config.socket, "/run/s");
  EXPECT_EQ(config.nonce_ttl, std::chrono::seconds(2));
  EXPECT_THAT(problem(""), HasSubstr("[mqtt]"));
  EXPECT_THAT(problem("[mqtt]\nbroker = \"a\"\nsocket = \"b\"\n"),
              HasSubstr("[mqtt] needs the key 'gateway'"));
}

TEST(MqttConfig, NamesBrokersByHostAndPort) {
  const auto at = [](const std::string& broker, const std::string& more = {}) {
    const auto config = parse_mqtt_config("[mqtt]\nbroker = \"" + broker +
                                          "\"\ngateway = \"a\"\nsocket = \"b\"\n" + more);
    return config ? config->host + " " + std::to_string(config->port)
                  : config.error().front().message;
  };
  EXPECT_EQ(at("b.example:99"), "b.example 99");
  EXPECT_EQ(at("b.example", "ca = \"c\"\n"), "b.example 8883");
  EXPECT_EQ(at("[::1]:99"), "::1 99");
  EXPECT_EQ(at("[::1]"), "::1 1883");
  for (const auto* wrong : {"", ":1", "b:0", "::1", "mqtt://b:1"})
    EXPECT_THAT(at(wrong), HasSubstr("'broker'")) << wrong;
}

TEST(BrokerAddress, IsAHostAndAPort) {
  using A = BrokerAddress;
  const std::pair<const char*, A> right[]{{"b", {"b", 7}},
                                          {"b.example:1", {"b.example", 1}},
                                          {"127.0.0.1:65535", {"127.0.0.1", 65535}},
                                          {"[::1]", {"::1", 7}},
                                          {"[::1]:01883", {"::1", 1883}},
                                          {"[fe80::1%eth0]:99", {"fe80::1%eth0", 99}},
                                          {"b\xc3\xbcro", {"b\xc3\xbcro", 7}}};
  for (const auto& [text, address] : right) EXPECT_EQ(read_address(text, 7), address) << text;
  for (const auto* wrong :
       {"",         ":",       ":1",      "b:",      "b:0",    "b:65536", "b:99999999999999999999",
        "b:-1",     "b:+1",    "b: 1",    "b:1 ",    "b:1x",   "b:0x10",  "b:1:2",
        "::1",      "fe80::1", "[::1",    "::1]",    "[]",     "[]:1",    "[b]:1",
        "[::1]1",   "[::1]:",  "[::1]:0", "[[::1]]", "a[::1]", "[:: 1]",  " b",
        "b ",       "a b:1",   "a\tb",    "a\nb",    "a\x7f",  "a/b",     "a@b",
        "mqtt://b", "b?x",     "b#x",     "[::1]]:1"})
    EXPECT_FALSE(read_address(wrong, 7)) << wrong;
  EXPECT_FALSE(read_address(std::string_view("b\0c", 3), 7));
}

/// What it takes is written again in one way only; any text is fine.
TEST(BrokerAddress, IsReadBackFromWhatItSays) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  constexpr std::string_view letters = "ab.:[]0123 /@9";
  int taken = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string text;
    for (int left = random.between(0, 12); left > 0; --left)
      text += letters[static_cast<std::size_t>(random.between(0, int(letters.size()) - 1))];
    const auto address = read_address(text, 1);
    if (!address) continue;
    ++taken;
    const bool has_colon = address->host.find(':') != std::string::npos;
    const auto host = has_colon ? '[' + address->host + ']' : address->host;
    const auto again = host + ':' + std::to_string(address->port);
    EXPECT_EQ(read_address(again, 2), address) << "seed " << seed << ": " << text;
    EXPECT_TRUE(text.starts_with(host)) << "seed " << seed << ": " << text;
  }
  EXPECT_GT(taken, 200) << "seed " << seed;
}

TEST(ReplyTopic, IsThatOfAUserAGatewayAndAProcess) {
  EXPECT_EQ(reply_topic("anna", "hall-1", "id"), "tmcl/v1/reply/anna/hall-1/id");
  EXPECT_EQ(Topics("hall-1").reply(reply_topic("anna", level_of_all, "id"), std::nullopt),
            reply_topic("anna", "hall-1", "id"));
  EXPECT_EQ(Topics("hall-1").reply(reply_topic("anna", any_level, "id"), "anna"), std::nullopt);
}

TEST(RandomText, IsALevelThatIsNeverDrawnTwice) {
  std::set<std::string> drawn;
  for (int i = 0; i < 1000; ++i) {
    const auto text = random_text();
    EXPECT_TRUE(is_level(text)) << text;
    EXPECT_EQ(text.size(), 32U);
    EXPECT_TRUE(drawn.insert(text).second) << text;
  }
}

TEST(MqttConfig, NamesTheKeyThatIsWrong) {
  EXPECT_THAT(problem_of("brocker = \"b\""), HasSubstr("unknown key 'brocker' in [mqtt]"));
  EXPECT_THAT(problem_of("brocker = \"b\""), HasSubstr("Did you mean 'broker'?"));
  EXPECT_THAT(problem_of("nonce_ttl_ms = 100"), HasSubstr("'nonce_ttl_ms' is 100"));
  EXPECT_THAT(problem_of("ca = 7"), HasSubstr("'ca' must be a text"));
  EXPECT_THAT(problem_of("key = \"k\""), HasSubstr("'key' needs 'certificate'"));
  EXPECT_THAT(problem_of("ca = \"c\"\ncertificate = \"k\""),
              HasSubstr("'certificate' needs 'key'"));
  EXPECT_THAT(problem_of("certificate = \"c\"\nkey = \"k\""), HasSubstr("needs 'ca'"));
  EXPECT_THAT(problem_of("log_level = \"loud\""), HasSubstr("'log_level' is 'loud'"));
  EXPECT_THAT(problem_of("[daemon]"), HasSubstr("unknown section 'daemon'"));
  EXPECT_THAT(problem_of("x"), HasSubstr("f:5"));
  for (const auto* name : {"a/b", "+", "#", "all", ""}) {
    const auto toml = "[mqtt]\nbroker = \"b\"\nsocket = \"s\"\ngateway = \"" + std::string(name);
    EXPECT_THAT(problem(toml + "\"\n"), HasSubstr("'gateway'")) << name;
  }
}

TEST(MqttConfig, HasTheDialectsOffUntilTheyAreNamed) {
  const auto off = parse_mqtt_config(least).value();
  EXPECT_EQ(off.sparkplug_group, "");
  EXPECT_FALSE(off.home_assistant);
  const auto on = parse_mqtt_config(least +
                                    "sparkplug_group = \"plant\"\nsparkplug_host = \"scada\"\n"
                                    "home_assistant = true\nhome_assistant_prefix = \"ha/b\"\n")
                      .value();
  EXPECT_EQ(on.sparkplug_group, "plant");
  EXPECT_EQ(on.sparkplug_host, "scada");
  EXPECT_TRUE(on.home_assistant);
  EXPECT_EQ(on.home_assistant_prefix, "ha/b");
  EXPECT_THAT(problem_of("sparkplug_group = \"a/b\""), HasSubstr("'sparkplug_group' is 'a/b'"));
  EXPECT_THAT(problem_of("sparkplug_group = \"\""), HasSubstr("'sparkplug_group'"));
  EXPECT_THAT(problem_of("sparkplug_host = \"a\""), HasSubstr("needs 'sparkplug_group'"));
  EXPECT_THAT(problem_of("sparkplug_group = \"a\"\nsparkplug_host = \"#\""),
              HasSubstr("'sparkplug_host' is '#'"));
  EXPECT_THAT(problem_of("home_assistant_prefix = \"a\""), HasSubstr("needs 'home_assistant"));
  EXPECT_THAT(problem_of("home_assistant = true\nhome_assistant_prefix = \"a//b\""),
              HasSubstr("'home_assistant_prefix' is 'a//b'"));
  EXPECT_THAT(problem("[mqtt]\nbroker = \"b\"\nsocket = \"s\"\ngateway = \"a.b\"\n"
                      "home_assistant = true\n"),
              HasSubstr("Home Assistant takes only"));
}

TEST(MqttConfig, SignsInWithAUserAndTheFileOfItsPassword) {
  EXPECT_EQ(parse_mqtt_config(least).value().user, "");
  const auto config =
      parse_mqtt_config(least + "user = \"plant:hall 1\"\npassword_file = \"/run/p\"\n").value();
  EXPECT_EQ(config.user, "plant:hall 1");
  EXPECT_EQ(config.password_file, "/run/p");
  // As of a broker that takes what vouches for a user for its name.
  EXPECT_EQ(parse_mqtt_config(least + "user = \"a\"\n").value().password_file, "");
  EXPECT_THAT(problem_of("password_file = \"/run/p\""), HasSubstr("'password_file' needs 'user'"));
  EXPECT_THAT(problem_of("user = \"a\"\npassword_file = \"\""), HasSubstr("must be a path"));
  EXPECT_THAT(problem_of("password = \"secret\""), HasSubstr("unknown key 'password' in [mqtt]"));
  EXPECT_THAT(problem_of("user = 7"), HasSubstr("'user' must be a text"));
  for (const auto& wrong : {std::string(), std::string("a\\u0000b"), std::string("a\\nb"),
                            std::string("a\\u007fb"), std::string(257, 'u')})
    EXPECT_THAT(problem_of("user = \"" + wrong + '"'), HasSubstr("'user' must be the name"));
}

class PasswordFile : public testing::Test {
 protected:
  PasswordFile() : path_(tmcl::test::temp_path("password")) { write("secret\n"); }
  ~PasswordFile() override { std::filesystem::remove(path_); }

  void write(const std::string& text) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
    let_others(std::filesystem::perms::none);
  }
  void let_others(std::filesystem::perms more) const {
    using std::filesystem::perms;
    std::filesystem::permissions(path_, perms::owner_read | perms::group_read | more);
  }
  std::string read() const {
    const auto password = password_in(path_);
    return password ? *password : "refused: " + password.error();
  }

  std::string path_;
};

TEST_F(PasswordFile, HasThePasswordInItsFirstLine) {
  const std::string longest(4096, 'p');
  const std::pair<std::string, std::string> right[]{
      {"secret", "secret"}, {"secret\r\nmore\n", "secret"}, {" a b \n", " a b "},
      {"\xff\n", "\xff"},   {longest + '\n', longest},      {longest + "\r\n", longest}};
  for (const auto& [text, password] : right) {
    write(text);
    EXPECT_EQ(read(), password);
  }
  for (const auto& wrong :
       {std::string(), std::string("\n"), std::string("\r\nsecret"), std::string("a\0b\n", 4),
        std::string(4097, 'p'), std::string(100'000, 'p')}) {
    write(wrong);
    EXPECT_THAT(read(), HasSubstr(path_ + ": its first line must be the password"));
  }
}

TEST_F(PasswordFile, IsReadOnlyIfOthersMayNotOpenIt) {
  using std::filesystem::perms;
  EXPECT_EQ(read(), "secret");
  for (const auto more : {perms::others_read, perms::others_write, perms::others_exec}) {
    let_others(more);
    EXPECT_THAT(read(), HasSubstr("try `chmod o-rwx " + path_ + "`"));
  }
  let_others(perms::none);
  EXPECT_EQ(read(), "secret");
}

TEST_F(PasswordFile, IsNamedWhereItCannotBeRead) {
  std::filesystem::remove(path_);
  EXPECT_THAT(read(), HasSubstr(path_ + ": cannot be read: No such file"));
  const auto folder = password_in(testing::TempDir());
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error(), HasSubstr("cannot be read: Is a directory"));
}

TEST(MqttConfig, IsInFilesThatCanBeRead) {
  const auto path = tmcl::test::temp_path("mqtt.toml");
  std::ofstream(path) << least << "ca = \"/nowhere/ca.pem\"\n";
  const auto config = load_mqtt_config(path);
  std::filesystem::remove(path);
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().front(), HasSubstr("'ca' of [mqtt]: /nowhere/ca.pem cannot be read"));
  EXPECT_THAT(load_mqtt_config(path).error().front(), HasSubstr(path));
  std::ofstream(path) << least << "user = \"a\"\npassword_file = \"/nowhere/password\"\n";
  EXPECT_THAT(load_mqtt_config(path).error().front(),
              HasSubstr("'password_file' of [mqtt]: /nowhere/password: cannot be read"));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tmclmqtt
