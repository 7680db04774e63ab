/// What must hold of the answers that clients get and of what moves, whatever they send.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "api/request.hpp"
#include "require.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld::fuzz {

namespace json = boost::json;
using tmcl::fuzz::require;

inline constexpr std::array<std::string_view, 2> axis_names{"x", "y"};
/// By motor.
using Axes = std::bitset<axis_names.size()>;

/// Beyond the numbers that clients have.
using Connection = std::size_t;

/// As its connection has been told.
struct KnownLease {
  std::int64_t lease = 0;
  std::int64_t epoch = 0;
  Connection holder = 0;
  Axes axes{};
  /// It holds so long, unless it is given up.
  tmcl::TimePoint sure_until{};
  bool is_over = false;
};

class SessionModel {
 public:
  // ---- what clients do ----

  /// Says what happened before it, if it does not hold.
  void must(bool holds, const char* what) const {
    for (const auto& line : history_)
      if (!holds) std::fprintf(stderr, "%s\n", line.c_str());
    require(holds, what);
  }

  void connect(Connection connection, bool for_stops) {
    connections_[connection] = {.for_stops = for_stops};
  }
  void send(Connection connection, std::string_view bytes, tmcl::TimePoint now) {
    auto& line = connections_[connection].unended;
    for (const char byte : bytes) {
      if (byte != '\n') {
        line += byte;
        continue;
      }
      note(now, connection, '>', line);
      if (line.find_first_not_of(" \t\r") != std::string::npos) begin(connection, line, now);
      line.clear();
    }
  }
  /// What it has asked for may still go out, if it waits for its turn on the bus already.
  void close(Connection connection) {
    auto& state = connections_[connection];
    for (const auto& question : state.questions) left_.push_back(question);
    state = {.is_closed = true};
    end_input(connection);
  }
  /// It may end at once if it waits for nothing.
  void end_input(Connection connection) {
    for (auto& lease : leases_)
      if (lease.holder == connection) lease.is_over = true;
  }
  /// Everything else that may end leases, or keep their holders from renewing them.
  void forget_leases() {
    for (auto& lease : leases_) lease.is_over = true;
  }

  // ---- what they are told ----

  void on_line(Connection connection, std::string_view line, tmcl::TimePoint now) {
    note(now, connection, '<', line);
    must(line.size() < max_answer_bytes, "an answer has a greatest length");
    boost::system::error_code error;
    const auto value = json::parse(line, error);
    must(!error && value.is_object(), "an answer is a JSON object");
    const auto& message = value.as_object();
    must(message.at("jsonrpc") == "2.0", "of the protocol");
    auto& state = connections_[connection];
    const bool says_hello = message.contains("method") && message.at("method") == "hello";
    must(says_hello != std::exchange(state.was_greeted, true), "hello comes first, and once");
    if (says_hello) return;
    if (message.contains("method")) return on_notification(state, message);
    on_answer(connection, message, now);
  }

  // ---- what moves ----

  void on_request(const tmcl::Request& request) {
    for (std::size_t motor = 0; motor < axis_names.size(); ++motor)
      if (moves(request, motor)) must(was_asked_for(motor), "somebody has asked for a movement");
  }

  bool awaits_answers(Connection connection) const {
    return !connections_.at(connection).questions.empty();
  }
  const std::vector<KnownLease>& leases() const { return leases_; }

 private:
  struct Question {
    std::uint64_t number = 0;  ///< In the order in which they were asked.
    std::string id{};          ///< Empty: it has none.
    const MethodInfo* method = nullptr;
    Axes axes{};
    json::object params{};
    tmcl::TimePoint asked{};
    bool must_fail = false;
    bool is_repeated = false;  ///< Another one has the same id.
  };
  struct State {
    bool for_stops = false;
    bool is_closed = false;
    bool was_greeted = false;
    std::string unended{};
    std::vector<Question> questions{};  ///< Not answered yet.
    std::set<std::string> ids{};        ///< All that it has used.
    bool has_subscribed = false;
    std::set<std::int64_t> subscriptions{};
  };

  void begin(Connection connection, const std::string& line, tmcl::TimePoint now) {
    auto& state = connections_[connection];
    json::parse_options options;
    options.max_depth = max_depth;
    boost::system::error_code error;
    const auto value = json::parse(line, error, {}, options);
    Question question{.number = ++last_question_, .asked = now};
    if (!error && value.is_object()) read(value.as_object(), question);
    // Which of two is answered nobody could tell.
    question.is_repeated = question.id.empty() || !state.ids.insert(question.id).second;
    if (question.method != nullptr) {
      question.must_fail = must_fail(connection, state, question);
      if (question.method->name == "subscribe") state.has_subscribed = true;
      if (question.method->name == "lease.break" || question.method->name == "lease.release")
        forget_leases();
    }
    state.questions.push_back(std::move(question));
  }

  static std::string text_of(const json::value& value) {
    return value.is_string() ? std::string(value.get_string()) : std::string();
  }
  static std::int64_t number_of(const json::object& params, std::string_view name) {
    const auto* value = params.if_contains(name);
    return value != nullptr && value->is_int64() ? value->get_int64() : -1;
  }

  static bool is_usable(const json::value& id) {
    if (id.is_string()) return id.get_string().size() <= max_id_bytes;
    return id.is_int64() || id.is_uint64();
  }
  static void read(const json::object& message, Question& question) {
    const auto* id = message.if_contains("id");
    if (id != nullptr && is_usable(*id)) question.id = json::serialize(*id);
    if (const auto* method = message.if_contains("method"))
      question.method = find_method(text_of(*method));
    if (const auto* params = message.if_contains("params"); params && params->is_object())
      question.params = params->get_object();
    for (std::size_t motor = 0; motor < axis_names.size(); ++motor)
      question.axes[motor] = names(question.params, axis_names[motor]);
  }
  /// What names no axis may be about any.
  static bool names(const json::object& params, std::string_view axis) {
    if (const auto* one = params.if_contains("axis")) return text_of(*one) == axis;
    const auto* several = params.if_contains("axes");
    if (several == nullptr || !several->is_array()) return true;
    return std::ranges::any_of(several->get_array(),
                               [&](const auto& name) { return text_of(name) == axis; });
  }

  static bool moves_single_axes(const MethodInfo& method) {
    constexpr std::array names{"axis.move_to", "axis.move_by", "axis.rotate", "axis.home",
                               "line.move"};
    return std::ranges::find(names, method.name) != names.end();
  }

  bool must_fail(Connection connection, const State& state, const Question& question) const {
    if (state.for_stops && question.method->effect != tmcl::Effect::stops) return true;
    const auto lease = number_of(question.params, "lease");
    const bool names_lease = question.params.contains("lease");
    const auto known = std::ranges::find(leases_, lease, &KnownLease::lease);
    const bool is_known = known != leases_.end();
    // Who reads or stops needs no lease.
    const auto effect = question.method->effect;
    const bool acts = effect == tmcl::Effect::moves || effect == tmcl::Effect::writes;
    if (acts && is_known && known->epoch != number_of(question.params, "epoch")) return true;
    if (names_lease || !moves_single_axes(*question.method)) return false;
    return std::ranges::any_of(leases_, [&](const KnownLease& other) {
      return blocks(other, connection, question, question.asked);
    });
  }
  static bool blocks(const KnownLease& lease, Connection connection, const Question& question,
                     tmcl::TimePoint now) {
    return !lease.is_over && lease.holder != connection && now < lease.sure_until &&
           (lease.axes & question.axes).any();
  }

  void on_notification(const State& state, const json::object& message) {
    const auto& params = message.at("params");
    if (message.at("method") == "notify_progress") {
      const auto id = json::serialize(params.at("id"));
      return must(state.ids.contains(id), "progress is told to whoever has called");
    }
    must(state.has_subscribed, "who has not subscribed is told nothing");
    if (message.at("method") != "notify_state") return;
    const auto number = params.at("subscription").to_number<std::int64_t>();
    must(state.subscriptions.contains(number), "states come to whoever has subscribed to them");
  }

  void on_answer(Connection connection, const json::object& message, tmcl::TimePoint now) {
    auto& questions = connections_[connection].questions;
    const auto& id = message.at("id");
    const auto text = id.is_null() ? std::string() : json::serialize(id);
    const auto found = std::ranges::find(questions, text, &Question::id);
    must(found != questions.end(), "an answer belongs to a question of its connection");
    const auto question = std::move(*found);
    questions.erase(found);
    must(message.contains("result") != message.contains("error"), "it is done or it is not");
    if (!message.contains("result")) return;
    must(!question.id.empty(), "what has no id is not done");
    must(question.method != nullptr, "what is no method is not done");
    if (question.is_repeated) return note_subscription(connections_[connection], message);
    must(!question.must_fail || may_have_changed(question, now), "what must be refused is");
    on_done(connection, question, message.at("result"));
  }
  /// A lease that was in its way may have ended since.
  bool may_have_changed(const Question& question, tmcl::TimePoint now) const {
    if (!moves_single_axes(*question.method) || question.params.contains("lease")) return false;
    return std::ranges::any_of(leases_, [&](const KnownLease& lease) {
      return (lease.axes & question.axes).any() && (lease.is_over || now >= lease.sure_until);
    });
  }

  /// Whichever question of an id was answered: it has subscribed if its answer says so.
  static void note_subscription(State& state, const json::object& message) {
    const auto* result = message.at("result").if_object();
    const auto* number = result == nullptr ? nullptr : result->if_contains("subscription");
    if (number != nullptr) state.subscriptions.insert(number->to_number<std::int64_t>());
  }

  void on_done(Connection connection, const Question& question, const json::value& result) {
    auto& state = connections_[connection];
    const auto name = question.method->name;
    if (name == "axis.stop" || name == "system.stop_all") {
      for (std::size_t motor = 0; motor < axis_names.size(); ++motor)
        if (question.axes[motor]) stopped_[motor] = std::max(stopped_[motor], question.number);
    } else if (name == "subscribe") {
      state.subscriptions.insert(result.at("subscription").to_number<std::int64_t>());
    } else if (name == "unsubscribe") {
      state.subscriptions.erase(number_of(question.params, "subscription"));
    } else if (name == "lease.acquire" || name == "lease.renew") {
      on_lease(connection, question, result);
    }
  }

  void on_lease(Connection connection, const Question& question, const json::value& result) {
    const auto lease = result.at("lease").to_number<std::int64_t>();
    const auto ttl = std::chrono::milliseconds(result.at("ttl_ms").to_number<std::int64_t>());
    const auto known = std::ranges::find(leases_, lease, &KnownLease::lease);
    if (known != leases_.end()) {
      known->sure_until = std::max(known->sure_until, question.asked + ttl);
      return;
    }
    must(question.method->name == "lease.acquire", "only what was granted can be renewed");
    must(std::ranges::none_of(leases_,
                              [&](const KnownLease& other) {
                                return blocks(other, connection, question, question.asked);
                              }),
         "an axis has one lease");
    leases_.push_back({lease, result.at("epoch").to_number<std::int64_t>(), connection,
                       question.axes, question.asked + ttl, false});
  }

  // From the manual, and not from the gateway's own table.
  static bool moves(const tmcl::Request& request, std::size_t motor) {
    using tmcl::Command;
    constexpr std::uint8_t coordinate = 2;
    switch (request.command) {
      case Command::ROR:
      case Command::ROL: return request.motor == motor && request.value != 0;
      case Command::RFS: return request.motor == motor && request.type == 0;
      case Command::MVP: return request.motor == motor || request.type == coordinate;
      case Command::SAP:
        return request.motor == motor &&
               (request.type == tmcl::axis_parameter::target_position ||
                (request.type == tmcl::axis_parameter::target_velocity && request.value != 0));
      default: return false;
    }
  }
  /// Since the last stop of the motor that was answered.
  bool was_asked_for(std::size_t motor) const {
    const auto is_cause = [&](const Question& question) {
      return question.method != nullptr && question.method->effect == tmcl::Effect::moves &&
             question.axes[motor] && question.number > stopped_[motor];
    };
    return std::ranges::any_of(left_, is_cause) ||
           std::ranges::any_of(connections_, [&](const auto& connection) {
             return std::ranges::any_of(connection.second.questions, is_cause);
           });
  }

  void note(tmcl::TimePoint now, Connection connection, char direction, std::string_view line) {
    const auto us = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch());
    history_.push_back(std::to_string(us.count()) + " us, " + std::to_string(connection) + ' ' +
                       direction + ' ' + std::string(line));
  }

  std::vector<std::string> history_;
  std::map<Connection, State> connections_;
  std::vector<Question> left_;  ///< Of connections that have closed.
  std::vector<KnownLease> leases_;
  std::array<std::uint64_t, axis_names.size()> stopped_{};
  std::uint64_t last_question_ = 0;
};

}  // namespace tmcld::fuzz
