/// A Mint program on axes, run by the daemon itself.
#pragma once

#include <algorithm>

#include "gateway/journey/awaited_run.hpp"
#include "tmcl/plan/mint_drive.hpp"

namespace tmcld {

class MintRun final : public AwaitedRun {
 public:
  /// Also told when a group has come to its end, once for each.
  using OnProgress = std::function<void(const MintRun& run)>;

  /// `members` are the axes of the groups.
  MintRun(const boost::asio::any_io_executor& executor,
          std::vector<tmcl::plan::MintDriveGroup> groups, std::vector<DriveMember> members,
          OnProgress on_progress);

  const tmcl::plan::MintReport& report() const override { return drive_.report(); }
  const std::vector<tmcl::plan::MintDriveGroup>& groups() const { return drive_.groups(); }
  /// Of the group that is under way.
  tmcl::Duration passed() const { return std::max(tmcl::Duration{}, now() - drive_.group_begin()); }

 private:
  tmcl::plan::Drive& what_drives() override { return drive_; }
  void tell_progress() override { on_progress_(*this); }

  tmcl::plan::MintDrive drive_;
  OnProgress on_progress_;
};

}  // namespace tmcld
