/// A tmcld of a benchmark's own, with one bus and one axis.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include <benchmark/benchmark.h>

#include "support/program.hpp"
#include "tmcl/client.hpp"

namespace tmcl::bench {

/// What goes wrong in a benchmark is told, and ends that one alone.
template <class Body>
void attempt(benchmark::State& state, Body body) {
  try {
    body(state);
  } catch (const std::exception& problem) {
    state.SkipWithError(problem.what());
  }
}

/// Processor time so far.
inline double cpu_seconds_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string skipped;
  std::getline(file, skipped, ')');
  constexpr int fields_before = 11;  // of utime, behind the name
  for (int i = 0; i < fields_before; ++i) file >> skipped;
  double user = 0, system = 0;
  file >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class DaemonProcess {
 public:
  /// Returns when the axis answers.
  explicit DaemonProcess(const std::string& port)
      : folder_(new_folder()), program_({"tmcld", "--config", written_config(port)}) {
    auto client = connect();
    const auto state = client.call("axis.get_state", {{"axis", "x"}});
    if (!state) throw std::runtime_error(state.error().message);
  }
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;
  ~DaemonProcess() { std::filesystem::remove_all(folder_); }

  std::string socket() const { return folder_ / "tmcld.sock"; }
  client::Caller connect() const {
    auto connection = client::Caller::open(socket());
    if (!connection) throw std::runtime_error(connection.error().message);
    return std::move(*connection);
  }
  double cpu_seconds() const { return cpu_seconds_of(program_.process()); }

 private:
  static std::filesystem::path new_folder() {
    auto name = (std::filesystem::temp_directory_path() / "tmcl_bench.XXXXXX").string();
    return mkdtemp(name.data());
  }
  std::string written_config(const std::string& port) const {
    auto file = folder_ / "tmcld.toml";
    // A busy computer is to be slow, and not to fail.
    std::ofstream(file) << "[daemon]\nsocket = \"" << socket() << "\"\nlog_level = \"error\"\n"
                        << "[[bus]]\nname = \"bench\"\nlink = \"serial:" << port << "@115200\"\n"
                        << "reply_timeout_ms = 5000\n"
                        << "[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 1\nmotor = 0\n";
    return file;
  }

  std::filesystem::path folder_;
  test::Program program_;
};

}  // namespace tmcl::bench
