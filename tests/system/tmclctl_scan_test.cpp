// A scan where no module answers as it should: six sentences; and the search for baud rates.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <atomic>
#include <functional>
#include <thread>

#include "support/pty.hpp"
#include "system/tmclctl_bench.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/link.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

/// What is at the other end of a serial port, instead of a module.
class FarEnd {
 public:
  /// `reply`: to what was read at once, and to nothing each 10 ms.
  explicit FarEnd(std::function<Bytes(const Bytes&)> reply) : reply_(std::move(reply)) {
    // What is not read by anyone gets lost.
    ::fcntl(pty_.master(), F_SETFL, O_NONBLOCK);
    thread_ = std::thread([this] { serve(); });
  }
  FarEnd(const FarEnd&) = delete;
  FarEnd& operator=(const FarEnd&) = delete;
  ~FarEnd() {
    ends_ = true;
    thread_.join();
  }
  Words direct() const { return {"--direct", "serial:" + pty_.path() + "@115200"}; }

 private:
  void serve() {
    while (!ends_) {
      pollfd entry{pty_.master(), POLLIN, 0};
      const bool came = ::poll(&entry, 1, 10) > 0 && (entry.revents & POLLIN) != 0;
      Bytes bytes(64);
      const auto count = came ? ::read(pty_.master(), bytes.data(), bytes.size()) : 0;
      bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
      const auto out = reply_(bytes);
      if (!out.empty()) [[maybe_unused]]
        const auto written = ::write(pty_.master(), out.data(), out.size());
    }
  }

  Pty pty_;
  std::function<Bytes(const Bytes&)> reply_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

class TmclctlScan : public testing::Test, public CtlBench {
 protected:
  /// What is said of it, which ends with exit code 3.
  std::string said_of(std::function<Bytes(const Bytes&)> reply) {
    const FarEnd far_end(std::move(reply));
    const auto ran = ctl(far_end.direct(), {"scan", "--addresses", "1-4"});
    EXPECT_EQ(ran.status, 3);
    EXPECT_EQ(ran.out, "");
    EXPECT_THAT(ran.err, HasSubstr("  Try: "));
    return ran.err;
  }
};

TEST_F(TmclctlScan, SaysThatNothingCameBack) {
  EXPECT_THAT(said_of([](const Bytes&) { return Bytes(); }), HasSubstr("nothing came back"));
}

TEST_F(TmclctlScan, SaysThatTheLineEchoes) {
  EXPECT_THAT(said_of([](const Bytes& came) { return came; }), HasSubstr("the line echoes"));
}

TEST_F(TmclctlScan, QuotesAText) {
  const std::string prompt = "\r\ngateway login: ";
  const auto said = said_of([&](const Bytes& came) {
    return came.empty() ? Bytes() : Bytes(prompt.begin(), prompt.end());
  });
  EXPECT_THAT(said, HasSubstr("as of a console: \"gateway login: \""));
}

TEST_F(TmclctlScan, IsNotNeededForDoctorToQuoteIt) {
  const std::string prompt = "\r\ngateway login: ";
  const FarEnd far_end([&](const Bytes& came) {
    return came.empty() ? Bytes() : Bytes(prompt.begin(), prompt.end());
  });
  const auto ran = ctl(far_end.direct(), {"doctor", "1"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_THAT(ran.out, HasSubstr("does not answer: text came, as of a console: \"gateway login: "));
  EXPECT_THAT(ran.out, HasSubstr("a console that the kernel or getty writes to"));
}

TEST_F(TmclctlScan, SaysThatChecksumsAreWrong) {
  const auto said = said_of([](const Bytes& came) {
    Bytes out;
    for (std::size_t i = 0; i + serial_datagram_size <= came.size(); i += serial_datagram_size) {
      auto bytes = encode_serial(Reply{2, came[i], Status::ok, static_cast<Command>(came[i + 1])});
      ++bytes[8];
      out.insert(out.end(), bytes.begin(), bytes.end());
    }
    return out;
  });
  EXPECT_THAT(said, HasSubstr("their checksums are wrong"));
}

TEST_F(TmclctlScan, SaysThatBytesHaveNoMeaning) {
  const auto said = said_of([](const Bytes&) { return Bytes{0x91, 0x17, 0xF8}; });
  EXPECT_THAT(said, HasSubstr("bytes without a meaning came"));
}

TEST_F(TmclctlScan, BusesTellWhatThisProcessSaw) {
  const FarEnd far_end([](const Bytes& came) { return came; });
  const auto ran = ctl(far_end.direct(), {"buses", "--for", "0.1"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.err, HasSubstr("the line echoes"));
  const auto buses = json(far_end.direct(), {"buses", "--for", "0.1"}).at("buses").as_array();
  EXPECT_EQ(buses.at(0).at("heard").at("kind"), "echo");
  EXPECT_GT(buses.at(0).at("counters").at("requests").as_int64(), 0);
}

TEST_F(TmclctlScan, ADoctorSaysThatNoModuleAnswers) {
  const FarEnd far_end([](const Bytes& came) { return came; });
  const auto ran = ctl(far_end.direct(), {"doctor"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_THAT(ran.out, HasSubstr("no module answered: "));
  EXPECT_THAT(ran.out, HasSubstr("the line echoes"));
}

TEST_F(TmclctlScan, TmcldKeepsItsBaudRate) {
  const auto ran = ctl(through_daemon(), {"scan", "--bauds"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, HasSubstr("tmcld has its ports at the baud rates of its configuration"));
}

/// The simulator hears garbage at any rate but that of its modules.
class TmclctlBaudSearch : public testing::Test, public CtlBench {
 protected:
  TmclctlBaudSearch() : CtlBench({"TMCM-1110@1", "TMCM-3110@3"}, {"--pace"}) {}

  /// Of a module that speaks 9600, as new ones do. Its answer comes at the other rate already.
  void set_baud_rate(std::uint16_t module, std::int32_t code) const {
    auto link = Link::open("serial:" + file("bus") + "@9600").value();
    const auto request = encode_serial(
        Request{ModuleAddress{module}, Command::SGP, global_parameter::serial_baud_rate, 0, code});
    ASSERT_EQ(link.write(request).value(), request.size());
    Bytes answer(serial_datagram_size);
    for (std::size_t have = 0; have < answer.size();) {
      pollfd entry{link.descriptor(), POLLIN, 0};
      ASSERT_GT(::poll(&entry, 1, 10'000), 0);
      have += link.read(std::span(answer).subspan(have)).value();
    }
  }
};

TEST_F(TmclctlBaudSearch, FindsTheRateTheAddressesAndTheLink) {
  set_baud_rate(1, 4);
  set_baud_rate(3, 4);
  // A busy simulator may take long to answer.
  const Words how{"--direct", "serial:" + file("bus"), "--reply-timeout", "2000"};
  const auto found = json(how, {"scan", "--bauds", "--addresses", "1-4"}).at("modules").as_array();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(std::string(found.at(0).at("link").as_string()), "serial:" + file("bus") + "@38400");
  EXPECT_EQ(found.at(0).at("address"), 1);
  EXPECT_EQ(found.at(1).at("address"), 3);
  EXPECT_EQ(found.at(1).at("model"), "TMCM-3110");
}

}  // namespace
}  // namespace tmcl::test
