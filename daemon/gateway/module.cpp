#include "gateway/module.hpp"

#include <string>

#include "gateway/bus.hpp"
#include "log/log.hpp"

namespace tmcld {

std::string_view name_of(GatewayModule::State state) {
  switch (state) {
    case GatewayModule::State::unknown: return "unknown";
    case GatewayModule::State::ready: return "ready";
    case GatewayModule::State::silent: return "silent";
  }
  return {};
}

const tmcl::Model* GatewayModule::model() const {
  return identity_ ? tmcl::find_model(identity_->version.model) : nullptr;
}

boost::asio::awaitable<tmcl::Result<void>> GatewayModule::be_ready() {
  if (state_ == State::ready) co_return tmcl::Result<void>{};
  RunOptions options;
  auto found = co_await bus_.run(tmcl::verbs::identify(address_), options);
  if (found) {
    adopt(*found);
    co_return tmcl::Result<void>{};
  }
  note(found.error());
  auto error = std::move(found.error());
  error.outcome = tmcl::Outcome::not_sent;
  co_return tl::unexpected(std::move(error));
}

void GatewayModule::adopt(const tmcl::FoundModule& found) {
  const bool news = state_ != State::ready;
  if (identity_ && identity_->version != found.version) {
    log(LogLevel::warning, bus_.name() + ": module " + std::to_string(number(address_)) +
                               " is another one than before");
  }
  state_ = State::ready;
  identity_ = found;
  duplicate_suspected_ = duplicate_suspected_ || found.duplicate_suspected;
  ++settings_epoch_;
  if (!news) return;
  auto name = found.model.empty() ? "unknown model " + std::to_string(found.version.model)
                                  : std::string(found.model);
  bus_.emit({GatewayEvent::Kind::module_answers, bus_.name(), number(address_), 0,
             std::move(name) + ", firmware " + to_string(found.version)});
}

void GatewayModule::note(const tmcl::Error& error) {
  const bool silence =
      error.code == tmcl::Errc::reply_timeout || error.code == tmcl::Errc::module_silent;
  if (!silence || state_ == State::silent) return;
  state_ = State::silent;
  bus_.emit({GatewayEvent::Kind::module_silent, bus_.name(), number(address_), 0, error.message});
}

void GatewayModule::forget_state() {
  state_ = State::unknown;
  duplicate_suspected_ = false;
}

}  // namespace tmcld
