#include "fronts/port_session.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <unistd.h>

#include "async/spawn.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using tmcl::Command;

constexpr unsigned highest_serial_address = 0xFF;

std::shared_ptr<GatewayBus> bus_named(const Gateway& gateway, const std::string& name) {
  const auto buses = gateway.buses();
  return *std::ranges::find(buses, name, &GatewayBus::name);
}

bool is_stop(const tmcl::Request& request) {
  return intent_of(request).effect == tmcl::Effect::stops;
}

std::string reason_of(const tmcl::Error& error) {
  return error.message + (error.hint.empty() ? "" : "; " + error.hint);
}

}  // namespace

PortSession::PortSession(std::shared_ptr<Gateway> gateway, const PortConfig& config,
                         std::string name, Output output, std::function<void()> disconnect,
                         std::string address)
    : gateway_(std::move(gateway)),
      bus_(bus_named(*gateway_, config.bus)),
      name_(std::move(name)),
      output_(std::move(output)),
      disconnect_(std::move(disconnect)),
      address_(std::move(address)),
      role_(config.role),
      client_(gateway_->add_client(name_)),
      conduct_(gateway_, bus_, role_, client_),
      asked_(bus_->executor()),
      entry_(ClientList::enter(gateway_->clients(), client_.number, gateway_->clock().now(),
                               [this] { return look(); })) {}

ConnectedClient PortSession::look() const {
  ConnectedClient now{"port", address_};
  now.role = role_;
  now.requests = pending_.size();
  return now;
}

void PortSession::start() {
  listener_ = gateway_->on_event([weak = weak_from_this()](const GatewayEvent& event) {
    if (const auto self = weak.lock()) self->on_event(event);
  });
  const auto on_failure = [self = shared_from_this()](const auto& failure) { self->fail(failure); };
  spawn(bus_->executor(), serve(shared_from_this()), on_failure);
}

void PortSession::close() {
  if (std::exchange(closed_, true)) return;
  entry_.leave();
  gateway_->ignore_events(listener_);
  give_up_tries();
  pending_.clear();
  conduct_.close();
  asked_.notify();
}

void PortSession::fail(const std::exception_ptr& failure) {
  const bool owes_stop = std::ranges::any_of(
      pending_, [](const AskedPtr& asked) { return !asked->ended && is_stop(asked->request); });
  if (owes_stop) gateway_->stop_in_need();
  close();
  disconnect_();
  gateway_->log_failure(name_ + ", which was closed", failure);
}

// ---- what the host says ------------------------------------------------------------------------

bool PortSession::has_room(bool stops) const {
  const auto count = std::ranges::count_if(
      pending_, [&](const AskedPtr& asked) { return is_stop(asked->request) == stops; });
  return static_cast<std::size_t>(count) < (stops ? most_stops_at_port : most_requests_at_port);
}

void PortSession::on_request(const tmcl::Request& request, CanForm form) {
  try {
    if (!closed_) take(request, form);
  } catch (...) {
    if (is_stop(request)) gateway_->stop_in_need();
    fail(std::current_exception());
  }
}

void PortSession::take(const tmcl::Request& request, CanForm form) {
  conduct_.note_datagram();
  last_form_ = form;
  const bool stops = is_stop(request);
  give_up_tries();
  if (!has_room(stops)) return;
  if (!bus_->is_can() && number(request.address) > highest_serial_address) return;
  const auto asked = std::make_shared<Asked>();
  asked->request = request;
  asked->form = form;
  asked->permit = conduct_.admit();
  asked->received = gateway_->clock().now();
  pending_.push_back(asked);
  if (!stops || conduct_.is_in_download(request)) return asked_.notify();
  asked->begun = true;
  see_meaning(*asked);
  const auto on_failure = [self = shared_from_this()](const auto& failure) { self->fail(failure); };
  spawn(bus_->executor(), serve_one(shared_from_this(), asked), on_failure);
}

/// As on a wire, where the next request ends the wait for an answer.
void PortSession::give_up_tries() {
  const auto is_tried = [](const AskedPtr& asked) {
    return asked->begun && !asked->ended && asked->only_tries;
  };
  const auto found = std::ranges::find_if(pending_, is_tried);
  if (found != pending_.end()) conduct_.give_up_tries((*found)->request.address);
}

void PortSession::on_wrong_checksum(tmcl::ModuleAddress module) {
  if (closed_ || !is_known(module) || !has_room(false)) return;
  const auto asked = std::make_shared<Asked>();
  asked->begun = true;
  pending_.push_back(asked);
  end(*asked, Told{wrong_checksum(module, host_address(module))});
}

void PortSession::forget_answers() {
  for (const auto& asked : pending_) asked->unwanted = true;
}

bool PortSession::is_known(tmcl::ModuleAddress module) const {
  return conduct_.is_ready(module) || hosts_.contains(module);
}

std::uint8_t PortSession::host_address(tmcl::ModuleAddress module) const {
  const auto found = hosts_.find(module);
  return found != hosts_.end() ? found->second : bus_->config().bus_options.host_address;
}

// ---- what it is told ---------------------------------------------------------------------------

bool PortSession::may_begin() const {
  return std::ranges::all_of(pending_, [](const AskedPtr& asked) {
    return !asked->begun || asked->ended || asked->only_tries || is_stop(asked->request);
  });
}

PortSession::AskedPtr PortSession::next() const {
  if (!may_begin()) return nullptr;
  const auto found =
      std::ranges::find_if(pending_, [](const AskedPtr& asked) { return !asked->begun; });
  return found == pending_.end() ? nullptr : *found;
}

awaitable<void> PortSession::serve(std::shared_ptr<PortSession> self) {
  while (!self->closed_) {
    if (const auto asked = self->next()) {
      asked->begun = true;
      self->see_meaning(*asked);
      const auto on_failure = [self](const auto& failure) { self->fail(failure); };
      spawn(self->bus_->executor(), serve_one(self, asked), on_failure);
    } else {
      co_await self->asked_.wait();
    }
  }
}

void PortSession::see_meaning(Asked& asked) {
  asked.request.address = conduct_.known_meaning(asked.request.address);
  asked.only_tries = !is_known(asked.request.address);
}

awaitable<void> PortSession::serve_one(std::shared_ptr<PortSession> self, AskedPtr asked) {
  co_await self->carry_out(asked);
  self->asked_.notify();
}

awaitable<void> PortSession::carry_out(AskedPtr asked) {
  auto& request = asked->request;
  const auto deadline =
      is_stop(request) ? std::nullopt : Deadline(asked->received + longest_wait_at_port);
  auto answer = co_await answer_to(asked, deadline);
  note(*asked, answer);
  end(*asked, told_about(request, answer, host_address(request.address),
                         bus_->link().traffic().last_reply_to(asked->permit.client)));
}

/// A stop does not wait until it is clear whom it reaches.
awaitable<tmcl::Result<tmcl::Answer>> PortSession::answer_to(AskedPtr asked, Deadline deadline) {
  auto& request = asked->request;
  if (asked->only_tries && !is_stop(request)) {
    const auto meaning = co_await conduct_.find_meaning(request.address, deadline);
    if (!meaning) co_return tl::unexpected(meaning.error());
    request.address = *meaning;
    asked->only_tries = !is_known(request.address);
  }
  co_return co_await conduct_.carry_out(request, asked->permit, deadline, asked->only_tries);
}

void PortSession::end(Asked& asked, std::optional<Told> told) {
  asked.told = std::move(told);
  asked.ended = true;
  const auto holds_up = [](const AskedPtr& one) { return !one->ended && !one->only_tries; };
  const auto end = std::ranges::find_if(pending_, holds_up);
  std::vector<AskedPtr> answered;
  std::copy_if(pending_.begin(), end, std::back_inserter(answered),
               [](const AskedPtr& one) { return one->ended; });
  std::erase_if(pending_, [&](const AskedPtr& one) {
    return std::ranges::find(answered, one) != answered.end();
  });
  for (const auto& one : answered)
    if (one->told && !one->unwanted && !closed_) output_(*one->told, one->form);
}

// ---- what others are told ----------------------------------------------------------------------

void PortSession::note(const Asked& asked, const tmcl::Result<tmcl::Answer>& answer) {
  const auto& request = asked.request;
  const bool is_its_own = answer && answer->reply.module == reply_byte(request.address);
  if (is_its_own) hosts_[request.address] = answer->reply.host;
  const bool is_gone = !answer && (answer.error().code == tmcl::Errc::reply_timeout ||
                                   answer.error().code == tmcl::Errc::module_silent);
  if (is_gone) hosts_.erase(request.address);
  if (is_gone) conduct_.forget_meaning();
  if (answer) note_arrival_events(request);
  const auto what = describe(request);
  if (intent_of(request).effect != tmcl::Effect::reads) {
    auto line = name_ + " of bus " + bus_->name() + ": " + what;
    line += answer ? " outcome=done"
                   : " outcome=" + std::string(name_of(answer.error().outcome)) +
                         " error=" + std::string(name_of(answer.error().code));
    if (answer && is_unpredictable(intent_of(request).motion)) line += " unattended";
    gateway_->audit({::geteuid(), ::getpid(), std::move(line)});
  }
  if (answer || is_silence(answer.error())) return;
  if (answer.error().code == tmcl::Errc::refused_by_module) return;
  gateway_->log_often(name_, LogLevel::warning,
                      name_ + ": refused " + what + ": " + reason_of(answer.error()));
}

void PortSession::note_arrival_events(const tmcl::Request& request) {
  if (request.command != Command::TARGET_REACHED_EVENT) return;
  const bool always = request.type == static_cast<std::uint8_t>(tmcl::ArrivalEvents::every_move);
  wants_arrivals_[request.address] = always;
}

void PortSession::on_event(const GatewayEvent& event) {
  const bool arrived = event.kind == GatewayEvent::Kind::target_reached;
  if (!arrived || closed_ || event.bus != bus_->name() || !event.address) return;
  const tmcl::ModuleAddress module{*event.address};
  const auto wanted = wants_arrivals_.find(module);
  if (wanted == wants_arrivals_.end()) return;
  if (!wanted->second) wants_arrivals_.erase(wanted);
  const tmcl::Reply reply{host_address(module), reply_byte(module), tmcl::Status::delayed,
                          Command::TARGET_REACHED_EVENT, event.value};
  output_(Told{reply}, last_form_);
}

}  // namespace tmcld
