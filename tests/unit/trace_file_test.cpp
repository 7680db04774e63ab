// Recorded traffic as a file: what is written is read again, and no file does any harm.
#include "tmcl/trace_file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/build_paths.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/status.hpp"
#include "tmcl/utc_text.hpp"

namespace tmcl::test {
namespace {

using std::chrono::microseconds;
using testing::HasSubstr;
using testing::StartsWith;

TracedDatagram serial(const Request& request, std::string client = {}) {
  TracedDatagram datagram{UtcTime(microseconds(1'764'065'521'123'456))};
  const auto bytes = encode_serial(request);
  datagram.bytes.assign(bytes.begin(), bytes.end());
  datagram.client = std::move(client);
  return datagram;
}
TracedDatagram serial(const Reply& reply) {
  TracedDatagram datagram{UtcTime(microseconds(1'764'065'521'125'000)), Traffic::Direction::in};
  const auto bytes = encode_serial(reply);
  datagram.bytes.assign(bytes.begin(), bytes.end());
  return datagram;
}
TracedDatagram on_can(const CanFrame& frame, Traffic::Direction direction) {
  TracedDatagram datagram{UtcTime(microseconds(5)), direction, true,
                          frame.extended,           false,     frame.id};
  datagram.bytes.assign(frame.data.begin(), frame.data.begin() + frame.length);
  return datagram;
}

const Request move{ModuleAddress{1}, Command::MVP, 0, 2, -51200};
const Reply refused{2, 1, Status::invalid_value, Command::MVP, -51200};

std::vector<TracedDatagram> some() {
  TracedDatagram garbage{UtcTime(microseconds(7)), Traffic::Direction::in};
  garbage.is_garbage = true;
  garbage.bytes = {1, 2, 3};
  return {serial(move, "process 4711"), serial(refused), garbage,
          on_can(encode_can(move), Traffic::Direction::out),
          on_can(encode_can(refused, 0x1234, true, 8), Traffic::Direction::in)};
}

std::string file_of(const std::vector<TracedDatagram>& datagrams) {
  auto file = trace_file_header("bench");
  for (const auto& datagram : datagrams) file += trace_file_packet(datagram);
  return file;
}

TEST(TraceFile, IsReadAsItWasWritten) {
  const auto trace = parse_trace_file(file_of(some()));
  ASSERT_TRUE(trace) << trace.error();
  EXPECT_EQ(trace->bus, "bench");
  EXPECT_EQ(trace->datagrams, some());
  EXPECT_TRUE(parse_trace_file(trace_file_header("")).value().datagrams.empty());
}

TEST(TraceFile, IsMadeOfWholeWordsAndBeginsAsPcapng) {
  const auto file = file_of(some());
  EXPECT_EQ(file.size() % 4, 0U);
  EXPECT_THAT(file, StartsWith("\x0a\x0d\x0d\x0a"));
}

TEST(TraceFile, WhatIsNoneIsToldWithItsPlace) {
  EXPECT_EQ(parse_trace_file("").error(), "the file is empty");
  EXPECT_EQ(parse_trace_file("no trace at all").error(), "byte 0: this is no pcapng file");
  auto file = file_of(some());
  const auto header = trace_file_header("bench").size();
  file.resize(file.size() - 1);
  EXPECT_THAT(parse_trace_file(file).error(), HasSubstr("the file ends within a block"));
  EXPECT_EQ(parse_trace_file(file.substr(0, header + 6)).error(),
            "byte " + std::to_string(header) + ": the file ends within a block");
  EXPECT_EQ(parse_trace_file(trace_file_header("").substr(0, 28) + trace_file_packet(serial(move)))
                .error(),
            "byte 28: a packet of interface 0");
  EXPECT_EQ(read_trace_file("/none").error(), "cannot read /none: No such file or directory");
  EXPECT_THAT(read_trace_file("/tmp").error(), StartsWith("cannot read /tmp"));
}

TEST(TraceFile, NoFileDoesHarm) {
  Random random(seed());
  const auto good = file_of(some());
  for (int i = 0; i < 20'000; ++i) {
    auto file = good;
    for (auto changes = random.between(1, 4); changes > 0; --changes) {
      const auto at =
          static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(file.size()) - 1));
      file[at] = static_cast<char>(random.between(-128, 127));
    }
    if (random.one_in(4))
      file.resize(
          static_cast<std::size_t>(random.between(0, static_cast<std::int64_t>(file.size()))));
    const auto trace = parse_trace_file(file);
    if (!trace) {
      EXPECT_FALSE(trace.error().empty());
      continue;
    }
    for (const auto& datagram : trace->datagrams) EXPECT_FALSE(describe(datagram).empty());
  }
}

TEST(TraceText, SaysWhatADatagramMeans) {
  const auto all = some();
  EXPECT_EQ(describe(all[0]), "1 MVP ABS -51200 motor 2");
  EXPECT_EQ(describe(all[1]), "1 MVP invalid_value (4) -51200");
  EXPECT_EQ(describe(all[2]), "garbage");
  EXPECT_EQ(describe(all[3]), "1 MVP ABS -51200 motor 2");
  EXPECT_EQ(describe(all[4]), "1 MVP invalid_value (4) -51200");
}

TEST(TraceText, NamesParametersThatItIsTold) {
  const Request get{ModuleAddress{1}, Command::GAP, 1, 0, 0};
  EXPECT_EQ(describe(serial(get)), "1 GAP 1 0 motor 0");
  EXPECT_EQ(describe(serial(get), axis_parameters(*find_model("TMCM-1110"))),
            "1 GAP actual_position 0 motor 0");
}

TEST(TraceText, KnowsAVersionThatIsAText) {
  TracedDatagram version{{}, Traffic::Direction::in};
  version.bytes = {2, '1', '1', '1', '0', 'V', '1', '1', '3'};
  EXPECT_EQ(describe(version), "firmware 1.13 of a TMCM-1110");
}

TEST(UtcText, IsIso8601) {
  EXPECT_EQ(to_text(UtcTime(microseconds(1'764'065'521'123'456))), "2025-11-25T10:12:01.123456Z");
  EXPECT_EQ(to_text(UtcTime(microseconds(0))), "1970-01-01T00:00:00.000000Z");
  EXPECT_EQ(to_text(UtcTime(microseconds(-1))), "1969-12-31T23:59:59.999999Z");
  const UtcTime late{std::chrono::nanoseconds(59'999'999'999)};
  EXPECT_EQ(to_text(late, 0), "1970-01-01T00:00:59Z");
  EXPECT_EQ(to_text(late, 3), "1970-01-01T00:00:59.999Z");
  EXPECT_EQ(to_text(late, 9), "1970-01-01T00:00:59.999999999Z");
}

// The dissector for Wireshark has tables of its own.
TEST(WiresharkDissector, HasTheNamesOfAllCommandsAndStatuses) {
  std::ifstream file(TMCL_SOURCE_DIR "/config/wireshark/tmcl.lua");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  for (const auto& row : command_table()) {
    EXPECT_THAT(text, HasSubstr('[' + std::to_string(static_cast<int>(row.command)) + "] = \"" +
                                std::string(name_of(row.command)) + "\","));
  }
  for (const auto& row : status_table()) {
    EXPECT_THAT(text, HasSubstr('[' + std::to_string(static_cast<int>(row.status)) + "] = \"" +
                                std::string(row.name) + "\","));
  }
}

}  // namespace
}  // namespace tmcl::test
