/// A course on axes, passed by the daemon itself.
///
/// It has been checked before, and it ends; so it needs nobody who watches it. Whatever goes wrong
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
#include <tl/expected.hpp>

#include "gateway/drive_run.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/stream.hpp"

namespace tmcld {

constexpr tmcl::Duration path_progress_interval = std::chrono::milliseconds(200);

using PathMember = DriveMember;

class PathRun final : public DriveRun {
 public:
  /// Told at the beginning, and then every path_progress_interval.
  using OnProgress = std::function<void(const PathRun& run)>;

  /// `axes` are those of the members, in the order of the course.
  PathRun(const boost::asio::any_io_executor& executor, tmcl::plan::Course course,
          std::vector<PathMember> members, std::vector<tmcl::plan::StreamAxis> axes,
          tmcl::plan::StreamOptions options, OnProgress on_progress);

  /// Returns when it has ended, whether at its end or not, and nothing moves any more. Once.
  /// Errors: those of claim_all().
  static boost::asio::awaitable<tl::expected<tmcl::plan::StreamReport, AxisFailure>> pass(
      std::shared_ptr<PathRun> self);

  void pause(bool on);
  /// What becomes of it is in the report.
  void end(tmcl::plan::DriveFault why);
  /// One of its axes may have been stopped.
  void look() { woken_.notify(); }

  bool has_ended() const { return ended_; }
  /// Once it has ended: those that could not be stopped and may still move.
  std::vector<std::string> unstopped() const;
  /// A fault in words, and what has not been stopped.
  std::string text_of(const tmcl::plan::DriveFault& fault) const;
  tmcl::plan::PathStream::Phase phase() const { return stream_.phase(); }
  double passed() const { return stream_.passed(); }
  double duration() const { return course_.duration(); }
  std::vector<std::string> axis_names() const;

 private:
  boost::asio::awaitable<std::optional<AxisFailure>> take_axes();
  boost::asio::awaitable<tmcl::TimePoint> before_step() override;
  GatewayAxis::Awaitable<void> stop(GatewayAxis& axis) override;
  GatewayAxis::Awaitable<void> write(const DriveMember& member, tmcl::plan::Setting setting,
                                     bool restores) override;
  /// Whoever asked for the path may be gone.
  void tell_fault() const;

  tmcl::plan::Course course_;
  tmcl::plan::PathStream stream_;
  OnProgress on_progress_;
  tmcl::TimePoint progress_due_{};
  bool ended_ = false;
};

}  // namespace tmcld
