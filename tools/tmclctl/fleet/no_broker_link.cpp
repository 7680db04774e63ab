// Where libmosquitto is not there.
#include "fleet/fleet_link.hpp"

namespace tmclctl {

Result<std::unique_ptr<FleetLink>> open_fleet(const FleetPlace&, Host&) {
  return tl::unexpected(usage_error("no_fleet", "this tmclctl was built without libmosquitto",
                                    "'tmclctl --url' reaches one gateway at a time"));
}

}  // namespace tmclctl
