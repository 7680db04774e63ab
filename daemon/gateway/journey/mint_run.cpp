#include "gateway/journey/mint_run.hpp"

#include <map>
#include <utility>

namespace tmcld {
namespace {

using Module = std::pair<std::string, tmcl::ModuleAddress>;

std::vector<tmcl::plan::MintDriveAxis> drive_axes(const std::vector<DriveMember>& members) {
  std::map<Module, std::size_t> modules;
  const auto module_of = [](const DriveMember& member) {
    return Module{member.axis->bus().name(), member.axis->address().module};
  };
  for (const auto& member : members) modules[module_of(member)] = 0;
  std::size_t count = 0;
  for (auto& [module, index] : modules) index = count++;
  std::vector<tmcl::plan::MintDriveAxis> axes;
  for (const auto& member : members)
    axes.push_back({modules.at(module_of(member)), member.axis->address().motor});
  return axes;
}

}  // namespace

MintRun::MintRun(const boost::asio::any_io_executor& executor,
                 std::vector<tmcl::plan::MintDriveGroup> groups, std::vector<DriveMember> members,
                 OnProgress on_progress)
    : AwaitedRun(executor, members, ClaimKind::mint, GatewayEvent::Kind::mint_broken),
      drive_(std::move(groups), drive_axes(members)),
      on_progress_(std::move(on_progress)) {}

}  // namespace tmcld
