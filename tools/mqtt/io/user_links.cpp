#include "io/user_links.hpp"

#include <algorithm>
#include <chrono>

#include "async/spawn.hpp"
#include "tmcl/api/relay.hpp"

namespace tmclmqtt {
namespace {

using boost::asio::awaitable;
using tmcl::client::Error;
using tmcl::client::ErrorKind;
using tmcl::client::Result;

constexpr auto sent_at = "sent_at_ms";

Error too_many(std::string message) {
  return {"too_many_requests", ErrorKind::failed, tmcl::Outcome::not_sent, std::move(message),
          "wait for answers before calling again"};
}

std::int64_t milliseconds(tmcl::TimePoint time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

/// Opened, and made the user's.
awaitable<Result<std::shared_ptr<GatewayLink>>> open_for(std::string socket,
                                                         tmcl::api::relay::SpeakFor user) {
  auto opening = GatewayLink::open(std::move(socket));
  auto opened = co_await std::move(opening);
  if (!opened) co_return opened;
  auto speaking =
      (*opened)->call(tmcl::api::relay::SpeakFor::method.name, tmcl::api::to_json(user));
  const auto spoken = co_await std::move(speaking);
  if (spoken) co_return opened;
  (*opened)->close();
  co_return tl::unexpected(spoken.error());
}

}  // namespace

void UserLinks::refuse(const GatewayLink::OnAnswer& on_answer, Error error) {
  on_answer(tl::unexpected(std::move(error)));
}

void UserLinks::send(GatewayLink& link, Waiting waiting) {
  auto& [call, judged, on_answer] = waiting;
  const bool acts = call.effect == tmcl::Effect::moves || call.effect == tmcl::Effect::writes;
  if (acts && gate_.is_stale(judged)) return refuse(on_answer, gate_.stale_call());
  // tmcld refuses what it was sent before it stood still; what a client says of that is not known
  // to be by this computer's clock.
  call.params.erase(sent_at);
  if (acts) call.params[sent_at] = milliseconds(judged);
  link.call(call.method, std::move(call.params), std::move(on_answer));
}

bool UserLinks::has_room_for(const CallWanted& call) {
  std::erase_if(links_,
                [](const auto& one) { return one.second.link && one.second.link->is_lost(); });
  return links_.contains({call.user, call.role}) || links_.size() < most_links;
}

void UserLinks::call(CallWanted call, tmcl::TimePoint judged, GatewayLink::OnAnswer on_answer) {
  const Key key{call.user, call.role};
  if (!has_room_for(call))
    return refuse(on_answer, too_many("too many users have called within a minute"));
  auto found = links_.find(key);
  if (found == links_.end()) {
    found = links_.emplace(key, UserLink{}).first;
    tmcld::spawn(executor_, open(shared_from_this(), key));
  }
  auto& user = found->second;
  user.used = judged;
  Waiting waiting{std::move(call), judged, std::move(on_answer)};
  if (user.link) return send(*user.link, std::move(waiting));
  if (user.waiting.size() >= most_waiting)
    return refuse(waiting.on_answer, too_many("too many calls of this user are in progress"));
  user.waiting.push_back(std::move(waiting));
}

awaitable<void> UserLinks::open(std::shared_ptr<UserLinks> self, Key key) {
  tmcl::api::relay::SpeakFor speaks;
  speaks.user = key.first;
  speaks.role = std::string(name_of(key.second));
  auto opening = open_for(self->socket_, speaks);
  const auto opened = co_await std::move(opening);
  const auto found = self->links_.find(key);
  if (found == self->links_.end()) {
    if (opened) (*opened)->close();
    co_return;
  }
  auto waiting = std::exchange(found->second.waiting, {});
  if (opened) {
    found->second.link = *opened;
    for (auto& one : waiting) self->send(**opened, std::move(one));
  } else {
    self->links_.erase(found);
    for (const auto& one : waiting) refuse(one.on_answer, opened.error());
  }
}

void UserLinks::end_silent_ones(tmcl::TimePoint now) {
  std::vector<std::shared_ptr<GatewayLink>> silent;
  std::erase_if(links_, [&](const auto& one) {
    const auto& user = one.second;
    const bool is_silent =
        user.link && user.link->calls_in_progress() == 0 && now - user.used > longest_silence;
    if (is_silent) silent.push_back(user.link);
    return is_silent;
  });
  for (const auto& link : silent) link->close();
}

void UserLinks::close() {
  for (auto& [key, user] : std::exchange(links_, {})) {
    if (user.link) user.link->close();
    for (const auto& one : user.waiting) {
      refuse(one.on_answer,
             {"daemon_ending", ErrorKind::failed, tmcl::Outcome::not_sent, "tmcld-mqtt is ending"});
    }
  }
}

}  // namespace tmclmqtt
