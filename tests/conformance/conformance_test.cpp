// Every case of tests/conformance/cases twice: the library must send its requests and understand
// its replies, and tmclsim must answer it so over a pty.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <thread>

#include "case.hpp"
#include "engine/bus_engine.hpp"
#include "simulated_module.hpp"
#include "tmcl/version.hpp"

namespace tmcl::conformance {

std::ostream& operator<<(std::ostream& out, const Case& text) {
  return out << text.file << ": " << text.title << ", " << text.model->name;
}

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds patience{2000};     // for a reply, on a busy machine
constexpr milliseconds silence_long{150};  // enough to hear a reply that should not come
constexpr milliseconds between_looks{5};

Bytes text_bytes(const std::string& text) {
  const auto whole = static_cast<char>(default_host_address) + text;
  return {whole.begin(), whole.end()};
}

// --- The library ---

/// What the engine makes of the bytes that come after a request.
class Library {
 public:
  Bytes send(const Request& request) {
    engine_.submit(0, request, {}, clock_.now());
    Bytes bytes;
    while (auto action = engine_.next_action()) {
      if (const auto* send = std::get_if<engine::Send>(&*action)) {
        const auto encoded = encode_serial(send->request);
        bytes.assign(encoded.begin(), encoded.end());
      } else {
        take(std::move(*action));
      }
    }
    return bytes;
  }
  void hear(const Bytes& bytes) {
    engine_.on_bytes(bytes, clock_.now());
    while (auto action = engine_.next_action()) take(std::move(*action));
  }
  const std::optional<Result<Answer>>& result() const { return result_; }

 private:
  void take(engine::Action action) {
    if (auto* completion = std::get_if<engine::Completion>(&action)) {
      result_ = std::move(completion->result);
    }
  }

  VirtualClock clock_;
  engine::BusEngine engine_{Framing::serial, Duration{}, {.name = "bench"}};
  std::optional<Result<Answer>> result_;
};

void library_understands(const Request& request, const Expected& expected) {
  Library library;
  ASSERT_EQ(library.send(request), serial_bytes(request));
  if (expected.kind == Expected::Kind::silence) return;
  if (expected.kind == Expected::Kind::text) {
    library.hear(text_bytes(expected.text));
    ASSERT_TRUE(library.result().has_value() && library.result()->has_value());
    const auto text = to_text((*library.result())->version_text.value());
    EXPECT_EQ(std::string(text.begin(), text.end()), expected.text);
    return;
  }
  // What the case does not say is what the request had, as of a module; the library looks at it.
  const auto value = expected.value.value_or(expected.status >= 100 ? request.value : 0);
  library.hear(serial_bytes(expected.status, static_cast<std::uint8_t>(request.command), value));
  ASSERT_TRUE(library.result().has_value()) << "it did not take the reply for the answer";
  const auto& result = *library.result();
  EXPECT_EQ(result.has_value(), expected.status >= 100);
  if (result) {
    EXPECT_EQ(result->reply.value, value);
  } else {
    EXPECT_EQ(result.error().outcome, Outcome::refused);
    EXPECT_EQ(static_cast<int>(result.error().status.value()), expected.status);
  }
}

// --- The simulator ---

class Simulator {
 public:
  explicit Simulator(const Case& text) : module_(text) {}

  void operator()(const Ask& ask) {
    const auto deadline = steady_clock::now() + ask.patience;
    auto answer = exchange(ask);
    while (!fits(answer, ask) && steady_clock::now() < deadline) {
      std::this_thread::sleep_for(between_looks);
      answer = exchange(ask);
    }
    expect(answer, ask);
  }
  void operator()(const RawExchange& raw) {
    module_.send(raw.request);
    EXPECT_EQ(module_.receive(raw.reply.empty() ? silence_long : patience), raw.reply);
  }
  void operator()(const Wait& wait) { std::this_thread::sleep_for(wait.time); }
  void operator()(const Event& event) {
    EXPECT_EQ(module_.receive(patience), serial_bytes(event.status, 138, event.value));
  }
  void operator()(const Console& console) { module_.console(console.line); }
  void operator()(const Restart&) { module_.restart(); }
  void operator()(const Download& download) {
    expect_reply({ModuleAddress{1}, Command::START_DOWNLOAD, 0, 0, 0}, 100);
    for (const auto& line : download.program) {
      expect_reply({ModuleAddress{1}, line.command, line.type, line.motor, line.value}, 101);
    }
    expect_reply({ModuleAddress{1}, Command::END_DOWNLOAD, 0, 0, 0}, 100);
  }

 private:
  Bytes exchange(const Ask& ask) {
    module_.send(serial_bytes(ask.request));
    const bool silence = ask.expected.kind == Expected::Kind::silence;
    return module_.receive(silence ? silence_long : patience);
  }
  static bool fits(const Bytes& answer, const Ask& ask) {
    switch (ask.expected.kind) {
      case Expected::Kind::silence: return answer.empty();
      case Expected::Kind::text: return answer == text_bytes(ask.expected.text);
      case Expected::Kind::reply: break;
    }
    const auto value = ask.expected.value.value_or(value_of(answer));
    return answer ==
           serial_bytes(ask.expected.status, static_cast<std::uint8_t>(ask.request.command), value);
  }
  static void expect(const Bytes& answer, const Ask& ask) {
    if (fits(answer, ask)) return;
    if (answer.size() == serial_datagram_size) {
      ADD_FAILURE() << "the reply has status " << int{answer[2]} << " and value "
                    << value_of(answer);
    } else {
      ADD_FAILURE() << answer.size() << " bytes came back";
    }
  }
  void expect_reply(const Request& request, int status) {
    (*this)(Ask{request, {.status = status}});
  }
  static std::int32_t value_of(const Bytes& answer) {
    if (answer.size() != serial_datagram_size) return 0;
    std::uint32_t value = 0;
    for (int i = 4; i < 8; ++i) value = value << 8 | answer[static_cast<std::size_t>(i)];
    return static_cast<std::int32_t>(value);
  }

  SimulatedModule module_;
};

std::string at(const Case& text, const Line& line) {
  return text.file + ".txt:" + std::to_string(line.number);
}

class Conformance : public testing::TestWithParam<Case> {};

TEST_P(Conformance, OfTheLibrary) {
  for (const auto& line : GetParam().lines) {
    SCOPED_TRACE(at(GetParam(), line));
    if (const auto* ask = std::get_if<Ask>(&line.action)) {
      library_understands(ask->request, ask->expected);
    }
  }
}

TEST_P(Conformance, OfTheSimulator) {
  Simulator simulator(GetParam());
  for (const auto& line : GetParam().lines) {
    SCOPED_TRACE(at(GetParam(), line));
    std::visit(simulator, line.action);
  }
}

std::string test_name(const testing::TestParamInfo<Case>& info) {
  auto name = info.param.file + "_" + info.param.title + "_" + std::string(info.param.model->name);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Conformance, testing::ValuesIn(load_cases()), test_name);

}  // namespace
}  // namespace tmcl::conformance
