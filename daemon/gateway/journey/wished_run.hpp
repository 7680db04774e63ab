/// A journey of one axis that is led by calls of one client: each has a wish, and is answered when
/// that has been carried out.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "gateway/journey/awaited_run.hpp"

namespace tmcld {

class WishedRun : public AwaitedRun {
 public:
  std::uint64_t client() const { return members_.front().movement.permit.client; }

  /// Carries out wishes until there are no more.
  static boost::asio::awaitable<void> run(std::shared_ptr<WishedRun> self);
  /// Returns when this wish has been carried out. Errors: what has ended the journey before.
  static GatewayAxis::Awaitable<void> outcome(std::shared_ptr<WishedRun> self, std::uint64_t wish);

 protected:
  WishedRun(const boost::asio::any_io_executor& executor, DriveMember member, ClaimKind kind,
            GatewayEvent::Kind when_broken)
      : AwaitedRun(executor, {std::move(member)}, kind, when_broken) {}

  GatewayAxis& axis() const { return *members_.front().axis; }
  /// The number of the last wish that has been.
  virtual std::uint64_t carried_out() const = 0;
  /// Such as "the jog of axis 'x'".
  virtual std::string what_it_is() const = 0;
  /// It has ended.
  virtual void over() {}
  boost::asio::awaitable<tmcl::TimePoint> before_step() override;
  void aim(const DriveMember& member, tmcl::Microsteps target) const override {
    member.admitted->aim_at({target});
  }

 private:
  void tell_progress() override {}
  tmcl::Error failure_of_run() const;

  std::optional<tmcl::Error> refusal_;  // before it had begun
  bool is_over_ = false;
};

}  // namespace tmcld
