/// Who is connected to a gateway, and what was moved and set by whom.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tmcl/api/field.hpp"

namespace tmcl::api::clients {

struct Client {
  TMCL_STRUCT(Client);
  TMCL_FIELD(std::string, client, "who it is, as other methods tell it");
  TMCL_FIELD(std::string, door,
             "by which it came: socket; http or websocket; port, where hosts speak TMCL; process, "
             "that of the gateway itself");
  TMCL_FIELD(std::optional<std::string>, address, "where it is; null: on this computer");
  TMCL_FIELD(std::optional<std::uint32_t>, uid, "number of its user; null: not of this computer");
  TMCL_FIELD(std::optional<std::int32_t>, pid, "its process; null: not of this computer");
  TMCL_FIELD(std::optional<std::string>, token, "name of the token that let it in; null: none did");
  TMCL_FIELD(std::string, role, "what it may do: stop, observe, operate or configure");
  TMCL_FIELD(std::vector<std::string>, axes, "those that it has leased");
  TMCL_FIELD(double, since_s, "for how long it has been connected");
  TMCL_FIELD(std::uint64_t, requests, "its calls that are in progress; this one is among them");
};
struct Clients {
  TMCL_STRUCT(Clients);
  TMCL_FIELD(std::vector<Client>, clients, "who is connected; who came first is first");
};
struct List {
  TMCL_METHOD("client.list", reads, Clients, "who is connected, by which door, with which role",
              List);
};

}  // namespace tmcl::api::clients

namespace tmcl::api::audit {

struct Line {
  TMCL_STRUCT(Line);
  TMCL_FIELD(std::uint64_t, number, "counts what was audited since tmcld was started, from 1 on");
  TMCL_FIELD(std::int64_t, utc_us, "when, in microseconds since 1970");
  TMCL_FIELD(std::optional<std::uint32_t>, uid,
             "number of the user; null: the text says who it is");
  TMCL_FIELD(std::optional<std::int32_t>, pid, "the process; null: the text says who it is");
  TMCL_FIELD(std::string, text, "what was asked for, and what came of it");
};
struct Lines {
  TMCL_STRUCT(Lines);
  TMCL_FIELD(std::uint64_t, last, "number of the newest one that there is");
  TMCL_FIELD(std::uint64_t, dropped, "how many after 'after' are not remembered any more");
  TMCL_FIELD(std::vector<Line>, lines, "the oldest first");
};
struct Tail {
  TMCL_METHOD("audit.tail", reads, Lines,
              "what was moved, set and stopped lately, by whom: the last 1000 lines", Tail);
  TMCL_FIELD(std::optional<std::int32_t>, lines, "how many at most; 100 if absent", {1, 1000});
  TMCL_FIELD(std::optional<std::uint64_t>, after,
             "those behind the one of this number; the newest if absent");
};

}  // namespace tmcl::api::audit
