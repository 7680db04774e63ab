/// A course on axes, passed by the daemon itself.
#pragma once

#include "gateway/journey/awaited_run.hpp"
#include "gateway/journey/path_words.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/stream.hpp"

namespace tmcld {

class PathRun final : public AwaitedRun {
 public:
  using OnProgress = std::function<void(const PathRun& run)>;

  /// `axes` are those of the members, in the order of the course; `name`: what its client calls it.
  PathRun(const boost::asio::any_io_executor& executor, tmcl::plan::Course course,
          std::vector<DriveMember> members, std::vector<tmcl::plan::StreamAxis> axes,
          tmcl::plan::StreamOptions options, PathWords words, std::string name,
          OnProgress on_progress)
      : AwaitedRun(executor, std::move(members), ClaimKind::path, GatewayEvent::Kind::path_broken),
        course_(std::move(course)),
        mode_(options.mode),
        words_(std::move(words)),
        name_(std::move(name)),
        stream_(course_, std::move(axes), options),
        on_progress_(std::move(on_progress)) {}

  void pause(bool on) {
    stream_.pause(on);
    woken_.notify();
  }
  /// Part of the planned speed, in a mode that takes_feed().
  void set_feed(double factor) {
    stream_.set_feed(factor);
    woken_.notify();
  }
  tmcl::plan::StreamFeed feed() const { return stream_.feed(); }
  /// Null if it waits at no M0.
  const tmcl::plan::CourseHalt* waits_at() const { return stream_.waits_at(); }
  tmcl::plan::StreamMode mode() const { return mode_; }
  const std::string& name() const { return name_; }
  const tmcl::plan::Course& course() const { return course_; }
  const tmcl::plan::StreamReport& report() const override { return stream_.report(); }
  tmcl::plan::PathStream::Phase phase() const { return stream_.phase(); }
  double passed() const { return stream_.passed(); }
  double duration() const { return course_.duration(); }

 private:
  tmcl::plan::Drive& what_drives() override { return stream_; }
  void tell_progress() override { on_progress_(*this); }
  boost::asio::awaitable<tmcl::Result<void>> carry_out_word(int word, bool at_stop) override {
    RunOptions options;
    options.permit = members_.front().movement.permit;
    if (!at_stop) options.objection = [this] { return objection(); };
    return words_.carry_out(word, std::move(options));
  }

  tmcl::plan::Course course_;
  tmcl::plan::StreamMode mode_;
  PathWords words_;
  std::string name_;
  tmcl::plan::PathStream stream_;
  OnProgress on_progress_;
};

}  // namespace tmcld
