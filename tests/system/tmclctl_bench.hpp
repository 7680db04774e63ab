// tmclctl as a user runs it: real processes, real ptys and sockets.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pty.h>
#include <boost/json.hpp>

#include "support/build_paths.hpp"
#include "support/program.hpp"

namespace tmcl::test {

using Words = std::vector<std::string>;

/// G-code of a circle with a radius of 2 mm.
inline const std::string circle = "G21 G90\nF600\nG1 X1\nG2 X1 Y0 I2 J0\nM2\n";

struct Ran {
  int status = -1;
  std::string out;
  std::string err;
};

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Simulated modules, otherwise a TMCM-1110 at address 1 and a TMCM-3110 at 3, on a pty and on TCP,
/// and a folder for files.
class CtlBench {
 public:
  /// `more`: options of the simulator; `bench`: a bench file with further modules.
  explicit CtlBench(const Words& modules = {"TMCM-1110", "TMCM-3110@3"}, const Words& more = {},
                    const std::string& bench = {}) {
    std::string name = std::filesystem::temp_directory_path() / "tmclctl-XXXXXX";
    folder_ = ::mkdtemp(name.data());
    Words words{"tmclsim", "--pty", file("bus"), "--tcp", "127.0.0.1:0"};
    for (const auto& module : modules) words.insert(words.end(), {"--module", module});
    words.insert(words.end(), more.begin(), more.end());
    if (!bench.empty()) {
      std::ofstream(file("bench.toml")) << bench;
      words.insert(words.end(), {"--bench", file("bench.toml")});
    }
    simulator_ = std::make_unique<Program>(words);
    if (!simulator_->wait_for("ready"))
      throw std::runtime_error("no simulator: " + simulator_->output());
  }
  ~CtlBench() {
    daemon_.reset();
    simulator_.reset();
    std::filesystem::remove_all(folder_);
  }
  CtlBench(const CtlBench&) = delete;
  CtlBench& operator=(const CtlBench&) = delete;

  std::string file(const std::string& name) const { return folder_ / name; }
  std::string pty_link() const { return "serial:" + file("bus") + "@115200"; }
  std::string tcp_link() const {
    const auto& output = simulator_->output();
    const auto begin = output.find("tcp ") + 4;
    return "tcp:" + output.substr(begin, output.find('\n', begin) - begin);
  }
  Words direct() const { return {"--direct", tcp_link()}; }
  Words through_daemon() const { return {"--socket", file("tmcld.sock")}; }
  Program& simulator() { return *simulator_; }

  /// Serves x, y (motor 0 and 1 of module 1 and 3) and "ghost", behind which there is no module;
  /// `of_y` are further lines of y.
  Program& start_daemon(const std::string& of_y = {}) {
    return start_daemon_with(axis("x", 1, 0) + axis("y", 3, 1) + of_y + axis("ghost", 9, 0));
  }
  Program& start_daemon_without_axes() { return start_daemon_with(""); }

  void stop_daemon() { daemon_.reset(); }

  /// Neither of its streams is a terminal.
  Ran ctl(const Words& how, const Words& words) const {
    std::string line = "exec '" TMCL_BIN_DIR "/tmclctl'";
    for (const auto& list : {how, words}) {
      for (const auto& word : list) line += " '" + word + "'";
    }
    const auto finished = run_program(
        {"/bin/sh", "-c", line + " </dev/null >'" + file("out") + "' 2>'" + file("err") + "'"});
    return {finished.status, contents(file("out")), contents(file("err"))};
  }
  boost::json::object json(Words how, const Words& words) const {
    how.emplace_back("--json");
    const auto ran = ctl(how, words);
    boost::system::error_code problem;
    auto value = boost::json::parse(ran.out, problem);
    if (problem || !value.is_object())
      throw std::runtime_error("no JSON document: " + ran.out + ran.err);
    return value.as_object();
  }

 private:
  Program& start_daemon_with(const std::string& axes) {
    std::ofstream(file("tmcld.toml"))
        << "[daemon]\nsocket = \"" << file("tmcld.sock")
        << "\"\n[[bus]]\nname = \"bench\"\nlink = \"" << tcp_link() << "\"\n"
        << axes;
    daemon_ = std::make_unique<Program>(Words{"tmcld", "--config", file("tmcld.toml")});
    for (int i = 0; i < 100 && !std::filesystem::exists(file("tmcld.sock")); ++i) ::usleep(50'000);
    return *daemon_;
  }
  static std::string axis(const std::string& name, int address, int motor) {
    return "[[axis]]\nname = \"" + name +
           "\"\nbus = \"bench\"\naddress = " + std::to_string(address) +
           "\nmotor = " + std::to_string(motor) + "\n";
  }

  std::filesystem::path folder_;
  std::unique_ptr<Program> simulator_;
  std::unique_ptr<Program> daemon_;
};

/// tmclctl on a terminal of 80 columns, as the child of a process that stands for the shell: at the
/// end of the process that leads a terminal's session the kernel drops what was not read yet.
class OnTerminal {
 public:
  OnTerminal(const Words& how, const Words& words) {
    winsize size{24, 80, 0, 0};
    shell_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (shell_ == 0) be_shell(how, words);
  }
  ~OnTerminal() {
    // Of the group: the program, too.
    ::kill(-shell_, SIGKILL);
    ::waitpid(shell_, nullptr, 0);
    ::close(terminal_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  const std::string& output() const { return output_; }
  bool wait_for(std::string_view text) {
    while (output_.find(text) == std::string::npos) {
      if (!read_more()) return false;
    }
    return true;
  }
  void press(char key) const { type({&key, 1}); }
  void type(std::string_view keys) const {
    [[maybe_unused]] const auto written = ::write(terminal_, keys.data(), keys.size());
  }
  void press_ctrl_c() const { press('\x03'); }
  void press_ctrl_z() const { press('\x1a'); }
  /// The exit code of the program; 128 and the signal where one ended it.
  int wait() {
    if (!wait_for(after_status)) return -1;
    const auto begin = output_.rfind(before_status);
    const int status = std::atoi(output_.c_str() + begin + before_status.size());
    output_.resize(begin);
    return status;
  }

 private:
  // Around what the shell writes when the program has ended.
  static constexpr std::string_view before_status = "\x1e";
  static constexpr std::string_view after_status = "\x1f";

  [[noreturn]] static void be_shell(const Words& how, const Words& words) {
    const pid_t program = ::fork();
    if (program == 0) be_program(how, words);
    for (const int key_signal : {SIGINT, SIGTSTP, SIGQUIT}) ::signal(key_signal, SIG_IGN);
    int status = 0;
    ::waitpid(program, &status, 0);
    const int exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const auto told = std::string(before_status) + std::to_string(exit) + std::string(after_status);
    [[maybe_unused]] const auto written = ::write(STDOUT_FILENO, told.data(), told.size());
    while (true) ::pause();
  }
  [[noreturn]] static void be_program(const Words& how, const Words& words) {
    Words all{TMCL_BIN_DIR "/tmclctl"};
    all.insert(all.end(), how.begin(), how.end());
    all.insert(all.end(), words.begin(), words.end());
    std::vector<char*> arguments;
    for (auto& word : all) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::setenv("LC_ALL", "C.UTF-8", 1);
    ::setenv("TERM", "xterm", 1);
    ::unsetenv("NO_COLOR");
    ::unsetenv("COLUMNS");
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  bool read_more() {
    pollfd waiting{terminal_, POLLIN, 0};
    if (::poll(&waiting, 1, 20'000) <= 0) return false;
    char buffer[4096];
    const auto count = ::read(terminal_, buffer, sizeof buffer);
    if (count <= 0) return false;
    output_.append(buffer, static_cast<std::size_t>(count));
    return true;
  }

  pid_t shell_ = -1;
  int terminal_ = -1;
  std::string output_;
};

}  // namespace tmcl::test
