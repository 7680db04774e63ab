// The families of modules: their models, their parameters, their units.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "axis/axis_names.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl {
namespace {

std::span<const ParameterInfo> table_of(std::uint16_t model) {
  return axis_parameters(*find_model(model));
}

TEST(Families, HaveModelsThatGoByNameAndNumber) {
  for (const auto* name : {"TMCM-142", "tmcm142", "142"}) {
    ASSERT_NE(find_model(name), nullptr) << name;
    EXPECT_EQ(find_model(name)->number, 142);
  }
  for (const auto* name : {"PD-146", "pd146", "146"}) {
    ASSERT_NE(find_model(name), nullptr) << name;
    EXPECT_EQ(find_model(name)->family, Family::tmc457);
  }
  EXPECT_EQ(find_model("TMCM-146"), nullptr);
  EXPECT_EQ(find_model("6212")->family, Family::sixpoint);
  EXPECT_EQ(find_model("6212")->axes, 6);
  for (const auto& model : models()) {
    EXPECT_EQ(find_model(model.number), &model);
    EXPECT_EQ(find_model(model.name), &model);
  }
}

TEST(Families, OfATmc457AreTwoModels) {
  std::vector<std::uint16_t> numbers;
  for (const auto& model : models())
    if (model.family == Family::tmc457) numbers.push_back(model.number);
  EXPECT_EQ(numbers, (std::vector<std::uint16_t>{142, 146}));
}

TEST(Families, HaveNoTablesForModelsThatNobodyKnows) {
  const Model unknown{9999, "TMCM-9999", 1, Family::tmc429};
  EXPECT_TRUE(axis_parameters(unknown).empty());
  EXPECT_TRUE(global_parameters(unknown).empty());
}

TEST(Families, NameEachParameterOnce) {
  for (const auto& model : models()) {
    for (const auto table : {axis_parameters(model), global_parameters(model)}) {
      for (const auto& row : table) {
        EXPECT_EQ(find_parameter(table, row.number), &row);
        EXPECT_EQ(find_parameter(table, row.name), &row) << model.name << ' ' << row.name;
        for (const auto alias : row.aliases) {
          if (alias.empty()) continue;
          EXPECT_EQ(find_parameter(table, alias), &row) << model.name << ' ' << alias;
        }
      }
    }
  }
}

TEST(Families, AgreeOnWhatTheLibraryUses) {
  const auto first = table_of(1110);
  for (const auto& model : models()) {
    for (std::uint8_t number = 0; number <= 8; ++number) {
      EXPECT_EQ(find_parameter(axis_parameters(model), number)->name,
                find_parameter(first, number)->name);
    }
  }
}

TEST(Families, NameTheirRegistersAsTheDataSheetsDo) {
  const auto number = [](std::uint16_t model, std::string_view name) {
    const auto* row = find_parameter(table_of(model), name);
    return row == nullptr ? -1 : int{row->number};
  };
  EXPECT_EQ(number(1110, "a_max"), 5);
  EXPECT_EQ(number(142, "a_max"), 16);
  EXPECT_EQ(number(142, "d_max"), 17);
  EXPECT_EQ(number(142, "d_stop"), 15);
  EXPECT_EQ(number(142, "bow_max"), 18);
  EXPECT_EQ(number(6212, "amax"), 5);
  EXPECT_EQ(number(6212, "a1"), 15);
  EXPECT_EQ(number(6212, "v1"), 16);
  EXPECT_EQ(number(6212, "dmax"), 17);
  EXPECT_EQ(number(6212, "d1"), 18);
  EXPECT_EQ(number(6212, "vstart"), 19);
  EXPECT_EQ(number(6212, "vstop"), 20);
  EXPECT_EQ(number(6212, "tzerowait"), 21);
}

TEST(Families, HaveTheRangesOfTheirChips) {
  const auto maximum = [](std::uint16_t model, std::uint8_t number) {
    return find_parameter(table_of(model), number)->maximum;
  };
  const auto tmc457 = ramp::Tmc457::registers();
  using R457 = ramp::Tmc457::Register;
  EXPECT_EQ(maximum(142, 4), tmc457[static_cast<std::size_t>(R457::v_max)].maximum);
  EXPECT_EQ(maximum(142, 16), tmc457[static_cast<std::size_t>(R457::a_max)].maximum);
  EXPECT_EQ(maximum(142, 18), tmc457[static_cast<std::size_t>(R457::bow_max)].maximum);
  // In microsteps per second.
  EXPECT_EQ(maximum(6212, 4), 7'999'511);
  EXPECT_EQ(maximum(6212, 16), 999'999);
  EXPECT_EQ(maximum(6212, 19), 249'999);
  EXPECT_EQ(maximum(6212, 5), 7'629'278);
}

// The names that one number has on a module of each family: TMC429, TMC457, sixPoint, TMC4361, and
// firmware of a TMCM-1021 and of a TMCM-1311. Empty: no such parameter.
struct Meaning {
  std::uint8_t number;
  std::array<std::string_view, 6> names;
};

TEST(Families, MeanDifferentThingsByTheSameNumber) {
  constexpr std::array<std::uint16_t, 6> models_asked{1110, 142, 6212, 1111, 1021, 1311};
  constexpr auto meanings = std::to_array<Meaning>({
      {14, {"", "", "swap_limit_switches", "ramp_type", "", "cl_torque_mode_target_current"}},
      {15,
       {"", "stop_deceleration", "acceleration_a1", "start_velocity", "",
        "maximum_possible_current"}},
      {16, {"", "acceleration", "velocity_v1", "start_acceleration", "", "cl_velocity_reached"}},
      {17,
       {"", "max_deceleration", "max_deceleration", "max_deceleration", "",
        "cl_velocity_reached_window"}},
      {18, {"", "max_bow", "deceleration_d1", "break_velocity", "", "status_word"}},
      {19, {"", "", "start_velocity", "final_deceleration", "", "cl_torque_mode_actual_current"}},
      {20, {"", "", "stop_velocity", "stop_velocity", "", "cl_torque_mode_slope"}},
      {21, {"", "", "ramp_wait_time", "stop_deceleration", "", ""}},
      {22, {"", "", "high_speed_threshold", "bow1", "", ""}},
      {26, {"", "", "soft_stop", "virtual_stop_left", "", "iit_limit"}},
      {33, {"", "", "dcstep_stallguard", "swap_limit_switches", "", ""}},
      {34, {"", "", "", "soft_stop", "", ""}},
      {41, {"", "encoder_position", "", "", "", ""}},
      {128, {"", "ramp_mode", "", "", "", "ramp_mode"}},
      {129, {"", "status_flags", "", "closed_loop_mode", "", "closed_loop_mode"}},
      {130,
       {"minimum_velocity", "velocity_reached", "", "", "minimum_velocity", "start_stop_velocity"}},
      {135, {"actual_acceleration", "", "", "", "", "cl_position_reached_time"}},
      {138,
       {"ramp_mode", "", "", "encoder_mean_interval", "", "cl_standstill_position_error_limit"}},
      {149, {"soft_stop", "", "", "", "", ""}},
      {150,
       {"end_switch_power_down", "", "", "encoder_input_sample_rate", "",
        "cl_actual_motor_current"}},
      {153, {"ramp_divisor", "", "", "", "", "supply_voltage"}},
      {154, {"pulse_divisor", "", "", "", "", "actual_dc_current"}},
      {213, {"group_index", "", "group_index", "max_velocity_encoder_deviation", "", ""}},
      {255, {"", "unit_mode", "unit_mode", "", "", ""}},
  });
  for (const auto& [number, names] : meanings) {
    for (std::size_t i = 0; i < models_asked.size(); ++i) {
      const auto* row = find_parameter(table_of(models_asked[i]), number);
      EXPECT_EQ(row == nullptr ? "" : row->name, names[i]) << number + 0 << ' ' << models_asked[i];
    }
  }
}

TEST(Families, DifferFromModelToModel) {
  const auto name = [](std::uint16_t model, std::uint8_t number) {
    const auto* row = find_parameter(table_of(model), number);
    return row == nullptr ? std::string_view{} : row->name;
  };
  EXPECT_EQ(name(1210, 12), "right_limit_switch_disable");
  EXPECT_EQ(name(1276, 12), "automatic_right_stop");
  EXPECT_EQ(name(1378, 12), "right_limit_switch_enable_polarity");
  EXPECT_EQ(name(6214, 43), "position_compare_pulse_length");
  EXPECT_EQ(name(3216, 43), "position_compare_position");
  EXPECT_EQ(name(1140, 178), "short_detection_time");
  EXPECT_EQ(name(1260, 178), "global_current_scaler");
  EXPECT_EQ(name(1160, 210), "encoder_prescaler");
  EXPECT_EQ(name(1161, 210), "encoder_resolution");
  EXPECT_EQ(name(6212, 210), "encoder_clear_on_null");
  EXPECT_EQ(name(1370, 140), "");
  EXPECT_EQ(find_parameter(table_of(351), "load_value")->maximum, 7);
  EXPECT_EQ(find_parameter(table_of(6110), "load_value")->maximum, 1023);
}

TEST(Globals, AreThoseOfTheModel) {
  const auto has = [](std::uint16_t model, std::string_view name) {
    return find_parameter(global_parameters(*find_model(model)), name) != nullptr;
  };
  EXPECT_TRUE(has(1110, "serial_baud_rate"));
  EXPECT_FALSE(has(1276, "serial_baud_rate"));
  EXPECT_TRUE(has(1276, "can_bit_rate"));
  EXPECT_FALSE(has(1161, "can_bit_rate"));
  EXPECT_TRUE(has(1110, "end_switch_polarity"));
  EXPECT_FALSE(has(6212, "end_switch_polarity"));
  const auto secondary = [](std::uint16_t model) {
    return find_parameter(global_parameters(*find_model(model)), "serial_secondary_address")
        ->number;
  };
  EXPECT_EQ(secondary(6212), 87);
  EXPECT_EQ(secondary(6214), 86);
  for (const auto& model : models()) {
    for (const auto* name : {"application_status", "program_counter", "tmcl_error", "tick_timer"}) {
      EXPECT_TRUE(has(model.number, name)) << model.name << ' ' << name;
    }
  }
}

TEST(Globals, HaveRangesInEveryBank) {
  const auto& model = *find_model(3110);
  EXPECT_EQ(global_range(model, 0, 65)->maximum, 11);
  EXPECT_EQ(global_range(model, 0, 133)->access, Access::read);
  EXPECT_EQ(global_range(model, 0, 1), std::nullopt);
  EXPECT_EQ(global_range(model, 1, 65), std::nullopt);
  EXPECT_TRUE(global_range(model, 2, 55)->stored);
  EXPECT_FALSE(global_range(model, 2, 56)->stored);
  EXPECT_EQ(global_range(model, 2, 255)->minimum, INT32_MIN);
  EXPECT_EQ(global_range(model, 3, 2)->maximum, INT32_MAX);
  EXPECT_EQ(global_range(model, 3, 3), std::nullopt);
  EXPECT_EQ(global_range(model, 3, 26), std::nullopt);
  EXPECT_EQ(global_range(model, 3, 38)->maximum, 3);
  EXPECT_EQ(global_range(model, 3, 39)->maximum, 3);
  EXPECT_EQ(global_range(model, 3, 46)->maximum, 3);
  EXPECT_EQ(global_range(model, 3, 47), std::nullopt);
}

TEST(Families, HaveInCommonWhatNoTwoModelsDisagreeOn) {
  const auto common = tmclctl::common_parameters();
  for (const auto& model : models()) {
    const auto table = axis_parameters(model);
    for (const auto& row : common) {
      const auto* same_number = find_parameter(table, row.number);
      EXPECT_TRUE(same_number == nullptr || same_number->name == row.name) << row.name;
      for (const auto name : {row.name, row.aliases[0], row.aliases[1]}) {
        const auto* same_name = find_parameter(table, name);
        EXPECT_TRUE(same_name == nullptr || same_name->number == row.number) << name;
      }
    }
  }
  EXPECT_EQ(find_parameter(common, "max_velocity")->number, 4);
  EXPECT_EQ(find_parameter(common, "bow_max"), nullptr);  // 18 is D1 elsewhere
  EXPECT_EQ(find_parameter(common, "ramp_mode"), nullptr);
  EXPECT_EQ(find_parameter(common, "a_max"), nullptr);
}

}  // namespace
}  // namespace tmcl
