// New firmware for a module: every datagram of it failing in every way, and every refusal.
#include "tmcl/firmware_verbs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/module/bootloader.hpp"
#include "support/intel_hex.hpp"
#include "support/scripted_bus.hpp"

namespace tmcl {
namespace {

using sim::Bootloader;
using sim::Flash;
using test::Fault;
using test::ScriptedBus;
using testing::AllOf;
using testing::HasSubstr;

constexpr ModuleAddress address{1};

// A bit more than a page.
firmware::Image image(std::string_view version = "3110V123",
                      std::size_t size = Flash::page_size + 90) {
  return {Flash::start, test::firmware_bytes(size, version)};
}

/// A bus with one TMCM-3110, firmware 1.09, that has a bootloader.
class Bench {
 public:
  explicit Bench(Framing framing = Framing::serial) : bus(framing, {.name = "bench"}) {
    auto& module = bus.add_module(1);
    module.play = [this](const Request& request) { return play(request); };
    for (std::uint8_t motor = 0; motor < 3; ++motor)
      module.parameter(motor, axis_parameter::actual_velocity) = 0;
  }

  Result<FirmwareReport> upload(const FirmwareOptions& options = {}) {
    return upload(image(), options);
  }
  Result<FirmwareReport> upload(const firmware::Image& what, const FirmwareOptions& options = {}) {
    return bus.run(verbs::upload_firmware(address, what, options));
  }
  FirmwareVersion runs() const { return bootloader.firmware_version({}); }

  ScriptedBus bus;
  Bootloader bootloader{3110, {3110, 1, 9}};
  bool in_bootloader = false;
  bool enters = true;
  bool starts = true;
  /// What the bootloader answers instead.
  std::function<std::optional<Status>(const Request&)> refuse;
  std::vector<Command> changes;  ///< Commands to the bootloader that change something.

 private:
  std::optional<Reply> play(const Request& request) {
    Reply reply{default_host_address, 1, Status::ok, request.command, request.value};
    if (!in_bootloader) return play_firmware(request, reply);
    if (const auto status = refuse ? refuse(request) : std::nullopt) {
      reply.status = *status;
      return reply;
    }
    if (effect_of(request.command, request.type) != Effect::reads)
      changes.push_back(request.command);
    const auto answer = bootloader.execute(request);
    if (request.command == Command::BOOT_START_APPLICATION)
      in_bootloader = !(starts && bootloader.has_firmware());
    reply.status = answer.status;
    reply.value = answer.value;
    return reply;
  }

  std::optional<Reply> play_firmware(const Request& request, Reply reply) {
    const auto number = static_cast<int>(request.command);
    if (request.command == Command::GET_FIRMWARE_VERSION) {
      reply.value = to_value(runs());
      return reply;
    }
    if (request.command == Command::ENTER_BOOTLOADER) {
      EXPECT_EQ(sim::check_bootloader_entry(request), Status::ok);
      in_bootloader = enters;
      return reply;
    }
    if (number < 200) return std::nullopt;
    reply.status = Status::invalid_command;
    return reply;
  }
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

}  // namespace
}  // namespace tmcl
