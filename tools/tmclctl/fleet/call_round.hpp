/// Calls of methods on many gateways at once, and their answers. What acts is preceded by a call
/// for a nonce; docs/FLEET.md says why. Does no I/O, reads no clock.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "broker/message.hpp"
#include "output/errors.hpp"
#include "tmcl/clock.hpp"

namespace tmclctl {

struct FleetCall {
  std::string gateway;
  std::string method;
  boost::json::object params{};
  bool acts = false;   ///< It moves or sets something, and needs epoch and nonce.
  std::string axis{};  ///< That its answer is about; empty: the gateway.
};

/// `outcome`: whether something may have been done before it went.
Error gateway_away(const std::string& gateway, tmcl::Outcome outcome);

class CallRound {
 public:
  /// How many calls of a gateway are in progress at a time.
  static constexpr int most_of_a_gateway = 8;
  static constexpr tmcl::Duration usual_patience = std::chrono::seconds(5);

  /// Levels of topics.
  struct Caller {
    std::string user;
    std::string id;
    std::string role;
    tmcl::Duration patience = usual_patience;  ///< For each call, from when it is published.
  };
  using OnAnswer = std::function<void(const FleetCall& call, const Result<boost::json::object>&)>;

  CallRound(Caller caller, std::vector<FleetCall> calls, OnAnswer on_answer);

  /// What its answers are to be heard by.
  std::string filter() const;
  /// What is to be published now; gives up what was not answered in time. To be asked often.
  std::vector<tmclmqtt::Publication> due(tmcl::TimePoint now);
  /// Whether it was an answer that is waited for.
  bool hear(const tmclmqtt::Message& message, tmcl::TimePoint now);
  /// That gateway is not there any more: its calls are not waited for. Cheap when it is repeated.
  void give_up(const std::string& gateway);
  bool is_done() const { return left_ == 0; }

 private:
  enum class Step : std::uint8_t { waits, asks_nonce, called, done };
  struct Entry {
    FleetCall call;
    Step step = Step::waits;
    tmcl::TimePoint deadline{};
    tmcl::TimePoint not_before{};
    int refusals = 0;
    int published = 0;  ///< How often: an answer is to the latest, or to none.
    std::optional<boost::json::object> permit{};  ///< Epoch and nonce.
  };

  struct OfGateway {
    std::vector<std::size_t> entries{};  ///< None once it was given up.
    int in_progress = 0;
  };

  std::string correlation(std::size_t index) const;
  tmclmqtt::Publication publication(std::size_t index) const;
  void end(Entry& entry, const Result<boost::json::object>& result);
  void take(Entry& entry, const boost::json::object& answer, tmcl::TimePoint now);
  /// It is published again, at the earliest then.
  void wait(Entry& entry, tmcl::TimePoint until);
  static tmcl::Outcome outcome_without_answer(const Entry& entry);
  Error no_answer(const Entry& entry) const;

  Caller caller_;
  std::vector<Entry> entries_;
  OnAnswer on_answer_;
  std::map<std::string, OfGateway> of_gateways_;  ///< By name.
  std::size_t left_;
};

}  // namespace tmclctl
