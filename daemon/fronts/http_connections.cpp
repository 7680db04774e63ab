#include "fronts/http_connections.hpp"

#include <algorithm>
#include <utility>

namespace tmcld {

std::uint64_t HttpConnections::add(std::string network) {
  unknown_.push_back({++last_id_, std::move(network)});
  return last_id_;
}

void HttpConnections::set(std::uint64_t id, const std::shared_ptr<HttpConnection>& connection) {
  all_.emplace(id, connection);
  if (unknown_.size() <= std::min(most_unknown_connections, most_)) return;
  gateway->log_often("unknown", LogLevel::warning,
                     "very many connections by HTTP ask for nothing: the oldest of the network "
                     "that has most of them are closed");
  const auto oldest = oldest_of_the_most();
  const auto found = all_.find(oldest->id);
  const auto closed = found == all_.end() ? nullptr : found->second;
  unknown_.erase(oldest);
  if (closed) closed->close();
}

std::deque<HttpConnections::Unknown>::iterator HttpConnections::oldest_of_the_most() {
  std::map<std::string_view, std::size_t> counts;
  for (const auto& one : unknown_) ++counts[one.network];
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
  return std::ranges::find(unknown_, most->first, &Unknown::network);
}

void HttpConnections::remove(std::uint64_t id) {
  std::erase_if(unknown_, [&](const Unknown& one) { return one.id == id; });
  all_.erase(id);
}

bool HttpConnections::let_in(std::uint64_t id) {
  const bool is_known = std::ranges::find(unknown_, id, &Unknown::id) == unknown_.end();
  if (is_known) return true;
  if (clients() >= most_) return false;
  std::erase_if(unknown_, [&](const Unknown& one) { return one.id == id; });
  return true;
}

std::vector<std::shared_ptr<HttpConnection>> HttpConnections::all() const {
  std::vector<std::shared_ptr<HttpConnection>> all;
  for (const auto& [id, connection] : all_) all.push_back(connection);
  return all;
}

Result<HttpEntry> HttpConnections::admit(const HttpHead& head,
                                         const HttpConnectionInfo& info) const {
  const HttpRules rules{config_.origins, config_.loopback_without_token};
  const auto now = gateway->clock().now();
  const auto sign_in = sign_ins_.of_secret(cookie_of(head, info), now);
  const auto invited_by = share->tokens->invitations().token_by(token_of(head), now);
  return admit_http(head, info, rules, *share->tokens, gateway->access(), sign_in, invited_by);
}

Caller HttpConnections::caller_by(std::string_view token, std::uint64_t sign_in) const {
  auto caller = tmcld::caller_by(token, *share->tokens, gateway->access());
  if (sign_in == 0 || sign_ins_.is_in(sign_in, gateway->clock().now())) return caller;
  caller.role = Role::stop;
  caller.exceeds_limits = false;
  caller.reason = "the sign-in has ended";
  return caller;
}

std::string HttpConnections::sign_in(const HttpHead& head, const HttpEntry& entry) {
  if (entry.is_invited) share->tokens->invitations().use(token_of(head));
  return sign_ins_.add(entry.token, gateway->clock().now());
}

void HttpConnections::sign_out(std::uint64_t sign_in, std::uint64_t but) {
  if (sign_in == 0) return;
  sign_ins_.remove(sign_in);
  // A copy: one that ends takes itself away.
  for (const auto& [id, connection] : std::map(all_)) {
    if (id != but) connection->end_if_signed_in_by(sign_in);
  }
}

void HttpConnections::end_what_has_expired() {
  for (const auto& ended : sign_ins_.take_ended(gateway->clock().now())) sign_out(ended.id);
}

void HttpConnections::end_by_token(const std::string& token) {
  sign_ins_.remove_of_token(token);
  for (const auto& connection : all()) connection->end_if_by_token(token);
}

}  // namespace tmcld
