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
#include "fronts/handshakes.hpp"
#include "fronts/http_admission.hpp"
#include "fronts/page_files.hpp"
#include "fronts/sign_ins.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// Connections that no client has been let in by yet: of more than these, the oldest gives way of
/// the network that has most of them.
constexpr std::size_t most_unknown_connections = 128;

class HttpConnection {
 public:
  virtual ~HttpConnection() = default;
  virtual void finish() = 0;
  virtual void close() = 0;
  /// If it was let in by this token.
  virtual void end_if_by_token(const std::string& name) = 0;
  /// If it was let in by the cookie of this sign-in.
  virtual void end_if_signed_in_by(std::uint64_t sign_in) = 0;
  /// If its client may do less by the configuration than before.
  virtual void end_if_it_lost_rights() = 0;
  /// If nothing has been asked by it for a while; not if something turns, or is leased, until it
  /// ends.
  virtual void end_if_idle(tmcl::TimePoint now) = 0;
};

class HttpConnections {
 public:
  HttpConnections(const boost::asio::any_io_executor& executor, std::shared_ptr<Gateway> of,
                  std::shared_ptr<FrontShare> with, HttpConfig config, std::size_t most)
      : gateway(std::move(of)),
        share(std::move(with)),
        handshakes(executor),
        page(PageFiles::load(
            config.page.empty() ? PageFiles::usual_folder() : config.page,
            [this](LogLevel level, std::string_view line) { gateway->log(level, line); })),
        config_(std::move(config)),
        most_(most) {}

  /// `network`: as in HttpConnectionInfo.
  std::uint64_t add(std::string network);
  void set(std::uint64_t id, const std::shared_ptr<HttpConnection>& connection);
  void remove(std::uint64_t id);
  /// Whether there is a place for it among the clients.
  bool let_in(std::uint64_t id);
  std::size_t clients() const { return all_.size() - std::min(all_.size(), unknown_.size()); }
  std::size_t size() const { return all_.size(); }
  std::vector<std::shared_ptr<HttpConnection>> all() const;

  Result<HttpEntry> admit(const HttpHead& head, const HttpConnectionInfo& info) const;
  /// The client that was let in so, and what it may do now.
  Caller caller_by(std::string_view token, std::uint64_t sign_in) const;

  /// What the cookie has from then on. An invitation is used by it.
  std::string sign_in(const HttpHead& head, const HttpEntry& entry);
  /// Ends all connections that it let in but the one of this id.
  void sign_out(std::uint64_t sign_in, std::uint64_t but = 0);
  void end_what_has_expired();
  void end_by_token(const std::string& token);

  std::shared_ptr<Gateway> gateway;
  std::shared_ptr<FrontShare> share;
  Handshakes handshakes;
  PageFiles page;

 private:
  HttpConfig config_;
  std::size_t most_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, std::shared_ptr<HttpConnection>> all_;
  struct Unknown {
    std::uint64_t id;
    std::string network;
  };
  std::deque<Unknown>::iterator oldest_of_the_most();

  SignIns sign_ins_;
  std::deque<Unknown> unknown_;  ///< Of those that no client was let in by; oldest first.
};

}  // namespace tmcld
