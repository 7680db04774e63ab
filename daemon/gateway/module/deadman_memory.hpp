/// What modules have been set to, and what tests have found of their deadmen, in a file that
/// outlives the process: a test moves a motor, so it is not repeated at each start.
/// Thread safety: none; the file is written on a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "async/workers.hpp"
#include "log/sink.hpp"
#include "tmcl/address.hpp"
#include "tmcl/version.hpp"

namespace tmcld {

struct KnownDeadman {
  std::string bus;
  tmcl::ModuleAddress address{};
  tmcl::FirmwareVersion version{};  ///< Another model or firmware may do otherwise.
  std::int32_t set_ms = 0;
  /// 0: it does not stop. Nothing: it was not tested.
  std::optional<std::int32_t> stops_after_ms{};
};

/// Of the modules that were noted last.
constexpr std::size_t most_known_deadmen = 1024;

class DeadmanMemory {
 public:
  /// Reads the file; blocks meanwhile. One that is damaged is said in the log, and of no use.
  static std::shared_ptr<DeadmanMemory> open(std::string path, const LogSink& log);

  /// Null if nothing is known; until something is noted.
  const KnownDeadman* find(std::string_view bus, tmcl::ModuleAddress address,
                           const tmcl::FirmwareVersion& version) const;
  /// Instead of what was known about that module.
  void note(KnownDeadman known);
  /// Returns when the file says what is known now, or the log that it could not be written.
  static boost::asio::awaitable<void> write(std::shared_ptr<DeadmanMemory> self);
  /// Waits for what is being written.
  void join() { writer_.join(); }

 private:
  DeadmanMemory(std::string path, LogSink log) : path_(std::move(path)), log_(std::move(log)) {}

  std::string path_;  ///< Empty: there is none.
  LogSink log_;
  Workers writer_{1};
  std::vector<KnownDeadman> known_;
};

}  // namespace tmcld
