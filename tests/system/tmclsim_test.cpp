// The real program, over real ptys and sockets, spoken to with bytes written down here.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/build_paths.hpp"

namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int patience_ms = 10'000;  // on a busy machine
using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::string>;

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }

  // What comes until `size` bytes are there, the far end closes, or nothing comes for so long.
  Bytes read(std::size_t size, int wait_ms = patience_ms) const {
    Bytes got;
    std::array<std::uint8_t, 256> buffer{};
    pollfd waiting{fd_, POLLIN, 0};
    while (got.size() < size && ::poll(&waiting, 1, wait_ms) > 0) {
      const auto n = ::read(fd_, buffer.data(), std::min(buffer.size(), size - got.size()));
      if (n <= 0) break;
      got.insert(got.end(), buffer.begin(), buffer.begin() + n);
    }
    return got;
  }

  std::string read_text() const {
    const auto bytes = read(1 << 20);
    return {bytes.begin(), bytes.end()};
  }

  void write(const Bytes& bytes) const {
    EXPECT_EQ(::write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  Bytes exchange(const Bytes& request) const {
    write(request);
    return read(9);
  }

 private:
  int fd_;
};

// An address, a command, a type, a motor and a value; the checksum is added.
Bytes request(Bytes bytes, std::int32_t value = 0) {
  for (const auto shift : {24, 16, 8, 0}) {
    bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> shift & 0xFFU));
  }
  std::uint8_t sum = 0;
  for (const auto byte : bytes) sum = static_cast<std::uint8_t>(sum + byte);
  bytes.push_back(sum);
  return bytes;
}

const Bytes ask_version = request({1, 136, 1, 0});
const Bytes version_1110{0x02, 0x01, 0x64, 0x88, 0x04, 0x56, 0x01, 0x0D, 0x57};

class Tmclsim {
 public:
  explicit Tmclsim(const Words& arguments) : Tmclsim(arguments, pipe_pair(), pipe_pair()) {}
  Tmclsim(const Tmclsim&) = delete;
  Tmclsim& operator=(const Tmclsim&) = delete;
  ~Tmclsim() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }

  // All lines up to the one that says that it serves.
  Words lines_until_ready() {
    Words lines;
    std::string line;
    for (auto byte = out_.read(1); !byte.empty(); byte = out_.read(1)) {
      if (byte[0] != '\n') {
        line.push_back(static_cast<char>(byte[0]));
        continue;
      }
      if (line == "ready") return lines;
      lines.push_back(std::exchange(line, {}));
    }
    ADD_FAILURE() << "not ready: " << err_.read_text();
    return lines;
  }

  int end(int signal) {
    ::kill(pid_, signal);
    return wait();
  }

  // The exit status; -1 if a signal killed it.
  int wait() {
    int status = 0;
    ::wait4(std::exchange(pid_, 0), &status, 0, &usage_);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string output() const { return out_.read_text(); }
  std::string errors() const { return err_.read_text(); }
  std::chrono::microseconds processor_time() const {
    const auto sum = [](timeval t) {
      return std::chrono::seconds(t.tv_sec) + std::chrono::microseconds(t.tv_usec);
    };
    return sum(usage_.ru_utime) + sum(usage_.ru_stime);
  }

 private:
  using Pipe = std::pair<Descriptor, Descriptor>;

  static Pipe pipe_pair() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) ADD_FAILURE() << "no pipe";
    return {Descriptor(ends[0]), Descriptor(ends[1])};
  }

  Tmclsim(const Words& arguments, Pipe out, Pipe err)
      : out_(std::move(out.first)), err_(std::move(err.first)) {
    std::string program = TMCL_BIN_DIR "/tmclsim";
    auto words = arguments;
    std::vector<char*> argv{program.data()};
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::dup2(out.second.get(), STDOUT_FILENO);
    ::dup2(err.second.get(), STDERR_FILENO);
    ::execv(program.c_str(), argv.data());
    ::_exit(127);
  }

  Descriptor out_;
  Descriptor err_;
  pid_t pid_ = 0;
  rusage usage_{};
};

class TmclsimTest : public testing::Test {
 protected:
  TmclsimTest() {
    auto name = (fs::temp_directory_path() / "tmclsim-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~TmclsimTest() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static Descriptor open_pty(const std::string& name) {
    return Descriptor(::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  }

  static std::uint16_t port_in(const std::string& line) {
    return static_cast<std::uint16_t>(std::stoi(line.substr(line.rfind(':') + 1)));
  }

  static Descriptor connect_to(std::uint16_t port) {
    Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    return socket;
  }

  fs::path folder_;
};

TEST_F(TmclsimTest, SaysWhatItServesAndEndsCleanly) {
  for (const auto signal : {SIGTERM, SIGINT}) {
    Tmclsim sim({"--module", "TMCM-1110", "--module", "TMCM-6110@7", "--module", "3110", "--pty",
                 path("bus"), "--tcp", "127.0.0.1:0"});
    const auto lines = sim.lines_until_ready();
    ASSERT_EQ(lines.size(), 5U);
    EXPECT_EQ(lines[0], "module 1 TMCM-1110, 1 motor, firmware 1.13");
    EXPECT_EQ(lines[1], "module 7 TMCM-6110, 6 motors, firmware 1.46");
    EXPECT_EQ(lines[2], "module 2 TMCM-3110, 3 motors, firmware 1.14");
    EXPECT_EQ(lines[3], "pty " + path("bus") + " -> " + fs::read_symlink(path("bus")).string());
    EXPECT_THAT(lines[4], HasSubstr("tcp 127.0.0.1:"));
    EXPECT_EQ(sim.end(signal), 0);
    EXPECT_FALSE(fs::is_symlink(path("bus")));
    EXPECT_THAT(sim.errors(), IsEmpty());
  }
}

TEST_F(TmclsimTest, AnswersHostsThatComeAndGoOnAPty) {
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("bus")});
  sim.lines_until_ready();
  for (int i = 0; i < 20; ++i) {
    const auto host = open_pty(path("bus"));
    EXPECT_EQ(host.exchange(ask_version), version_1110);
  }
}

TEST_F(TmclsimTest, PassesEveryByteThroughThePty) {
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("bus")});
  sim.lines_until_ready();
  const auto host = open_pty(path("bus"));
  // Bytes that a terminal not in raw mode would swallow or change.
  for (const std::int32_t value : {0x03040A0D, 0x11131A1C, 0x7F150012}) {
    const auto reply = host.exchange(request({1, 5, 0, 0}, value & 0x007FFFFF));
    EXPECT_EQ(Bytes(reply.begin() + 4, reply.begin() + 8),
              (Bytes{0, static_cast<std::uint8_t>(value >> 16 & 0x7F),
                     static_cast<std::uint8_t>(value >> 8 & 0xFF),
                     static_cast<std::uint8_t>(value & 0xFF)}));
  }
}

TEST_F(TmclsimTest, ServesAModuleAsByItsUsbPort) {
  Tmclsim sim(
      {"--module", "TMCM-1110", "--module", "TMCM-3110@7", "--usb-pty", "7=" + path("usb")});
  const auto line = sim.lines_until_ready().back();
  const auto terminal = fs::read_symlink(path("usb")).string();
  EXPECT_EQ(line, "usb-pty " + path("usb") + " -> " + terminal + ", module 7");
  const auto host = open_pty(path("usb"));
  const auto reply = host.exchange(ask_version);  // of module 1
  EXPECT_EQ(Bytes(reply.begin(), reply.begin() + 6),
            (Bytes{2, 7, 100, 136, 3110 / 256, 3110 % 256}));
  EXPECT_EQ(host.exchange(Bytes(9, 0)), (Bytes{2, 7, 2, 0, 0, 0, 0, 0, 11}));
}

TEST_F(TmclsimTest, SaysWhichModuleAUsbPortIsMissing) {
  const Words two{"--module", "TMCM-1110", "--module", "TMCM-3110@7"};
  const auto error_of = [&](Words more) {
    Words words = two;
    words.insert(words.end(), more.begin(), more.end());
    Tmclsim sim(words);
    EXPECT_EQ(sim.wait(), 2);
    return sim.errors();
  };
  EXPECT_THAT(error_of({"--usb-pty", path("usb")}), HasSubstr("which of the 2 modules"));
  EXPECT_THAT(error_of({"--usb-pty", "9=" + path("usb")}),
              HasSubstr("no module has the address 9"));
  EXPECT_THAT(error_of({"--usb-pty", "7="}), HasSubstr("names no file"));
  EXPECT_THAT(error_of({"--usb-pty", "7=" + path("a"), "--usb-pty", "7=" + path("b")}),
              HasSubstr("has a USB port already"));
  EXPECT_THAT(error_of({"--module", "TMCM-1140@7", "--usb-pty", "7=" + path("usb")}),
              HasSubstr("several modules have the address 7"));
}

TEST_F(TmclsimTest, AHostHasToSetTheRateOfTheModuleIfThereIsAPace) {
  Tmclsim sim({"--module", "TMCM-1110", "--pace", "--pty", path("bus")});
  sim.lines_until_ready();
  const auto host = open_pty(path("bus"));
  const auto set_rate = [&](speed_t rate) {
    termios settings{};
    ASSERT_EQ(::tcgetattr(host.get(), &settings), 0);
    ::cfsetspeed(&settings, rate);
    ASSERT_EQ(::tcsetattr(host.get(), TCSANOW, &settings), 0);
  };
  set_rate(B19200);
  host.write(ask_version);
  EXPECT_THAT(host.read(1, 300), IsEmpty());
  set_rate(B9600);
  EXPECT_EQ(host.exchange(ask_version), version_1110);
}

TEST_F(TmclsimTest, APaceMakesExchangesTakeTheTimeOfTheirBits) {
  Tmclsim sim({"--module", "TMCM-1110", "--pace", "4800", "--pty", path("bus")});
  sim.lines_until_ready();
  const auto host = open_pty(path("bus"));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(host.exchange(ask_version), version_1110);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::microseconds(37'500));
}

TEST_F(TmclsimTest, EchoesWhatTheHostSays) {
  Tmclsim sim({"--module", "TMCM-1110", "--echo", "--tcp", "127.0.0.1:0"});
  const auto host = connect_to(port_in(sim.lines_until_ready().back()));
  host.write(ask_version);
  EXPECT_EQ(host.read(9), ask_version);
  EXPECT_EQ(host.read(9), version_1110);
}

TEST_F(TmclsimTest, RefusesWiresThatThereAreNot) {
  const auto error_of = [&](Words more) {
    Words words{"--module", "TMCM-1110"};
    words.insert(words.end(), more.begin(), more.end());
    Tmclsim sim(words);
    EXPECT_EQ(sim.wait(), 2);
    return sim.errors();
  };
  const auto bus = path("bus");
  EXPECT_THAT(error_of({"--pty", bus, "--pace", "fast"}), HasSubstr("--pace fast is no baud rate"));
  EXPECT_THAT(error_of({"--pty", bus, "--pace", "0"}), HasSubstr("--pace 0 is no baud rate"));
  EXPECT_THAT(error_of({"--pty", bus, "--noise", "2"}), HasSubstr("--noise is 0 to 1"));
  EXPECT_THAT(error_of({"--pty", bus, "--noise", "nan"}), HasSubstr("--noise is 0 to 1"));
  EXPECT_THAT(error_of({"--usb-pty", bus, "--echo"}), HasSubstr("of serial lines"));
}

TEST_F(TmclsimTest, MovesInRealTime) {
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("bus")});
  sim.lines_until_ready();
  const auto host = open_pty(path("bus"));
  const auto time_to_move = [&](std::int32_t target) {
    host.exchange(request({1, 138, 0, 0}, 1));
    const auto start = std::chrono::steady_clock::now();
    host.exchange(request({1, 4, 0, 0}, target));
    EXPECT_EQ(host.read(9), (Bytes{2, 1, 128, 138, 0, 0, 0, 1, 0x0E}));  // has arrived
    return std::chrono::steady_clock::now() - start;
  };
  // A busy computer is late now and then; a simulator that is slow, each time.
  int tries = 5;
  while (true) {
    const auto took = time_to_move(20'000);
    EXPECT_GE(took, std::chrono::milliseconds(335));  // 20000 steps at 61035 a second, and ramps
    EXPECT_EQ(host.exchange(request({1, 6, 1, 0})), (Bytes{2, 1, 100, 6, 0, 0, 0x4E, 0x20, 0xDB}));
    if (took <= std::chrono::milliseconds(1335)) break;
    ASSERT_GT(--tries, 0);
    time_to_move(0);
  }
}

TEST_F(TmclsimTest, ServesSeveralTcpClientsAtOnce) {
  Tmclsim sim({"--module", "TMCM-1110", "--tcp", "127.0.0.1:0"});
  const auto port = port_in(sim.lines_until_ready().back());
  const auto first = connect_to(port);
  const auto second = connect_to(port);
  first.exchange(request({1, 5, 4, 0}, 777));
  EXPECT_EQ(second.exchange(request({1, 6, 4, 0})), (Bytes{2, 1, 100, 6, 0, 0, 3, 9, 0x79}));
  { const auto third = connect_to(port); }
  EXPECT_EQ(first.exchange(ask_version), version_1110);
}

TEST_F(TmclsimTest, ForgetsAClientThatArmedAnEventAndLeft) {
  Tmclsim sim({"--module", "TMCM-1110", "--tcp", "127.0.0.1:0"});
  const auto port = port_in(sim.lines_until_ready().back());
  connect_to(port).exchange(request({1, 138, 1, 0}, 1));
  const auto host = connect_to(port);
  host.exchange(request({1, 4, 0, 0}, 100));
  EXPECT_THAT(host.read(1, 300), IsEmpty());
  EXPECT_EQ(host.exchange(ask_version), version_1110);
}

TEST_F(TmclsimTest, UsesAlmostNoProcessorTimeWhenAskedNothing) {
  Tmclsim sim({"--module", "TMCM-6110", "--pty", path("bus"), "--tcp", "127.0.0.1:0"});
  sim.lines_until_ready();
  const auto host = open_pty(path("bus"));
  host.exchange(request({1, 1, 0, 0}, 1000));  // a motor that turns costs nothing either
  std::this_thread::sleep_for(std::chrono::seconds(2));
  EXPECT_EQ(sim.end(SIGTERM), 0);
  EXPECT_LT(sim.processor_time(), std::chrono::milliseconds(100));
}

TEST_F(TmclsimTest, LeavesAloneWhatIsNotItsOwn) {
  std::ofstream(path("file")) << "precious";
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("file")});
  EXPECT_EQ(sim.wait(), 1);
  EXPECT_THAT(sim.errors(), HasSubstr(path("file") + ", where the link is to be"));
  EXPECT_EQ(fs::file_size(path("file")), 8U);
}

TEST_F(TmclsimTest, DoesNotTakeAwayAnotherSimulatorsLink) {
  Tmclsim first({"--module", "TMCM-1110", "--pty", path("bus")});
  first.lines_until_ready();
  Tmclsim second({"--module", "TMCM-1110", "--pty", path("bus")});
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.errors(), HasSubstr("in use"));
  EXPECT_EQ(open_pty(path("bus")).exchange(ask_version), version_1110);
}

TEST_F(TmclsimTest, ReplacesTheLinkOfARunThatWasKilled) {
  {
    Tmclsim killed({"--module", "TMCM-1110", "--pty", path("bus")});
    killed.lines_until_ready();
  }
  EXPECT_TRUE(fs::is_symlink(path("bus")));
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("bus")});
  sim.lines_until_ready();
  EXPECT_EQ(open_pty(path("bus")).exchange(ask_version), version_1110);
}

TEST_F(TmclsimTest, NamesTheFolderThatIsMissing) {
  Tmclsim sim({"--module", "TMCM-1110", "--pty", path("no/such/bus")});
  EXPECT_EQ(sim.wait(), 1);
  EXPECT_THAT(sim.errors(), HasSubstr("mkdir -p " + path("no/such")));
}

TEST_F(TmclsimTest, SaysThatATcpPortIsTaken) {
  Tmclsim first({"--module", "TMCM-1110", "--tcp", "127.0.0.1:0"});
  const auto port = std::to_string(port_in(first.lines_until_ready().back()));
  Tmclsim second({"--module", "TMCM-1110", "--tcp", "127.0.0.1:" + port});
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.errors(), HasSubstr("cannot listen on 127.0.0.1:" + port));
}

TEST_F(TmclsimTest, SaysWhyThereIsNoCan) {
  Tmclsim sim({"--module", "TMCM-1110", "--can", "nosuch0"});
  EXPECT_EQ(sim.wait(), 1);
  EXPECT_THAT(sim.errors(), testing::AnyOf(HasSubstr("no CAN interface 'nosuch0'"),
                                           HasSubstr("this kernel has no CAN")));
}

TEST_F(TmclsimTest, WarnsOfModulesWithOneAddress) {
  Tmclsim sim({"--module", "TMCM-1110@4", "--module", "TMCM-3110@4", "--pty", path("bus")});
  sim.lines_until_ready();
  EXPECT_EQ(sim.end(SIGTERM), 0);
  EXPECT_THAT(sim.errors(), HasSubstr("2 modules have the address 4"));
}

struct BadLine {
  Words arguments;
  std::string said;
};

TEST_F(TmclsimTest, NamesTheOffenderOnABadCommandLine) {
  const std::vector<BadLine> lines{
      {{"--modul", "TMCM-1110"}, "no option '--modul'. Did you mean '--module'?"},
      {{"--module", "TMCM-1112", "--tcp", "127.0.0.1:0"}, "no module 'TMCM-1112'. Did you mean"},
      {{"--module", "TMCM-1110@0", "--tcp", "127.0.0.1:0"}, "'0' in 'TMCM-1110@0'"},
      {{"--module", "TMCM-1110@256", "--tcp", "127.0.0.1:0"}, "'256' in 'TMCM-1110@256'"},
      {{"--module", "TMCM-1110@", "--tcp", "127.0.0.1:0"}, "'' in 'TMCM-1110@'"},
      {{"--module", "TMCM-1110"}, "no way to reach the modules"},
      {{"--tcp", "127.0.0.1:0"}, "no module to simulate"},
      {{"--module", "TMCM-1110", "--tcp", "127.0.0.1:0", "more"}, "'more' belongs to no option"},
      {{"--module", "TMCM-1110", "--tcp", "127.0.0.1"}, "'127.0.0.1' is not HOST:PORT"},
      {{"--module", "TMCM-1110", "--tcp", "127.0.0.1:99999"}, "is not HOST:PORT"},
      {{"--module"}, "--module"},
  };
  for (const auto& [arguments, said] : lines) {
    Tmclsim sim(arguments);
    EXPECT_EQ(sim.wait(), 2) << said;
    EXPECT_THAT(sim.errors(), HasSubstr(said));
    EXPECT_THAT(sim.output(), IsEmpty());
  }
}

TEST_F(TmclsimTest, ExplainsItself) {
  Tmclsim help({"--help"});
  EXPECT_EQ(help.wait(), 0);
  const auto text = help.output();
  for (const auto* word : {"--module", "--pty", "--can", "--tcp", "TMCM-6110", "Exit status"}) {
    EXPECT_THAT(text, HasSubstr(word));
  }
  Tmclsim version({"--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_THAT(version.output(), testing::MatchesRegex("tmclsim [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

}  // namespace
