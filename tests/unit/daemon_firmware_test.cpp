// New firmware through the daemon: how an image is handed over, and what others are told meanwhile.
#include <gmock/gmock.h>

#include "support/bootable.hpp"
#include "support/intel_hex.hpp"
#include "tmcl/hex.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;
using tmcl::FirmwareVersion;

constexpr std::size_t size = 700;

class DaemonFirmware : public DaemonTest {
 protected:
  DaemonFirmware() {
    daemon.on_reactor([&] {
      module.be_played_by(daemon.wire().modules.at(1));
      return 0;
    });
  }
  ~DaemonFirmware() override { daemon.end(); }

  json::object stage(RpcClient& from, std::size_t offset, std::span<const std::uint8_t> part) {
    return from.answer_to(
        from.send("firmware.stage", {{"offset", offset}, {"data", tmcl::to_hex(part)}}));
  }
  void stage(RpcClient& from) {
    const std::span all(bytes);
    EXPECT_EQ(stage(from, 0, all.first(300)).at("result").at("bytes"), 300);
    EXPECT_EQ(stage(from, 300, all.subspan(300)).at("result").at("bytes"), size);
  }
  int send_upload(RpcClient& from, json::object params = {}) {
    params["bus"] = "bench";
    params["address"] = 1;
    params["start"] = tmcl::sim::Flash::start;
    if (!params.contains("bytes")) params["bytes"] = size;
    return from.send("firmware.upload", std::move(params));
  }
  json::object status() {
    return client.result("firmware.status", {{"bus", "bench"}, {"address", 1}});
  }
  static json::object error_in(const json::object& answer) {
    return answer.at("error").at("data").as_object();
  }
  /// Called on the daemon's thread before the module executes the first of this command.
  void when(Command command, std::function<void()> act) {
    daemon.on_reactor([&] {
      daemon.wire().modules.at(1).before = [command, act = std::move(act), done = false](
                                               FakeModule&, const tmcl::Request& request) mutable {
        if (request.command == command && !std::exchange(done, true)) act();
      };
      return 0;
    });
  }

  tmcl::test::Bootable module;
  std::vector<std::uint8_t> bytes = tmcl::test::firmware_bytes(size, "3110V123");
};

TEST_F(DaemonFirmware, IsHandedOverInPartsAndUploaded) {
  EXPECT_EQ(text(status().at("running")), "3110V109");
  stage(client);
  const auto done = client.answer_to(send_upload(client)).at("result").as_object();
  EXPECT_EQ(text(done.at("model")), "TMCM-3110");
  EXPECT_EQ(text(done.at("before")), "3110V109");
  EXPECT_EQ(text(done.at("running")), "3110V123");
  EXPECT_EQ(done.at("checksum"), checksum(tmcl::firmware::Image{0, bytes}));
  EXPECT_EQ(text(status().at("running")), "3110V123");
  EXPECT_FALSE(status().at("in_bootloader").as_bool());
  EXPECT_TRUE(daemon.eventually([&] {
    const auto* known = daemon.daemon().gateway().buses()[0]->find_module(tmcl::ModuleAddress{1});
    return known->identity()->version == FirmwareVersion{3110, 1, 23};
  })) << "the daemon has asked the module again what it is";
}

TEST_F(DaemonFirmware, APathIsNotTakenForAnImage) {
  const auto hand_over_path = [&] {
    return client.result("path.stage", {{"offset", 0}, {"data", tmcl::to_hex(bytes)}});
  };
  EXPECT_EQ(hand_over_path().at("bytes"), size);
  const auto error = client.answer_to(send_upload(client)).at("error").as_object();
  EXPECT_EQ(text(error.at("data").at("name")), "bad_argument");
  EXPECT_EQ(text(error.at("message")), "of an image of this client there are 0 bytes, and not 700");
  EXPECT_EQ(text(status().at("running")), "3110V109");
  // Nor do parts of both become one, and neither takes the other's place.
  stage(client, 0, std::span(bytes).first(300));
  hand_over_path();
  EXPECT_EQ(stage(client, 300, std::span(bytes).subspan(300)).at("result").at("bytes"), size);
  EXPECT_EQ(text(client.answer_to(send_upload(client)).at("result").at("running")), "3110V123");
}

TEST_F(DaemonFirmware, TellsItsProgress) {
  stage(client);
  const auto id = send_upload(client);
  std::vector<std::string> phases;
  while (true) {
    const auto message = client.read();
    ASSERT_TRUE(message.is_object()) << "no answer";
    if (message.as_object().contains("result")) break;
    const auto& params = message.at("params");
    EXPECT_EQ(params.at("id"), id);
    EXPECT_EQ(params.at("of"), size);
    if (phases.empty() || phases.back() != text(params.at("phase")))
      phases.push_back(text(params.at("phase")));
  }
  EXPECT_THAT(phases, testing::ElementsAre("stopping the motors", "entering the bootloader",
                                           "erasing", "writing", "comparing", "starting"));
}

TEST_F(DaemonFirmware, AStopOfAnotherClientIsToldWhyItIsOfNoUse) {
  RpcClient other(daemon.socket());
  std::atomic<int> stop = -1;
  std::atomic<int> stop_all = -1;
  std::atomic<int> state = -1;
  when(Command::BOOT_WRITE_BUFFER, [&] {
    stop = other.send("axis.stop", {{"axis", "x"}});
    stop_all = other.send("system.stop_all");
    state = other.send("axis.get_state", {{"axis", "y"}});
  });
  stage(client);
  EXPECT_TRUE(client.answer_to(send_upload(client)).contains("result"));
  for (const int id : {stop.load(), state.load()}) {
    const auto error = error_in(other.answer_to(id));
    EXPECT_EQ(text(error.at("name")), "in_bootloader");
    EXPECT_EQ(text(error.at("outcome")), "not_sent");
    EXPECT_EQ(error.at("address"), 1);
  }
  const auto all = other.answer_to(stop_all).at("result").as_object();
  EXPECT_TRUE(all.at("stopped").as_array().empty());
  // The module has a motor besides the axes.
  ASSERT_EQ(all.at("failed").as_array().size(), 3U);
  EXPECT_EQ(text(all.at("failed").at(0).at("error").at("data").at("name")), "in_bootloader");
}

TEST_F(DaemonFirmware, GoesOnWhenItsClientGoes) {
  auto gone = std::make_unique<RpcClient>(daemon.socket());
  std::atomic<bool> is_writing = false;
  when(Command::BOOT_WRITE_BUFFER, [&] { is_writing = true; });
  stage(*gone);
  send_upload(*gone);
  ASSERT_TRUE(daemon.eventually([&] { return is_writing.load(); }));
  gone.reset();
  EXPECT_TRUE(daemon.eventually([&] {
    return !module.in_bootloader && module.runs() == FirmwareVersion{3110, 1, 23};
  }));
}

TEST_F(DaemonFirmware, TheEndOfTheDaemonWaitsForIt) {
  RpcClient other(daemon.socket());
  std::atomic<int> stop_of_other = -1;
  std::atomic<int> upload_of_other = -1;
  when(Command::BOOT_WRITE_BUFFER, [&] { daemon.daemon().stop(); });
  // The daemon has taken notice by now.
  daemon.on_reactor([&] {
    auto& fake = daemon.wire().modules.at(1);
    fake.before = [&, stop = std::move(fake.before), done = false](
                      FakeModule& self, const tmcl::Request& request) mutable {
      stop(self, request);
      if (request.command != Command::BOOT_WRITE_PAGE || std::exchange(done, true)) return;
      upload_of_other = send_upload(other);
      stop_of_other = other.send("axis.stop", {{"axis", "x"}});
    };
    return 0;
  });
  stage(client);
  const auto answer = client.answer_to(send_upload(client));
  ASSERT_TRUE(answer.contains("result")) << answer;
  EXPECT_EQ(text(answer.at("result").at("running")), "3110V123");
  EXPECT_EQ(text(error_in(other.answer_to(upload_of_other)).at("name")), "daemon_ending");
  EXPECT_EQ(text(error_in(other.answer_to(stop_of_other)).at("name")), "in_bootloader")
      << "still served";
}

TEST_F(DaemonFirmware, AnEndThatComesBeforeTheEraseLeavesTheOldFirmwareRunning) {
  for (const auto early : {Command::GET_FIRMWARE_VERSION, Command::BOOT_GET_INFO}) {
    SCOPED_TRACE(name_of(early));
    tmcl::test::Bootable here;
    TestDaemon ending;
    here.be_played_by(ending.wire().modules.at(1));
    ending.start();
    RpcClient from(ending.socket());
    stage(from);
    ending.on_reactor([&] {
      ending.wire().modules.at(1).before = [&](FakeModule&, const tmcl::Request& request) {
        if (request.command == early) ending.daemon().stop();
      };
      return 0;
    });
    const auto answer = from.answer_to(send_upload(from));
    ASSERT_TRUE(answer.contains("error")) << answer;
    EXPECT_EQ(text(answer.at("error").at("message")), "the daemon is ending");
    EXPECT_EQ(text(error_in(answer).at("outcome")), "not_sent");
    ending.end();
    EXPECT_EQ(std::ranges::count(here.changes, Command::BOOT_ERASE_ALL), 0);
    EXPECT_FALSE(here.in_bootloader);
    EXPECT_EQ(here.runs(), (FirmwareVersion{3110, 1, 9}));
  }
}

TEST_F(DaemonFirmware, AnImageThatIsNotThereAsAWholeIsNotUploaded) {
  const auto without = client.answer_to(send_upload(client));
  EXPECT_EQ(text(error_in(without).at("param")), "bytes");
  stage(client);
  const auto half = client.answer_to(send_upload(client, {{"bytes", size + 1}}));
  EXPECT_EQ(text(error_in(half).at("name")), "bad_argument");
  EXPECT_THAT(text(half.at("error").at("message")), HasSubstr("there are 700 bytes, and not 701"));
  EXPECT_TRUE(client.answer_to(send_upload(client)).contains("result"));
  const auto again = client.answer_to(send_upload(client));
  EXPECT_EQ(text(error_in(again).at("name")), "bad_argument") << "it was taken";
}

TEST_F(DaemonFirmware, PartsThatDoNotFitTogetherAreRefused) {
  const std::span all(bytes);
  EXPECT_EQ(text(error_in(stage(client, 5, all)).at("param")), "offset");
  stage(client, 0, all.first(10));
  EXPECT_EQ(text(error_in(stage(client, 11, all)).at("param")), "offset");
  EXPECT_EQ(stage(client, 10, all.first(1)).at("result").at("bytes"), 11);
  const auto nonsense =
      client.answer_to(client.send("firmware.stage", {{"offset", 11}, {"data", "0g"}}));
  EXPECT_EQ(text(error_in(nonsense).at("param")), "data");
  EXPECT_EQ(stage(client, 0, all.first(3)).at("result").at("bytes"), 3) << "begins again";
}

TEST_F(DaemonFirmware, ANewerImageOfAnotherClientTakesThePlace) {
  RpcClient other(daemon.socket());
  stage(client);
  stage(other);
  EXPECT_EQ(text(error_in(client.answer_to(send_upload(client))).at("name")), "bad_argument");
  EXPECT_TRUE(other.answer_to(send_upload(other)).contains("result"));
}

TEST_F(DaemonFirmware, AnImageHasAnEnd) {
  const std::vector<std::uint8_t> part(25'000, 0x55);
  std::size_t offset = 0;
  json::object answer;
  do {
    answer = stage(client, offset, part);
    offset += part.size();
    ASSERT_LE(offset, tmcl::firmware::most_image_bytes + part.size());
  } while (answer.contains("result"));
  EXPECT_EQ(text(error_in(answer).at("name")), "out_of_range");
}

TEST_F(DaemonFirmware, ForAnotherModelIsRefused) {
  bytes = tmcl::test::firmware_bytes(size, "1110V123");
  stage(client);
  const auto answer = client.answer_to(send_upload(client));
  EXPECT_THAT(text(answer.at("error").at("message")), HasSubstr("module 1 is a TMCM-3110"));
  EXPECT_TRUE(module.changes.empty());
}

// ---- modules that were left in their bootloader ----

class DaemonBootloader : public testing::Test {
 protected:
  DaemonBootloader() {
    module.be_played_by(daemon.wire().modules.at(1));
    module.in_bootloader = true;
    daemon.start(false);
    client = std::make_unique<RpcClient>(daemon.socket());
  }
  ~DaemonBootloader() override { daemon.end(); }
  bool comes_to_be(GatewayModule::State state) {
    return daemon.eventually(
        [&] { return daemon.daemon().gateway().axes()[0]->module().state() == state; });
  }

  tmcl::test::Bootable module;
  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

TEST_F(DaemonBootloader, AreToldOf) {
  ASSERT_TRUE(comes_to_be(GatewayModule::State::in_bootloader));
  const auto row = client->result("module.list").at("modules").at(0).as_object();
  EXPECT_EQ(text(row.at("state")), "in_bootloader");
  EXPECT_EQ(text(row.at("model")), "TMCM-3110");
  EXPECT_EQ(text(client->result("axis.list").at("axes").at(0).at("state")), "in_bootloader");
  const auto found = client->result("bus.scan", {{"last", 2}}).at("modules").at(0).as_object();
  EXPECT_EQ(found.at("in_bootloader"), true);
  EXPECT_EQ(
      text(client->result("firmware.status", {{"bus", "bench"}, {"address", 1}}).at("running")),
      "3110B101");
}

TEST_F(DaemonBootloader, NoVerbIsSentToTheirAxesButStops) {
  ASSERT_TRUE(comes_to_be(GatewayModule::State::in_bootloader));
  const std::vector<std::pair<std::string, json::object>> verbs{
      {"axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}},
      {"axis.rotate", {{"axis", "x"}, {"velocity_internal", 1}}},
      {"axis.wait", {{"axis", "x"}}},
      {"axis.home", {{"axis", "x"}}},
      {"axis.get_state", {{"axis", "x"}}},
      {"parameter.get", {{"axis", "x"}, {"parameter", "max_velocity"}}},
      {"parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1}}},
  };
  for (const auto& [method, params] : verbs) {
    const auto error = client->error(method, params);
    EXPECT_EQ(text(error.at("data").at("name")), "in_bootloader") << method;
    EXPECT_EQ(text(error.at("data").at("outcome")), "not_sent") << method;
    EXPECT_THAT(text(error.at("message")), HasSubstr("no firmware runs")) << method;
    EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("tmclctl firmware upload")) << method;
  }
  for (const auto command : {Command::MVP, Command::ROR, Command::RFS, Command::SAP})
    EXPECT_EQ(daemon.requests_seen(command), 0U) << name_of(command);
  EXPECT_EQ(text(client->error("axis.stop", {{"axis", "x"}}).at("data").at("name")),
            "refused_by_module");
  EXPECT_EQ(daemon.requests_seen(Command::MST), 1U);
}

TEST_F(DaemonBootloader, AreServedWhenTheyRunAFirmwareAgain) {
  ASSERT_TRUE(comes_to_be(GatewayModule::State::in_bootloader));
  client->result("subscribe", {{"interval_ms", 60'000}});
  daemon.on_reactor([&] { return std::exchange(module.in_bootloader, false); });
  ASSERT_TRUE(comes_to_be(GatewayModule::State::ready));
  EXPECT_EQ(text(client->notification("notify_event").at("kind")), "module_answers");
  EXPECT_EQ(client->result("axis.get_state", {{"axis", "x"}}).at("axis"), "x");
}

}  // namespace
}  // namespace tmcld::test
