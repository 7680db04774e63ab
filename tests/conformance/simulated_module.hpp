/// tmclsim with one module on a pty, and the far end of that pty.
#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "case.hpp"
#include "support/program.hpp"

namespace tmcl::conformance {

class SimulatedModule {
 public:
  explicit SimulatedModule(const Case& text) : case_(text) {
    auto name = (std::filesystem::temp_directory_path() / "conformance-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder to be had");
    folder_ = name;
    power_on();
  }
  SimulatedModule(const SimulatedModule&) = delete;
  SimulatedModule& operator=(const SimulatedModule&) = delete;
  ~SimulatedModule() {
    power_off();
    std::filesystem::remove_all(folder_);
  }

  void restart() {
    power_off();
    power_on();
  }
  void send(const Bytes& bytes) const {
    if (::write(line_, bytes.data(), bytes.size()) < 0) throw std::runtime_error("the pty is gone");
  }
  /// Up to nine bytes; fewer if nothing comes for so long.
  Bytes receive(std::chrono::milliseconds patience) const {
    Bytes bytes;
    pollfd waiting{line_, POLLIN, 0};
    while (bytes.size() < serial_datagram_size &&
           ::poll(&waiting, 1, static_cast<int>(patience.count())) > 0) {
      std::uint8_t byte = 0;
      if (::read(line_, &byte, 1) != 1) break;
      bytes.push_back(byte);
    }
    return bytes;
  }
  /// A line for its console, which must take it.
  void console(const std::string& line) {
    ++console_lines_;
    simulator_->say(line + "\n");
    if (!simulator_->wait_for_count("\nok", console_lines_)) {
      throw std::runtime_error("console: " + simulator_->output());
    }
  }

 private:
  void power_on() {
    std::vector<std::string> words{"tmclsim", "--pty", pty()};
    if (does<Console>()) words.emplace_back("--console");
    if (does<Restart>()) words.insert(words.end(), {"--eeprom", folder_.string()});
    if (case_.stage.empty() && case_.settings.empty()) {
      words.insert(words.end(), {"--module", std::string(case_.model->name) + "@1"});
    } else {
      write_bench_file();
      words.insert(words.end(), {"--bench", bench_file()});
    }
    simulator_ = std::make_unique<test::Program>(words, test::Program::Input::piped);
    console_lines_ = 0;
    if (!simulator_->wait_for("ready\n")) throw std::runtime_error(simulator_->output());
    line_ = ::open(pty().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  void power_off() {
    if (line_ >= 0) ::close(std::exchange(line_, -1));
    if (!simulator_) return;
    simulator_->signal(SIGTERM);
    simulator_->wait();
    simulator_.reset();
  }
  template <class Action>
  bool does() const {
    return std::ranges::any_of(
        case_.lines, [](const Line& line) { return std::holds_alternative<Action>(line.action); });
  }
  std::string pty() const { return (folder_ / "pty").string(); }
  std::string bench_file() const { return (folder_ / "bench.toml").string(); }
  void write_bench_file() const {
    std::ofstream file(bench_file());
    file << "[[module]]\nmodel = \"" << case_.model->name << "\"\naddress = 1\n";
    for (const auto& line : case_.settings) file << line << '\n';
    file << "[[module.axis]]\nmotor = 0\n";
    for (const auto& line : case_.stage) file << line << '\n';
  }

  Case case_;
  std::filesystem::path folder_;
  std::unique_ptr<test::Program> simulator_;
  std::size_t console_lines_ = 0;
  int line_ = -1;
};

}  // namespace tmcl::conformance
