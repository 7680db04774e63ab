#include "tmcl/firmware_verbs.hpp"

#include <algorithm>
#include <bit>
#include <span>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/bootloader.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

using namespace std::chrono_literals;
using firmware::address_text;
using firmware::Image;

constexpr std::uint32_t word_size = 4;
// A word of the page buffer is counted with 16 bits.
constexpr std::uint32_t largest_page = word_size << 16U;

// The older tools wait ten seconds and longer for these.
constexpr Duration erase_time = 20s;
constexpr Duration page_time = 10s;
constexpr Duration sum_time = 5s;
constexpr unsigned most_tries = 3;
// So long a module that did not answer counts as silent, and is not asked.
constexpr Duration between_tries = 300ms;

constexpr Duration first_look = 200ms;
constexpr Duration between_looks = 100ms;
constexpr Duration standstill_time = 10s;
constexpr Duration standstill_look = 20ms;

constexpr std::string_view rerun =
    "the module is in its bootloader, without a firmware that it "
    "could run; start the same upload again";
constexpr std::string_view still_in_bootloader =
    "nothing was changed; the module may still be in its bootloader: start the same upload again, "
    "or switch its power off and on";
constexpr std::string_view unchanged =
    "nothing was changed; the module runs its firmware as before";

struct BootMemory {
  std::uint32_t page_size = 0;
  std::uint32_t start = 0;
  std::uint32_t size = 0;
};

/// What all steps of an upload know.
struct Upload {
  ModuleAddress module;
  Image image;
  FirmwareOptions options;
  FirmwareMatch match{};
  BootMemory memory{};
  /// From the first stop to the start of the firmware.
  std::shared_ptr<const Hold> hold = std::make_shared<const Hold>();
  bool in_bootloader = false;

  CallOptions call(std::optional<Duration> reply_timeout = std::nullopt) const {
    return {.reply_timeout = reply_timeout, .hold = hold, .in_bootloader = in_bootloader};
  }
  std::optional<Error> objection() const {
    return options.objection ? options.objection() : std::nullopt;
  }
  void tell(std::string_view step, std::size_t written = 0) const {
    if (options.progress) options.progress({step, written, image.bytes.size()});
  }
};

Request boot_request(ModuleAddress module, Command command, std::uint8_t type = 0,
                     std::uint32_t value = 0) {
  return {module, command, type, 0, static_cast<std::int32_t>(value)};
}

Error failed(Errc code, Outcome outcome, std::string message, std::string_view hint) {
  return {code, outcome, std::move(message), std::string(hint), {}, {}, {}};
}

/// A part of the upload, and in which state it leaves the module if it fails.
template <class T>
Script<Result<T>> during(std::string_view step, Script<Result<T>> part, std::string_view state) {
  auto result = co_await part;
  if (result) co_return result;
  auto& error = result.error();
  error.message = fmt::format("{}: {}", step, error.message);
  error.hint = state;
  // Something was done to the module, whatever became of the last command.
  if (state == rerun) error.outcome = Outcome::unknown;
  co_return result;
}

/// For commands that may be given twice: the answer may be lost, the command is not.
Script<Result<std::uint32_t>> insist(Request request, CallOptions options) {
  for (unsigned tries = 1;; ++tries) {
    const auto answer = co_await exchange(request, options);
    if (answer) co_return static_cast<std::uint32_t>(answer->reply.value);
    const bool lost = is_silence(answer.error()) || answer.error().status == Status::wrong_checksum;
    if (!lost || tries == most_tries) co_return tl::unexpected(answer.error());
    co_await pause(between_tries);
  }
}

Script<Result<std::uint32_t>> info(const Upload& upload, bootloader::Info what) {
  const auto type = static_cast<std::uint8_t>(what);
  return insist(boot_request(upload.module, Command::BOOT_GET_INFO, type), upload.call(sum_time));
}

/// Asks until it answers from where it should be.
Script<Result<void>> wait_until(const Upload& upload, bool in_bootloader) {
  co_await pause(first_look);
  auto waited = first_look;
  while (true) {
    const auto there = co_await is_in_bootloader(upload.module, upload.call());
    if (!there && !is_silence(there.error())) co_return tl::unexpected(there.error());
    if (there && *there == in_bootloader) co_return Result<void>{};
    if (waited >= upload.options.restart_time) {
      if (!there) co_return tl::unexpected(there.error());
      co_return tl::unexpected(failed(
          Errc::deadline_passed, Outcome::unknown,
          in_bootloader ? "the module did not leave its firmware" : "the firmware did not start",
          {}));
    }
    co_await pause(between_looks);
    waited += between_looks;
  }
}

std::string list_of(std::span<const FirmwareVersion> versions) {
  std::string text;
  for (const auto& version : versions) {
    const auto one = to_text(version);
    text += (text.empty() ? "" : ", ") + std::string(one.begin(), one.end());
  }
  return text;
}

std::string name_of_model(std::uint16_t number) {
  const auto* model = find_model(number);
  return model != nullptr ? std::string(model->name) : std::to_string(number);
}

std::optional<Error> objection(const FoundModule& found, const FirmwareMatch& match, bool force) {
  if (found.duplicate_suspected) {
    return bad_argument(
        fmt::format("more than one module seems to answer at address {}", number(found.address)),
        "give each its own address, or connect only one");
  }
  if (match.version || force) return std::nullopt;
  const auto who =
      match.model == 0
          ? fmt::format("module {} does not say which model it is", number(found.address))
          : fmt::format("module {} is a {}", number(found.address), name_of_model(match.model));
  const auto what = match.offered.empty()
                        ? std::string("the image does not say for which model it is")
                        : fmt::format("the image is for {}", list_of(match.offered));
  return bad_argument(fmt::format("{}; {}", what, who),
                      "nothing was changed; look for the firmware of this model");
}

/// Some say only as text which model they are.
Script<Result<FirmwareVersion>> version_of(const FoundModule& found) {
  if (found.version.model != 0) co_return found.version;
  const auto answer = co_await exchange(Request{found.address, Command::GET_FIRMWARE_VERSION,
                                                static_cast<std::uint8_t>(VersionForm::text)});
  if (!answer && !is_silence(answer.error()) && answer.error().outcome != Outcome::refused)
    co_return tl::unexpected(answer.error());
  const bool told = answer && answer->version_text;
  co_return told ? *answer->version_text : found.version;
}

Script<Result<FirmwareMatch>> match_found(const FoundModule& found, const Image& image) {
  const auto version = co_await must(version_of(found));
  FirmwareMatch match;
  match.model = version.model;
  match.running = version;
  match.offered = firmware::versions_in(image);
  match.version = firmware::version_for(image, match.model);
  match.in_bootloader = found.version.bootloader;
  match.running.bootloader = match.in_bootloader;
  co_return match;
}

Script<Result<void>> wait_for_standstill(const Upload& upload, std::uint8_t motor) {
  const Request velocity{upload.module, Command::GAP, axis_parameter::actual_velocity, motor, 0};
  for (Duration waited{}; waited < standstill_time; waited += standstill_look) {
    const auto now = co_await must(exchange(velocity, upload.call()));
    if (now.reply.value == 0) co_return Result<void>{};
    co_await pause(standstill_look);
  }
  co_return tl::unexpected(failed(Errc::deadline_passed, Outcome::not_sent,
                                  fmt::format("motor {} does not come to a stop", motor), {}));
}

Script<Result<void>> stop_motors(const Upload& upload, std::uint8_t motors) {
  for (std::uint8_t motor = 0; motor < motors; ++motor) {
    const Request stop{upload.module, Command::MST, 0, motor, 0};
    co_await must(exchange(stop, upload.call()));
  }
  for (std::uint8_t motor = 0; motor < motors; ++motor) {
    co_await must(wait_for_standstill(upload, motor));
  }
  co_return Result<void>{};
}

Script<Result<void>> enter_bootloader(const Upload& upload) {
  const Request entry{upload.module, Command::ENTER_BOOTLOADER, bootloader::entry_type,
                      bootloader::entry_motor, static_cast<std::int32_t>(bootloader::entry_value)};
  co_await must(exchange(entry, upload.call()));
  co_return co_await wait_until(upload, true);
}

Script<Result<BootMemory>> read_memory_layout(const Upload& upload) {
  const auto page_size = co_await must(info(upload, bootloader::Info::page_size));
  const auto start = co_await must(info(upload, bootloader::Info::start));
  const auto size = co_await must(info(upload, bootloader::Info::size));
  co_return BootMemory{page_size, start, size};
}

std::optional<Error> misfit(const Image& image, const BootMemory& memory) {
  const auto page = memory.page_size;
  if (!std::has_single_bit(page) || page < word_size || page > largest_page) {
    return failed(Errc::unexpected_value, Outcome::refused,
                  fmt::format("the bootloader has pages of {} bytes, which cannot be", page), {});
  }
  if (image.start != memory.start) {
    return bad_argument(fmt::format("the image begins at {}, the module's firmware at {}",
                                    address_text(image.start), address_text(memory.start)));
  }
  if (image.bytes.size() > memory.size) {
    return bad_argument(fmt::format("the image has {} bytes, the module's memory {}",
                                    image.bytes.size(), memory.size));
  }
  return std::nullopt;
}

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = word_size; i-- > 0;) {
    const auto byte = at + i < bytes.size() ? bytes[at + i] : firmware::erased_byte;
    word = word << 8U | byte;
  }
  return word;
}

Script<Result<void>> put_word(const Upload& upload, std::uint32_t index, std::uint32_t word) {
  auto request = boot_request(upload.module, Command::BOOT_WRITE_BUFFER,
                              static_cast<std::uint8_t>(index & 0xFFU), word);
  request.motor = static_cast<std::uint8_t>(index >> 8U);
  co_await must(insist(request, upload.call(sum_time)));
  co_return Result<void>{};
}

Script<Result<void>> fill_page(const Upload& upload, std::uint32_t offset, std::size_t count) {
  const auto bytes = std::span(upload.image.bytes).subspan(offset, count);
  for (std::uint32_t at = 0; at < bytes.size(); at += word_size) {
    co_await must(put_word(upload, at / word_size, word_at(bytes, at)));
  }
  co_return Result<void>{};
}

/// When the answer is lost, the content of the page buffer is unknown: it is filled again.
Script<Result<void>> write_page(const Upload& upload, std::uint32_t offset, std::size_t count) {
  const auto address = upload.image.start + offset;
  for (unsigned tries = 1;; ++tries) {
    co_await must(fill_page(upload, offset, count));
    const auto written = co_await exchange(
        boot_request(upload.module, Command::BOOT_WRITE_PAGE, 0, address), upload.call(page_time));
    if (written) co_return Result<void>{};
    if (!is_silence(written.error()) || tries == most_tries)
      co_return tl::unexpected(written.error());
    co_await pause(between_tries);
  }
}

Script<Result<void>> write_pages(const Upload& upload) {
  const auto& bytes = upload.image.bytes;
  const auto page = upload.memory.page_size;
  for (std::uint32_t offset = 0; offset < bytes.size(); offset += page) {
    upload.tell("writing", offset);
    const auto count = std::min<std::size_t>(page, bytes.size() - offset);
    const auto part = std::span(bytes).subspan(offset, count);
    const bool is_gap =
        std::ranges::all_of(part, [](std::uint8_t byte) { return byte == firmware::erased_byte; });
    if (is_gap) continue;
    co_await must(write_page(upload, offset, count));
  }
  upload.tell("writing", bytes.size());
  co_return Result<void>{};
}

Script<Result<void>> compare_sum(const Upload& upload) {
  const auto last = upload.image.start + static_cast<std::uint32_t>(upload.image.bytes.size()) - 1;
  const auto sum = co_await must(insist(
      boot_request(upload.module, Command::BOOT_GET_CHECKSUM, 0, last), upload.call(sum_time)));
  const auto expected = firmware::checksum(upload.image);
  if (sum == expected) co_return Result<void>{};
  co_return tl::unexpected(failed(
      Errc::unexpected_value, Outcome::unknown,
      fmt::format("what was written has the checksum 0x{:08X}, the image 0x{:08X}", sum, expected),
      {}));
}

/// Bootloaders from before command 208 find both in the last words of the last page.
Script<Result<void>> seal_by_page(const Upload& upload, std::uint32_t length, std::uint32_t sum) {
  const auto words = upload.memory.page_size / word_size;
  const auto last_page = upload.memory.size - upload.memory.page_size;
  co_await must(put_word(upload, words - 2, length));
  co_await must(put_word(upload, words - 1, sum));
  co_await must(exchange(boot_request(upload.module, Command::BOOT_WRITE_PAGE, 0, last_page),
                         upload.call(page_time)));
  co_return Result<void>{};
}

Script<Result<std::uint32_t>> write_seal(const Upload& upload, bootloader::Seal what,
                                         std::uint32_t value) {
  const auto type = static_cast<std::uint8_t>(what);
  return insist(boot_request(upload.module, Command::BOOT_WRITE_LENGTH, type, value),
                upload.call(page_time));
}

Script<Result<void>> seal(const Upload& upload) {
  const auto length = static_cast<std::uint32_t>(upload.image.bytes.size());
  const auto sum = firmware::checksum(upload.image);
  const auto first = co_await write_seal(upload, bootloader::Seal::length, length);
  if (!first && is_unknown_command(first.error())) {
    co_return co_await seal_by_page(upload, length, sum);
  }
  if (!first) co_return tl::unexpected(first.error());
  co_await must(write_seal(upload, bootloader::Seal::checksum, sum));
  co_return Result<void>{};
}

Script<Result<void>> start_firmware(Upload& upload) {
  // From here on a stop may be of use again.
  upload.in_bootloader = false;
  co_await must(
      exchange(boot_request(upload.module, Command::BOOT_START_APPLICATION), upload.call()));
  co_return co_await wait_until(upload, false);
}

/// From the module as it runs to the module in its bootloader, with an image that fits.
Script<Result<void>> prepare(Upload& upload, const FoundModule& found) {
  auto unwanted = upload.objection();
  if (unwanted) co_return tl::unexpected(std::move(*unwanted));
  if (!upload.match.in_bootloader) {
    upload.tell("stopping the motors");
    co_await must(during("stopping", stop_motors(upload, found.axes), unchanged));
    upload.tell("entering the bootloader");
    co_await must(during("entering the bootloader", enter_bootloader(upload), still_in_bootloader));
  }
  upload.in_bootloader = true;
  upload.memory = co_await must(
      during("asking the bootloader", read_memory_layout(upload), still_in_bootloader));
  auto wrong = misfit(upload.image, upload.memory);
  if (!wrong) wrong = upload.objection();
  if (!wrong) co_return Result<void>{};
  const auto started = co_await start_firmware(upload);
  wrong->hint = started ? unchanged : still_in_bootloader;
  co_return tl::unexpected(*wrong);
}

/// From the old firmware to the new one, whole and trusted by the bootloader.
Script<Result<void>> exchange_firmware(const Upload& upload) {
  upload.tell("erasing");
  const auto erase = boot_request(upload.module, Command::BOOT_ERASE_ALL);
  co_await must(during("erasing", insist(erase, upload.call(erase_time)), rerun));
  co_await must(during("writing", write_pages(upload), rerun));
  upload.tell("comparing", upload.image.bytes.size());
  co_await must(during("comparing", compare_sum(upload), rerun));
  co_await must(during("writing length and checksum", seal(upload), rerun));
  co_return Result<void>{};
}

}  // namespace

Script<Result<FirmwareMatch>> match_firmware(ModuleAddress module, firmware::Image image) {
  const auto found = co_await must(identify(module));
  co_return co_await match_found(found, image);
}

Script<Result<FirmwareReport>> upload_firmware(ModuleAddress module, firmware::Image image,
                                               FirmwareOptions options) {
  Upload upload{module, std::move(image), std::move(options)};
  const auto found = co_await must(identify(module));
  const auto match = co_await must(match_found(found, upload.image));
  upload.match = match;
  if (auto wrong = objection(found, match, upload.options.force)) {
    co_return tl::unexpected(std::move(*wrong));
  }
  co_await must(prepare(upload, found));
  co_await must(exchange_firmware(upload));
  upload.tell("starting", upload.image.bytes.size());
  constexpr std::string_view state =
      "the new firmware is written, whole, but does not answer: switch the power off and on, and "
      "look whether it has another address or baud rate now";
  co_await must(during("starting", start_firmware(upload), state));
  upload.hold.reset();
  const auto after = co_await must(during("starting", identify(module), state));
  co_return FirmwareReport{upload.match, after.version, firmware::checksum(upload.image)};
}

}  // namespace tmcl::verbs
