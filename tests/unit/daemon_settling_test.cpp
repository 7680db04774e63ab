// Moves that are done when the encoder says so, on a simulated TMCM-6212 in virtual time.
#include <cmath>

#include "gateway/axis/settling.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/seconds.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

constexpr std::uint8_t encoder = 209;
constexpr double counts_per_mm = 800;

class DaemonSettling : public DaemonPath {
 protected:
  explicit DaemonSettling(const std::string& more = "encoder_counts_per_unit = 800\n")
      : DaemonPath(std::string(in_mm) + "in_position = 0.01\nsettle_ms = 50\n" + more) {}

  /// What the encoder of y reads from now on.
  void encoder_is_at(double mm, double counts = counts_per_mm) {
    on_module([&](Played& played) {
      played.set(1, encoder, static_cast<std::int32_t>(std::lround(mm * counts)));
    });
  }
  tmcl::TimePoint now() {
    return daemon.on_reactor([&] { return reactor->clock.now(); });
  }
  int move_y_to_2() {
    client->result("axis.move_to", {{"axis", "y"}, {"position", 2}});
    return client->send("axis.wait", {{"axis", "y"}});
  }
};

TEST_F(DaemonSettling, TheEncoderMustBeNearEnough) {
  encoder_is_at(1.991);
  const auto answer = client->answer_to(move_y_to_2()).at("result").as_object();
  EXPECT_EQ(answer.at("position"), 2);
  EXPECT_TRUE(answer.at("warnings").as_array().empty());
}

TEST_F(DaemonSettling, AMoveThatItDoesNotConfirmHasFailed) {
  encoder_is_at(1.95);
  const auto error = error_of(move_y_to_2());
  EXPECT_EQ(name_in(error), "not_in_position");
  EXPECT_EQ(text(error.at("data").at("outcome")), "done");
  EXPECT_THAT(
      text(error.at("message")),
      HasSubstr("axis 'y' is at 2 mm by its counter, and by its encoder 0.05 mm from there: "
                "'in_position' allows 0.01"));
  EXPECT_NEAR(error.at("data").at("off").to_number<double>(), 0.05, 1e-9);
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("tmclctl home y"));
}

TEST_F(DaemonSettling, TheLoadMayComeLater) {
  encoder_is_at(1);
  const auto waiting = move_y_to_2();
  ASSERT_TRUE(daemon.eventually([&] { return module.mm(1) == 2; }));
  daemon.run_for(std::chrono::seconds(2));
  const auto in_place = now();
  encoder_is_at(2.005);
  EXPECT_EQ(client->answer_to(waiting).at("result").at("position"), 2);
  EXPECT_GE(now() - in_place, std::chrono::milliseconds(50));
}

TEST_F(DaemonSettling, TheTimeOfTheClientEndsIt) {
  encoder_is_at(1);
  client->result("axis.move_to", {{"axis", "y"}, {"position", 2}});
  const auto begin = now();
  const auto error = client->error("axis.wait", {{"axis", "y"}, {"timeout_ms", 1500}});
  EXPECT_LT(now() - begin, std::chrono::seconds(2));
  EXPECT_EQ(name_in(error), "deadline_passed");
}

TEST_F(DaemonSettling, WaitsInPartsAreOneWait) {
  encoder_is_at(1);
  client->result("axis.move_to", {{"axis", "y"}, {"position", 2}});
  const auto begin = now();
  std::string name;
  do {
    name = name_in(client->error("axis.wait", {{"axis", "y"}, {"timeout_ms", 700}}));
  } while (name == "deadline_passed" && now() - begin < std::chrono::seconds(20));
  EXPECT_EQ(name, "not_in_position");
  EXPECT_LT(now() - begin, std::chrono::seconds(7));
}

class DaemonSettlingReversed : public DaemonSettling {
 protected:
  DaemonSettlingReversed() : DaemonSettling("encoder_lines = 1000\nreverse = true\n") {}
};

TEST_F(DaemonSettlingReversed, AnEncoderOnTheShaftCountsAsTheMotorTurns) {
  encoder_is_at(-1.995, 4000 / 5.0);
  EXPECT_EQ(client->answer_to(move_y_to_2()).at("result").at("position"), 2);
}

class DaemonSettlingInMicrosteps : public DaemonSettling {
 protected:
  DaemonSettlingInMicrosteps() : DaemonSettling("") {}
};

TEST_F(DaemonSettlingInMicrosteps, WithoutAScaleTheEncoderCountsThem) {
  encoder_is_at(2.009, microsteps_per_mm);
  EXPECT_EQ(client->answer_to(move_y_to_2()).at("result").at("position"), 2);
  encoder_is_at(2.02, microsteps_per_mm);
  EXPECT_EQ(name_in(error_of(client->send("axis.wait", {{"axis", "y"}}))), "not_in_position");
}

TEST(DaemonConfig, TellsWhatIsWrongWithSettling) {
  const auto problem = [](const std::string& lines) {
    const auto config = parse_config("[daemon]\nsocket = \"/run/a\"\n" + std::string(bench_bus) +
                                     axis_section("x", 0, lines));
    return config ? std::string("none") : config.error().front().message;
  };
  EXPECT_THAT(problem("settle_ms = 5\n"), HasSubstr("means nothing without 'in_position'"));
  EXPECT_THAT(problem("in_position = 0\n"), HasSubstr("greater than 0"));
}

// ---- the rule ----

/// Looks of an encoder that swings, each so long after the one before; the answer takes 2 ms.
struct Swing {
  explicit Swing(tmcl::test::Random<>& random) {
    period = std::chrono::milliseconds(random.between(5, 300));
    decay = std::chrono::milliseconds(random.between(1, 1000));
    amplitude = static_cast<double>(random.between(0, 1000));
    rest = static_cast<double>(random.between(-15, 15));
  }
  double at(tmcl::Duration time) const {
    const auto in = [&](tmcl::Duration part) { return tmcl::seconds(time) / tmcl::seconds(part); };
    return rest + amplitude * std::exp(-in(decay)) * std::cos(2 * M_PI * in(period));
  }
  tmcl::Duration period{};
  tmcl::Duration decay{};
  double amplitude = 0;
  double rest = 0;
};

// For as long as it must have been near enough, every look at it was.
TEST(Settling, IsOverWhenNoLookOfTheLastWhileWasOff) {
  const EncoderWindow window{encoder, 0, 10, 1};
  constexpr auto answer_takes = std::chrono::milliseconds(2);
  tmcl::test::Random random(tmcl::test::seed());
  int settled = 0;
  for (int round = 0; round < 500; ++round) {
    const Swing swing(random);
    const tmcl::Duration steady = std::chrono::milliseconds(random.between(1, 200));
    tmcl::TimePoint now{};
    const auto give_up = now + std::chrono::seconds(2);
    auto script = settle({tmcl::ModuleAddress{1}, 0}, window, steady, give_up);
    std::vector<std::pair<tmcl::TimePoint, double>> looks;
    auto step = script.start(now);
    while (step) {
      tmcl::StepResult results;
      if (const auto* pause = std::get_if<tmcl::step::Pause>(&*step)) {
        now += pause->duration;
      } else {
        const auto& asked = std::get<tmcl::step::Exchange>(*step).request;
        now += answer_takes / 2;
        const auto value = static_cast<std::int32_t>(std::lround(swing.at(now.time_since_epoch())));
        looks.emplace_back(now, value);
        now += answer_takes / 2;
        results.push_back(
            tmcl::Answer{{tmcl::default_host_address, 1, tmcl::Status::ok, asked.command, value}});
      }
      step = script.resume(std::move(results), now);
    }
    const auto off = script.take();
    ASSERT_TRUE(off);
    if (*off) {
      EXPECT_GE(now, give_up);
      EXPECT_GT(std::abs(**off), window.width);
      continue;
    }
    ++settled;
    for (const auto& [time, value] : looks) {
      if (time < now - steady) continue;
      ASSERT_LE(std::abs(value), window.width) << "round " << round;
    }
  }
  EXPECT_GT(settled, 100);
}

}  // namespace
}  // namespace tmcld::test
