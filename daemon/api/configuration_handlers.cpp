#include "api/configuration_handlers.hpp"

#include "api/configuration_keeper.hpp"

namespace tmcld::handlers {
namespace {

/// With the rest of the call it fits a line.
constexpr std::size_t max_toml_bytes = 48 << 10;

Result<std::shared_ptr<ConfigurationKeeper>> keeper_of(const Call& call) {
  const auto* place = dynamic_cast<const ConfigurationPlace*>(call.peer.get());
  if (place != nullptr && place->configuration()) return place->configuration();
  return tl::unexpected(not_managed());
}

std::optional<Error> objection_to_length(const std::string& toml) {
  if (toml.size() <= max_toml_bytes) return std::nullopt;
  return param_error<&configuration::Set::toml>(
      "bad_argument", "the text has " + std::to_string(toml.size()) + " bytes, and may have " +
                          std::to_string(max_toml_bytes));
}

}  // namespace

Answer<configuration::Get> get_configuration(Call& call, const configuration::Get&) {
  const auto keeper = co_await must(keeper_of(call));
  auto managed = co_await must(keeper->get());
  co_return managed;
}

Answer<configuration::Set> set_configuration(Call& call, const configuration::Set& params) {
  // What changes nothing leaves no line in the audit.
  if (params.dry_run.value_or(false)) call.effect = tmcl::Effect::reads;
  const auto keeper = co_await must(keeper_of(call));
  co_await must_not(objection_to_length(params.toml));
  auto taken = co_await must(keeper->set(params, call.peer->client()));
  co_return taken;
}

}  // namespace tmcld::handlers
