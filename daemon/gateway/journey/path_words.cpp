#include "gateway/journey/path_words.hpp"

#include <utility>

#include <fmt/format.h>

#include "gateway/gateway.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {

std::string to_string(const OutputSetting& output) {
  return fmt::format("{}:{} output {} {}", output.bus, number(output.module), output.port,
                     output.value);
}

tmcl::plan::path_file::GcodeSetup setup_of(const PathConfig& path) {
  tmcl::plan::path_file::GcodeSetup setup;
  for (const auto& [word, output] : path.words) setup.words.set(word);
  setup.origins = path.origins;
  setup.tools = path.tools;
  return setup;
}

PathWords::PathWords(const Gateway& gateway) {
  for (const auto& [word, output] : gateway.path().words) {
    if (auto* bus = gateway.find_bus(output.bus))
      switches_[word] = {bus->shared_from_this(), output};
  }
}

std::string PathWords::what_switches(int word) const {
  const auto found = switches_.find(static_cast<std::uint8_t>(word));
  return found == switches_.end() ? std::string() : to_string(found->second.output);
}

boost::asio::awaitable<tmcl::Result<void>> PathWords::carry_out(int word,
                                                                RunOptions options) const {
  const auto found = switches_.find(static_cast<std::uint8_t>(word));
  if (found == switches_.end()) co_return tmcl::Result<void>{};
  const auto bus = found->second.bus;
  const auto output = found->second.output;
  auto script = tmcl::verbs::set_output(output.module, output.port, output.value);
  auto switched = co_await bus->run(std::move(script), std::move(options));
  if (!switched) switched.error().message = to_string(output) + ": " + switched.error().message;
  co_return switched;
}

}  // namespace tmcld
