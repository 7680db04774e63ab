// New firmware for a module: every datagram of it failing in every way, and every refusal.
#include "tmcl/firmware_verbs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/bootable.hpp"
#include "support/intel_hex.hpp"
#include "support/scripted_bus.hpp"

namespace tmcl {
namespace {

using sim::Flash;
using test::Fault;
using test::ScriptedBus;
using testing::HasSubstr;

constexpr ModuleAddress address{1};

// A bit more than a page.
firmware::Image image(std::string_view version = "3110V123",
                      std::size_t size = Flash::page_size + 90) {
  return {Flash::start, test::firmware_bytes(size, version)};
}

/// A bus with one module that has a bootloader.
class Bench : public test::Bootable {
 public:
  explicit Bench(Framing framing = Framing::serial) : bus(framing, {.name = "bench"}) {
    be_played_by(bus.add_module(1));
  }

  Result<FirmwareReport> upload(const FirmwareOptions& options = {}) {
    return upload(image(), options);
  }
  Result<FirmwareReport> upload(const firmware::Image& what, const FirmwareOptions& options = {}) {
    return bus.run(verbs::upload_firmware(address, what, options));
  }
  /// Called once, before the module executes the first request of this command.
  void when(Command command, std::function<void()> act) {
    bus.module(1).before = [command, act = std::move(act), done = false](
                               test::FakeModule&, const Request& request) mutable {
      if (request.command == command && !std::exchange(done, true)) act();
    };
  }

  ScriptedBus bus;
};

TEST(FirmwareUpload, TheNewFirmwareRunsAfterwards) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    Bench bench(framing);
    std::vector<std::string> steps;
    FirmwareOptions options;
    options.progress = [&](const FirmwareProgress& progress) {
      EXPECT_EQ(progress.of, image().bytes.size());
      if (steps.empty() || steps.back() != progress.step) steps.emplace_back(progress.step);
    };
    const auto report = bench.upload(options);
    ASSERT_TRUE(report) << describe(report.error());
    EXPECT_EQ(report->after, (FirmwareVersion{3110, 1, 23}));
    EXPECT_EQ(report->before.running, (FirmwareVersion{3110, 1, 9}));
    EXPECT_EQ(report->before.version, (FirmwareVersion{3110, 1, 23}));
    EXPECT_FALSE(report->before.in_bootloader);
    EXPECT_EQ(report->checksum, firmware::checksum(image()));
    EXPECT_FALSE(bench.in_bootloader);
    EXPECT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 23}));
    EXPECT_THAT(steps, testing::ElementsAre("stopping the motors", "entering the bootloader",
                                            "erasing", "writing", "comparing", "starting"));
  }
}

TEST(FirmwareUpload, AnyLengthArrivesWhole) {
  for (const std::size_t size : {16U, 17U, 18U, 19U, 511U, 512U, 513U, 1024U}) {
    Bench bench;
    const auto report = bench.upload(image("3110V123", size));
    ASSERT_TRUE(report) << size << ": " << describe(report.error());
    EXPECT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 23})) << size;
  }
}

TEST(FirmwareUpload, PagesWithoutAnythingInThemAreNotWritten) {
  Bench bench;
  auto gappy = image("3110V123", 5 * Flash::page_size);
  std::fill_n(gappy.bytes.begin() + Flash::page_size, Flash::page_size, firmware::erased_byte);
  ASSERT_TRUE(bench.upload(gappy));
  EXPECT_EQ(std::ranges::count(bench.changes, Command::BOOT_WRITE_PAGE), 4);
}

TEST(FirmwareUpload, MotorsStandBeforeItBegins) {
  Bench bench;
  int looks = 0;
  bench.bus.module(1).before = [&](test::FakeModule& self, const Request& request) {
    if (request.command == Command::GAP) {
      self.parameter(1, axis_parameter::actual_velocity) = ++looks < 10 ? 500 : 0;
    }
    if (request.command == Command::ENTER_BOOTLOADER) {
      EXPECT_GE(looks, 10);
    }
  };
  ASSERT_TRUE(bench.upload());
}

TEST(FirmwareUpload, AMotorThatDoesNotStopIsAReasonNotToBegin) {
  Bench bench;
  bench.bus.module(1).before = [&](test::FakeModule& self, const Request&) {
    self.parameter(2, axis_parameter::actual_velocity) = 7;
  };
  const auto report = bench.upload();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("motor 2 does not come to a stop"));
  EXPECT_THAT(report.error().hint, HasSubstr("nothing was changed"));
  EXPECT_FALSE(bench.in_bootloader);
}

TEST(FirmwareUpload, AnImageForAnotherModelIsRefused) {
  Bench bench;
  const auto other = bench.upload(image("1110V142"));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, Errc::bad_argument);
  EXPECT_EQ(other.error().message, "the image is for 1110V142; module 1 is a TMCM-3110");
  const auto nameless = bench.upload(image(""));
  ASSERT_FALSE(nameless);
  EXPECT_THAT(nameless.error().message, HasSubstr("does not say for which model it is"));
  EXPECT_TRUE(bench.changes.empty());
  EXPECT_FALSE(bench.in_bootloader);
}

TEST(FirmwareUpload, ForceTakesAnImageThatDoesNotSayWhatItIs) {
  Bench bench;
  FirmwareOptions options;
  options.force = true;
  const auto report = bench.upload(image(""), options);
  ASSERT_TRUE(report) << describe(report.error());
  EXPECT_EQ(report->before.version, std::nullopt);
}

TEST(FirmwareUpload, AnImageThatDoesNotFitLeavesTheOldFirmwareRunning) {
  for (auto wrong : {image(), image("3110V123", Flash::size + 1)}) {
    if (wrong.bytes.size() < Flash::size) wrong.start = 0x08000000;
    Bench bench;
    const auto report = bench.upload(wrong);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, Errc::bad_argument);
    EXPECT_THAT(report.error().hint, HasSubstr("runs its firmware as before"));
    EXPECT_FALSE(bench.in_bootloader);
    EXPECT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 9}));
  }
}

TEST(FirmwareUpload, AnObjectionBeforeTheEraseLeavesTheOldFirmwareRunning) {
  constexpr int questions = 2;  // before the motors are stopped, and before the erase
  for (int refused = 1; refused <= questions; ++refused) {
    Bench bench;
    FirmwareOptions options;
    options.objection = [&, asked = 0]() mutable -> std::optional<Error> {
      if (++asked < refused) return std::nullopt;
      return bad_argument("not now");
    };
    const auto report = bench.upload(options);
    ASSERT_FALSE(report) << refused;
    EXPECT_EQ(report.error().message, "not now");
    EXPECT_EQ(std::ranges::count(bench.changes, Command::BOOT_ERASE_ALL), 0);
    EXPECT_EQ(std::ranges::count(bench.bus.sent(), Command::MST, &Request::command),
              refused == 1 ? 0 : 3);
    EXPECT_FALSE(bench.in_bootloader);
    EXPECT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 9}));
  }
}

TEST(FirmwareUpload, AnObjectionIsOfNoUseOnceTheFirmwareIsErased) {
  Bench bench;
  FirmwareOptions options;
  options.objection = [&]() -> std::optional<Error> {
    if (bench.changes.empty()) return std::nullopt;
    return bad_argument("too late");
  };
  EXPECT_TRUE(bench.upload(options));
}

TEST(FirmwareUpload, GoesOnInAModuleThatIsInItsBootloader) {
  Bench bench;
  bench.in_bootloader = true;
  bench.bootloader.execute({address, Command::BOOT_ERASE_ALL});
  const auto report = bench.upload();
  ASSERT_TRUE(report) << describe(report.error());
  EXPECT_TRUE(report->before.in_bootloader);
  EXPECT_EQ(report->after, (FirmwareVersion{3110, 1, 23}));
}

TEST(FirmwareUpload, AModuleThatDoesNotLeaveItsFirmwareIsToldOf) {
  Bench bench;
  bench.enters = false;
  const auto report = bench.upload();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("the module did not leave its firmware"));
  EXPECT_THAT(report.error().hint, HasSubstr("nothing was changed"));
}

TEST(FirmwareUpload, AFirmwareThatDoesNotStartIsToldOf) {
  Bench bench;
  bench.starts = false;
  const auto report = bench.upload();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("the firmware did not start"));
  EXPECT_THAT(report.error().hint, HasSubstr("power"));
}

TEST(FirmwareUpload, EveryRefusalNamesItsStepAndTheStateOfTheModule) {
  struct Case {
    Command command;
    std::string message;
    std::string hint;
  };
  const std::vector<Case> cases{
      {Command::BOOT_ERASE_ALL, "erasing: refused", "start the same upload again"},
      {Command::BOOT_WRITE_BUFFER, "writing: refused", "start the same upload again"},
      {Command::BOOT_WRITE_PAGE, "writing: refused", "start the same upload again"},
      {Command::BOOT_GET_CHECKSUM, "comparing: refused", "start the same upload again"},
      {Command::BOOT_WRITE_LENGTH, "writing length and checksum: refused", "same upload again"},
  };
  for (const auto& expected : cases) {
    Bench bench;
    bench.refuse = [&](const Request& request) {
      return request.command == expected.command ? std::optional(Status::invalid_value)
                                                 : std::nullopt;
    };
    const auto report = bench.upload();
    ASSERT_FALSE(report) << expected.message;
    EXPECT_THAT(report.error().message, HasSubstr(expected.message));
    EXPECT_THAT(report.error().hint, HasSubstr(expected.hint));
    EXPECT_EQ(report.error().outcome, Outcome::unknown) << expected.message;
    bench.refuse = nullptr;
    EXPECT_TRUE(bench.upload()) << expected.message;
  }
}

TEST(FirmwareUpload, AWrongChecksumIsNotTrusted) {
  Bench bench;
  bool spoilt = false;
  bench.bus.module(1).before = [&](test::FakeModule&, const Request& request) {
    if (request.command != Command::BOOT_GET_CHECKSUM || std::exchange(spoilt, true)) return;
    bench.bootloader.execute({address, Command::BOOT_WRITE_BUFFER});
    bench.bootloader.execute({address, Command::BOOT_WRITE_PAGE, 0, 0, Flash::start});
  };
  const auto report = bench.upload();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("has the checksum 0x"));
  EXPECT_FALSE(bench.bootloader.has_firmware());
  EXPECT_TRUE(bench.upload());
}

TEST(FirmwareUpload, OlderBootloadersFindLengthAndSumInTheLastPage) {
  Bench bench;
  bench.refuse = [](const Request& request) {
    return request.command == Command::BOOT_WRITE_LENGTH ? std::optional(Status::invalid_command)
                                                         : std::nullopt;
  };
  const auto report = bench.upload();
  ASSERT_TRUE(report) << describe(report.error());
  EXPECT_EQ(report->after, (FirmwareVersion{3110, 1, 23}));
}

TEST(FirmwareUpload, TwoModulesOfOneAddressAreAReasonNotToBegin) {
  Bench bench;
  bool first = true;
  bench.bus.module(1).before = [&](test::FakeModule&, const Request& request) {
    if (request.command != Command::GET_FIRMWARE_VERSION || !std::exchange(first, false)) return;
    bench.bus.clock().advance(std::chrono::milliseconds(1));
    bench.bus.deliver({default_host_address, 1, Status::ok, request.command, 0x0C260109});
  };
  const auto report = bench.upload();
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("more than one module seems to answer"));
  EXPECT_TRUE(bench.changes.empty());
}

// Whatever gets lost: the module runs the new firmware, or it says what to do, and that helps.
TEST(FirmwareUpload, EveryDatagramMayFailInEveryWay) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    Bench whole(framing);
    ASSERT_TRUE(whole.upload());
    const auto datagrams = whole.bus.sent().size();
    // In the middle there are many words, one like the other.
    const auto step = [&](std::size_t at) { return at > 40 && at + 40 < datagrams ? 7U : 1U; };
    for (std::size_t datagram = 0; datagram < datagrams; datagram += step(datagram)) {
      for (const auto fault : test::all_faults) {
        Bench bench(framing);
        bench.bus.fail(datagram, fault);
        const auto report = bench.upload();
        const auto what = name_of(fault) + " at " + std::to_string(datagram);
        if (report) {
          ASSERT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 23})) << what;
          ASSERT_FALSE(bench.in_bootloader) << what;
          continue;
        }
        ASSERT_FALSE(report.error().hint.empty()) << what;
        const auto again = bench.upload();
        ASSERT_TRUE(again) << what << ": " << describe(report.error()) << "\nand then "
                           << describe(again.error());
        ASSERT_EQ(bench.runs(), (FirmwareVersion{3110, 1, 23})) << what;
      }
    }
  }
}

// And a module that says nothing more from some point on.
TEST(FirmwareUpload, SilenceFromAnyPointOnEndsWithAHint) {
  Bench whole;
  ASSERT_TRUE(whole.upload());
  const auto datagrams = whole.bus.sent().size();
  for (std::size_t last = 0; last < datagrams; last += last < 30 ? 1 : 17) {
    Bench bench;
    bench.bus.chance = [&](std::size_t datagram) {
      return datagram >= last ? std::optional(Fault::lost_request) : std::nullopt;
    };
    const auto report = bench.upload();
    ASSERT_FALSE(report) << last;
    EXPECT_FALSE(report.error().hint.empty()) << last;
    bench.bus.chance = nullptr;
    bench.bus.pass(std::chrono::seconds(3));
    const auto again = bench.upload();
    ASSERT_TRUE(again) << last << ": " << describe(again.error());
  }
}

// ---- others on the same bus ----

constexpr Request read_by_other{address, Command::GAP, 1, 0, 0};
constexpr Request stop_by_other{address, Command::MST, 0, 2, 0};
constexpr Request move_by_other{address, Command::MVP, 0, 0, 777};

TEST(FirmwareUpload, OthersEndAtOnceWhileTheModuleIsInItsBootloader) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (const auto during : {Command::BOOT_ERASE_ALL, Command::BOOT_WRITE_BUFFER,
                              Command::BOOT_GET_CHECKSUM, Command::BOOT_WRITE_LENGTH}) {
      Bench bench(framing);
      std::vector<engine::Ticket> others;
      bench.when(during, [&] {
        for (const auto& request : {read_by_other, stop_by_other, move_by_other})
          others.push_back(bench.bus.submit(request));
      });
      const auto report = bench.upload();
      ASSERT_TRUE(report) << describe(report.error());
      ASSERT_EQ(others.size(), 3U);
      for (const auto other : others) {
        ASSERT_TRUE(bench.bus.has_ended(other));
        const auto& answer = bench.bus.result(other);
        ASSERT_FALSE(answer);
        EXPECT_EQ(answer.error().code, Errc::in_bootloader);
        EXPECT_EQ(answer.error().outcome, Outcome::not_sent);
        EXPECT_THAT(answer.error().message, HasSubstr("module 1 is in its bootloader"));
      }
      EXPECT_EQ(std::ranges::count(bench.bus.sent(), move_by_other), 0);
      EXPECT_EQ(std::ranges::count(bench.bus.sent(), stop_by_other), 1) << "its own, before";
    }
  }
}

// A motor that somebody starts once more would turn while the module has no firmware.
TEST(FirmwareUpload, NobodyStartsAMotorBetweenItsStopAndTheBootloader) {
  Bench bench;
  std::optional<engine::Ticket> other;
  bench.when(Command::MST, [&] { other = bench.bus.submit(move_by_other); });
  ASSERT_TRUE(bench.upload());
  ASSERT_TRUE(other && bench.bus.has_ended(*other));
  ASSERT_FALSE(bench.bus.result(*other));
  EXPECT_EQ(bench.bus.result(*other).error().code, Errc::in_bootloader);
  EXPECT_EQ(std::ranges::count(bench.bus.sent(), move_by_other), 0);
}

TEST(FirmwareUpload, AStopBeforeTheBootloaderGoesOut) {
  Bench bench;
  std::optional<engine::Ticket> other;
  bench.when(Command::MST, [&] { other = bench.bus.submit(stop_by_other); });
  ASSERT_TRUE(bench.upload());
  ASSERT_TRUE(other && bench.bus.has_ended(*other));
  EXPECT_TRUE(bench.bus.result(*other));
}

TEST(FirmwareUpload, AStopIsOfUseAgainWhenTheFirmwareStarts) {
  Bench bench;
  std::optional<engine::Ticket> other;
  bench.when(Command::BOOT_START_APPLICATION, [&] { other = bench.bus.submit(stop_by_other); });
  ASSERT_TRUE(bench.upload());
  ASSERT_TRUE(other && bench.bus.has_ended(*other));
  EXPECT_TRUE(bench.bus.result(*other));
}

TEST(FirmwareUpload, OtherModulesOfTheBusGoOn) {
  Bench bench;
  bench.bus.add_module(2);
  std::optional<engine::Ticket> other;
  bench.when(Command::BOOT_WRITE_PAGE, [&] {
    other = bench.bus.submit({ModuleAddress{2}, Command::MST, 0, 0, 0});
  });
  ASSERT_TRUE(bench.upload());
  ASSERT_TRUE(other && bench.bus.has_ended(*other));
  EXPECT_TRUE(bench.bus.result(*other));
}

TEST(FirmwareUpload, EndsTheHoldHoweverItEnds) {
  Bench bench;
  bench.refuse = [](const Request& request) {
    return request.command == Command::BOOT_WRITE_PAGE ? std::optional(Status::invalid_value)
                                                       : std::nullopt;
  };
  ASSERT_FALSE(bench.upload());
  const auto answer = bench.bus.run(verbs::command(stop_by_other));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, Errc::refused_by_module) << "the bootloader itself";
}

TEST(FirmwareUpload, AScanByOthersLeavesTheModuleOut) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    Bench bench(framing);
    bench.bus.add_module(2);
    const auto hold = std::make_shared<const Hold>();
    const CallOptions holding{.hold = hold, .in_bootloader = true};
    ASSERT_TRUE(bench.bus.run(verbs::command(read_by_other, holding)));
    ScanOptions options;
    options.last = 3;
    const auto found = bench.bus.run(verbs::scan(options));
    ASSERT_TRUE(found) << describe(found.error());
    ASSERT_EQ(found->size(), 1U);
    EXPECT_EQ(found->front().address, ModuleAddress{2});
  }
}

TEST(FirmwareMatchTest, LooksWithoutChangingAnything) {
  Bench bench;
  const auto match = bench.bus.run(verbs::match_firmware(address, image("1110V142")));
  ASSERT_TRUE(match);
  EXPECT_EQ(match->model, 3110);
  EXPECT_FALSE(match->version);
  EXPECT_EQ(match->offered, std::vector{(FirmwareVersion{1110, 1, 42})});
  for (const auto& request : bench.bus.sent())
    EXPECT_EQ(effect_of(request.command, request.type), Effect::reads);
}

TEST(FirmwareMatchTest, KnowsABootloader) {
  Bench bench;
  bench.in_bootloader = true;
  const auto match = bench.bus.run(verbs::match_firmware(address, image()));
  ASSERT_TRUE(match);
  EXPECT_TRUE(match->in_bootloader);
  EXPECT_EQ(match->running, (FirmwareVersion{3110, 1, 1, true}));
  EXPECT_EQ(match->version, (FirmwareVersion{3110, 1, 23}));
}

TEST(Identifying, SaysThatOnlyABootloaderAnswers) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (const bool says_nothing_to_motors : {false, true}) {
      Bench bench(framing);
      bench.in_bootloader = true;
      bench.bus.chance = [&](std::size_t) {
        const bool lost = says_nothing_to_motors && bench.bus.sent().back().command == Command::GAP;
        return lost ? std::optional(Fault::lost_request) : std::nullopt;
      };
      const auto found = bench.bus.run(verbs::identify(address));
      ASSERT_TRUE(found) << describe(found.error());
      EXPECT_EQ(found->version, (FirmwareVersion{3110, 1, 1, true}));
      EXPECT_EQ(found->model, "TMCM-3110");
      EXPECT_TRUE(bench.changes.empty());
    }
  }
}

// What a firmware says to a question that only bootloaders know is not worth asking for.
TEST(Identifying, AsksAFirmwareNothingThatIsForBootloaders) {
  Bench bench;
  const auto found = bench.bus.run(verbs::identify(address));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->version, (FirmwareVersion{3110, 1, 9}));
  EXPECT_EQ(std::ranges::count(bench.bus.sent(), Command::BOOT_GET_INFO, &Request::command), 0);
}

TEST(Identifying, AFirmwareThatKnowsNoSuchMotorIsNoBootloader) {
  for (const auto status : {Status::wrong_type, Status::invalid_value, Status::invalid_command}) {
    Bench bench;
    bench.bus.module(1).refuse = [status](const Request& request) {
      return request.command == Command::GAP ? std::optional(status) : std::nullopt;
    };
    const auto found = bench.bus.run(verbs::identify(address));
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->version.bootloader) << static_cast<int>(status);
  }
}

}  // namespace
}  // namespace tmcl
