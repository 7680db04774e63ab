// A host that knows nothing of the simulator reads an axis over a pty, foresees its moves, and
// watches them: each ends when it was said to, as far as a host can tell.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "support/program.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/prediction.hpp"

namespace tmcl::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;
namespace ap = axis_parameter;

constexpr int moves = 12;
constexpr auto tolerance = milliseconds(1);

// Something happened at some time between these two.
struct Bracket {
  Clock::time_point earliest;
  Clock::time_point latest;
};

struct Kind {
  const char* model;
  std::uint16_t address;
};

class Foreseen : public testing::TestWithParam<Kind> {
 protected:
  Foreseen()
      : folder_(make_folder()),
        simulator_({"tmclsim", "--module", "TMCM-1110@1", "--module", "TMCM-142@2", "--module",
                    "TMCM-6212@3", "--pty", folder_ + "/bus"}),
        ready_(simulator_.wait_for("ready")),
        bus_(blocking::Bus::open("serial:" + folder_ + "/bus@115200")),
        address_{ModuleAddress{GetParam().address}, 0} {}
  ~Foreseen() override { std::filesystem::remove_all(folder_); }

  plan::AxisTwin twin() {
    const auto& model = *find_model(GetParam().model);
    auto ramp = bus_->run(verbs::read_ramp(address_, model));
    return bus_->run(verbs::read_twin(address_, model, std::move(ramp.value()))).value();
  }

  Bracket start(Microsteps target) {
    const auto before = Clock::now();
    EXPECT_TRUE(bus_->run(verbs::move_to(address_, target)));
    return {before, Clock::now()};
  }

  // Between the last look that did not show it standing there, and the first that did.
  Bracket watch(Microsteps target) {
    Bracket arrival{Clock::now(), {}};
    const auto end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
      const auto before = Clock::now();
      const auto speed = bus_->run(verbs::velocity(address_));
      const auto place = bus_->run(verbs::position(address_));
      if (speed->value == 0 && *place == target) {
        arrival.latest = Clock::now();
        return arrival;
      }
      arrival.earliest = before;
      std::this_thread::sleep_for(milliseconds(1));
    }
    ADD_FAILURE() << "it has not arrived";
    return arrival;
  }

 private:
  static std::string make_folder() {
    auto name = (std::filesystem::temp_directory_path() / "tmcl-foreseen-XXXXXX").string();
    return ::mkdtemp(name.data());
  }

  std::string folder_;
  Program simulator_;
  bool ready_;
  Result<blocking::Bus> bus_;
  AxisAddress address_;
};

TEST_P(Foreseen, ToAMillisecondByWhoeverWatchesOverAPty) {
  Random<> random(seed());
  std::int64_t here = 0;
  for (int i = 0; i < moves; ++i) {
    const auto way = random.either_way(random.between(500, 40'000));
    here += way;
    const Microsteps target{static_cast<std::int32_t>(here)};
    auto foreseen = twin();
    foreseen.move_to(target);
    const auto duration = foreseen.time_to_arrival();
    ASSERT_TRUE(duration);
    const auto begin = start(target);
    const auto end = watch(target);
    EXPECT_LE(end.earliest - tolerance, begin.latest + *duration) << "it was later than foreseen";
    EXPECT_GE(end.latest + tolerance, begin.earliest + *duration) << "it was earlier than foreseen";
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Foreseen,
                         testing::Values(Kind{"TMCM-1110", 1}, Kind{"TMCM-142", 2},
                                         Kind{"TMCM-6212", 3}),
                         [](const auto& kind) {
                           std::string name = kind.param.model;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace tmcl::test
