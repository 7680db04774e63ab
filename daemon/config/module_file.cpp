#include "config/module_file.hpp"

#include "config/module_keys.hpp"
#include "config/toml_reading.hpp"

namespace tmcld {

tl::expected<MeasuredModule, std::string> read_measured_module(const std::string& path) {
  const auto text = text_of_file(path);
  if (!text) return tl::unexpected(text.error());
  return parsed<MeasuredModule>(*text, path, [](const toml::table& file) {
    const auto& table = measured_module(file);
    MeasuredModule module{&model_of(table), {}};
    take_traits(table, *module.model, module.traits);
    return module;
  });
}

}  // namespace tmcld
