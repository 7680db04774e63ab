/// Carries out on the axes of the gateway what a Drive says.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "gateway/authority/claim.hpp"
#include "gateway/journey/reconnect_grace.hpp"
#include "tmcl/context_clock.hpp"
#include "tmcl/plan/drive.hpp"

namespace tmcld {

struct DriveMember {
  std::shared_ptr<GatewayAxis> axis;
  RunOptions movement;                    ///< Begun when the call came in.
  std::optional<Admitted> admitted = {};  ///< There before anything is driven.
};

class DriveRun : public std::enable_shared_from_this<DriveRun> {
 public:
  virtual ~DriveRun() = default;

  /// Why the journal did not say what has to be put in order, when it had to; empty if it did.
  const std::string& journal_failure() const { return journal_failure_; }

 protected:
  DriveRun(const boost::asio::any_io_executor& executor, std::vector<DriveMember> members)
      : members_(std::move(members)), woken_(executor), clock_(executor) {}

  /// Until the drive has ended, or until it has done enough, with no command under way. What is
  /// thrown in carrying out a command counts as its failure; failure() has it then. If anything
  /// else throws, all axes are stopped until they stand, and so does this.
  boost::asio::awaitable<void> drive(tmcl::plan::Drive& drive, std::function<bool()> is_enough);
  const std::exception_ptr& failure() const { return failure_; }
  /// All of its axes. Errors: those of claim_all().
  boost::asio::awaitable<std::optional<tmcl::Error>> claim(ClaimOwner claim_owner);
  /// They are as they were, or that has failed: what could not be stopped or set back is then, as
  /// soon as its module answers. `report`: null if nothing was driven.
  void release(const tmcl::plan::DriveReport* report);
  tmcl::TimePoint now() const { return clock_.now(); }

  /// It is about to be sent there.
  virtual void aim(const DriveMember& /*member*/, tmcl::Microsteps /*target*/) const {}
  /// Nothing more is commanded once its axes are on their way.
  virtual bool runs_by_itself() const { return false; }
  /// Called before each step; the next time at the latest then.
  virtual boost::asio::awaitable<tmcl::TimePoint> before_step() = 0;
  /// Ends what the axis does.
  virtual GatewayAxis::Awaitable<void> stop(GatewayAxis& axis) = 0;
  /// An M word of G-code.
  virtual boost::asio::awaitable<tmcl::Result<void>> carry_out_word(int word, bool at_stop);
  /// `restores`: it was changed for the drive, and is to be as it was.
  virtual GatewayAxis::Awaitable<void> write(const DriveMember& member, tmcl::plan::Setting setting,
                                             bool restores) = 0;
  /// The right to move an axis, as long as none of them has been stopped by others, and the soft
  /// limits of all allow it.
  Admitted movement_of(const DriveMember& member) const;
  /// Why nothing more may be begun for the drive, if one of its axes was stopped by others.
  std::optional<tmcl::Error> objection() const;

  std::vector<DriveMember> members_;
  Wake woken_;

 private:
  static boost::asio::awaitable<void> watch_modules(std::shared_ptr<DriveRun> self,
                                                    std::size_t drive);
  boost::asio::awaitable<void> take_steps(tmcl::plan::Drive& drive,
                                          std::function<bool()> is_enough);
  /// Axes that were stopped by others end the drive.
  void notice_stops(tmcl::plan::Drive& drive) const;
  boost::asio::awaitable<void> give(tmcl::plan::Drive& drive, tmcl::plan::DriveCommands commands);
  boost::asio::awaitable<void> answer(tmcl::plan::Drive& drive, tmcl::plan::DriveCommand command);
  boost::asio::awaitable<tmcl::Result<std::int32_t>> carry_out(tmcl::plan::DriveCommand command);
  boost::asio::awaitable<tmcl::Result<std::int32_t>> get(const DriveMember& member,
                                                         tmcl::plan::DriveCommand command);
  boost::asio::awaitable<void> enter_journal(const GatewayAxis& axis);
  boost::asio::awaitable<tmcl::Result<std::int32_t>> set(const DriveMember& member,
                                                         tmcl::plan::DriveCommand command);

  tmcl::ContextClock clock_;
  std::vector<Claim> claims_;
  ReconnectGrace patience_;
  std::size_t drives_ = 0;     ///< Begun or ended.
  std::size_t under_way_ = 0;  ///< Beside the coroutine that drives.
  std::exception_ptr failure_;
  std::string journal_failure_;
  std::exception_ptr broken_;  ///< What ends it without the drive.
};

}  // namespace tmcld
