/// What becomes of a message to a gateway: whether it is carried out, and if not, why. What moves
/// or sets something must be wanted now: it brings the epoch of the gateway's present connection to
/// the broker, and a nonce that was given out a moment ago. No message that lay in a broker, in a
/// socket or in a gateway that stood still has both. Does no I/O, reads no clock.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "gateway/authority/gaps.hpp"
#include "protocol/call_rate.hpp"
#include "protocol/nonces.hpp"
#include "protocol/topics.hpp"
#include "tmcl/client_error.hpp"
#include "tmcl/command.hpp"

namespace tmclmqtt {

using tmcl::client::Error;

/// Of what a client wants to know its answer by.
constexpr std::size_t max_correlation_bytes = 128;
/// The method of this program itself, by which a client is given a nonce.
constexpr std::string_view nonce_method = "nonce";

struct ReplyTo {
  std::string topic;
  std::string correlation;
  std::string user;  ///< Whom a nonce in the answer is for; empty: no user is known.
};

/// It is not carried out.
struct Refused {
  Error error;
};
/// The client wants a nonce, and nothing else.
struct NonceWanted {};
/// A call for tmcld.
struct CallWanted {
  std::string user;
  Role role;
  std::string method;
  tmcl::Effect effect;
  boost::json::object params;
};
/// All axes are to stop.
struct StopWanted {};
/// A user wants to see how axes move, for so long.
struct WishMade {
  std::string user;
  tmcl::Duration time{};
};
/// Another birth of this gateway than its own may be there.
struct BirthSeen {};
struct Nothing {};

struct Judged {
  std::variant<Nothing, Refused, NonceWanted, CallWanted, StopWanted, WishMade, BirthSeen> is{};
  std::optional<ReplyTo> reply{};
  /// The broker keeps it for who comes later: it must be taken away there.
  bool must_be_cleared = false;
};

class Gate {
 public:
  /// `gateway`: its name; `draw`: see Nonces.
  Gate(std::string_view gateway, std::function<std::string()> draw, tmcl::Duration time_to_live)
      : topics_(gateway), draw_(draw), nonces_(std::move(draw), time_to_live) {}

  const Topics& topics() const { return topics_; }

  /// A connection to the broker begins: what was said before is worth nothing on it.
  void begin_epoch();
  const std::string& epoch() const { return epoch_; }
  /// What tmcld can be asked for; empty: it is not there.
  void know_methods(std::map<std::string, tmcl::Effect, std::less<>> methods) {
    methods_ = std::move(methods);
  }
  /// The reactor turns; to be said often, and before messages are judged. After a gap what waited
  /// is refused. `slept`: how long the computer has slept until now.
  void look(tmcl::TimePoint now, tmcl::Duration slept);
  /// Of a call that was judged then.
  bool is_stale(tmcl::TimePoint judged) const { return gaps_.is_stale(judged); }
  Error stale_call() const;

  /// After look() with the same time.
  Judged judge(const Message& message, tmcl::TimePoint now);
  std::string give_nonce(std::string_view user, tmcl::TimePoint now) {
    return nonces_.give(user, now);
  }
  tmcl::Duration time_to_live() const { return nonces_.time_to_live(); }

 private:
  Judged judge_call(const CallTopic& topic, const Message& message, tmcl::TimePoint now);
  Judged judge_wish(const WishTopic& topic, const Message& message) const;
  std::variant<Error, CallWanted> call_of(const CallTopic& topic, const Message& message,
                                          tmcl::TimePoint now);
  std::optional<Error> objection_to_age(const boost::json::object& said, std::string_view user,
                                        tmcl::TimePoint now);

  Topics topics_;
  std::function<std::string()> draw_;
  Nonces nonces_;
  std::string epoch_;
  std::map<std::string, tmcl::Effect, std::less<>> methods_;
  tmcld::Gaps gaps_;
  CallRate rate_;
};

}  // namespace tmclmqtt
