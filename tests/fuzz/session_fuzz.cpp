// The bytes as what clients do on the daemon's socket: they connect, call methods well and badly,
// send anything, go away; meanwhile time passes and answers of the module go wrong. What they are
// told and what moves is compared with session_model.hpp.
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "session_model.hpp"
#include "session_world.hpp"

namespace tmcld::fuzz {
namespace {

using namespace std::chrono_literals;

/// Reads zeros behind its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool is_over() const { return left_ == 0; }
  std::uint8_t next() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  std::size_t below(std::size_t limit) { return next() % limit; }
  std::int16_t number() {
    const auto high = next();
    return static_cast<std::int16_t>(high << 8 | next());
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

class Play {
 public:
  explicit Play(Bytes bytes) : bytes_(bytes) {
    world_.wire.on_request = [this](const tmcl::Request& request) { model_.on_request(request); };
  }

  /// So much is enough to find anything, and takes some milliseconds.
  void run() {
    constexpr int most_actions = 40;
    for (int action = 0; action < most_actions && !bytes_.is_over(); ++action) {
      act();
      settle();
    }
    end();
  }

 private:
  // Connections of the last kind take stops only.
  static constexpr std::size_t places = 4;
  static constexpr std::size_t for_stops = places - 1;

  struct Client {
    std::unique_ptr<SessionClient> socket;
    Connection number = 0;
    bool has_ended_input = false;
    std::string unread{};
  };

  void act() {
    auto& client = clients_[bytes_.below(places)];
    const auto what = bytes_.below(16);
    if (!client.socket) connect(client);
    switch (what) {
      case 0: return close(client);
      case 1: return end_input(client);
      case 2: return send(client, damaged(line()));
      case 3: return send(client, raw());
      case 4: return spoil();
      case 5: return unplug();
      case 6:
      case 7: return pass();
      default: return send(client, line());
    }
  }

  void connect(Client& client) {
    const bool stops = &client == &clients_[for_stops];
    client = {world_.connect(stops ? Session::Serves::stops : Session::Serves::all),
              ++last_connection_};
    model_.connect(client.number, stops);
    settle();
  }
  void close(Client& client) {
    read(client);
    if (!client.socket) return;
    model_.close(client.number);
    client.socket->close();
    gone_.push_back(std::move(client.socket));
  }
  void end_input(Client& client) {
    model_.end_input(client.number);
    client.has_ended_input = true;
    client.socket->end_input();
  }
  void send(Client& client, const std::string& bytes) {
    if (client.has_ended_input) return;
    model_.send(client.number, bytes, world_.time.now());
    client.socket->send(bytes);
  }
  void spoil() {
    const auto fate = static_cast<Fate>(bytes_.below(5));
    world_.wire.spoil(fate, bytes_.next() % 16U);
  }
  void unplug() {
    model_.forget_leases();
    world_.wire.unplug();
  }
  void pass() {
    constexpr std::array times{0ms, 1ms, 5ms, 20ms, 100ms, 300ms, 1000ms, 2000ms};
    world_.time.run_for(times[bytes_.below(times.size())]);
  }

  // ---- what is sent ----

  std::string line() {
    json::object params;
    const auto method = call(params);
    // Under somebody's lease, perhaps with an epoch that was never right.
    if (bytes_.below(8) == 0) name_lease(params);
    return json::serialize(json::object{{"jsonrpc", "2.0"},
                                        {"id", "q" + std::to_string(++last_id_)},
                                        {"method", method},
                                        {"params", params}}) +
           '\n';
  }
  json::string axis() { return json::string(axis_names[bytes_.below(axis_names.size())]); }
  json::array axes() {
    const auto chosen = bytes_.below(3);
    if (chosen < axis_names.size()) return {json::string(axis_names[chosen])};
    return {"x", "y"};
  }
  void name_lease(json::object& params) {
    const auto& leases = model_.leases();
    const auto chosen = bytes_.next();
    const auto lease = leases.empty() ? KnownLease{} : leases[chosen % leases.size()];
    params["lease"] = lease.lease;
    params["epoch"] = lease.epoch + (chosen < 64 ? 1 : 0);
  }

  std::string_view call(json::object& params) {
    switch (bytes_.below(20)) {
      case 0:
      case 1:
        params = {{"axis", axis()}, {"position_microsteps", bytes_.number()}};
        return "axis.move_to";
      case 2:
        params = {{"axis", axis()}, {"distance_microsteps", bytes_.number()}};
        return "axis.move_by";
      case 3:
        params = {{"axis", axis()}, {"velocity_internal", bytes_.number() % 2048}};
        return "axis.rotate";
      case 4:
      case 5: params = {{"axis", axis()}}; return "axis.stop";
      case 6: return "system.stop_all";
      case 7: params = {{"axis", axis()}, {"timeout_ms", bytes_.next()}}; return "axis.wait";
      case 8:
      case 9:
        params = {{"axes", axes()}, {"ttl_ms", 200 + 20 * bytes_.next()}};
        return "lease.acquire";
      case 10: name_lease(params); return "lease.renew";
      case 11: name_lease(params); return "lease.release";
      case 12:
        params = {{"axes", axes()}, {"interval_ms", 50 + 2 * bytes_.next()}};
        return "subscribe";
      case 13: params = {{"subscription", bytes_.below(4)}}; return "unsubscribe";
      case 14:
        params = {{"axes", {"x", "y"}},
                  {"positions_microsteps", {bytes_.number(), bytes_.number()}}};
        return "line.move";
      case 15:
        params = {{"axes", {"x", "y"}}, {"text", "G1 X1 Y2 F600\nG1 X3 Y0\n"}, {"deviation", 1}};
        return "path.run";
      case 16: params = {{"axes", axes()}}; return "path.stop";
      case 17: params = {{"axis", axis()}, {"timeout_ms", 500}}; return "axis.home";
      case 18:
        params = {{"axis", axis()}, {"parameter", bytes_.below(8)}, {"value", bytes_.next()}};
        return "parameter.set";
      default: params = {{"axis", axis()}}; return "axis.get_state";
    }
  }

  std::string damaged(std::string line) {
    const auto place = bytes_.next() * line.size() / 256;
    const auto byte = static_cast<char>(bytes_.next());
    switch (bytes_.below(4)) {
      case 0: line[place] = byte; break;
      case 1: line.insert(place, 1, byte); break;
      case 2: line.erase(place, 1U + bytes_.below(8)); break;
      default: line.resize(place);
    }
    return line;
  }
  std::string raw() {
    std::string bytes;
    for (auto left = bytes_.next(); left > 0 && !bytes_.is_over(); --left)
      bytes += static_cast<char>(bytes_.next());
    return bytes;
  }

  // ---- what comes back ----

  void settle() {
    world_.time.settle();
    for (auto& client : clients_) read(client);
  }
  void read(Client& client) {
    if (!client.socket) return;
    const bool is_open = client.socket->read(client.unread);
    std::size_t begin = 0;
    for (auto end = client.unread.find('\n'); end != std::string::npos;
         end = client.unread.find('\n', begin)) {
      const auto line = std::string_view(client.unread).substr(begin, end - begin);
      model_.on_line(client.number, line, world_.time.now());
      begin = end + 1;
    }
    client.unread.erase(0, begin);
    if (is_open) return;
    model_.must(client.has_ended_input, "who reads and goes on sending is not cut off");
    model_.must(!model_.awaits_answers(client.number), "who has ended its input gets its answers");
    model_.close(client.number);
    gone_.push_back(std::move(client.socket));
  }

  /// On a line that works everything ends, once all axes are told to stop.
  void end() {
    world_.wire.spoil(Fate::delivered, 0);
    auto& last = clients_[for_stops];
    if (last.socket && last.has_ended_input) close(last);
    if (!last.socket) connect(last);
    world_.time.run_for(1s);
    send(last, "\n{\"jsonrpc\":\"2.0\",\"id\":\"end\",\"method\":\"system.stop_all\"}\n");
    const bool all_answered = world_.time.run_while_not(
        [&] {
          for (auto& client : clients_) read(client);
          return std::ranges::none_of(clients_, [&](const Client& client) {
            return client.socket && model_.awaits_answers(client.number);
          });
        },
        10min);
    model_.must(all_answered, "everything is answered");
    for (auto& client : clients_)
      if (client.socket) close(client);
    world_.time.run_for(5s);
    for (const auto& socket : gone_) require(socket->is_forgotten(), "who has gone is forgotten");
  }

  Bytes bytes_;
  SessionModel model_;
  SessionWorld world_;
  std::array<Client, places> clients_;
  std::vector<std::unique_ptr<SessionClient>> gone_;
  Connection last_connection_ = 0;
  int last_id_ = 0;
};

}  // namespace
}  // namespace tmcld::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tmcld::fuzz::Play(tmcld::fuzz::Bytes(data, size)).run();
  return 0;
}
