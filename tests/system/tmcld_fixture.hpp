/// Real programs: tmclsim, and tmcld on it.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/program.hpp"
#include "support/rpc_client.hpp"

namespace tmcl::test {

class TmcldTest : public testing::Test {
 protected:
  TmcldTest() {
    auto name = (std::filesystem::temp_directory_path() / "tmcld-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~TmcldTest() override {
    daemon.reset();
    simulator.reset();
    std::filesystem::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string socket() const { return path("socket"); }
  std::string config() const { return path("tmcld.toml"); }

  /// A TMCM-1110 at address 1 and a TMCM-3110 at address 2.
  void start_simulator(std::vector<std::string> port) {
    std::vector<std::string> words{"tmclsim", "--module", "TMCM-1110@1", "--module", "TMCM-3110@2"};
    words.insert(words.end(), port.begin(), port.end());
    simulator = std::make_unique<Program>(words);
    ASSERT_TRUE(simulator->wait_for("ready")) << simulator->output();
  }
  void start_simulator_on_pty() { start_simulator({"--pty", path("pty")}); }
  /// Where the simulator serves, if that is TCP.
  std::string tcp_address() const {
    const auto& said = simulator->output();
    const auto at = said.find("127.0.0.1:");
    return said.substr(at, said.find('\n', at) - at);
  }
  std::string pty_link() const { return "serial:" + path("pty") + "@115200"; }

  /// Axes x on the first module, y and z on the second; `of_z` are further lines of z.
  void write_config(const std::string& link, const std::string& of_z = {}) const {
    std::ofstream file(config());
    file << "[daemon]\nsocket = \"" << socket() << "\"\n";
    file << "[[bus]]\nname = \"bench\"\nlink = \"" << link << "\"\n";
    // A busy machine may not run the simulator for a while; a movement is never sent twice.
    file << "reply_timeout_ms = 1000\n";
    write_axis(file, "x", 1, 0);
    write_axis(file, "y", 2, 0);
    write_axis(file, "z", 2, 1);
    file << of_z;
  }

  void start_daemon(int modules = 2) {
    daemon = std::make_unique<Program>(std::vector<std::string>{"tmcld", "--config", config()});
    ASSERT_TRUE(daemon->wait_for("serving 3 axes")) << daemon->output();
    for (int module = 1; module <= modules; ++module) {
      const auto ready = "module_answers (module " + std::to_string(module) + ")";
      ASSERT_TRUE(daemon->wait_for(ready)) << daemon->output();
    }
  }

  std::unique_ptr<Program> simulator;
  std::unique_ptr<Program> daemon;

 private:
  static void write_axis(std::ofstream& file, const std::string& name, int address, int motor) {
    file << "[[axis]]\nname = \"" << name << "\"\nbus = \"bench\"\naddress = " << address
         << "\nmotor = " << motor << "\n";
  }

  std::string folder_;
};

}  // namespace tmcl::test
