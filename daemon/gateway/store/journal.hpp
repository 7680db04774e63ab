/// What this daemon would have to put in order if it ended in this instant, in a file: axes that it
/// leads, or that would have to be stopped, and settings that were changed for that. Another run of
/// it does that: see orphans.hpp.
///
/// The file is there before the first datagram that needs it goes out, as a whole: it is written
/// beside, and then renamed; where nothing is held there is none. It survives the end of the
/// process, not that of the computer.
/// Thread safety: none; files are written on a thread of their own.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "async/workers.hpp"
#include "log/limiter.hpp"
#include "log/sink.hpp"
#include "tmcl/address.hpp"
#include "tmcl/context_clock.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcld {

/// One axis. Of two with the same values, it does not matter which stands in the file.
struct Holding {
  /// What a module said by which it is noticed that it starts again, and when: milliseconds of the
  /// computer's calendar, which goes on from one run to the next.
  struct Seen {
    std::int32_t value = 0;
    std::int64_t asked_ms = 0;
    std::int64_t answered_ms = 0;
    bool operator==(const Seen&) const { return true; }
  };

  std::string bus;
  tmcl::AxisAddress motor{};
  /// "line", "path", "mint", "stop", "lease", "turning"; "unattended" is not stopped.
  std::string why;
  /// In the order in which they were changed.
  std::vector<tmcl::plan::Setting> before{};
  std::optional<Seen> seen{};
  bool operator==(const Holding&) const = default;
};
using Holdings = std::vector<Holding>;

class Journal {
 public:
  using OnFailure = std::function<void(const std::string& why)>;

  /// `held` tells what is held at that moment. `on_failure`: called when the file cannot be
  /// written, once until it can be again.
  Journal(const boost::asio::any_io_executor& executor, std::string path,
          std::function<Holdings()> held, LogSink log, OnFailure on_failure)
      : clock_(executor),
        path_(std::move(path)),
        held_(std::move(held)),
        log_(std::move(log)),
        on_failure_(std::move(on_failure)) {}

  /// What another run has left; nothing where there is no file. Errors: in words, also for a
  /// version that this one does not know.
  static tl::expected<Holdings, std::string> read(const std::string& path);
  /// Returns when the file says what is held now, or a log line that it could not be written. From
  /// then on it follows what is held, within a second, for as long as there is anything.
  static boost::asio::awaitable<void> write(std::shared_ptr<Journal> self);
  /// Why the file does not say what is held; empty if it does.
  const std::string& failure() const { return failure_; }
  /// Nothing is written any more.
  void close() { closed_ = true; }
  /// Waits for what is being written.
  void join() { writer_.join(); }

 private:
  void note(std::string failure);
  static boost::asio::awaitable<void> follow(std::shared_ptr<Journal> self);

  tmcl::ContextClock clock_;
  std::string path_;
  std::function<Holdings()> held_;
  LogSink log_;
  OnFailure on_failure_;
  LogLimiter limiter_;
  std::string failure_;
  Workers writer_{1};
  std::optional<Holdings> last_;  ///< Given to the writer; nothing if it may not be in the file.
  std::size_t writing_ = 0;       ///< In progress.
  std::uint64_t number_ = 0;
  /// The newest that is in the file: what is older does not replace it.
  std::shared_ptr<std::uint64_t> written_ = std::make_shared<std::uint64_t>(0);
  bool follows_ = false;
  bool closed_ = false;
};

/// What the answer of a call says that needs the journal, where it could not be written: `failure`
/// is not empty.
std::string journal_warning(const std::string& failure);

}  // namespace tmcld
