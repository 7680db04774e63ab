/// A journey whose caller waits for its end: a path, or a Mint program.
///
/// It has been checked before, and it ends; so it needs no watcher. Whatever goes wrong
/// on the way, all its axes are stopped and their settings are set back: a stop of one of them by
/// anyone, a command that fails, an axis that is not where it should be.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "gateway/journey/drive_run.hpp"

namespace tmcld {

constexpr tmcl::Duration progress_interval = std::chrono::milliseconds(200);

class AwaitedRun : public DriveRun {
 public:
  /// Returns when it has ended, whether at its end or not, and nothing moves any more. Once.
  /// Errors: those of claim_all(), and of admission. What became of it is in the report.
  static boost::asio::awaitable<std::optional<tmcl::Error>> pass(std::shared_ptr<AwaitedRun> self);

  /// What becomes of it is in the report.
  void end(tmcl::plan::DriveFault why);
  /// One of its axes may have been stopped.
  void look() { woken_.notify(); }

  /// Returns when something has become of it, or then.
  static boost::asio::awaitable<void> until_told(std::shared_ptr<AwaitedRun> self,
                                                 tmcl::TimePoint until);

  virtual const tmcl::plan::DriveReport& report() const = 0;
  bool has_ended() const { return ended_; }
  /// Once it has ended: those that could not be stopped and may still move.
  std::vector<std::string> unstopped() const;
  /// A fault in words, and what has not been stopped.
  std::string text_of(const tmcl::plan::DriveFault& fault) const;
  std::vector<std::string> axis_names() const;

 protected:
  AwaitedRun(const boost::asio::any_io_executor& executor, std::vector<DriveMember> members,
             ClaimKind kind, GatewayEvent::Kind when_broken)
      : DriveRun(executor, std::move(members)),
        claim_kind_(kind),
        when_broken_(when_broken),
        executor_(executor) {}

  virtual tmcl::plan::Drive& what_drives() = 0;
  /// Called at the beginning, and then every progress_interval.
  virtual void tell_progress() = 0;
  /// To all that wait for that.
  void tell();

 private:
  boost::asio::awaitable<std::optional<tmcl::Error>> take_axes();
  boost::asio::awaitable<tmcl::TimePoint> before_step() override;
  GatewayAxis::Awaitable<void> stop(GatewayAxis& axis) override;
  GatewayAxis::Awaitable<void> write(const DriveMember& member, tmcl::plan::Setting setting,
                                     bool restores) override;
  /// The client that asked may be gone.
  void tell_fault() const;

  ClaimKind claim_kind_;
  GatewayEvent::Kind when_broken_;
  boost::asio::any_io_executor executor_;
  std::vector<std::shared_ptr<Wake>> waiting_;
  tmcl::TimePoint progress_due_{};
  bool ended_ = false;
};

}  // namespace tmcld
