// Structs of methods and the JSON that stands for them.
#include <gmock/gmock.h>

#include <boost/json.hpp>

#include "tmcl/api/axis.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/system.hpp"

namespace tmcl::api {
namespace {

namespace json = boost::json;

/// What a client writes and a daemon reads: also the other way round.
template <class T>
void expect_same_again(const T& object) {
  const auto written = to_json(object);
  EXPECT_EQ(to_json(from_json<T>(written)), written);
}

TEST(ApiFields, AreNamedAsTheirMembers) {
  constexpr std::string_view names[] = {"axis", "position_microsteps", "position", "predict",
                                        "deadline_ms"};
  ASSERT_EQ(rows<axis::MoveTo>.size(), std::size(names));
  for (std::size_t i = 0; i < std::size(names); ++i)
    EXPECT_EQ(rows<axis::MoveTo>[i].name, names[i]);
  EXPECT_EQ(name_of<&axis::MoveTo::deadline_ms>(), "deadline_ms");
  EXPECT_EQ(name_of<&module::Execute::bus>(), "bus");
}

TEST(ApiFields, OfBasesComeFirst) {
  const auto& all = rows<module::Execute>;
  EXPECT_EQ(all.front().name, "bus");
  EXPECT_EQ(all[2].name, "deadline_ms");
  EXPECT_EQ(all.back().name, "value");
}

TEST(ApiFields, KnowWhatTheyAre) {
  const auto& row = rows<axis::MoveTo>;
  EXPECT_TRUE(row[0].required);
  EXPECT_FALSE(row[1].required);
  EXPECT_EQ(row[0].type, FieldType::text);
  EXPECT_EQ(row[2].type, FieldType::quantity);
  EXPECT_EQ(row[4].maximum, axis::longest_ms);
  const auto& motor = rows<module::Execute>[5];
  EXPECT_EQ(motor.name, "motor");
  EXPECT_EQ(motor.maximum, 255) << "of its type";
  EXPECT_EQ(rows<line::Move>[1].type, FieldType::integers);
  EXPECT_EQ(rows<axis::Axes>[0].type, FieldType::objects);
}

TEST(ApiFields, OfAMethodAreLeftOutWithoutAValue) {
  EXPECT_EQ(to_json(axis::MoveTo{.axis = "x", .position = "12.5mm"}),
            (json::object{{"axis", "x"}, {"position", "12.5mm"}}));
  EXPECT_EQ(to_json(axis::MoveTo{.axis = "x", .position = 12.5, .predict = false}),
            (json::object{{"axis", "x"}, {"position", 12.5}, {"predict", false}}));
  EXPECT_EQ(to_json(axis::MoveTo{.axis = "x", .position = Quantity{300, "um"}}).at("position"),
            "300um");
}

TEST(ApiFields, OfAResultAreNullWithoutAValue) {
  EXPECT_EQ(to_json(axis::StartedMove{.target_microsteps = 7}),
            (json::object{{"target_microsteps", 7},
                          {"unit", nullptr},
                          {"target", nullptr},
                          {"predicted_s", nullptr},
                          {"warnings", nullptr}}));
}

TEST(ApiFields, BecomeTheSameAgain) {
  expect_same_again(axis::MoveTo{.axis = "x", .position = "12.5mm"});
  expect_same_again(module::Execute{{{"bench", 3}, 500}, "GAP", 4, {}, -7});
  expect_same_again(line::Move{.axes = {"x", "y"}, .positions = {{1.5, "2mm"}}});
  expect_same_again(axis::Axes{{{"x", "bench", 1, 0, "TMCM-1110", "ready", "mm"}, {}}});
  expect_same_again(bus::Buses{{{"bench", "can:can0", "open", {}, 500000, {1, 2, 3, 4, 5, 6, 7}}}});
}

TEST(ApiFields, StayAsTheyAreWhereTheJsonIsOfAnotherKind) {
  const auto read = from_json<axis::State>({{"axis", 7},
                                            {"position_microsteps", 1e3},
                                            {"velocity_internal", 1.5},
                                            {"target_microsteps", 1e300},
                                            {"moving", "yes"},
                                            {"velocity", true},
                                            {"from_a_newer_daemon", json::array{}}});
  EXPECT_EQ(read.axis, "");
  EXPECT_EQ(read.position_microsteps, 1000);
  EXPECT_EQ(read.velocity_internal, 0);
  EXPECT_EQ(read.target_microsteps, 0);
  EXPECT_FALSE(read.moving);
  EXPECT_FALSE(read.velocity);
  EXPECT_EQ(from_json<module::Execute>({{"motor", 256}, {"address", -1}}).motor, std::nullopt);
}

TEST(ApiFields, OfListsKeepWhatCanBeRead) {
  const auto read = from_json<axis::Axes>({{"axes", {{{"name", "x"}}, 7, {{"name", "y"}}}}});
  ASSERT_EQ(read.axes.size(), 2U);
  EXPECT_EQ(read.axes[1].name, "y");
}

}  // namespace
}  // namespace tmcl::api
