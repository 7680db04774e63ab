#include "sim/ports/eeprom_file.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>

namespace tmcl::sim {
namespace {

namespace fs = std::filesystem;

using Area = EepromCell::Area;

class SimEepromFile : public testing::Test {
 protected:
  ~SimEepromFile() override { fs::remove_all(folder); }

  void write_text(const std::string& text) {
    fs::create_directories(folder);
    std::ofstream(file) << text;
  }
  std::int32_t stored() const {
    const auto eeprom = read_eeprom_file(file, model);
    return eeprom && *eeprom ? (*eeprom)->read(cell).value_or(-1) : -2;
  }

  static constexpr EepromCell cell{Area::axis_parameter, 0, 4};
  const Model& model = *find_model(1110);
  fs::path folder = fs::temp_directory_path() / ("tmcl-eeprom-" + std::to_string(::getpid()));
  fs::path file = folder / "deep" / "module.eeprom";
  boost::asio::io_context io;
  VirtualClock clock;
};

TEST_F(SimEepromFile, IsNothingAtFirst) {
  const auto eeprom = read_eeprom_file(file, model);
  ASSERT_TRUE(eeprom) << eeprom.error();
  EXPECT_FALSE(*eeprom);
}

TEST_F(SimEepromFile, GivesBackWhatWasWritten) {
  Eeprom eeprom;
  eeprom.write(cell, 77);
  const auto written = write_eeprom_file(file, eeprom, model);
  ASSERT_TRUE(written) << written.error();
  EXPECT_EQ(stored(), 77);
  EXPECT_FALSE(fs::exists(file.string() + ".new"));
}

TEST_F(SimEepromFile, WritesNothingThroughALink) {
  fs::create_directories(folder);
  file = folder / "module.eeprom";
  std::ofstream(folder / "diary") << "mine";
  fs::create_symlink(folder / "diary", file.string() + ".new");
  ASSERT_TRUE(write_eeprom_file(file, Eeprom{}, model));
  EXPECT_EQ(fs::file_size(folder / "diary"), 4U);
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(file)));
}

TEST_F(SimEepromFile, IsRefusedByNameIfItIsForeign) {
  file = folder / "module.eeprom";
  write_text("my diary, entirely unlike an EEPROM");
  const auto eeprom = read_eeprom_file(file, model);
  ASSERT_FALSE(eeprom);
  EXPECT_EQ(eeprom.error(), file.string() + " is not the memory of a simulated module");
}

TEST_F(SimEepromFile, SaysWhyItCannotBeWritten) {
  write_text("");
  file = folder / "module.eeprom" / "below-a-file";
  write_text("");
  std::ofstream(folder / "module.eeprom") << "";
  const auto written = write_eeprom_file(file, Eeprom{}, model);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().find("module.eeprom"), std::string::npos);
  EXPECT_NE(written.error().find("cannot be written"), std::string::npos);
}

TEST_F(SimEepromFile, IsWrittenSomeTimeAfterTheEeprom) {
  Module module(model, ModuleAddress{1}, clock);
  EepromFile keeper(io, module, file);
  module.eeprom().write(cell, 1);
  module.eeprom().write(cell, 2);
  EXPECT_EQ(stored(), -2);
  io.run();
  EXPECT_EQ(stored(), 2);
  module.eeprom().write(cell, 3);
  io.restart();
  io.run();
  EXPECT_EQ(stored(), 3);
}

TEST_F(SimEepromFile, IsWrittenAtTheEndIfNotBefore) {
  Module module(model, ModuleAddress{1}, clock);
  {
    EepromFile keeper(io, module, file);
    module.eeprom().write(cell, 5);
  }
  EXPECT_EQ(stored(), 5);
  { EepromFile idle(io, module, folder / "other"); }
  EXPECT_FALSE(fs::exists(folder / "other"));
}

}  // namespace
}  // namespace tmcl::sim
