#include "world/fleet/fleet_world.hpp"

#include <csignal>
#include <fstream>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include <pwd.h>
#include <unistd.h>

#include <fmt/format.h>
#include <boost/asio/post.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "fronts/socket_file.hpp"
#include "log/log.hpp"
#include "support/build_paths.hpp"
#include "support/temp_path.hpp"
#include "world/world_peer.hpp"

namespace tmcld::test {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;
using std::chrono::seconds;
namespace ap = tmcl::axis_parameter;

constexpr auto local_axis = "d";
constexpr tmcl::Duration stop_interval = milliseconds(100);
/// The fastest of them stands after that.
constexpr tmcl::Duration time_to_rest = seconds(1);

const std::vector<WorldAxis>& fleet_axes() {
  using tmcl::ModuleAddress;
  static const std::vector<WorldAxis> all{{"a", "line", {ModuleAddress{1}, 0}},
                                          {"b", "line", {ModuleAddress{1}, 1}},
                                          {"c", "field", {ModuleAddress{1}, 0}},
                                          {local_axis, "field", {ModuleAddress{3}, 0}}};
  return all;
}

Config fleet_config() {
  const auto* account = ::getpwuid(::getuid());
  std::string text = "[daemon]\nsocket = \"/none\"\n";
  text += "[[bus]]\nname = \"line\"\nlink = \"serial:/dev/none@115200\"\n";
  text += "[[bus]]\nname = \"field\"\nlink = \"can:none\"\n";
  text += fmt::format("[[access]]\nrole = \"configure\"\nusers = [\"{}\"]\nrelay = true\n",
                      account == nullptr ? "root" : account->pw_name);
  for (const auto& axis : fleet_axes())
    text += fmt::format("[[axis]]\nname = \"{}\"\nbus = \"{}\"\naddress = {}\nmotor = {}\n",
                        axis.name, axis.bus, number(axis.address.module), int{axis.address.motor});
  return parse_config(text).value();
}

/// That of config/fleet, with the users of this world.
tmclmqtt::test::AccessList fleet_access() {
  std::ifstream file(TMCL_SOURCE_DIR "/config/fleet/tmcl.acl");
  std::ostringstream text;
  text << file.rdbuf();
  text << "user ben\ntopic write tmcl/v1/+/call/configure/ben/+\n";
  return tmclmqtt::test::AccessList(text.str());
}

std::string epoch_in(const tmclmqtt::BrokerOptions& by) {
  if (!by.will) return {};
  return std::string(json::parse(by.will->payload).at("epoch").as_string());
}

const json::object* object_in(const json::object& object, std::string_view name) {
  const auto* value = object.if_contains(name);
  return value == nullptr ? nullptr : value->if_object();
}

/// What a call moves by; 0 if it is none that moves.
std::int32_t value_in(const std::string& payload) {
  boost::system::error_code error;
  const auto value = json::parse(payload, error);
  if (error || !value.is_object()) return 0;
  const auto* params = object_in(value.get_object(), "params");
  if (params == nullptr) return 0;
  for (const auto* name :
       {"position_microsteps", "velocity_internal", "value", "positions_microsteps"}) {
    const auto* given = params->if_contains(name);
    if (given != nullptr && given->is_array()) given = given->get_array().if_contains(0);
    if (given != nullptr && given->is_int64())
      return static_cast<std::int32_t>(std::abs(given->get_int64()));
  }
  return 0;
}

bool has_result(const std::optional<json::object>& answer) {
  return answer && answer->contains("result");
}

}  // namespace

// ---- cells -------------------------------------------------------------------------------------

void FleetCells::add(const FleetCells& other) {
  for (const auto& [what, states] : other.counts_)
    for (const auto& [state, count] : states) counts_[what][state] += count;
}

std::size_t FleetCells::never() const {
  std::set<std::string> states;
  for (const auto& [what, of_it] : counts_)
    for (const auto& [state, count] : of_it) states.insert(state);
  std::size_t never = 0;
  for (const auto& [what, of_it] : counts_) never += states.size() - of_it.size();
  return never;
}

void FleetCells::print(std::ostream& out) const {
  std::set<std::string> states;
  for (const auto& [what, of_it] : counts_)
    for (const auto& [state, count] : of_it) states.insert(state);
  out << fmt::format("{:24}", "");
  for (const auto& state : states) out << fmt::format("{:>16}", state);
  out << '\n';
  for (const auto& [what, of_it] : counts_) {
    out << fmt::format("{:24}", what);
    for (const auto& state : states) {
      const auto found = of_it.find(state);
      out << fmt::format("{:>16}", found == of_it.end() ? "." : std::to_string(found->second));
    }
    out << '\n';
  }
}

// ---- the world ---------------------------------------------------------------------------------

FleetWorld::FleetWorld(std::uint64_t seed, const FleetTrouble& trouble)
    : trouble_(trouble), seed_(seed) {
  std::signal(SIGPIPE, SIG_IGN);
  silence_log();
  const Faults faults{.lost = seed % 2 == 0 && trouble.faults ? 10 : 0};
  serial_ = std::make_unique<Wire>(gateway_program_.context, "line", tmcl::Framing::serial, seed,
                                   faults, trace_);
  can_ = std::make_unique<Wire>(gateway_program_.context, "field", tmcl::Framing::can, seed, faults,
                                trace_);
  ledger_ = std::make_unique<FleetLedger>(fleet_axes(), [this] { return frozen(); });
  network_ = std::make_unique<Network>(outside_.context.get_executor(), fleet_access(),
                                       generator(seed, "network"));
  network_->doubles = trouble.faults;
  serial_->bench().add(*tmcl::find_model("TMCM-3110"), tmcl::ModuleAddress{1});
  can_->bench().add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{1});
  can_->bench().add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{3});
  for (auto* wire : {serial_.get(), can_.get()}) {
    wire->on_request = [this, wire](const tmcl::Request& request) {
      ledger_->on_request(wire->name(), request, now());
    };
  }
  static int worlds = 0;
  socket_ = tmcl::test::temp_path("fleet-" + std::to_string(++worlds) + ".sock");
  start_gateway();
  start_bridge();
  for (const auto& [name, role] :
       {std::pair{"anna", "operate"}, std::pair{"ben", "configure"}, std::pair{"eve", "observe"}}) {
    users_.push_back(
        std::make_shared<FleetUser>(*network_, outside_.context.get_executor(), name, role));
    users_.back()->complain = [this](std::string text) { ledger_->complain(std::move(text)); };
  }
}

FleetWorld::~FleetWorld() {
  for (const auto& user : users_) user->end();
  bridge_->stop();
  server_->stop_accepting();
  server_->close_sessions();
  gateway_->close();
  programs_.run_for(seconds(3));
}

void FleetWorld::start_gateway() {
  const auto executor = gateway_program_.context.get_executor();
  GatewayOptions options;
  options.open_link = [this](const BusConfig& bus) {
    return (bus.name == serial_->name() ? *serial_ : *can_).open();
  };
  options.new_epoch = [last = std::int64_t{0}]() mutable { return ++last; };
  gateway_ = Gateway::create(executor, fleet_config(), std::move(options));
  auto file = SocketFile::claim(socket_);
  if (!file) throw std::runtime_error(file.error());
  auto share = std::make_shared<FrontShare>();
  share->clients_share_virtual_time = true;
  server_ = std::make_shared<UnixServer>(executor, std::move(*file), gateway_, max_clients, share);
  gateway_->start();
  server_->start();
}

void FleetWorld::start_bridge() {
  const auto executor = bridge_program_.context.get_executor();
  tmclmqtt::MqttConfig config;
  config.host = "broker";
  config.port = 1;
  config.gateway = FleetUser::gateway;
  config.socket = socket_;
  tmclmqtt::BridgeParts parts;
  tmclmqtt::test::SimConnectOptions options;
  options.user = FleetUser::gateway;
  options.on_read = [this](const auto& by, auto& message) { on_read(by, message); };
  options.on_publish = [this](const auto& by, const auto& it) { on_publish(by, it); };
  options.on_connected = [this](const auto& by, auto connection) {
    on_connected(by, std::move(connection));
  };
  parts.connect = tmclmqtt::test::connect_to(*network_, executor, std::move(options));
  parts.draw = [this, drawn = 0]() mutable {
    if (trouble_.canary == FleetCanary::same_nonce) return std::string("the same");
    return "drawn-" + std::to_string(++drawn);
  };
  parts.on_turn = [] {};
  bridge_ = std::make_shared<tmclmqtt::Bridge>(executor, config, std::move(parts));
  bridge_->start();
}

void FleetWorld::on_connected(const tmclmqtt::BrokerOptions& by,
                              std::shared_ptr<Connection> connection) {
  trace_.add(now(), by.client_id, {});
  if (by.client_id.ends_with("-stop")) {
    stops_ = std::move(connection);
    return;
  }
  calls_ = std::move(connection);
  calls_began_ = now();
  calls_epoch_ = epoch_in(by);
  ledger_->note(now(), "gateway is connected, epoch " + calls_epoch_);
}

void FleetWorld::on_read(const tmclmqtt::BrokerOptions& by, tmclmqtt::Message& message) {
  trace_.add(now(), message.topic, {});
  for (const auto& user : users_)
    if (message.correlation.starts_with(user->name() + '-')) ++user->read[message.correlation];
  if (message.topic.ends_with("/stop")) {
    // Of one that asks for no answer it is not known whether it was refused.
    if (!message.correlation.empty()) ledger_->on_stop_read(message.correlation, now());
    if (trouble_.canary == FleetCanary::deaf_to_stops) message.topic.clear();
    return;
  }
  if (message.topic.find("/call/") == message.topic.npos) return;
  if (const auto freeze = std::exchange(freeze_at_call_, nullptr)) freeze();
  const auto value = value_in(message.payload);
  if (value != 0) ledger_->on_read(value, now(), calls_began_, epoch_in(by));
}

void FleetWorld::on_publish(const tmclmqtt::BrokerOptions& by, const Publication& publication) {
  trace_.add(now(), publication.topic, {});
  if (!by.client_id.ends_with("-stop")) return;
  const auto said = json::parse(publication.payload.empty() ? "{}" : publication.payload);
  const auto* error = object_in(said.as_object(), "error");
  if (error == nullptr) return;
  ledger_->on_stop_refused(publication.correlation,
                           std::string(error->at("data").at("name").as_string()), now());
}

std::size_t FleetWorld::answered() const {
  std::size_t sum = 0;
  for (const auto& user : users_) sum += user->answered;
  return sum;
}

std::string FleetWorld::state_of_way() const {
  if (!network_->is_there()) return "no broker";
  if (network_->is_frozen()) return "broker frozen";
  if (bridge_program_.is_frozen() && gateway_program_.is_frozen()) return "both frozen";
  if (bridge_program_.is_frozen()) return "bridge frozen";
  if (gateway_program_.is_frozen()) return "tmcld frozen";
  const bool is_connected = calls_ && calls_->is_open() && stops_ && stops_->is_open();
  if (!is_connected) return "not connected";
  if (calls_->is_disturbed()) return "calls disturbed";
  if (stops_->is_disturbed()) return "stops disturbed";
  if (now() - calls_began_ < seconds(2)) return "just connected";
  if (now() - drops_noted_ < seconds(2)) return "tmcld cut off";
  return "calm";
}

// ---- users: as the protocol wants it -----------------------------------------------------------

const std::string& FleetWorld::any_axis(Random& random) const {
  return fleet_axes()[static_cast<std::size_t>(random.between(0, 2))].name;
}

FleetCall FleetWorld::call_of(const FleetUser& user, const std::string& method,
                              const std::string& axis, const std::optional<Nonce>& nonce,
                              json::object& params) {
  FleetCall call{.user = user.name(), .method = method, .axes = {axis}};
  call.value = ledger_->new_value();
  call.epoch = user.epoch();
  if (nonce) call.nonce = nonce->text;
  if (nonce) call.nonce_came = nonce->came;
  call.is_fit = nonce.has_value();
  if (method == "line.move") {
    call.axes = {"a", "c"};
    params = {{"axes", {"a", "c"}}, {"positions_microsteps", {call.value, call.value}}};
    return call;
  }
  params["axis"] = axis;
  if (method == "parameter.set") {
    params["parameter"] = ap::target_position;
    params["value"] = call.value;
  } else {
    params[method == "axis.rotate" ? "velocity_internal" : "position_microsteps"] = call.value;
  }
  return call;
}

awaitable<bool> FleetWorld::see_to_nonce(std::shared_ptr<FleetUser> user) {
  for (int tries = 0; tries < 2; ++tries) {
    const auto correlation = user->publish("nonce", {});
    auto waiting = user->answer_to(correlation, seconds(2));
    const auto answer = co_await std::move(waiting);
    if (answer) co_return true;
  }
  co_return false;
}

awaitable<void> FleetWorld::move(std::shared_ptr<FleetUser> user, Random& random) {
  const auto nonce = user->take_nonce();
  if (!nonce) co_return;
  const bool sets = user->name() == "ben" && random.one_in(3);
  const bool is_line = !sets && random.one_in(4);
  json::object params;
  auto call = call_of(*user,
                      sets      ? "parameter.set"
                      : is_line ? "line.move"
                                : "axis.move_to",
                      any_axis(random), nonce, params);
  const auto method = call.method;
  Form form;
  form.qos = random.one_in(3) ? 1 : 0;
  if (random.one_in(3)) form.expiry_s = 2;
  note_action(method);
  // Wall clocks are years off: nothing may go by what is said of time.
  if (random.one_in(4)) params["sent_at_ms"] = random.between(0, std::int64_t{1} << 52);
  const auto said = user->with_epoch_and_nonce(std::move(params), nonce->text);
  ledger_->on_made(std::move(call), now());
  const auto publication = user->publication_of(method, said, form);
  user->publish(publication);
  said_[user->name()].push_back(publication);
  if (random.one_in(6)) {
    auto stopping = stop_until_answered(user, false, seconds(20));
    co_await std::move(stopping);
    co_return;
  }
  if (random.one_in(3)) co_return;
  auto waiting = user->answer_to(publication.correlation, milliseconds(random.between(200, 3000)));
  co_await std::move(waiting);
}

awaitable<void> FleetWorld::lease_and_rotate(std::shared_ptr<FleetUser> user, Random& random) {
  auto& held = leases_[user->name()];
  const auto axis = any_axis(random);
  held = LeaseHeld{};
  held.axis = axis;
  held.ttl = milliseconds(random.between(300, 3000));
  const auto asked_ms = trouble_.canary == FleetCanary::lease_for_long ? 60'000 : held.ttl.count();
  auto nonce = user->take_nonce();
  if (!nonce) co_return;
  note_action("lease.acquire");
  json::object params{{"axes", {axis}}, {"ttl_ms", asked_ms}};
  auto correlation =
      user->publish("lease.acquire", user->with_epoch_and_nonce(std::move(params), nonce->text));
  auto waiting = user->answer_to(correlation, seconds(2));
  auto answer = co_await std::move(waiting);
  if (!has_result(answer)) co_return;
  ledger_->on_nonce_used(nonce->text);
  const auto& granted = answer->at("result").as_object();
  held.lease = granted.at("lease").as_int64();
  held.epoch = granted.at("epoch").as_int64();
  held.said = now();
  held.frozen_then = frozen();
  nonce = user->take_nonce();
  if (!nonce) co_return;
  params.clear();
  auto call = call_of(*user, "axis.rotate", axis, nonce, params);
  call.has_lease = true;
  params["lease"] = held.lease;
  params["epoch"] = held.epoch;
  note_action("axis.rotate");
  const auto said = user->with_epoch_and_nonce(std::move(params), nonce->text);
  ledger_->on_made(std::move(call), now());
  correlation = user->publish("axis.rotate", said);
  waiting = user->answer_to(correlation, seconds(1));
  answer = co_await std::move(waiting);
  auto renewing = renew(user, static_cast<int>(random.between(0, 6)));
  co_await std::move(renewing);
}

awaitable<void> FleetWorld::renew(std::shared_ptr<FleetUser> user, int times) {
  for (; times > 0; --times) {
    auto& held = leases_[user->name()];
    auto resting = rest(held.ttl / 3);
    co_await std::move(resting);
    auto nonce = user->take_nonce();
    if (!nonce) {
      auto getting = see_to_nonce(user);
      const bool has = co_await std::move(getting);
      if (has) nonce = user->take_nonce();
    }
    if (!nonce) co_return;
    note_action("lease.renew");
    json::object params{{"lease", held.lease}, {"epoch", held.epoch}};
    held.said = now();
    held.frozen_then = frozen();
    const auto correlation =
        user->publish("lease.renew", user->with_epoch_and_nonce(std::move(params), nonce->text));
    auto waiting = user->answer_to(correlation, seconds(1));
    const auto answer = co_await std::move(waiting);
    if (answer && !has_result(answer)) co_return;
  }
}

awaitable<void> FleetWorld::stop_until_answered(std::shared_ptr<FleetUser> user, bool of_all,
                                                tmcl::Duration patience) {
  const auto deadline = now() + patience;
  const auto topic = of_all ? std::string("tmcl/v1/all/stop")
                            : std::string("tmcl/v1/") + FleetUser::gateway + "/stop";
  const auto place = of_all ? std::string("all") : std::string(FleetUser::gateway);
  note_action(of_all ? "all/stop" : "stop");
  stop_noted_ = now();
  while (now() < deadline) {
    Publication stop{.topic = topic, .qos = 1};
    stop.response_topic = "tmcl/v1/reply/" + user->name() + "/" + place + "/s";
    stop.correlation = user->next_correlation();
    user->publish(stop);
    stop_noted_ = now();
    auto waiting = user->answer_to(stop.correlation, stop_interval);
    const auto answer = co_await std::move(waiting);
    if (has_result(answer)) co_return;
  }
  if (!trouble_.faults) ledger_->complain("a stop of " + user->name() + " has no answer");
}

awaitable<void> FleetWorld::do_well(std::shared_ptr<FleetUser> user, Random& random) {
  auto getting = see_to_nonce(user);
  const bool has_nonce = co_await std::move(getting);
  if (!has_nonce) co_return;
  switch (random.between(0, 7)) {
    case 0:
    case 1: {
      auto rotating = lease_and_rotate(user, random);
      co_await std::move(rotating);
      break;
    }
    case 2: {
      auto stopping = stop_until_answered(user, random.one_in(3), seconds(20));
      co_await std::move(stopping);
      break;
    }
    case 3: {
      note_action("axis.stop");
      const auto correlation =
          user->publish("axis.stop", {{"params", {{"axis", any_axis(random)}}}});
      auto waiting = user->answer_to(correlation, seconds(1));
      co_await std::move(waiting);
      break;
    }
    default: {
      auto moving = move(user, random);
      co_await std::move(moving);
    }
  }
}

// ---- users: carelessly, and with bad intent ----------------------------------------------------

void FleetWorld::do_carelessly(FleetUser& user, Random& random) {
  auto& said = said_[user.name()];
  json::object params;
  const auto axis = any_axis(random);
  switch (random.between(0, 6)) {
    case 0:
    case 1: {  // The same call once more, and again.
      if (said.empty()) return;
      const auto last = static_cast<std::int64_t>(said.size()) - 1;
      const auto again = said[static_cast<std::size_t>(random.between(0, last))];
      note_action("sent again");
      for (auto times = random.between(1, 3); times > 0; --times) {
        ledger_->on_published(value_in(again.payload), now());
        user.publish(again);
      }
      return;
    }
    case 2: {  // With what was good in another connection, or for another call.
      // What it was taken for may have got lost: then it is as good as new.
      std::optional<Nonce> nonce;
      if (!user.used_nonces.empty()) nonce = user.used_nonces.front();
      auto call = call_of(user, "axis.move_to", axis, nonce, params);
      if (!user.old_epochs.empty() && random.one_in(2)) call.epoch = *user.old_epochs.rbegin();
      const json::object with_old{{"params", params}, {"epoch", call.epoch}, {"nonce", call.nonce}};
      ledger_->on_made(std::move(call), now());
      note_action("old nonce");
      user.publish("axis.move_to", with_old);
      return;
    }
    case 3: {  // Retained.
      const auto nonce = user.take_nonce();
      auto call = call_of(user, "axis.move_to", axis, nonce, params);
      call.is_fit = false;
      ledger_->on_made(std::move(call), now());
      note_action("retained call");
      user.publish("axis.move_to", user.with_epoch_and_nonce(params, nonce ? nonce->text : ""),
                   {.retained = true, .qos = 1});
      return;
    }
    case 4: {  // Turning without a lease.
      const auto nonce = user.take_nonce();
      auto call = call_of(user, "axis.rotate", axis, nonce, params);
      call.is_fit = false;
      ledger_->on_made(std::move(call), now());
      note_action("no lease");
      user.publish("axis.rotate", user.with_epoch_and_nonce(params, nonce ? nonce->text : ""));
      return;
    }
    case 5: {  // A stop that stays: that of all for ever, and a gateway stops when it connects.
      note_action("retained stop");
      stop_noted_ = now();
      const std::string of = random.one_in(4) ? "all" : FleetUser::gateway;
      user.publish(
          {.topic = "tmcl/v1/" + of + "/stop", .payload = "{}", .retained = true, .qos = 1});
      return;
    }
    default: {  // One nonce for two calls at once: one of them is carried out.
      const auto nonce = user.take_nonce();
      if (!nonce) return;
      note_action("nonce for two");
      for (int i = 0; i < 2; ++i) {
        params.clear();
        ledger_->on_made(call_of(user, "axis.move_to", axis, nonce, params), now());
        user.publish("axis.move_to", user.with_epoch_and_nonce(params, nonce->text), {.qos = i});
      }
    }
  }
}

void FleetWorld::do_hostile_things(FleetUser& user, Random& random) {
  const auto hall = std::string("tmcl/v1/") + FleetUser::gateway;
  json::object params;
  switch (random.between(0, 8)) {
    case 0:
      note_action("forged birth");
      return user.publish({.topic = hall + "/birth",
                           .payload = R"({"online":true,"epoch":"forged","axes":[]})",
                           .retained = true,
                           .qos = 1});
    case 1:
      note_action("foreign answer");
      return user.publish({.topic = "tmcl/v1/reply/anna/hall/x",
                           .payload = R"({"result":{},"epoch":"forged","nonce":"forged"})",
                           .qos = 1,
                           .correlation = "anna-1"});
    case 2: {  // As another user.
      auto call = call_of(user, "axis.move_to", "a", std::nullopt, params);
      call.is_fit = false;
      ledger_->on_made(std::move(call), now());
      note_action("as another user");
      return user.publish({.topic = hall + "/call/operate/anna/axis.move_to",
                           .payload = json::serialize(user.with_epoch_and_nonce(params, "")),
                           .qos = 1,
                           .response_topic = user.reply_topic(),
                           .correlation = user.next_correlation()});
    }
    case 3: {  // With the role of another.
      const auto nonce = user.take_nonce();
      auto call = call_of(user, "axis.move_to", "b", nonce, params);
      call.is_fit = call.is_fit && user.name() != "eve";
      ledger_->on_made(std::move(call), now());
      note_action("answer elsewhere");
      user.publish("axis.move_to", user.with_epoch_and_nonce(params, nonce ? nonce->text : ""),
                   {.response_topic = "tmcl/v1/reply/anna/hall/x"});
      return;
    }
    case 4:
      note_action("too large");
      return user.publish({.topic = user.call_topic("axis.move_to"),
                           .payload = std::string(random.one_in(4) ? 1'300'000 : 80'000, 'x'),
                           .correlation = user.next_correlation()});
    case 5: note_action("wildcard"); return user.publish({.topic = "tmcl/v1/+/stop"});
    case 6: {
      note_action("nonsense");
      const std::array<std::string, 4> texts{"{", "[]", R"({"params":[]})",
                                             R"({"params":{},"x":1})"};
      user.publish("axis.move_to", {},
                   {.payload = texts.at(static_cast<std::size_t>(random.between(0, 3)))});
      return;
    }
    case 7:
      note_action("wish without end");
      return user.publish({.topic = hall + "/want/" + user.name(),
                           .payload = "1",
                           .retained = true,
                           .expiry_s = random.one_in(2) ? std::optional(30U) : std::nullopt});
    default:
      note_action("flood");
      for (auto left = random.between(50, 200); left > 0; --left)
        user.publish("axis.get_state", {{"params", {{"axis", "a"}}}});
  }
}

awaitable<void> FleetWorld::do_something(std::shared_ptr<FleetUser> user, Random& random) {
  const auto kind = random.between(0, 9);
  if (kind >= 8 || user->name() == "eve") {
    do_hostile_things(*user, random);
  } else if (kind >= 5) {
    do_carelessly(*user, random);
  } else {
    auto doing = do_well(user, random);
    co_await std::move(doing);
  }
  if (user->name() != "eve" || !random.one_in(4)) co_return;
  auto stopping = stop_until_answered(user, random.one_in(2), seconds(20));
  co_await std::move(stopping);
}

awaitable<void> FleetWorld::act(std::shared_ptr<FleetUser> user, std::uint64_t number) {
  auto random = generator(seed_, "user " + std::to_string(number));
  user->start();
  auto resting = rest(seconds(1));
  co_await std::move(resting);
  for (int i = 0; i < trouble_.actions; ++i) {
    resting = rest(std::chrono::microseconds(random.any_size(800'000)));
    co_await std::move(resting);
    auto doing = do_something(user, random);
    co_await std::move(doing);
  }
  --acting_;
}

// ---- faults ------------------------------------------------------------------------------------

void FleetWorld::note_fault(const std::string& what, tmcl::Duration time) {
  const auto ms = std::chrono::duration_cast<milliseconds>(time).count();
  ledger_->note(now(), fmt::format("{}, {} ms", what, ms));
}

void FleetWorld::break_line(std::int64_t kind, bool is_of_calls, tmcl::Duration time,
                            Random& random) {
  const auto line = is_of_calls ? calls_ : stops_;
  const std::string of_line = is_of_calls ? "the connection of calls " : "that of stops ";
  switch (kind) {
    case 0:
      note_fault(of_line + "is cut", time);
      if (line) line->cut(random.one_in(2));
      return;
    case 1:
      note_fault(of_line + "falls silent", time);
      if (line) line->fall_silent();
      return;
    case 2:
      note_fault(of_line + "stalls downwards", time);
      if (line) line->stall_down(time);
      return;
    default:
      note_fault(of_line + "stalls upwards", time);
      if (line) line->stall_up(time);
  }
}

void FleetWorld::break_user(std::int64_t kind, const FleetUser& user, tmcl::Duration time,
                            Random& random) {
  const auto of_user = user.connection();
  switch (kind) {
    case 4:
      note_fault("that of " + user.name() + " is cut", time);
      if (of_user) of_user->cut(random.one_in(2));
      return;
    case 5:
      note_fault("that of " + user.name() + " stalls upwards", time);
      if (of_user) of_user->stall_up(time);
      return;
    default:
      note_fault("that of " + user.name() + " stalls downwards", time);
      if (of_user) of_user->stall_down(time);
  }
}

void FleetWorld::break_something(Random& random) {
  const bool is_of_calls = random.one_in(2);
  const auto last = static_cast<std::int64_t>(users_.size()) - 1;
  const auto& user = *users_[static_cast<std::size_t>(random.between(0, last))];
  const tmcl::Duration time = milliseconds(random.any_size(8'000));
  const auto turns = static_cast<int>(random.between(0, 12));
  const auto note = [&](const std::string& what) { note_fault(what, time); };
  constexpr std::int64_t first_of_users = 4;
  constexpr std::int64_t first_of_programs = 7;
  const auto kind = random.between(0, 16);
  if (kind < first_of_users) return break_line(kind, is_of_calls, time, random);
  if (kind < first_of_programs) return break_user(kind, user, time, random);
  switch (kind) {
    case 7: note("the broker stands still"); return network_->freeze_broker(time);
    case 8: {
      note("the broker begins anew");
      const bool keeps = random.one_in(2);
      return network_->restart_broker(keeps, milliseconds(random.any_size(4'000)));
    }
    case 9: note("the bridge stands still"); return programs_.freeze(bridge_program_, turns, time);
    case 10: note("tmcld stands still"); return programs_.freeze(gateway_program_, turns, time);
    case 11: {
      note("both stand still");
      programs_.freeze(bridge_program_, turns, time);
      const auto turns_of_gateway = static_cast<int>(random.between(0, 12));
      const tmcl::Duration of_gateway = random.one_in(2) ? time : tmcl::Duration(time / 2);
      return programs_.freeze(gateway_program_, turns_of_gateway, of_gateway);
    }
    case 12:  // Another program comes under its name.
      note("another birth");
      network_->broker().publish_as_broker(
          {.topic = std::string("tmcl/v1/") + FleetUser::gateway + "/birth",
           .payload = random.one_in(2) ? "" : R"({"online":false,"epoch":"old"})",
           .retained = true},
          now());
      return;
    case 13:
    case 14: {  // While a call is on its way through one of them.
      const bool is_bridge = random.one_in(2);
      auto& program = is_bridge ? bridge_program_ : gateway_program_;
      note(is_bridge ? "the bridge will stand still at a call"
                     : "tmcld will stand still at a call");
      freeze_at_call_ = [this, &program, turns, time] { programs_.freeze(program, turns, time); };
      return;
    }
    case 15: {  // With a call on its way, too.
      note("the computer will sleep at a call");
      const auto turns_of_gateway = static_cast<int>(random.between(0, 12));
      freeze_at_call_ = [this, turns, turns_of_gateway, long_time = time + seconds(5)] {
        programs_.freeze(bridge_program_, turns, long_time, true);
        programs_.freeze(gateway_program_, turns_of_gateway, long_time, true);
      };
      return;
    }
    default:
      drops_noted_ = now();
      note("tmcld cuts its clients off");
      boost::asio::post(gateway_program_.context, [server = server_] { server->close_sessions(); });
  }
}

awaitable<void> FleetWorld::break_things() {
  auto random = generator(seed_, "faults");
  auto resting = rest(seconds(2));
  co_await std::move(resting);
  while (acting_ > 0) {
    resting = rest(milliseconds(random.any_size(4'000)));
    co_await std::move(resting);
    if (trouble_.faults) break_something(random);
  }
  breaks_ = false;
}

// ---- who looks ---------------------------------------------------------------------------------

std::int32_t FleetWorld::value_of(const WorldAxis& axis, std::uint8_t parameter) {
  auto& bench = (axis.bus == serial_->name() ? *serial_ : *can_).bench();
  bench.run_due();
  for (const auto& module : bench.modules())
    if (module->globals().value(tmcl::global_parameter::can_id) == number(axis.address.module))
      return *module->axis(axis.address.motor).get(parameter);
  throw std::logic_error("no module of " + axis.name);
}

void FleetWorld::look_at_turning() {
  if (gateway_program_.is_frozen()) return;
  for (const auto& axis : fleet_axes()) {
    const auto* call = ledger_->turned_by(axis.name);
    if (call == nullptr || call->unattended) continue;
    const auto held = leases_.find(call->user);
    if (held == leases_.end()) continue;
    const auto& lease = held->second;
    const auto most = FleetLedger::longest_age + lease.ttl + time_to_rest +
                      FleetLedger::time_to_stop + (frozen() - lease.frozen_then);
    const bool is_over = now() - std::max(lease.said, call->made) > most;
    if (!is_over || value_of(axis, ap::actual_velocity) == 0) continue;
    if (std::exchange(complained_[axis.name], true)) continue;
    ledger_->complain(axis.name + " turns, although its lease has ended");
  }
}

awaitable<void> FleetWorld::look_around() {
  while (!ends_) {
    auto resting = rest(milliseconds(100));
    co_await std::move(resting);
    ledger_->look(now());
    look_at_turning();
  }
}

/// On an axis of its own, over no broker.
awaitable<void> FleetWorld::local_client() {
  const auto peer = std::make_shared<WorldPeer>(trace_);
  peer->number = gateway_->add_client().number;
  auto random = generator(seed_, "local");
  auto resting = rest(seconds(2));
  co_await std::move(resting);
  while (!ends_) {
    resting = rest(milliseconds(random.between(200, 1'500)));
    co_await std::move(resting);
    FleetCall call{.user = "local", .method = "axis.move_to", .axes = {local_axis}};
    call.is_local = true;
    call.value = ledger_->new_value();
    const json::object line{
        {"jsonrpc", "2.0"},
        {"id", 1},
        {"method", call.method},
        {"params", {{"axis", local_axis}, {"position_microsteps", call.value}}}};
    const auto began = now();
    const auto frozen_then = gateway_program_.frozen();
    ledger_->on_made(std::move(call), now());
    auto request = parse_request(json::serialize(line)).request;
    auto dispatched = dispatch(gateway_, peer, std::move(*request));
    const auto result = co_await std::move(dispatched);
    const bool is_excused = gateway_program_.frozen() != frozen_then ||
                            now() - stop_noted_ < seconds(25) || trouble_.faults;
    if (!result && !is_excused)
      ledger_->complain("a call of the local client is refused: " + result.error().message);
    const bool is_late = now() - began > seconds(1);
    if (is_late && gateway_program_.frozen() == frozen_then)
      ledger_->complain("a call of the local client took longer than a second");
  }
  gateway_->remove_client(peer->number);
}

void FleetWorld::look_at_state(const std::string& axis) {
  const auto topic = std::string("tmcl/v1/") + FleetUser::gateway + "/state/" + axis;
  const auto kept = network_->broker().retained(topic, now());
  if (!kept) return ledger_->complain("no state of " + axis + " is retained");
  const auto state = json::parse(kept->payload).as_object();
  const auto& of_world = *std::ranges::find(fleet_axes(), axis, &WorldAxis::name);
  const auto place = value_of(of_world, ap::actual_position);
  if (state.at("position_microsteps") != place || state.at("moving") != false)
    ledger_->complain(axis + " is at " + std::to_string(place) + ", and its state says " +
                      kept->payload);
}

/// When nothing is broken any more, and everything stands.
void FleetWorld::look_at_end() {
  const auto hall = std::string("tmcl/v1/") + FleetUser::gateway;
  const auto birth = network_->broker().retained(hall + "/birth", now());
  if (!birth) return ledger_->complain("no birth is retained");
  const auto said = json::parse(birth->payload).as_object();
  const json::array axes{"a", "b", "c", "d"};
  if (said.at("online") != true || said.at("epoch").as_string() != calls_epoch_ ||
      !said.contains("axes") || said.at("axes") != axes)
    ledger_->complain("the birth is not that of epoch " + calls_epoch_ + ": " + birth->payload);
  for (const auto& axis : fleet_axes()) {
    if (value_of(axis, ap::actual_velocity) != 0)
      ledger_->complain(axis.name + " turns after the last stop");
    look_at_state(axis.name);
  }
  for (const auto& topic : network_->broker().retained_topics())
    if (topic == hall + "/stop" || topic.find("/call/") != topic.npos)
      ledger_->complain("still retained: " + topic);
}

void FleetWorld::run() {
  const auto outside = outside_.context.get_executor();
  acting_ = static_cast<int>(users_.size());
  for (std::size_t i = 0; i < users_.size(); ++i) spawn(outside, act(users_[i], i));
  spawn(outside, break_things());
  spawn(outside, look_around());
  spawn(gateway_program_.context.get_executor(), local_client());
  if (!programs_.run_while_not([this] { return !breaks_; }, std::chrono::minutes(20)))
    ledger_->complain("a user has no end");
  // Pauses between attempts to connect get longer: 15 s, and patience as long.
  const auto is_well = [this] {
    return calls_ && calls_->is_open() && !calls_->is_disturbed() && stops_->is_open() &&
           !stops_->is_disturbed() && users_.front()->is_connected() &&
           users_.front()->gateway_is_online();
  };
  // The last of what was broken may be on its way.
  bool is_back = true;
  do {
    is_back = programs_.run_while_not(is_well, seconds(60));
    programs_.run_for(seconds(12));
  } while (is_back && !is_well());
  if (!is_back)
    ledger_->complain(
        fmt::format("the gateway does not come back: calls {}, stops {}, user {}, who sees it {}",
                    calls_ && calls_->is_open(), stops_ && stops_->is_open(),
                    users_.front()->is_connected(), users_.front()->gateway_is_online()));
  bool has_stopped = false;
  auto last_stop = [](FleetWorld& self, bool& done) -> awaitable<void> {
    auto stopping = self.stop_until_answered(self.users_.front(), false, seconds(20));
    co_await std::move(stopping);
    done = true;
  };
  const auto asked = now();
  ends_ = true;
  spawn(outside, last_stop(*this, has_stopped));
  programs_.run_while_not([&] { return has_stopped; }, seconds(30));
  if (now() - asked > seconds(2)) ledger_->complain("the last stop was not answered in time");
  programs_.run_for(seconds(3));
  ledger_->look(now());
  look_at_end();
  trace_.add(answered());
  trace_.add(static_cast<std::uint64_t>(now().time_since_epoch().count()));
}

}  // namespace tmcld::test
