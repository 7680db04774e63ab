// Who may do what: roles from the configuration, looked at before anything is done.
#include "api/caller.hpp"

#include <unistd.h>

#include <boost/json/stream_parser.hpp>

#include <gmock/gmock.h>

#include "api/audit.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t anna = 4001;
constexpr std::uint32_t ben = 4002;
constexpr std::uint32_t lab = 5001;

const std::vector<AccessConfig>& some_access() {
  static const std::vector<AccessConfig> access{{Role::observe, {{"anna", anna}}, {}},
                                                {Role::operate, {}, {{"lab", lab}}}};
  return access;
}

TEST(CallerRole, IsConfigureForEverybodyWithoutAccess) {
  const auto caller = caller_with({anna, 1, {}}, {});
  EXPECT_EQ(caller.role, Role::configure);
  EXPECT_FALSE(caller.exceeds_limits);
}

TEST(CallerRole, IsTheHighestOfUserAndGroups) {
  EXPECT_EQ(caller_with({anna, 1, {}}, some_access()).role, Role::observe);
  EXPECT_EQ(caller_with({ben, 1, {7, lab}}, some_access()).role, Role::operate);
  const auto both = caller_with({anna, 1, {lab}}, some_access());
  EXPECT_EQ(both.role, Role::operate);
  EXPECT_THAT(both.reason, HasSubstr("'lab'"));
  EXPECT_FALSE(both.exceeds_limits);
}

TEST(CallerRole, IsToStopForWhoeverIsNotNamed) {
  const auto caller = caller_with({ben, 1, {7}}, some_access());
  EXPECT_EQ(caller.role, Role::stop);
  EXPECT_THAT(caller.reason, HasSubstr("user 4002"));
}

TEST(CallerRole, IsConfigureForRootAndForTheUserOfTheDaemon) {
  for (const std::uint32_t uid : {0U, static_cast<std::uint32_t>(::geteuid())}) {
    const auto caller = caller_with({uid, 1, {}}, some_access());
    EXPECT_EQ(caller.role, Role::configure);
    EXPECT_TRUE(caller.exceeds_limits);
  }
}

class Roles : public testing::Test {
 protected:
  Roles() { bench.wire.seen.clear(); }
  std::string refusal(std::string_view method, json::object params) {
    const auto result = bench.call(method, std::move(params));
    return result ? "" : result.error().name;
  }
  std::string refused_command(std::string_view command, int type = 0) {
    return refusal("module.execute", {{"bus", "bench"},
                                      {"address", 1},
                                      {"command", command},
                                      {"type", type},
                                      {"motor", 0},
                                      {"value", 0}});
  }

  VirtualGateway bench;
};

TEST_F(Roles, AreAskedForBeforeAnythingIsDone) {
  for (const auto& method : method_table()) {
    if (method.role == Role::stop) continue;
    bench.caller.role = static_cast<Role>(static_cast<int>(method.role) - 1);
    bench.caller.reason = "the test says so";
    const auto result = bench.call(method.name, {});
    ASSERT_FALSE(result) << method.name;
    const auto& error = result.error();
    EXPECT_EQ(error.kind, ErrorKind::not_now);
    EXPECT_EQ(error.name, "not_permitted");
    EXPECT_EQ(error.outcome, tmcl::Outcome::not_sent);
    EXPECT_THAT(error.message, HasSubstr(std::string(method.name) + " needs the role '" +
                                         std::string(name_of(method.role)) + "'"));
    EXPECT_THAT(error.message, HasSubstr("the test says so"));
    EXPECT_THAT(error.hint, HasSubstr("[[access]]"));
  }
  EXPECT_THAT(bench.wire.seen, IsEmpty());
}

TEST_F(Roles, AreNotAskedForToStop) {
  bench.caller.role = Role::stop;
  EXPECT_EQ(refusal("system.stop_all", {}), "");
  EXPECT_EQ(refusal("axis.stop", {{"axis", "x"}}), "");
  EXPECT_EQ(refused_command("MST"), "");
}

TEST_F(Roles, OfARawCommandGoByWhatItDoes) {
  bench.caller.role = Role::stop;
  EXPECT_EQ(refused_command("GAP", 1), "not_permitted");
  bench.caller.role = Role::observe;
  EXPECT_EQ(refused_command("GAP", 1), "");
  EXPECT_EQ(refused_command("MVP"), "not_permitted");
  EXPECT_EQ(refused_command("SIO"), "not_permitted");
  bench.caller.role = Role::operate;
  for (const auto* command : {"MVP", "ROR", "SIO"}) EXPECT_EQ(refused_command(command), "");
  EXPECT_EQ(refused_command("SAP", 0), "");
  EXPECT_EQ(refused_command("SAP", 4), "not_permitted");
  for (const auto* command : {"STAP", "RSAP", "SGP", "SOFTWARE_RESET", "FACTORY_RESET", "WRITE_MC"})
    EXPECT_EQ(refused_command(command), "not_permitted") << command;
  bench.caller.role = Role::configure;
  EXPECT_EQ(refused_command("SAP", 4), "");
}

TEST_F(Roles, OfAParameterGoByWhetherItMovesTheMotor) {
  const auto set = [&](const char* name) {
    return refusal("parameter.set", {{"axis", "x"}, {"parameter", name}, {"value", 100}});
  };
  bench.caller.role = Role::operate;
  EXPECT_EQ(set("target_position"), "");
  EXPECT_EQ(set("max_velocity"), "not_permitted");
  bench.caller.role = Role::configure;
  EXPECT_EQ(set("max_velocity"), "");
}

// ---- what is audited ---------------------------------------------------------------------------

TEST_F(Roles, MovementsAndSettingsAreAudited) {
  bench.wire.modules.at(1).parameter(0, tmcl::axis_parameter::actual_velocity) = 0;
  bench.call("axis.get_state", {{"axis", "x"}});
  bench.call("module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "GAP"}});
  bench.call("lease.list", {});
  EXPECT_THAT(bench.audited, IsEmpty());
  bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 100}});
  bench.call("parameter.set", {{"axis", "x"}, {"parameter", "max_velocity"}, {"value", 100}});
  bench.caller.role = Role::observe;
  bench.call("axis.stop", {{"axis", "x"}});
  bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 7}, {"unattended", true}});
  bench.call("lease.break", {{"axis", "x"}});
  using testing::StartsWith;
  EXPECT_THAT(
      bench.audited,
      testing::ElementsAre(
          "method=axis.move_to params={\"axis\":\"x\",\"position_microsteps\":100} outcome=done",
          AllOf(StartsWith("method=parameter.set params="), HasSubstr("max_velocity"),
                HasSubstr("outcome=done")),
          "method=axis.stop params={\"axis\":\"x\"} outcome=done",
          AllOf(HasSubstr("\"unattended\":true"),
                HasSubstr("outcome=not_sent error=not_permitted")),
          AllOf(StartsWith("method=lease.break "), HasSubstr("error=not_permitted"))));
}

/// The parameters as the line of the audit has them.
json::object audited_params(const std::string& line) {
  const auto begin = line.find("params=") + 7;
  json::stream_parser parser;
  parser.write_some(line.data() + begin, line.size() - begin);
  return parser.release().as_object();
}

TEST_F(Roles, NoParameterHidesAnotherInTheAudit) {
  const std::string zeros(300, '0');
  const auto words = words_of("axis.move_to", {{"position", zeros + "50000"}, {"axis", "z"}});
  EXPECT_THAT(words, testing::StartsWith("method=axis.move_to params={\"axis\":\"z\","));
  const auto line = words_of("line.move", {{"positions", {zeros, "7mm"}},
                                           {"axes", {zeros, "z"}},
                                           {"deadline_ms", 5},
                                           {"lease", 3},
                                           {"epoch", 12345}});
  const auto said = audited_params(line);
  EXPECT_EQ(said.at("axes").as_array().at(1), "z");
  EXPECT_EQ(said.at("positions").as_array().at(1), "7mm");
  EXPECT_EQ(said.at("deadline_ms"), 5);
  EXPECT_EQ(said.at("lease"), 3);
  EXPECT_THAT(line, testing::Not(HasSubstr("12345"))) << "it proves the lease";
}

TEST_F(Roles, AuditedTextsAreCutBetweenLetters) {
  for (const std::string letter : {"a", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"}) {
    for (std::size_t before = 0; before < 4; ++before) {
      std::string text(before, 'a');
      for (int i = 0; i < 100; ++i) text += letter;
      const auto said = audited_params(words_of("path.run", {{"name", text}}));
      const std::string shown(said.at("name").as_string());
      ASSERT_TRUE(shown.ends_with("...")) << shown;
      EXPECT_EQ((shown.size() - 3 - before) % letter.size(), 0U) << shown;
      EXPECT_LE(shown.size(), 83U);
    }
  }
}

TEST_F(Roles, AQuantityIsShownWholeInTheAudit) {
  const auto moved = [&](const std::string& position) {
    bench.audited.clear();
    bench.call("axis.move_to", {{"axis", "x"}, {"position", position}});
    return bench.audited.empty() ? "" : bench.audited.front();
  };
  const std::string longest = std::string(64 - 14, '0') + "100 microsteps";
  EXPECT_THAT(moved(longest), AllOf(HasSubstr(longest), HasSubstr("outcome=done")));
  EXPECT_THAT(moved("0" + longest), HasSubstr("bad_quantity"));
}

TEST_F(Roles, TheAuditNamesTheLeaseOfACall) {
  bench.client = bench.gateway().add_client("a");
  const auto granted = bench.call("lease.acquire", {{"axes", {"x"}}, {"ttl_ms", 60000}}).value();
  bench.client = bench.gateway().add_client("b");
  json::object params{{"axis", "x"}, {"position_microsteps", 10}};
  params["lease"] = granted.at("lease");
  params["epoch"] = granted.at("epoch");
  bench.audited.clear();
  bench.call("axis.move_to", params);
  ASSERT_EQ(bench.audited.size(), 1U);
  EXPECT_THAT(bench.audited.front(), testing::EndsWith(" outcome=done lease=1"));
}

}  // namespace
}  // namespace tmcld::test
