/// The methods of settings: what of a module can be kept in a file, and given to another one of its
/// model. See tmcl/settings.hpp.
#pragma once

#include "tmcl/api/module.hpp"

namespace tmcl::api::settings {

constexpr std::string_view section_summary =
    "where it stands in a file: global, interrupts, motor.0";
constexpr std::string_view toml_summary =
    "the file, as settings.read gives it; settings may be left out";

struct Place {
  TMCL_STRUCT(Place);
  TMCL_FIELD(std::string, section, section_summary);
  TMCL_FIELD(std::string, parameter, "its standard name");
  TMCL_FIELD(std::uint8_t, number, "its number");
};

struct Setting : Place {
  TMCL_STRUCT(Setting, Place);
  TMCL_FIELD(std::int32_t, value, "its value");
  TMCL_FIELD(std::int32_t, initial, "what a new module has");
  TMCL_FIELD(std::optional<std::string>, unit, "unit of the value; null for codes and flags");
  TMCL_FIELD(std::string, meaning, "what it does");
};

struct Settings {
  TMCL_STRUCT(Settings);
  TMCL_FIELD(std::string, model, "model of the module");
  TMCL_FIELD(std::string, firmware, "its version");
  TMCL_FIELD(std::vector<Setting>, settings, "in the order of their numbers");
  TMCL_FIELD(std::vector<Setting>, apart,
             "what is of this module alone, such as its address, and is never loaded");
  TMCL_FIELD(std::string, toml, "the same as a file");
};
struct Read : OnModule {
  TMCL_METHOD("settings.read", reads, Settings, "reads all settings of a module", Read, OnModule);
};

struct Difference : Place {
  TMCL_STRUCT(Difference, Place);
  TMCL_FIELD(std::optional<std::int32_t>, present, "what the module has; null: it has none");
  TMCL_FIELD(std::int32_t, wanted, "what the file says");
};

struct Differences {
  TMCL_STRUCT(Differences);
  TMCL_FIELD(std::string, model, "model of the module");
  TMCL_FIELD(std::vector<Difference>, differences, "what settings.load would write");
};
struct Compare : OnModule {
  TMCL_METHOD("settings.compare", reads, Differences,
              "compares a module with a file of settings, or with the one that is configured",
              Compare, OnModule);
  TMCL_FIELD(std::optional<std::string>, toml,
             "the file, as settings.read gives it; the configured one if absent");
};

struct Refused : Place {
  TMCL_STRUCT(Refused, Place);
  TMCL_FIELD(std::string, why, "what the module or the configuration says to it");
};
struct Loaded {
  TMCL_STRUCT(Loaded);
  TMCL_FIELD(std::vector<Difference>, written, "what was written; 'present' is what was before");
  TMCL_FIELD(std::vector<Refused>, refused, "what could not be written, or not be stored");
  TMCL_FIELD(std::vector<Difference>, differing, "what is not as in the file afterwards");
  TMCL_FIELD(std::int32_t, stored, "how many were copied to the EEPROM");
};
struct Load : OnModule {
  TMCL_METHOD("settings.load", writes, Loaded,
              "sets a module as a file of settings says; its motors must stand, and nothing moves",
              Load, OnModule);
  TMCL_FIELD(std::string, toml, toml_summary);
  TMCL_FIELD(std::optional<bool>, store, "keeps those of the file in the module's EEPROM, too");
};

struct Stored {
  TMCL_STRUCT(Stored);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, stored, "how many were copied to the EEPROM");
  TMCL_FIELD(std::vector<Refused>, refused, "what could not be stored");
};
struct Store {
  TMCL_METHOD("settings.store", writes, Stored,
              "keeps all settings of an axis as they are now, in the module's EEPROM", Store);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
};

struct Progress {
  TMCL_STRUCT(Progress);
  TMCL_FIELD(std::string, text, "what is done");
};

}  // namespace tmcl::api::settings
