#include "fronts/http_connections.hpp"

#include <algorithm>
#include <utility>

namespace tmcld {

std::uint64_t HttpConnections::add() {
  unknown_.push_back(++last_id_);
  return last_id_;
}

void HttpConnections::set(std::uint64_t id, const std::shared_ptr<HttpConnection>& connection) {
  all_.emplace(id, connection);
  if (unknown_.size() <= std::min(most_unknown_connections, most_)) return;
  gateway->log_often("unknown", LogLevel::warning,
                     "very many connections by HTTP ask for nothing: the oldest are closed");
  const auto oldest = all_.find(unknown_.front());
  const auto closed = oldest == all_.end() ? nullptr : oldest->second;
  unknown_.pop_front();
  if (closed) closed->close();
}

void HttpConnections::remove(std::uint64_t id) {
  std::erase(unknown_, id);
  all_.erase(id);
}

bool HttpConnections::let_in(std::uint64_t id) {
  const bool is_known = std::ranges::find(unknown_, id) == unknown_.end();
  if (is_known) return true;
  if (clients() >= most_) return false;
  std::erase(unknown_, id);
  return true;
}

std::vector<std::shared_ptr<HttpConnection>> HttpConnections::all() const {
  std::vector<std::shared_ptr<HttpConnection>> all;
  for (const auto& [id, connection] : all_) all.push_back(connection);
  return all;
}

tl::expected<HttpEntry, HttpRefusal> HttpConnections::admit(const HttpHead& head,
                                                            const HttpConnectionInfo& info) const {
  const HttpRules rules{config_.origins, config_.loopback_without_token};
  return admit_http(head, info, rules, *share->tokens, gateway->access());
}

}  // namespace tmcld
