#include "world/fleet/sim_broker.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "broker/topic_levels.hpp"

namespace tmclmqtt::test {
namespace {

std::string with_user(std::string filter, const std::string& user) {
  constexpr std::string_view place = "%u";
  const auto at = filter.find(place);
  if (at != filter.npos) filter.replace(at, place.size(), user);
  return filter;
}

/// What is left of it; nothing: its time is over.
std::optional<std::optional<std::uint32_t>> expiry_left(std::optional<std::uint32_t> expiry_s,
                                                        tmcl::Duration kept) {
  if (!expiry_s) return std::optional<std::uint32_t>();
  const auto passed = std::chrono::duration_cast<std::chrono::seconds>(kept).count();
  if (passed >= static_cast<std::int64_t>(*expiry_s)) return std::nullopt;
  return *expiry_s - static_cast<std::uint32_t>(passed);
}

std::size_t size_of(const Publication& it) {
  return it.topic.size() + it.payload.size() + it.response_topic.size() + it.correlation.size();
}

}  // namespace

bool is_of_filter(std::string_view filter, std::string_view topic) {
  const auto levels = levels_of(filter);
  const auto of_topic = levels_of(topic);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i] == "#") return true;
    if (i >= of_topic.size()) return false;
    if (levels[i] != "+" && levels[i] != of_topic[i]) return false;
  }
  return levels.size() == of_topic.size();
}

// ---- access ------------------------------------------------------------------------------------

AccessList::AccessList(const std::string& text) {
  std::istringstream lines(text);
  std::string line, user;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string kind, right, filter;
    words >> kind;
    if (kind.empty() || kind.front() == '#') continue;
    if (kind == "user") {
      words >> user;
      continue;
    }
    words >> right >> filter;
    const bool is_known = (kind == "pattern" || (kind == "topic" && !user.empty())) &&
                          (right == "read" || right == "write" || right == "readwrite");
    if (!is_known || filter.empty()) throw std::invalid_argument("access list: " + line);
    rules_.push_back({kind == "pattern" ? "" : user, filter, right != "write", right != "read"});
  }
}

bool AccessList::may(const std::string& user, std::string_view topic, bool Rule::*right) const {
  return std::ranges::any_of(rules_, [&](const Rule& rule) {
    if (!(rule.*right) || (!rule.user.empty() && rule.user != user)) return false;
    return is_of_filter(rule.user.empty() ? with_user(rule.filter, user) : rule.filter, topic);
  });
}
bool AccessList::may_write(const std::string& user, std::string_view topic) const {
  return may(user, topic, &Rule::writes);
}
bool AccessList::may_read(const std::string& user, std::string_view topic) const {
  return may(user, topic, &Rule::reads);
}

// ---- connections -------------------------------------------------------------------------------

SimBroker::Session* SimBroker::session_of(const Subscriber& from) {
  const auto found = std::ranges::find_if(
      sessions_, [&](const auto& one) { return one.second.connection == &from; });
  return found == sessions_.end() ? nullptr : &found->second;
}

bool SimBroker::connect(Subscriber& from, ConnectPacket packet, tmcl::TimePoint now) {
  const auto id = packet.client_id;
  if (const auto found = sessions_.find(id); found != sessions_.end()) {
    if (auto* other = std::exchange(found->second.connection, nullptr)) {
      // A session that does not last ends here, and so does the delay of its will.
      const bool ends = packet.clean_start || found->second.packet.session_expiry.count() == 0;
      if (ends) publish_will(id, now);
      other->on_close("session taken over");
    } else if (found->second.will_due && packet.clean_start) {
      publish_will(id, now);
    }
    if (packet.clean_start) sessions_.erase(id);
  }
  auto& session = sessions_[id];
  const bool was_there = !session.packet.client_id.empty();
  session.packet = std::move(packet);
  session.connection = &from;
  session.will_due.reset();
  session.ends.reset();
  for (auto& kept : std::exchange(session.queue, {})) deliver(session, kept, 1, false, now);
  return was_there;
}

void SimBroker::subscribe(Subscriber& from, const std::string& filter, int qos,
                          tmcl::TimePoint now) {
  auto* session = session_of(from);
  if (session == nullptr) return;
  session->filters[filter] = qos;
  for (const auto& [topic, kept] : retained_) {
    // No-local: what it has published itself does not come back.
    if (!is_of_filter(filter, topic) || kept.publisher == session->packet.client_id) continue;
    deliver(*session, kept, std::min(qos, kept.publication.qos), true, now);
  }
}

void SimBroker::end_connection(Session& session, tmcl::TimePoint now) {
  session.connection = nullptr;
  session.ends = now + session.packet.session_expiry;
}

void SimBroker::disconnect(Subscriber& from, tmcl::TimePoint now) {
  auto* session = session_of(from);
  if (session == nullptr) return;
  session->packet.will.reset();
  end_connection(*session, now);
  run_due(now);
}

void SimBroker::lose(Subscriber& from, tmcl::TimePoint now) {
  auto* session = session_of(from);
  if (session == nullptr) return;
  // mosquitto 2.0 waits for the delay although the session has ended.
  if (session->packet.will) session->will_due = now + session->packet.will_delay;
  end_connection(*session, now);
  run_due(now);
}

// ---- messages ----------------------------------------------------------------------------------

Reason SimBroker::publish(Subscriber& from, const Publication& publication, tmcl::TimePoint now) {
  auto* session = session_of(from);
  if (session == nullptr) return Reason::not_authorized;
  const bool is_too_large = size_of(publication) > ConnectPacket::max_packet_bytes_of_broker;
  const bool is_wrong = publication.topic.find_first_of("+#") != publication.topic.npos;
  if (is_too_large || is_wrong) {
    lose(from, now);
    from.on_close(is_too_large ? "packet too large" : "malformed packet");
    return is_too_large ? Reason::packet_too_large : Reason::topic_name_invalid;
  }
  if (!access_.may_write(session->packet.user, publication.topic)) return Reason::not_authorized;
  return pass_on(publication, session->packet.client_id, now);
}

Reason SimBroker::publish_as_broker(const Publication& publication, tmcl::TimePoint now) {
  return pass_on(publication, "", now);
}

Reason SimBroker::pass_on(const Publication& publication, const std::string& publisher,
                          tmcl::TimePoint now) {
  const Kept kept{publication, now, publisher};
  if (publication.retained) {
    if (publication.payload.empty()) {
      retained_.erase(publication.topic);
    } else {
      retained_.insert_or_assign(publication.topic, kept);
    }
  }
  bool is_heard = false;
  for (auto& [id, session] : sessions_) {
    if (id == publisher) continue;
    int qos = -1;
    for (const auto& [filter, most] : session.filters)
      if (is_of_filter(filter, publication.topic)) qos = std::max(qos, most);
    if (qos < 0) continue;
    is_heard = true;
    deliver(session, kept, std::min(qos, publication.qos), publication.retained, now);
  }
  return is_heard ? Reason::success : Reason::no_matching_subscribers;
}

void SimBroker::deliver(Session& session, const Kept& kept, int qos, bool retained,
                        tmcl::TimePoint now) {
  const auto& it = kept.publication;
  const auto left = expiry_left(it.expiry_s, now - kept.since);
  if (!left || !access_.may_read(session.packet.user, it.topic)) return;
  if (size_of(it) > session.packet.max_packet_bytes) return;
  if (session.connection == nullptr) {
    const bool lasts = session.packet.session_expiry.count() > 0 && qos > 0;
    if (lasts && session.queue.size() < most_queued) session.queue.push_back(kept);
    return;
  }
  session.connection->on_message(
      {it.topic, it.payload, retained, *left, it.response_topic, it.correlation}, qos);
}

// ---- time --------------------------------------------------------------------------------------

void SimBroker::publish_will(const std::string& client_id, tmcl::TimePoint now) {
  const auto found = sessions_.find(client_id);
  if (found == sessions_.end()) return;
  found->second.will_due.reset();
  const auto will = std::exchange(found->second.packet.will, std::nullopt);
  if (will) pass_on(*will, client_id, now);
}

std::optional<tmcl::TimePoint> SimBroker::next_due() const {
  std::optional<tmcl::TimePoint> next;
  for (const auto& [id, session] : sessions_) {
    // A session with a will to come lasts until that.
    const auto due = session.will_due ? session.will_due : session.ends;
    if (due && (!next || *due < *next)) next = due;
  }
  return next;
}

void SimBroker::run_due(tmcl::TimePoint now) {
  std::vector<std::string> wills;
  for (const auto& [id, session] : sessions_)
    if (session.will_due && *session.will_due <= now) wills.push_back(id);
  for (const auto& id : wills) publish_will(id, now);
  std::erase_if(sessions_, [&](const auto& one) {
    return one.second.ends && *one.second.ends <= now && !one.second.will_due;
  });
}

void SimBroker::restart(bool keeps, tmcl::TimePoint now) {
  std::vector<Subscriber*> gone;
  for (auto& [id, session] : sessions_)
    if (session.connection != nullptr) gone.push_back(session.connection);
  for (auto* connection : gone) {
    auto* session = session_of(*connection);
    if (!keeps) session->packet.will.reset();
    if (keeps && session->packet.will) session->will_due = now + session->packet.will_delay;
    end_connection(*session, now);
  }
  if (!keeps) {
    sessions_.clear();
    retained_.clear();
  }
  run_due(now);
  for (auto* connection : gone) connection->on_close("connection lost");
}

std::optional<Publication> SimBroker::retained(const std::string& topic,
                                               tmcl::TimePoint now) const {
  const auto found = retained_.find(topic);
  if (found == retained_.end()) return std::nullopt;
  const auto left = expiry_left(found->second.publication.expiry_s, now - found->second.since);
  if (!left) return std::nullopt;
  return found->second.publication;
}

std::vector<std::string> SimBroker::retained_topics() const {
  std::vector<std::string> topics;
  for (const auto& [topic, kept] : retained_) topics.push_back(topic);
  return topics;
}

}  // namespace tmclmqtt::test
