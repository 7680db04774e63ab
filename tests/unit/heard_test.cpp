// What a line brings where answers are expected, and what is made of it.
#include "tmcl/heard.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>
#include <vector>

#include "support/seed.hpp"

namespace tmcl::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

class Listening : public testing::Test {
 protected:
  void ask(std::uint16_t address = 1) {
    request =
        encode_serial(Request{ModuleAddress{address}, Command::GET_FIRMWARE_VERSION, 1, 0, 0});
    heard.note({now, Traffic::Direction::out, 0, false, request});
  }
  void come(std::span<const std::uint8_t> bytes) {
    now += milliseconds(10);
    heard.note({now, Traffic::Direction::in, 0, false, bytes});
  }
  void come(const std::string& text) { come(Bytes(text.begin(), text.end())); }
  static SerialBytes answer() {
    return encode_serial(Reply{2, 1, Status::ok, Command::GET_FIRMWARE_VERSION, 0x0456'0113});
  }
  HeardKind kind() const { return heard.verdict().kind; }

  TimePoint now{std::chrono::hours(1)};
  Heard heard;
  SerialBytes request{};
};

TEST_F(Listening, NothingCame) {
  ask();
  EXPECT_EQ(kind(), HeardKind::nothing);
  EXPECT_EQ(heard.verdict().bytes, 0U);
}

TEST_F(Listening, AnAnswerCountsWhateverElseCame) {
  ask();
  come("login: ");
  come(request);
  come(answer());
  EXPECT_EQ(kind(), HeardKind::answers);
}

TEST_F(Listening, BegunAnewItKnowsWhatWasAskedLast) {
  ask();
  come("login: ");
  heard.begin_anew();
  EXPECT_EQ(kind(), HeardKind::nothing);
  come(answer());
  EXPECT_EQ(kind(), HeardKind::answers);
}

TEST_F(Listening, BegunWithinALineItQuotesTheFirstThatIsWhole) {
  const std::string prompt = "\r\ngateway login: ";
  for (std::size_t cut = 0; cut <= prompt.size(); ++cut) {
    for (const bool anew : {false, true}) {
      heard = Heard();
      ask();
      if (anew) come(prompt.substr(0, cut));
      if (anew) heard.begin_anew();
      come(prompt.substr(cut));
      come(prompt);
      EXPECT_EQ(heard.verdict().text, "gateway login: ") << "cut at " << cut;
    }
  }
}

TEST_F(Listening, TheVersionMayComeAsAText) {
  ask();
  come(
      "\x02"
      "1110V113");
  EXPECT_EQ(kind(), HeardKind::answers);
}

TEST_F(Listening, WhatWasSentComesBack) {
  for (std::uint16_t address = 1; address <= 255; ++address) {
    ask(address);
    come(request);
  }
  EXPECT_EQ(kind(), HeardKind::echo);
}

TEST_F(Listening, AConsoleSaysWhatItIs) {
  ask();
  come("\r\nDebian GNU/Linux 12 gateway ttyS0\r\n\r\ngateway login: ");
  const auto verdict = heard.verdict();
  EXPECT_EQ(verdict.kind, HeardKind::text);
  EXPECT_EQ(verdict.text, "Debian GNU/Linux 12 gateway ttyS0");
}

TEST_F(Listening, ATextIsCutAndCannotDisturbATerminal) {
  ask();
  come("\x1b[2J" + std::string(100, 'x'));
  const auto text = heard.verdict().text;
  EXPECT_EQ(text, "[2J" + std::string(37, 'x'));
}

TEST_F(Listening, APromptWithoutALineEndIsAText) {
  ask();
  come("login: ");
  EXPECT_EQ(kind(), HeardKind::text);
  EXPECT_EQ(heard.verdict().text, "login: ");
}

TEST_F(Listening, AnAnswerWithAWrongChecksum) {
  ask();
  auto damaged = answer();
  damaged[6] ^= 0x10U;
  come(damaged);
  EXPECT_EQ(kind(), HeardKind::wrong_checksums);
}

TEST_F(Listening, RepliesToOthers) {
  ask();
  come(encode_serial(Reply{2, 7, Status::ok, Command::GAP, 5}));
  EXPECT_EQ(kind(), HeardKind::foreign);
}

TEST_F(Listening, AnAnswerToAnotherHostAddress) {
  ask();
  come(encode_serial(Reply{5, 1, Status::ok, Command::GET_FIRMWARE_VERSION, 5}));
  EXPECT_EQ(kind(), HeardKind::foreign);
}

TEST_F(Listening, BytesOnlyAfterQuestionsAreOfAnotherBaudRate) {
  come(Bytes{0xF8});  // as the port is opened
  for (int i = 0; i < 20; ++i) {
    ask();
    come(Bytes{0x00, 0xF8, 0x80, 0x00});
    now += milliseconds(200);
  }
  EXPECT_EQ(kind(), HeardKind::other_baud_rate);
}

TEST_F(Listening, BytesThatComeUnaskedAreNoise) {
  ask();
  come(Bytes{0x00, 0xF8});
  now += milliseconds(200);
  come(Bytes{0x91, 0x17});
  EXPECT_EQ(kind(), HeardKind::noise);
}

TEST(Heard, EachKindHasItsWordItsSentenceAndItsHint) {
  using enum HeardKind;
  std::set<std::string> words, meanings, hints;
  for (const auto kind :
       {nothing, answers, wrong_checksums, foreign, echo, text, other_baud_rate, noise}) {
    words.insert(std::string(name_of(kind)));
    meanings.insert(meaning_of({kind, 7, "login: "}));
    const auto hint = hint_for(kind, "serial:/dev/ttyUSB0");
    EXPECT_EQ(hint.empty(), kind == answers);
    hints.insert(hint);
  }
  EXPECT_EQ(words.size(), 8U);
  EXPECT_EQ(meanings.size(), 8U);
  EXPECT_EQ(hints.size(), 8U);
  EXPECT_THAT(hint_for(other_baud_rate, "serial:/dev/ttyUSB0"),
              HasSubstr("'tmclctl --direct serial:/dev/ttyUSB0 scan --bauds'"));
  EXPECT_THAT(hint_for(other_baud_rate, ""), testing::Not(HasSubstr("--bauds")));
}

/// Questions, and between them pieces of everything that a line may bring.
struct Line {
  std::vector<Bytes> pieces;
  std::vector<SerialBytes> requests;
};

Line random_line(std::mt19937_64& random) {
  Line line;
  const auto pick = [&random](int below) {
    return std::uniform_int_distribution<int>(0, below - 1)(random);
  };
  for (int i = pick(12); i >= 0; --i) {
    const auto request = encode_serial(Request{
        ModuleAddress{static_cast<std::uint16_t>(1 + pick(3))}, Command::GET_FIRMWARE_VERSION, 1});
    auto reply = encode_serial(Reply{2, request[0], Status::ok, Command::GET_FIRMWARE_VERSION, i});
    Bytes bytes;
    switch (pick(6)) {
      case 0: bytes.assign(request.begin(), request.end()); break;
      case 1: reply[8] = static_cast<std::uint8_t>(reply[8] + pick(2)); [[fallthrough]];
      case 2: bytes.assign(reply.begin(), reply.end()); break;
      case 3: bytes = {'l', 'o', 'g', 'i', 'n', ':', ' '}; break;
      default:
        for (int n = pick(30); n > 0; --n) bytes.push_back(static_cast<std::uint8_t>(pick(256)));
    }
    line.requests.push_back(request);
    line.pieces.push_back(bytes);
  }
  return line;
}

HeardVerdict verdict_of(const Line& line, std::mt19937_64* cuts) {
  Heard heard;
  TimePoint now{std::chrono::hours(1)};
  for (std::size_t i = 0; i < line.pieces.size(); ++i) {
    heard.note({now, Traffic::Direction::out, 0, false, line.requests[i]});
    now += milliseconds(i % 3 == 0 ? 200 : 20);
    for (std::span<const std::uint8_t> left = line.pieces[i]; !left.empty();) {
      const auto size = cuts == nullptr
                            ? left.size()
                            : std::uniform_int_distribution<std::size_t>(1, left.size())(*cuts);
      heard.note({now, Traffic::Direction::in, 0, false, left.first(size)});
      left = left.subspan(size);
    }
  }
  return heard.verdict();
}

TEST(Heard, HowBytesAreCutMakesNoDifference) {
  std::mt19937_64 random(seed());
  std::set<HeardKind> kinds;
  for (int round = 0; round < 2000; ++round) {
    const auto line = random_line(random);
    const auto whole = verdict_of(line, nullptr);
    const auto cut = verdict_of(line, &random);
    ASSERT_EQ(whole.kind, cut.kind) << "round " << round;
    ASSERT_EQ(whole.text, cut.text);
    ASSERT_EQ(whole.bytes, cut.bytes);
    kinds.insert(whole.kind);
  }
  EXPECT_GE(kinds.size(), 5U);
}

TEST(Heard, RandomBytesAreNeitherTextNorEchoNorAnswers) {
  std::mt19937_64 random(seed());
  for (int round = 0; round < 300; ++round) {
    Heard heard;
    TimePoint now{std::chrono::hours(1)};
    for (std::uint16_t address = 1; address <= 255; ++address) {
      heard.note(
          {now, Traffic::Direction::out, 0, false,
           encode_serial(Request{ModuleAddress{address}, Command::GET_FIRMWARE_VERSION, 1})});
      now += milliseconds(25);
      Bytes bytes(1 + random() % 12);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      heard.note({now, Traffic::Direction::in, 0, false, bytes});
    }
    ASSERT_EQ(heard.verdict().kind, HeardKind::other_baud_rate) << "round " << round;
  }
}

}  // namespace
}  // namespace tmcl::test
