// ramp --model --as: what other programs are given is read back, by our assembler and simulator.
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>

#include <fmt/format.h>

#include "support/program_host.hpp"
#include "tmcl/plan/ramp_registers.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "unit/ctl_bench.hpp"
#include "unit/sim_fixture.hpp"

namespace tmclctl::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;
using tmcl::ramp::RegisterInfo;

const std::vector<std::string> models{"TMCM-1110", "TMCM-142", "TMCM-6212", "TMCM-1378"};

class CtlRampExport : public tmcl::sim::SimTest {
 protected:
  std::vector<std::string> words(const std::string& model, std::vector<std::string> more) const {
    std::vector<std::string> all{"ramp",  "--model",        model,       "--velocity",
                                 "40rpm", "--acceleration", "20000pps/s"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::string exported(const std::string& model, std::vector<std::string> more) {
    more.insert(more.begin(), "--as");
    EXPECT_EQ(ctl.run(words(model, more)), ExitCode::done) << ctl.err;
    return ctl.out;
  }
  /// What `ramp --model --json` says of the same.
  boost::json::object told(const std::string& model) { return ctl.json(words(model, {})); }

  /// In a module that is new.
  tmcl::sim::Module& new_module(const std::string& model) {
    return bench.add(*tmcl::find_model(model), tmcl::ModuleAddress{1});
  }
  void expect_set(const std::string& model, std::uint8_t motor) {
    const auto document = told(model);
    for (const auto& [name, value] : document.at("parameters").as_object()) {
      const auto* row = find_parameter(axis_parameters(*tmcl::find_model(model)), name);
      ASSERT_NE(row, nullptr) << name;
      // In steps of its register.
      EXPECT_NEAR(get(row->number, motor), value.to_number<double>(),
                  0.01 * value.to_number<double>())
          << model << ' ' << name;
    }
  }

  CtlBench ctl;
};

class CtlRampExportOf : public CtlRampExport, public testing::WithParamInterface<std::string> {};

TEST_P(CtlRampExportOf, LinesAreTakenByAModule) {
  new_module(GetParam());
  const auto lines = tmcl::sim::assembled(exported(GetParam(), {"sap"}) + "STOP\n");
  for (const auto& line : lines) {
    if (line.command == Command::STOP) continue;
    EXPECT_EQ(status_of(line.command, line.type, line.motor, line.value), tmcl::Status::ok);
  }
  expect_set(GetParam(), 0);
}

TEST_P(CtlRampExportOf, AProgramSetsItAndEnds) {
  auto& module = new_module(GetParam());
  const std::uint8_t motor = module.model().axes > 1 ? 1 : 0;
  const auto program =
      tmcl::sim::assembled(exported(GetParam(), {"tmc", "--motor", std::to_string(motor)}));
  ASSERT_TRUE(ask(Command::START_DOWNLOAD, 0, 0));
  for (const auto& line : program) ask(line.command, line.type, line.motor, line.value);
  ASSERT_TRUE(ask(Command::END_DOWNLOAD, 0, 0));
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 1, 0), tmcl::Status::ok);
  pass(std::chrono::seconds(1));
  expect_set(GetParam(), motor);
}

/// The value of a register in the words of a table for C; nothing if it is in none of them.
std::optional<std::int64_t> value_in(const std::string& table, const RegisterInfo& info) {
  const std::regex row(R"(\{0x(\w+), 0x(\w+)ul, 0x(\w+)ul\})");
  for (auto found = std::sregex_iterator(table.begin(), table.end(), row);
       found != std::sregex_iterator(); ++found) {
    const auto number = [&](std::size_t group) {
      return std::stoull((*found)[group].str(), nullptr, 16);
    };
    const auto bits = ((std::uint64_t{1} << info.bits.count) - 1) << info.bits.shift;
    EXPECT_EQ(number(3) & ~number(2), 0U) << "all of it is in the mask";
    if (info.bits.are_at(static_cast<std::uint8_t>(number(1))) && (number(2) & bits) == bits)
      return static_cast<std::int64_t>((number(3) & bits) >> info.bits.shift);
  }
  return std::nullopt;
}

TEST_P(CtlRampExportOf, ATableHasTheRegistersOfTheChip) {
  const auto table = exported(GetParam(), {"c"});
  const auto registers = told(GetParam()).at("registers").as_object();
  ASSERT_FALSE(registers.empty());
  const auto chip = tmcl::plan::RampRegisters::of(*tmcl::find_model(GetParam()));
  for (const auto& [name, value] : registers) {
    const auto index = tmcl::ramp::find_register(chip->registers(), name);
    ASSERT_TRUE(index) << name;
    const auto& info = chip->registers()[*index];
    EXPECT_EQ(value_in(table, info), value.to_number<std::int64_t>()) << name;
  }
}

TEST_P(CtlRampExportOf, IsOneDocument) {
  const auto document = boost::json::parse(exported(GetParam(), {"json"})).as_object();
  EXPECT_EQ(document.at("model"), boost::json::value(GetParam()));
  EXPECT_EQ(document.at("parameters").as_array().size(),
            told(GetParam()).at("parameters").as_object().size());
  EXPECT_FALSE(document.at("registers").as_array().empty());
}

constexpr auto name_of_model = [](const auto& model) {
  auto name = model.param;
  std::erase(name, '-');
  return name;
};
INSTANTIATE_TEST_SUITE_P(Models, CtlRampExportOf, testing::ValuesIn(models), name_of_model);

// 24.8 and 22.2 bits, at the addresses of the vendor's register headers.
TEST_F(CtlRampExport, OfATmc4361HasFractions) {
  const auto table = exported("TMCM-1378", {"c"});
  const auto parameters = told("TMCM-1378").at("parameters").as_object();
  const auto row = [](int address, std::uint32_t mask, std::int64_t value) {
    return fmt::format("{{0x{:02X}, 0x{:08X}ul, 0x{:08X}ul}}", address, mask, value);
  };
  const auto velocity = parameters.at("max_velocity").to_number<std::int64_t>();
  const auto acceleration = parameters.at("max_acceleration").to_number<std::int64_t>();
  EXPECT_THAT(table, HasSubstr(row(0x24, 0xFFFF'FFFF, velocity * 256)));
  EXPECT_THAT(table, HasSubstr(row(0x28, 0x00FF'FFFF, acceleration * 4)));
  EXPECT_THAT(table, HasSubstr(row(0x29, 0x00FF'FFFF, acceleration * 4)));
}

// With the bit that the chip takes for set.
TEST_F(CtlRampExport, OfATmc429HasTheFactorOfItsDeceleration) {
  using tmcl::ramp::Tmc429;
  const auto table = exported("TMCM-1110", {"c"});
  Tmc429 chip;
  const auto document = told("TMCM-1110");
  for (const auto& [name, value] : document.at("registers").as_object()) {
    const auto index = tmcl::ramp::find_register(Tmc429::registers(), name);
    ASSERT_TRUE(chip.write(static_cast<Tmc429::Register>(*index), value.to_number<std::int64_t>()));
  }
  const auto pmul = chip.read(Tmc429::Register::pmul);
  const auto pdiv = chip.read(Tmc429::Register::pdiv);
  EXPECT_THAT(table, HasSubstr(fmt::format("{{0x12, 0x0000FF0Ful, 0x{:08X}ul}}",
                                           (pmul | 0x80) << 8 | pdiv)));
}

TEST_F(CtlRampExport, RefusesWhatCannotBe) {
  const auto complaint = [&](const std::string& model, std::vector<std::string> more) {
    EXPECT_EQ(ctl.run(words(model, std::move(more))), ExitCode::usage) << ctl.out;
    return ctl.err;
  };
  EXPECT_THAT(complaint("TMCM-1110", {"--as", "SAP"}), HasSubstr("'SAP' is none of sap, tmc, c"));
  EXPECT_THAT(complaint("TMCM-1110", {"--as", "sap", "--motor", "1"}),
              HasSubstr("a TMCM-1110 has no motor 1"));
  EXPECT_THAT(complaint("TMCM-1021", {"--as", "c"}), HasSubstr("no registers whose addresses"));
  EXPECT_EQ(ctl.run({"ramp", "x", "--velocity", "1rps", "--acceleration", "1rps/s", "--as", "sap"}),
            ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("--as needs --model"));
}

}  // namespace
}  // namespace tmclctl::test
