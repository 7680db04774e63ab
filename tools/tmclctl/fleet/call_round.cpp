#include "fleet/call_round.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "broker/topic_levels.hpp"
#include "connection/json_read.hpp"
#include "fleet/gateways.hpp"
#include "tmcl/json_text.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr int most_refusals = 3;
constexpr tmcl::Duration pause_after_refusal = std::chrono::milliseconds(250);
constexpr std::string_view too_often = "too_many_requests";
// Of a message that lies in a queue.
constexpr std::uint32_t expiry_s = 5;

/// The gateway has not done it, and takes it with another nonce, or later.
bool is_to_be_repeated(const Error& error) {
  constexpr std::array<std::string_view, 4> names{"stale_epoch", "stale_nonce", "stale_request",
                                                  too_often};
  return std::ranges::count(names, std::string_view(error.name)) != 0;
}

std::optional<json::object> permit_in(const json::object& answer) {
  const auto epoch = text_at(answer, "epoch");
  const auto nonce = text_at(answer, "nonce");
  if (epoch.empty() || nonce.empty()) return std::nullopt;
  return json::object{{"epoch", epoch}, {"nonce", nonce}};
}

}  // namespace

Error gateway_away(const std::string& gateway, tmcl::Outcome outcome) {
  return {"gateway_away", ErrorKind::failed, outcome,
          fmt::format("gateway {} is not on the broker", gateway),
          "'tmclctl doctor' on that computer says why"};
}

CallRound::CallRound(Caller caller, std::vector<FleetCall> calls, OnAnswer on_answer)
    : caller_(std::move(caller)), on_answer_(std::move(on_answer)), left_(calls.size()) {
  for (auto& call : calls) {
    of_gateways_[call.gateway].entries.push_back(entries_.size());
    entries_.push_back({std::move(call)});
  }
}

std::string CallRound::filter() const {
  return tmclmqtt::reply_topic(caller_.user, tmclmqtt::any_level, caller_.id);
}

std::string CallRound::correlation(std::size_t index) const {
  return fmt::format("{}.{}", index, entries_[index].published);
}

tmclmqtt::Publication CallRound::publication(std::size_t index) const {
  const auto& entry = entries_[index];
  const auto& call = entry.call;
  json::object said;
  if (entry.step == Step::called) {
    if (entry.permit) said = *entry.permit;
    said["params"] = call.params;
  }
  tmclmqtt::Publication publication;
  publication.topic =
      fmt::format("{}{}/call/{}/{}/{}", tmclmqtt::topic_root, call.gateway, caller_.role,
                  caller_.user, entry.step == Step::called ? call.method : "nonce");
  publication.payload = tmcl::json_text(said);
  publication.expiry_s = expiry_s;
  publication.response_topic = tmclmqtt::reply_topic(caller_.user, call.gateway, caller_.id);
  publication.correlation = correlation(index);
  return publication;
}

std::vector<tmclmqtt::Publication> CallRound::due(tmcl::TimePoint now) {
  std::vector<tmclmqtt::Publication> due;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    auto& entry = entries_[i];
    if (entry.step == Step::done) continue;
    if (entry.step != Step::waits) {
      if (now >= entry.deadline) end(entry, tl::unexpected(no_answer(entry)));
      continue;
    }
    auto& in_progress = of_gateways_[entry.call.gateway].in_progress;
    if (in_progress >= most_of_a_gateway || now < entry.not_before) continue;
    ++in_progress;
    entry.step = entry.call.acts && !entry.permit ? Step::asks_nonce : Step::called;
    entry.deadline = now + caller_.patience;
    ++entry.published;
    due.push_back(publication(i));
  }
  return due;
}

bool CallRound::hear(const tmclmqtt::Message& message, tmcl::TimePoint now) {
  std::size_t index = entries_.size();
  const auto& text = message.correlation;
  std::from_chars(text.data(), text.data() + text.size(), index);
  if (index >= entries_.size() || text != correlation(index)) return false;
  auto& entry = entries_[index];
  const bool is_awaited = entry.step == Step::asks_nonce || entry.step == Step::called;
  if (!is_awaited || message.topic != publication(index).response_topic) return false;
  take(entry, object_in(message.payload), now);
  return true;
}

void CallRound::take(Entry& entry, const json::object& answer, tmcl::TimePoint now) {
  const bool was_called = entry.step == Step::called;
  entry.permit = permit_in(answer);
  if (const auto* error = answer.if_contains("error"); error != nullptr && error->is_object()) {
    auto failure = tmcl::client::error_from_json(error->get_object());
    if (!is_printable(failure.message + failure.hint)) failure.message = failure.hint = "?";
    if (!is_to_be_repeated(failure) || entry.refusals >= most_refusals)
      return end(entry, tl::unexpected(std::move(failure)));
    ++entry.refusals;
    return wait(entry, failure.name == too_often ? now + pause_after_refusal : now);
  }
  if (was_called) return end(entry, object_at(answer, "result"));
  if (entry.permit) return wait(entry, now);
  if (++entry.refusals > most_refusals) return end(entry, tl::unexpected(no_answer(entry)));
  wait(entry, now + pause_after_refusal);
}

void CallRound::wait(Entry& entry, tmcl::TimePoint until) {
  --of_gateways_[entry.call.gateway].in_progress;
  entry.step = Step::waits;
  entry.not_before = until;
}

void CallRound::end(Entry& entry, const Result<json::object>& result) {
  if (entry.step != Step::waits) --of_gateways_[entry.call.gateway].in_progress;
  entry.step = Step::done;
  --left_;
  on_answer_(entry.call, result);
}

tmcl::Outcome CallRound::outcome_without_answer(const Entry& entry) {
  // Where not even a nonce came, nothing was asked for that acts.
  const bool may_have_acted = entry.call.acts && entry.step == Step::called;
  return may_have_acted ? tmcl::Outcome::unknown : tmcl::Outcome::not_sent;
}

Error CallRound::no_answer(const Entry& entry) const {
  const auto seconds = std::chrono::duration<double>(caller_.patience).count();
  return {
      "gateway_timeout", ErrorKind::failed, outcome_without_answer(entry),
      fmt::format("gateway {} has not answered within {} s", entry.call.gateway, seconds),
      "is it there, and does the broker let this user call it in the role '" + caller_.role + "'?"};
}

void CallRound::give_up(const std::string& gateway) {
  const auto found = of_gateways_.find(gateway);
  if (found == of_gateways_.end()) return;
  for (const auto index : std::exchange(found->second.entries, {})) {
    auto& entry = entries_[index];
    if (entry.step == Step::done) continue;
    end(entry, tl::unexpected(gateway_away(gateway, outcome_without_answer(entry))));
  }
}

}  // namespace tmclctl
