/// The connections by HTTP that there are, and what holds for each of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/http_config.hpp"
#include "fronts/front_share.hpp"
#include "fronts/http_admission.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// Connections that nobody has been let in by yet: of more than these, the oldest gives way.
constexpr std::size_t most_unknown_connections = 128;

class HttpConnection {
 public:
  virtual ~HttpConnection() = default;
  virtual void finish() = 0;
  virtual void close() = 0;
  /// If it was let in by this token.
  virtual void end_if_by_token(const std::string& name) = 0;
};

class HttpConnections {
 public:
  HttpConnections(std::shared_ptr<Gateway> of, std::shared_ptr<FrontShare> with, HttpConfig config,
                  std::size_t most)
      : gateway(std::move(of)), share(std::move(with)), config_(std::move(config)), most_(most) {}

  std::uint64_t add();
  void set(std::uint64_t id, const std::shared_ptr<HttpConnection>& connection);
  void remove(std::uint64_t id);
  /// Whether there is a place for it among the clients.
  bool let_in(std::uint64_t id);
  std::size_t clients() const { return all_.size() - std::min(all_.size(), unknown_.size()); }
  std::size_t size() const { return all_.size(); }
  std::vector<std::shared_ptr<HttpConnection>> all() const;

  tl::expected<HttpEntry, HttpRefusal> admit(const HttpHead& head,
                                             const HttpConnectionInfo& info) const;

  std::shared_ptr<Gateway> gateway;
  std::shared_ptr<FrontShare> share;

 private:
  HttpConfig config_;
  std::size_t most_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, std::shared_ptr<HttpConnection>> all_;
  std::deque<std::uint64_t> unknown_;  ///< Of those that nobody was let in by; oldest first.
};

}  // namespace tmcld
