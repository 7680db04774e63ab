// A simulated module whose traits were chosen by chance: a verification finds each of them, or says
// which ones it cannot tell apart, and leaves the module as it was.
#include <gtest/gtest.h>

#include <random>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/verified_module.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
namespace ap = axis_parameter;

constexpr auto measurable = std::to_array<Trait>(
    {Trait::last_step, Trait::factor_rule, Trait::order, Trait::accumulator, Trait::relative_from,
     Trait::relative_answer, Trait::velocity_target, Trait::range_check, Trait::addressing});

class Verified : public testing::Test {
 protected:
  std::int32_t some(std::int32_t least, std::int32_t most) {
    return std::uniform_int_distribution(least, most)(random);
  }
  ModuleTraits some_traits(const Model& model) {
    ModuleTraits traits;
    for (const auto trait : measurable) {
      const auto& info = trait_table()[static_cast<std::size_t>(trait)];
      if (concerns(trait, model))
        traits.set(trait, static_cast<std::uint8_t>(
                              some(0, static_cast<std::int32_t>(info.variants.size()) - 1)));
    }
    return traits;
  }
  /// It has moved before, and stands anywhere.
  void move_about(test::VerifiedModule& module) {
    module.lone.ask(Command::SAP, number_of("pulse_divisor"), some(3, 8));
    module.lone.ask(Command::SAP, number_of("ramp_divisor"), some(4, 9));
    module.lone.ask(Command::SAP, ap::max_velocity, some(100, 1500));
    module.lone.ask(Command::SAP, ap::max_acceleration, some(10, 500));
    module.lone.ask(Command::MVP, 0, some(-3000, 3000));
    module.pass(std::chrono::milliseconds(some(0, 5000)));
    module.lone.ask(Command::MST, 0, 0);
    module.pass(60s);
  }

  std::mt19937_64 random{test::seed()};
};

std::string text_of(const ModuleTraits& traits) {
  std::string text;
  for (const auto& info : trait_table()) {
    if (const auto variant = traits.find(info.trait))
      text += std::string(info.name) + "=" + std::string(info.variants[*variant]) + " ";
  }
  return text;
}

void expect_found(const Verification& found, const ModuleTraits& traits, bool all) {
  for (const auto& finding : found.traits) {
    const auto is = traits.find(finding.trait);
    if (!is || !finding.measured) continue;
    const auto& info = trait_table()[static_cast<std::size_t>(finding.trait)];
    EXPECT_EQ(std::ranges::count(finding.fits, *is), 1)
        << info.name << " is " << info.variants[*is] << ": " << finding.text;
    // Which stage is first looks like another phase of the ramp's tick, in most movements.
    const bool is_to_be_found = all && finding.trait != Trait::order;
    EXPECT_TRUE(!is_to_be_found || finding.fits.size() == 1) << info.name << ": " << finding.text;
  }
}

TEST_F(Verified, NamesEachTraitOfATmc429ModuleAndLeavesItAsItWas) {
  const auto& model = *find_model("TMCM-1110");
  for (int round = 0; round < test::rounds(20) && !HasFailure(); ++round) {
    sim::ModuleSettings settings;
    settings.traits = some_traits(model);
    SCOPED_TRACE(text_of(settings.traits));
    test::VerifiedModule module(model, settings);
    module.random.seed(random());
    move_about(module);
    auto options = module.options();
    const auto home = module.get(ap::actual_position);
    options.travel = {home - 100, home + 100};
    module.after_each = [&] { EXPECT_LE(std::abs(module.get(ap::actual_position) - home), 100); };
    const auto found = module.verify(options);
    ASSERT_TRUE(found) << found.error().message;
    expect_found(*found, settings.traits, true);
    EXPECT_EQ(module.get(ap::actual_position), home);
    for (const auto& [parameter, value] : options.settings)
      EXPECT_EQ(module.get(parameter), value) << int{parameter};
  }
}

TEST_F(Verified, NamesNothingWrongOnASlowLine) {
  const auto& model = *find_model("TMCM-6110");
  for (int round = 0; round < test::rounds(5) && !HasFailure(); ++round) {
    sim::ModuleSettings settings;
    settings.traits = some_traits(model);
    SCOPED_TRACE(text_of(settings.traits));
    test::VerifiedModule module(model, settings);
    module.random.seed(random());
    const auto least = std::chrono::milliseconds(some(5, 40));
    module.exchange_time = {least, least * some(1, 4)};
    const auto found = module.verify();
    ASSERT_TRUE(found) << found.error().message;
    expect_found(*found, settings.traits, false);
  }
}

}  // namespace
}  // namespace tmcl
