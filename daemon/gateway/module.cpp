#include "gateway/module.hpp"

#include <string>

#include "gateway/bus.hpp"

namespace tmcld {

std::string_view name_of(GatewayModule::State state) {
  switch (state) {
    case GatewayModule::State::unknown: return "unknown";
    case GatewayModule::State::ready: return "ready";
    case GatewayModule::State::silent: return "silent";
    case GatewayModule::State::in_bootloader: return "in_bootloader";
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
    if (state_ == State::ready) co_return tmcl::Result<void>{};
    auto error = tmcl::no_firmware(address_);
    error.bus = bus_.name();
    co_return tl::unexpected(std::move(error));
  }
  note(found.error());
  auto error = std::move(found.error());
  error.outcome = tmcl::Outcome::not_sent;
  co_return tl::unexpected(std::move(error));
}

void GatewayModule::adopt(const tmcl::FoundModule& found) {
  const bool runs = !found.version.bootloader;
  const auto state = runs ? State::ready : State::in_bootloader;
  const bool news = state_ != state;
  const bool ran = identity_ && !identity_->version.bootloader;
  if (runs && ran && identity_->version != found.version) {
    bus_.log(LogLevel::warning, bus_.name() + ": module " + std::to_string(number(address_)) +
                                    " is another one than before");
  }
  state_ = state;
  identity_ = found;
  duplicate_suspected_ = duplicate_suspected_ || found.duplicate_suspected;
  ++settings_epoch_;
  if (!news) return;
  auto name = found.model.empty() ? "unknown model " + std::to_string(found.version.model)
                                  : std::string(found.model);
  const auto kind =
      runs ? GatewayEvent::Kind::module_answers : GatewayEvent::Kind::module_in_bootloader;
  bus_.emit(
      {kind, bus_.name(), number(address_), 0,
       std::move(name) + (runs ? ", firmware " : ", bootloader ") + to_string(found.version)});
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
